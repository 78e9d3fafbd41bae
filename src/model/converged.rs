//! The three-bounce integral itself, by quadrature over spots, hidden surfaces and footprints.

use std::f64::consts::FRAC_1_PI;

use super::ModelError;
use super::kernel::{HiddenPoint, Kernel};
use super::parts::{
    Ball, FootprintPart, HiddenParts, LAST_LEVEL, MOST_CONNECTIONS, footprint_parts,
};
use super::wall_point::{self, WallPoint};
use crate::geometry::Basis;
use crate::matrix::Matrix;
use crate::num::quadrature::Rule;
use crate::scene::{Profile, Scene};

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

/// Whether a quantity is taken at its centre or integrated over.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Take {
    /// One point in the middle, as the matrix model has it.
    Centre,
    /// Quadrature over all of it.
    Integral,
}

/// What the three-bounce integral is integrated over.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Extent {
    /// Elements of the hidden surfaces, with their mean albedo; or the surfaces with the albedo as
    /// it varies.
    pub elements: Take,
    /// Pixels' footprints.
    pub footprints: Take,
    /// Spots' profiles.
    pub spots: Take,
}

impl Extent {
    /// Everything integrated.
    pub const FULL: Self = Self {
        elements: Take::Integral,
        footprints: Take::Integral,
        spots: Take::Integral,
    };
}

/// Refinement stops below this relative change of the whole, and of each entry.
const TARGET: f64 = 1e-10;
const ENTRY_TARGET: f64 = 1e-7;
/// Relative change below which the rule before is good enough for derivatives.
const ROUGH: f64 = 1e-4;
/// Nodes, and pixels, handled at once.
pub(super) const CHUNK: usize = 4096;
/// The Gaussian profile is cut at this many of its 1/e² radii, beyond which lies e^−32 of the
/// power.
const GAUSSIAN_REACH: f64 = 4.0;

/// The matrix model's integral: Gauss–Legendre over each smooth texture cell of each hidden
/// surface, over each footprint and over each spot's profile, as far as `extent` asks for it,
/// refined together until Φcam changes by less than 1e-10, and every entry by less than 1e-7, or
/// the rules are as large as they may be. Cells and footprints that come close to each other or to
/// a spot are cut into smaller ones there. As in the matrix model there is no occlusion, light
/// meets three surfaces, and the hidden ones are Lambertian: one that is not is taken for
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
            return Ok(Converged {
                phi: next,
                bound,
                change,
                rough,
            });
        }
        (phi, before) = (next, Some(changed));
    }
}

/// Φcam, pixels × spots, W, by the rules `nodes` as they stand, without a bound.
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

/// A scene cut into parts on which the rules converge.
pub(super) struct Cut<'a> {
    elements: Take,
    pub(super) hidden: HiddenParts<'a>,
    /// Of each pixel.
    footprints: Vec<Vec<FootprintPart>>,
    spots: usize,
    profile: Profile,
}

impl<'a> Cut<'a> {
    pub(super) fn new(scene: &'a Scene, extent: Extent) -> Self {
        let (profile, reach) = match (extent.spots, scene.laser.profile) {
            (Take::Centre, _) | (_, Profile::Ideal) => (Profile::Ideal, 0.0),
            (_, profile @ Profile::Disc { radius }) => (profile, radius),
            (_, profile @ Profile::Gaussian { radius }) => (profile, GAUSSIAN_REACH * radius),
        };
        let footprint = |p| match extent.footprints {
            Take::Centre => vec![FootprintPart::centre(scene, p)],
            Take::Integral => footprint_parts(scene, p),
        };
        let footprints: Vec<_> = (0..scene.camera.pixels()).map(footprint).collect();
        let spots = scene.laser.spots.iter().map(|s| Ball {
            middle: s.target.position,
            radius: reach,
        });
        let near: Vec<Ball> = footprints
            .iter()
            .flatten()
            .map(|p| p.ball)
            .chain(spots)
            .collect();
        Self {
            elements: extent.elements,
            hidden: HiddenParts::new(scene, &near),
            footprints,
            spots: scene.laser.spots.len(),
            profile,
        }
    }

    /// Connections between wall points and hidden points at `level`.
    fn connections(&self, level: usize) -> f64 {
        let seen = self.footprints.iter().flatten();
        let seen: usize = seen.map(|part| part.nodes(level).count()).sum();
        let lit = self.spots * profile_nodes(self.profile, 2 + 2 * level).len();
        self.hidden.count(level) as f64 * (seen + lit) as f64
    }

    /// The wall as each pixel sees it, at `level`.
    pub(super) fn seen(&self, scene: &Scene, level: usize) -> Vec<Vec<WallPoint>> {
        let seen = |p: usize| {
            let nodes = self.footprints[p].iter().flat_map(|part| part.nodes(level));
            nodes
                .map(|(ab, w)| wall_point::seen(scene, p, ab, w))
                .collect()
        };
        (0..self.footprints.len()).map(seen).collect()
    }

    /// The wall as each spot lights it, at `level`.
    pub(super) fn lit(&self, scene: &Scene, level: usize) -> Vec<Vec<WallPoint>> {
        let offsets = profile_nodes(self.profile, 2 + 2 * level);
        let lit = |l: usize| {
            let basis = Basis::around(scene.laser.spots[l].target.normal);
            let lit = |([x, y], w): &([f64; 2], f64)| {
                wall_point::lit(scene, l, basis.to_world([*x, *y, 0.0]), *w)
            };
            offsets.iter().map(lit).collect()
        };
        (0..self.spots).map(lit).collect()
    }

    /// One quadrature: Φ = Σ_q C\[p,q\]·D\[q,l\] over the nodes q of the hidden surfaces, in
    /// chunks.
    fn integrate(&self, scene: &Scene, kernel: Kernel, level: usize) -> Matrix {
        let (seen, lit) = (self.seen(scene, level), self.lit(scene, level));
        let side = |walls: &[WallPoint], point| {
            walls
                .iter()
                .map(|w| w.towards(scene, kernel, point))
                .sum::<f64>()
        };
        let hidden = match self.elements {
            Take::Centre => elements(scene),
            Take::Integral => {
                let nodes = self.hidden.nodes(level).into_iter();
                nodes.map(|node| (node.point, node.weight)).collect()
            }
        };
        let mut phi = Matrix::zeros(seen.len(), lit.len());
        for chunk in hidden.chunks(CHUNK) {
            let laser = Matrix::from_fn(chunk.len(), lit.len(), |q, l| {
                chunk[q].1 * side(&lit[l], &chunk[q].0)
            });
            for (strip, seen) in seen.chunks(CHUNK).enumerate() {
                let camera =
                    Matrix::from_fn(seen.len(), chunk.len(), |p, q| side(&seen[p], &chunk[q].0));
                let mut rows = phi.rows_mut(strip * CHUNK, seen.len());
                rows.gemm(1.0, &camera, &laser, 1.0);
            }
        }
        phi
    }
}

/// The middles of the scene's elements with area · albedo/π.
fn elements(scene: &Scene) -> Vec<(HiddenPoint, f64)> {
    let all = scene.hidden().flat_map(|(_, s)| s.divided(s.elements));
    let light = all.filter(|e| e.albedo > 0.0 && e.area > 0.0);
    light
        .map(|e| (HiddenPoint::from(&e), e.area * e.albedo * FRAC_1_PI))
        .collect()
}

/// Offsets in the wall's plane and shares of the power; the shares add up to 1 (a Gaussian's to 1 −
/// e^−32).
fn profile_nodes(profile: Profile, n: usize) -> Vec<([f64; 2], f64)> {
    let (reach, gaussian) = match profile {
        Profile::Ideal => return vec![([0.0, 0.0], 1.0)],
        Profile::Disc { radius } => (radius, None),
        Profile::Gaussian { radius } => (GAUSSIAN_REACH * radius, Some(radius)),
    };
    // Radially Gauss–Legendre in r, with r dr; around the circle the trapezoidal rule, exact for
    // low orders.
    let (radial, around) = (if gaussian.is_some() { 4 * n } else { n }, 2 * n);
    let mut nodes = Vec::with_capacity(radial * around);
    for (r, w) in Rule::gauss_legendre(radial).on(0.0, reach) {
        let share = match gaussian {
            None => w * 2.0 * r / (reach * reach),
            Some(radius) => {
                let x = r / radius;
                w * 4.0 * x / radius * libm::exp(-2.0 * x * x)
            }
        };
        for k in 0..around {
            let (sin, cos) = libm::sincos(std::f64::consts::TAU * (k as f64 + 0.5) / around as f64);
            nodes.push(([r * cos, r * sin], share / around as f64));
        }
    }
    nodes
}

#[cfg(test)]
mod tests {
    use super::*;

    /// ∫ dP = 1 and ∫ r² dP = ½R² (disc), ½w² (Gaussian of 1/e² radius w).
    #[test]
    fn profiles_have_their_moments() {
        for (profile, second) in [
            (Profile::Disc { radius: 0.25 }, 0.5 * 0.0625),
            (Profile::Gaussian { radius: 0.25 }, 0.5 * 0.0625),
        ] {
            let nodes = profile_nodes(profile, 8);
            let total: f64 = nodes.iter().map(|(_, w)| w).sum();
            let moment: f64 = nodes.iter().map(|([x, y], w)| w * (x * x + y * y)).sum();
            assert!((total - 1.0).abs() < 1e-10, "{profile:?}: {total}");
            assert!(
                (moment / second - 1.0).abs() < 1e-10,
                "{profile:?}: {moment}"
            );
        }
    }
}
