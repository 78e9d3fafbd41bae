//! A scene cut into parts on which the rules of quadrature converge.

use std::f64::consts::FRAC_1_PI;

use rayon::prelude::*;

use super::extent::{Extent, Take};
use super::kernel::{HiddenPoint, HiddenPoints, Kernel};
use super::parts::{Ball, FootprintPart, HiddenParts, footprint_parts};
use super::wall_point::{self, WallPoint};
use crate::geometry::{Basis, DVec3};
use crate::matrix::Matrix;
use crate::num::quadrature::Rule;
use crate::scene::{Profile, Scene, Surface};

/// Nodes, and pixels, handled at once.
pub(super) const CHUNK: usize = 4096;
const STRIP: usize = 64;
/// Multiplications of a product in the time of a connection.
const PRODUCTS: f64 = 8.0;
/// The Gaussian profile is cut at this many of its 1/e² radii, beyond which lies e^−32 of the
/// power.
const GAUSSIAN_REACH: f64 = 4.0;

/// Its multiples, less what is whole, leave the unit interval most evenly filled.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// How far from its target a spot lights the wall.
pub(super) fn reach(profile: Profile) -> f64 {
    match profile {
        Profile::Ideal | Profile::Shining { .. } => 0.0,
        Profile::Disc { radius } => radius,
        Profile::Gaussian { radius } => GAUSSIAN_REACH * radius,
    }
}

/// M at a point of the surface that shines, W length⁻²: 0 where it is dark in that column. `None`
/// where a laser lights the scene.
pub(super) fn exitance(scene: &Scene, column: usize, at: DVec3) -> Option<f64> {
    let (_, surface) = scene.shining()?;
    let uv = surface.shape.at_position(at).uv;
    Some(scene.laser.exitance(surface, column, uv))
}

/// Levels of refinement of the hidden surfaces, and of footprints and spots.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Level {
    pub hidden: usize,
    pub walls: usize,
}

impl Level {
    pub(super) fn both(level: usize) -> Self {
        Self {
            hidden: level,
            walls: level,
        }
    }

    /// The hidden surfaces alone.
    pub(super) fn hidden(level: usize) -> Self {
        Self {
            hidden: level,
            walls: 0,
        }
    }

    /// Footprints and spots alone.
    pub(super) fn walls(level: usize) -> Self {
        Self {
            hidden: 0,
            walls: level,
        }
    }
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
        let profile = match extent.spots {
            Take::Centre => Profile::Ideal,
            Take::Integral => scene.laser.profile,
        };
        let reach = reach(profile);
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
    pub(super) fn connections(&self, level: Level) -> f64 {
        let seen = self.footprints.iter().flatten();
        let seen: usize = seen.map(|part| part.nodes(level.walls).len()).sum();
        let lit = self.spots * profile_nodes(self.profile, 2 + 2 * level.walls).len();
        self.hidden.count(level.hidden) as f64 * (seen + lit) as f64
    }

    /// What an integration at `level` costs, in connections.
    pub(super) fn cost(&self, level: Level) -> f64 {
        let products = (self.footprints.len() * self.spots) as f64;
        self.connections(level) + self.hidden.count(level.hidden) as f64 * products / PRODUCTS
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

    /// The wall as each spot lights it, at `level`; nothing where a surface shines.
    pub(super) fn lit(&self, scene: &Scene, level: usize) -> Vec<Vec<WallPoint>> {
        lit(scene, self.profile, 2 + 2 * level)
    }

    /// One quadrature: Φ = Σ_q C\[p,q\]·D\[q,l\] over the nodes q of the hidden surfaces, in
    /// chunks.
    pub(super) fn integrate(&self, scene: &Scene, kernel: Kernel, level: Level) -> Matrix {
        let (seen, lit) = (self.seen(scene, level.walls), self.lit(scene, level.walls));
        let hidden = match self.elements {
            Take::Centre => elements(scene),
            Take::Integral => self.hidden.nodes(level.hidden),
        };
        // Its transpose, spots × pixels, so that the photographs of some pixels lie side by side.
        let mut phi = Matrix::zeros(lit.len(), seen.len());
        for chunk in hidden.chunks(CHUNK) {
            let points = HiddenPoints::new(chunk);
            let sides = |walls: &[Vec<WallPoint>]| {
                let mut sums = Matrix::zeros(chunk.len(), walls.len());
                for (sums, walls) in sums.as_mut_slice().chunks_mut(chunk.len()).zip(walls) {
                    for wall in walls {
                        wall.add_towards(scene, kernel, &points, sums);
                    }
                }
                sums
            };
            let mut laser = if scene.laser.is_shining() {
                Matrix::from_fn(chunk.len(), lit.len(), |q, l| {
                    exitance(scene, l, chunk[q].0.position).unwrap_or(0.0)
                })
            } else {
                sides(&lit)
            };
            for (mut row, (_, share)) in laser.row_iter_mut().zip(chunk) {
                row *= *share;
            }
            let laser = laser.transpose();
            let strips = phi.as_mut_slice().par_chunks_mut(STRIP * lit.len());
            strips.zip(seen.par_chunks(STRIP)).for_each(|(phi, seen)| {
                let more = &laser * sides(seen);
                for (sum, more) in phi.iter_mut().zip(&more) {
                    *sum += more;
                }
            });
        }
        phi.transpose()
    }
}

/// The wall as each spot of this profile lights it, by `n` nodes from middle to rim; nothing
/// where a surface shines.
pub(super) fn lit(scene: &Scene, profile: Profile, n: usize) -> Vec<Vec<WallPoint>> {
    let spots = scene.laser.spots.len();
    if scene.laser.is_shining() {
        return vec![Vec::new(); spots];
    }
    let offsets = profile_nodes(profile, n);
    let lit = |l: usize| {
        let basis = Basis::around(scene.laser.spots[l].target.normal);
        let lit = |([x, y], w): &([f64; 2], f64)| {
            wall_point::lit(scene, l, basis.to_world([*x, *y, 0.0]), *w)
        };
        offsets.iter().map(lit).collect()
    };
    (0..spots).map(lit).collect()
}

/// So many points of the cell about each of [`profile_nodes`], all of the same light: a cell holds
/// as much as the rule gives its node, and points of one ring lie where that many parts of the
/// light lie within,
///
/// > r = R √S of a disc,   r = w √(−½ ln(1 − S)) of a Gaussian,
///
/// and around by steps of the golden ratio, so that no edge meets many at once.
pub(super) fn profile_cells(profile: Profile, n: usize, points: usize) -> Vec<Vec<[f64; 2]>> {
    let nodes = profile_nodes(profile, n);
    let around = 2 * n;
    let within = |share: f64| match profile {
        Profile::Gaussian { radius } => {
            radius * (-0.5 * libm::log((1.0 - share).max(f64::EPSILON))).sqrt()
        }
        other => reach(other) * share.sqrt(),
    };
    let mut inner = 0.0;
    let mut found = Vec::with_capacity(nodes.len());
    for ring in nodes.chunks(around) {
        let own = ring.iter().map(|(_, share)| share).sum::<f64>();
        let cell = |k: usize| -> Vec<[f64; 2]> {
            let point = |i: usize| {
                let r = within(inner + own * (i as f64 + 0.5) / points as f64);
                let turn = (k as f64 + (GOLDEN * i as f64).fract()) / around as f64;
                let (sin, cos) = libm::sincos(std::f64::consts::TAU * turn);
                [r * cos, r * sin]
            };
            (0..points).map(point).collect()
        };
        found.extend((0..ring.len()).map(cell));
        inner += own;
    }
    found
}

/// The middles of the scene's elements with area · albedo/π.
fn elements<'a>(scene: &'a Scene) -> Vec<(HiddenPoint, f64)> {
    let divided = |s: &'a Surface| s.divided(s.elements).into_iter().map(move |e| (s, e));
    let all = scene.hidden().flat_map(|(_, s)| divided(s));
    let light = all.filter(|(_, e)| e.albedo > 0.0 && e.area > 0.0);
    light
        .map(|(s, e)| (HiddenPoint::new(s, &e), e.area * e.albedo * FRAC_1_PI))
        .collect()
}

/// Offsets in the wall's plane and shares of the power; the shares add up to 1 (a Gaussian's to 1 −
/// e^−32).
fn profile_nodes(profile: Profile, n: usize) -> Vec<([f64; 2], f64)> {
    let (reach, gaussian) = match profile {
        Profile::Ideal | Profile::Shining { .. } => return vec![([0.0, 0.0], 1.0)],
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
