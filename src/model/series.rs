//! Φcam under rules that are refined step by step.

use crate::matrix::Matrix;

/// The last of a sequence of ever finer rules, and what the last two steps changed.
pub(super) struct Series {
    pub level: usize,
    pub phi: Matrix,
    changed: Option<Matrix>,
    before: Option<Matrix>,
}

impl Series {
    /// The first rule.
    pub(super) fn at(level: usize, phi: Matrix) -> Self {
        Self {
            level,
            phi,
            changed: None,
            before: None,
        }
    }

    /// Φcam at the next level.
    pub(super) fn refine(&mut self, next: Matrix) {
        self.before = self.changed.take();
        self.changed = Some((&next - &self.phi).abs());
        self.phi = next;
        self.level += 1;
    }

    /// Relative Frobenius norm of the last change; 1 where there was none.
    pub(super) fn change(&self) -> f64 {
        let relative = |c: &Matrix| c.norm() / self.phi.norm().max(f64::MIN_POSITIVE);
        self.changed.as_ref().map_or(1.0, relative)
    }

    /// Whether the last change was below `whole` of Φcam, and below `entry` of each entry.
    pub(super) fn is_settled(&self, whole: f64, entry: f64) -> bool {
        let settled = |(e, x): (&f64, &f64)| *e <= entry * x.abs();
        let each = |c: &Matrix| c.iter().zip(&self.phi).all(settled);
        self.change() < whole && self.changed.as_ref().is_some_and(each)
    }

    /// How far each entry may be off: the last change e, times r/(1 − r) where that is more, r ≤
    /// 0.9 the last change over the one before; all of it where there was no change.
    pub(super) fn bound(&self) -> Matrix {
        match (&self.changed, &self.before) {
            (None, _) => self.phi.abs(),
            (Some(changed), None) => changed.clone(),
            (Some(changed), Some(before)) => changed.zip_map(before, remainder),
        }
    }
}

/// What the changes of an entry, the last and the one before, leave to come.
fn remainder(last: f64, before: f64) -> f64 {
    let ratio = if before > 0.0 {
        (last / before).min(0.9)
    } else {
        0.9
    };
    last * (ratio / (1.0 - ratio)).max(1.0)
}
