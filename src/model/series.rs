//! Φcam under rules that are refined step by step.

use super::parts::NODES;
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

    /// How far each entry may be off: the last change e, times what it leaves to come where that is
    /// more ([`remainder`]); all of it where there was no change.
    pub(super) fn bound(&self) -> Matrix {
        match (&self.changed, &self.before) {
            (None, _) => self.phi.abs(),
            (Some(changed), None) => changed.clone(),
            (Some(changed), Some(before)) => {
                let nodes = [2, 1, 0].map(|back| NODES[self.level - back]);
                changed.zip_map(before, |last, before| remainder(last, before, nodes))
            }
        }
    }
}

/// What the changes of an entry, the last and the one before, leave to come by rules of such
/// numbers of nodes: of changes that fall like r, r/(1 − r) times the last; of an error like n^−p,
/// as a kink leaves it, 1/((n₂/n₁)^p − 1) times, which is more, for rules grow by less and less. It
/// has r = (n₁^−p − n₂^−p)/(n₀^−p − n₁^−p), which falls with p.
fn remainder(last: f64, before: f64, [n0, n1, n2]: [f64; 3]) -> f64 {
    let ratio = if before > 0.0 {
        (last / before).min(0.9)
    } else {
        0.9
    };
    // Between an error that hardly falls and one that leaves less than the last change.
    let (mut low, mut high) = (0.5, 8.0);
    for _ in 0..20 {
        let p = 0.5 * (low + high);
        let [a, b, c] = [n0, n1, n2].map(|n| libm::pow(n, -p));
        if (b - c) / (a - b) > ratio {
            low = p;
        } else {
            high = p;
        }
    }
    let algebraic = 1.0 / (libm::pow(n2 / n1, low) - 1.0);
    last * (ratio / (1.0 - ratio)).max(algebraic).max(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is left of errors like n^−p is within the bound, and not far within.
    #[test]
    fn errors_that_fall_like_a_power_are_bounded() {
        for p in [0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 4.0] {
            let left = |level: usize| libm::pow(NODES[level], -p);
            let at = |level: usize| Matrix::from_element(1, 1, 1.0 + left(level));
            let mut series = Series::at(0, at(0));
            for level in 1..NODES.len() {
                series.refine(at(level));
                let (error, bound) = (left(level), series.bound()[0]);
                if level > 1 {
                    assert!(bound > 0.999 * error, "{p}, {level}: {bound} of {error}");
                    assert!(p > 2.5 || bound < 4.0 * error, "{p}, {level}: {bound}");
                }
            }
        }
    }
}
