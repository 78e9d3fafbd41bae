//! The three-bounce integral itself, by quadrature over spots, hidden surfaces and footprints.

use super::cut::{Cut, Level};
use super::error::ModelError;
use super::extent::{Extent, Occlusion};
use super::kernel::Kernel;
use super::parts::{LAST_LEVEL, MOST_APART, MOST_CONNECTIONS};
use super::series::Series;
use super::visible::{Visible, visible};
use crate::matrix::Matrix;
use crate::scene::Scene;

/// Φcam by quadrature, and how far it can be trusted.
#[derive(Clone, Debug)]
pub struct Converged {
    /// Pixels × spots, W.
    pub phi: Matrix,
    /// How far each entry may be off, W: what the last refinement changed in it, e, times r/(1 − r)
    /// where that is more, r ≤ 0.9 the last change over the one before, or what such an r leaves of
    /// an error that falls like a power of the nodes. It covers what is left of a geometric
    /// sequence and of a power, and some ten times the last change at most. Where hidden surfaces
    /// and walls were refined apart the sum of both, and what mixes them. Where more cells of a
    /// wall's texture lie in a pixel or spot than it is cut along, what their edges may leave.
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

    /// Refines the hidden surfaces and what the wall is taken at one without the other, each under
    /// the roughest rule of the other, where finer rules of both together have too many
    /// connections: Φ(h, w) ≈ Φ(l, l) + \[Φ(h, 0) − Φ(l, 0)\] + \[Φ(0, w) − Φ(0, l)\], l the last
    /// level of both. What that leaves out is about a·b/Φ, a and b all that each changes.
    fn apart(
        &mut self,
        first: &Matrix,
        level: usize,
        integrate: impl Fn(Level) -> Matrix,
        finer: impl Fn(Level) -> bool,
    ) {
        let along = |at: fn(usize) -> Level| {
            let from = level.saturating_sub(1);
            let mut series = Series::at(from, integrate(at(from)));
            let mut joined = series.phi.clone();
            loop {
                series.refine(integrate(at(series.level + 1)));
                if series.level == level {
                    joined.clone_from(&series.phi);
                }
                let settled = series.is_settled(ENOUGH, ENOUGH)
                    || series.level == LAST_LEVEL
                    || !finer(at(series.level + 1));
                if series.level >= level && settled {
                    return (series, joined);
                }
            }
        };
        let (hidden, hidden_joined) = along(Level::hidden);
        let (walls, walls_joined) = along(Level::walls);
        let all_changed = |series: &Series| (&series.phi - first).abs();
        let both = all_changed(&hidden).component_mul(&all_changed(&walls));
        let phi = &self.phi + (&hidden.phi - hidden_joined) + (&walls.phi - walls_joined);
        let left_out = both.zip_map(&phi, |ab, x| if x > 0.0 { ab / x } else { 0.0 });
        let bound = hidden.bound() + walls.bound() + left_out;
        if bound.norm() < self.bound.norm() {
            (self.phi, self.bound) = (phi, bound);
            self.change = hidden.change() + walls.change();
        }
    }

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
/// Bound of each entry, relative, beyond which hidden surfaces and walls are refined apart, and
/// last change below which they no longer are.
const ENOUGH: f64 = 1e-5;
/// Relative change below which the rule before is good enough for derivatives.
const ROUGH: f64 = 1e-4;

/// The matrix model's integral: Gauss–Legendre over each smooth texture cell of each hidden
/// surface, over each footprint and over each spot's profile, cut along the edges of the walls and
/// of their texture's cells, as far as `extent` asks for it,
/// refined together until Φcam changes by less than 1e-10, and every entry by less than 1e-7, or
/// the rules are as large as they may be; where the bound of an entry is then above 1e-5 of it, the
/// hidden surfaces and the walls are refined further, each by itself. Cells and footprints that
/// come close to each other or to a spot are cut into smaller ones there. What stands in the way
/// takes its share of each entry ([`visible`](fn@visible)) where `extent` says so. As in the matrix
/// model light meets three surfaces, and the hidden ones are Lambertian: one that is not is taken
/// for [`Surface::lambertian_equivalent`](crate::scene::Surface::lambertian_equivalent).
///
/// # Errors
/// [`ModelError::NothingHidden`].
pub fn converged(scene: &Scene, kernel: Kernel, extent: Extent) -> Result<Converged, ModelError> {
    if scene.hidden().next().is_none() {
        return Err(ModelError::NothingHidden);
    }
    let free = unobstructed(scene, kernel, extent, [MOST_CONNECTIONS, MOST_APART]);
    Ok(match extent.occlusion {
        Occlusion::Ignored => free,
        Occlusion::Considered => free.past(visible(scene, kernel)?),
    })
}

/// The same with nothing in the way, of at most so many connections in a rule refined together, and
/// apart.
fn unobstructed(
    scene: &Scene,
    kernel: Kernel,
    extent: Extent,
    [together, apart]: [f64; 2],
) -> Converged {
    let cut = Cut::new(scene, extent);
    let integrate = |level: Level| cut.integrate(kernel, level);
    let finer = |level: Level, most| cut.connections(level) <= most;
    let first = integrate(Level::both(0));
    let (mut series, mut rough) = (Series::at(0, first.clone()), None);
    while !series.is_settled(TARGET, ENTRY_TARGET)
        && series.level < LAST_LEVEL
        && finer(Level::both(series.level + 1), together)
    {
        series.refine(integrate(Level::both(series.level + 1)));
        if series.change() < ROUGH {
            rough = rough.or(Some(series.level - 1));
        }
    }
    let cheap = |l: &usize| finer(Level::both(*l), 0.1 * together);
    let level = rough.filter(cheap).unwrap_or(0);
    let mut free = Converged {
        bound: series.bound(),
        change: series.change(),
        rough: Nodes { extent, level },
        visible: None,
        phi: series.phi,
    };
    let walls = series.level;
    let enough = |(e, x): (&f64, &f64)| *e <= ENOUGH * x.abs();
    if series.level < LAST_LEVEL && !free.bound.iter().zip(&free.phi).all(enough) {
        let level = series.level;
        free.apart(&first, level, integrate, |level| cut.cost(level) <= apart);
    }
    let [pixels, spots] = cut.jumps(walls);
    let (rows, columns) = free.phi.shape();
    free.bound += Matrix::from_fn(rows, columns, |p, l| {
        free.phi[(p, l)].abs() * (pixels[p] + spots[l])
    });
    free
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
    Ok(Cut::new(scene, nodes.extent).integrate(kernel, Level::both(nodes.level)))
}

/// What is integrated over, and the level of refinement.
#[derive(Clone, Copy, Debug)]
pub struct Nodes {
    extent: Extent,
    level: usize,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Take;
    use crate::num::quadrature::Rule;

    /// Refined apart, each under the roughest rule of the other, a textured ball has the light that
    /// it has refined together, within the bounds of both.
    #[test]
    fn apart_is_together() {
        let ball =
            "mesh = { generate = \"sphere\", faces = 320, scale = 1.2, translate = [9, 9, 3] }";
        let rectangle = "rectangle = { corner = [3, 11.350951966438567, 4.149048033561433], u = [4, 0, 0], v = [0, -2.82842712474619, 2.82842712474619] }";
        let plate = "\n[[surface]]\nname = \"plate\"\nrole = \"occluder\"\nmaterial = { lambertian = 0.0 }\n\
            rectangle = { corner = [2, 5, 4], u = [0, 8, 0], v = [0, 0, 4.5] }\n";
        let text = Scene::load("bench").unwrap().text + plate;
        let text = text
            .replacen("pixels = [16, 16]", "pixels = [3, 3]", 1)
            .replacen("per_side = 30", "per_side = 2", 1)
            .replacen(rectangle, ball, 1);
        assert!(text.contains(ball));
        let scene = Scene::from_toml("ball", &text).unwrap();
        let found = |most| unobstructed(&scene, Kernel::Physical, Extent::UNOBSTRUCTED, most);
        let (together, apart) = (found([1e9, 0.0]), found([0.0, 1e9]));
        assert!(together.worst().unwrap().1 < 1e-5, "{:?}", together.worst());
        assert!(apart.worst().unwrap().1 < 1e-4, "{:?}", apart.worst());
        // One was not the other.
        assert!(apart.phi != together.phi);
        for k in 0..apart.phi.len() {
            let (error, bound) = (
                apart.phi[k] - together.phi[k],
                apart.bound[k] + together.bound[k],
            );
            assert!(error.abs() <= bound, "{k}: {error:e} beyond {bound:e}");
        }
    }

    /// A disc beside its axis, between points of a wall: to 1e-9 a polar rule written here, Gauss–
    /// Legendre in r and the trapezoidal rule around, 1e-9 from one of half the nodes. Plain and
    /// checkered cells alike: a checkerboard of two equal albedos is the plain disc. And so is a
    /// wide spot beside which the wall ends.
    #[test]
    fn discs_are_integrated() {
        let (spots, c, radius, camera) = ([[1.0, 1.5], [7.5, 4.0]], [4.0, 9.0, 3.0], 1.8, 15.0);
        let text = |albedo: &str| {
            format!(
                "name = \"disc\"\nunit = \"in\"\nmax_bounces = 3\n\
                [laser]\npower = 0.005\nwavelength = 632.8e-9\nposition = [-20, 10, 15]\n\
                [laser.spots]\nlayout = \"list\"\npoints = [[1.0, 1.5], [7.5, 4.0]]\n\
                [camera]\nposition = [-20, 10, 15]\naperture_area = 0.05\npixels = [2, 1]\n\
                view = {{ x = [2.25, 5.5], y = [2.75, 6.0] }}\n\
                [[surface]]\nname = \"wall\"\nrole = \"relay\"\n\
                rectangle = {{ corner = [-30, -30, 0], u = [60, 0, 0], v = [0, 60, 0] }}\n\
                material = {{ lambertian = 0.8 }}\n\
                [[surface]]\nname = \"disc\"\nrole = \"hidden\"\nelements = [2, 2]\n\
                disc = {{ centre = [4, 9, 3], normal = [0, -1, -1], radius = 1.8 }}\n\
                material = {{ lambertian = {albedo} }}\n"
            )
        };
        let g = |at: [f64; 3], x: f64, y: f64| {
            let r = [at[0] - x, at[1] - y, at[2]];
            let r2 = r[0] * r[0] + r[1] * r[1] + r[2] * r[2];
            r[2] * (r[1] + r[2]) * 0.5f64.sqrt() / (r2 * r2)
        };
        let light = |spot: [f64; 2], pixel: f64, n: usize| {
            let middle = [2.25 + 3.25 * (0.25 + 0.5 * pixel), 4.375];
            let d2: f64 = (middle[0] + 20.0).powi(2) + (middle[1] - 10.0).powi(2) + camera * camera;
            let etendue = 0.05 * camera * camera / (d2 * d2) * 3.25 * 3.25 / 2.0;
            let around = std::f64::consts::TAU / (4 * n) as f64;
            let rule = Rule::gauss_legendre(n);
            let rings = rule
                .on(0.0, radius)
                .flat_map(|(r, w)| (0..4 * n).map(move |k| (r * w * around, r, around * k as f64)));
            let sum: f64 = rings
                .map(|(w, r, phi)| {
                    let (sin, cos) = libm::sincos(phi);
                    let (x, y) = (r * cos, r * sin * 0.5f64.sqrt());
                    let at = [c[0] + x, c[1] + y, c[2] - y];
                    w * g(at, spot[0], spot[1]) * g(at, middle[0], middle[1])
                })
                .sum();
            let pi = std::f64::consts::PI;
            0.005 * etendue * (0.8 / pi) * (0.8 / pi) * (0.7 / pi) * sum
        };
        let extent = Extent {
            footprints: Take::Centre,
            ..Extent::UNOBSTRUCTED
        };
        for albedo in ["0.7", "{ checkerboard = [3, 2], dark = 0.7, light = 0.7 }"] {
            let scene = Scene::from_toml("disc", &text(albedo)).unwrap();
            let found = converged(&scene, Kernel::Physical, extent).unwrap();
            assert!(found.worst().unwrap().1 < 1e-7, "{albedo}");
            for (l, spot) in spots.into_iter().enumerate() {
                for p in 0..2 {
                    let truth = light(spot, p as f64, 24);
                    assert!((light(spot, p as f64, 12) / truth - 1.0).abs() < 1e-9);
                    let (phi, bound) = (found.phi[(p, l)], found.bound[(p, l)]);
                    let error = (phi - truth).abs();
                    assert!(error < 1e-9 * truth, "{albedo}: {phi:e} for {truth:e}");
                    assert!(
                        error <= bound + 1e-12 * truth,
                        "{albedo}: {error:e} > {bound:e}"
                    );
                }
            }
        }
        // The wall ends at x = 7.7, 0.2 beside the middle of the second spot, of radius ½: the sum
        // over points (7.5 + ½ sin θ, 4 + ½ t cos θ), t from −1 to 1.
        let ends = text("0.7")
            .replacen("u = [60, 0, 0]", "u = [37.7, 0, 0]", 1)
            .replacen("[laser.spots]", "spot_diameter = 1.0\n[laser.spots]", 1);
        let [theta, t] = [24, 12].map(Rule::gauss_legendre);
        let until = libm::asin(0.4);
        for profile in ["disc", "gaussian"] {
            let named = format!("spot_diameter = 1.0\nprofile = \"{profile}\"");
            let scene = ends.replacen("spot_diameter = 1.0", &named, 1);
            let scene = Scene::from_toml("ends", &scene).unwrap();
            let found = converged(&scene, Kernel::Physical, extent).unwrap();
            if profile == "gaussian" {
                let worst = found.worst().unwrap().1;
                assert!(worst < 1e-6, "{worst:e}");
                continue;
            }
            for p in 0..2 {
                let mut truth = 0.0;
                for (theta, w) in theta.on(-std::f64::consts::FRAC_PI_2, until) {
                    let (sin, cos) = libm::sincos(theta);
                    for (t, v) in t.on(-1.0, 1.0) {
                        let at = [7.5 + 0.5 * sin, 4.0 + 0.5 * t * cos];
                        let share = w * v * cos * cos * std::f64::consts::FRAC_1_PI;
                        truth += share * light(at, p as f64, 12);
                    }
                }
                let (phi, bound) = (found.phi[(p, 1)], found.bound[(p, 1)]);
                let error = (phi - truth).abs();
                assert!(
                    error < 1e-8 * truth && bound < 1e-6 * truth,
                    "{phi:e} for {truth:e}, bound {bound:e}"
                );
            }
        }
    }
}
