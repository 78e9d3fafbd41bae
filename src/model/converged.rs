//! The three-bounce integral itself, by quadrature over spots, hidden surfaces and footprints.

use super::cut::Cut;
use super::error::ModelError;
use super::extent::{Extent, Occlusion};
use super::kernel::Kernel;
use super::parts::{LAST_LEVEL, MOST_CONNECTIONS};
use super::visible::{Visible, visible};
use crate::matrix::Matrix;
use crate::scene::Scene;

/// Φcam by quadrature, and how far it can be trusted.
#[derive(Clone, Debug)]
pub struct Converged {
    /// Pixels × spots, W.
    pub phi: Matrix,
    /// How far each entry may be off, W: what the last refinement changed in it, e, times
    /// r/(1 − r) where that is more, r ≤ 0.9 the last change over the one before. It covers what is
    /// left of a geometric sequence, and ten times the last change at most.
    pub bound: Matrix,
    /// Relative Frobenius norm of the last change.
    pub change: f64,
    /// Nodes with which Φcam is right to about 1e-4, for what needs no more; the fewest there are
    /// where that takes too many.
    pub rough: Nodes,
    /// What share of it is left, where something stands in the way and is considered.
    pub visible: Option<Visible>,
}

impl Converged {
    /// The entry (pixel, spot) with the largest bound relative to itself, and that; `None` where
    /// nothing is lit. An entry of 0 that may be lit counts as 1.
    pub fn worst(&self) -> Option<([usize; 2], f64)> {
        let relative = |i: usize| match (self.bound[i], self.phi[i].abs()) {
            (0.0, _) => 0.0,
            (b, phi) => (b / phi).min(1.0),
        };
        let lit = (0..self.phi.len()).filter(|i| self.phi[*i] != 0.0 || self.bound[*i] != 0.0);
        let worst = lit
            .map(|i| (i, relative(i)))
            .reduce(|a, b| if b.1 > a.1 { b } else { a });
        worst.map(|(i, share)| ([i % self.phi.nrows(), i / self.phi.nrows()], share))
    }
}

impl Converged {
    /// |Φ s − Φ′ s′| ≤ b_Φ s + Φ b_s.
    fn past(mut self, visible: Option<Visible>) -> Self {
        if let Some(Visible { share, bound, .. }) = &visible {
            self.bound = self.bound.component_mul(share) + self.phi.component_mul(bound);
            self.phi.component_mul_assign(share);
        }
        self.visible = visible;
        self
    }
}

/// Refinement stops below this relative change of the whole, and of each entry.
const TARGET: f64 = 1e-10;
const ENTRY_TARGET: f64 = 1e-7;
/// Relative change below which the rule before is good enough for derivatives.
const ROUGH: f64 = 1e-4;

/// The matrix model's integral: Gauss–Legendre over each smooth texture cell of each hidden
/// surface, over each footprint and over each spot's profile, as far as `extent` asks for it,
/// refined together until Φcam changes by less than 1e-10, and every entry by less than 1e-7, or
/// the rules are as large as they may be. Cells and footprints that come close to each other or to
/// a spot are cut into smaller ones there. What stands in the way takes its share of each entry
/// ([`visible`](fn@visible)) where `extent` says so. As in the matrix model light meets three
/// surfaces, and the hidden ones are Lambertian: one that is not is taken for
/// [`Surface::lambertian_equivalent`](crate::scene::Surface::lambertian_equivalent).
///
/// # Errors
/// [`ModelError::NothingHidden`].
pub fn converged(scene: &Scene, kernel: Kernel, extent: Extent) -> Result<Converged, ModelError> {
    if scene.hidden().next().is_none() {
        return Err(ModelError::NothingHidden);
    }
    let cut = Cut::new(scene, extent);
    let mut phi = cut.integrate(scene, kernel, 0);
    let mut before: Option<Matrix> = None;
    let mut rough = None;
    let mut level = 0;
    loop {
        level += 1;
        let next = cut.integrate(scene, kernel, level);
        let changed = (&next - &phi).abs();
        let change = changed.norm() / next.norm().max(f64::MIN_POSITIVE);
        let settled = |(e, x): (&f64, &f64)| *e <= ENTRY_TARGET * x.abs();
        if change < ROUGH {
            rough = rough.or(Some(level - 1));
        }
        let done = change < TARGET && changed.iter().zip(&next).all(settled);
        let exhausted = level == LAST_LEVEL || cut.connections(level + 1) > MOST_CONNECTIONS;
        if done || exhausted {
            let bound = match before {
                None => changed,
                Some(before) => changed.zip_map(&before, remainder),
            };
            let cheap = |l: &usize| cut.connections(*l) <= 0.1 * MOST_CONNECTIONS;
            let level = rough.filter(cheap).unwrap_or(0);
            let rough = Nodes { extent, level };
            let free = Converged {
                phi: next,
                bound,
                change,
                rough,
                visible: None,
            };
            return Ok(match extent.occlusion {
                Occlusion::Ignored => free,
                Occlusion::Considered => free.past(visible(scene, kernel)?),
            });
        }
        (phi, before) = (next, Some(changed));
    }
}

/// Φcam with nothing in the way, pixels × spots, W, by the rules `nodes` as they stand, without a
/// bound.
///
/// # Errors
/// [`ModelError::NothingHidden`].
pub fn integrated(scene: &Scene, kernel: Kernel, nodes: Nodes) -> Result<Matrix, ModelError> {
    if scene.hidden().next().is_none() {
        return Err(ModelError::NothingHidden);
    }
    Ok(Cut::new(scene, nodes.extent).integrate(scene, kernel, nodes.level))
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

/// What is integrated over, and the level of refinement.
#[derive(Clone, Copy, Debug)]
pub struct Nodes {
    extent: Extent,
    level: usize,
}
