//! The three-bounce integral itself, by quadrature over spots, hidden surfaces and footprints.

use super::ModelError;
use super::kernel::Kernel;
use super::matrix_model::hidden_point;
use super::sight::{self, WallPoint};
use crate::geometry::Basis;
use crate::matrix::Matrix;
use crate::num::quadrature::Rule;
use crate::scene::{Profile, Scene};

/// Φcam by quadrature, and how far it can be trusted.
#[derive(Clone, Debug)]
pub struct Converged {
    /// Pixels × spots, W.
    pub phi: Matrix,
    /// Relative Frobenius change at the last refinement: a bound on the error of the step before.
    pub change: f64,
    /// Nodes a side on each smooth cell of a hidden surface.
    pub hidden_nodes: usize,
    /// Nodes a side on each pixel's footprint.
    pub footprint_nodes: usize,
}

/// Refinement stops below this relative change.
const TARGET: f64 = 1e-10;
/// Nodes on all hidden surfaces together beyond which no finer rule is tried.
const MOST_NODES: usize = 400_000;
/// Nodes handled at once.
const CHUNK: usize = 4096;
/// The Gaussian profile is cut at this many of its 1/e² radii, beyond which lies e^−32 of the power.
const GAUSSIAN_REACH: f64 = 4.0;

/// The matrix model's integral with everything integrated: Gauss–Legendre over each smooth texture cell of each hidden
/// surface, over each footprint and over each spot's profile, refined together until Φcam changes by less than 1e-10.
/// As in the matrix model there is no occlusion and light meets three surfaces.
///
/// # Errors
/// [`ModelError::NothingHidden`].
pub fn converged(scene: &Scene, kernel: Kernel) -> Result<Converged, ModelError> {
    let cells: usize = scene
        .hidden()
        .map(|(_, s)| s.albedo.smooth_cells().iter().product::<usize>())
        .sum();
    if cells == 0 {
        return Err(ModelError::NothingHidden);
    }
    let finest = ((MOST_NODES / cells) as f64).sqrt() as usize;
    let (mut hidden, mut footprint, mut spread) = (2.min(finest.max(1)), 1, 2);
    let mut phi = integrate(scene, kernel, hidden, footprint, spread);
    loop {
        let finer = (hidden + 2 + hidden / 4).min(finest.max(1));
        let next = integrate(scene, kernel, finer, footprint + 1, spread + 2);
        let change = (&next - &phi).norm() / next.norm().max(f64::MIN_POSITIVE);
        let exhausted = finer == hidden || footprint >= 8;
        (phi, hidden, footprint, spread) = (next, finer, footprint + 1, spread + 2);
        if change < TARGET || exhausted {
            return Ok(Converged {
                phi,
                change,
                hidden_nodes: hidden,
                footprint_nodes: footprint,
            });
        }
    }
}

/// One quadrature with the given nodes a side.
fn integrate(
    scene: &Scene,
    kernel: Kernel,
    hidden: usize,
    footprint: usize,
    spread: usize,
) -> Matrix {
    let (pixels, spots) = (scene.camera.pixels(), scene.laser.spots.len());
    let seen: Vec<Vec<WallPoint>> = (0..pixels)
        .map(|p| {
            plane_nodes(footprint)
                .map(|(ab, w)| sight::seen(scene, p, ab, w))
                .collect()
        })
        .collect();
    let lit: Vec<Vec<WallPoint>> = (0..spots)
        .map(|l| {
            let basis = Basis::around(scene.laser.spots[l].target.normal);
            profile_nodes(scene.laser.profile, spread)
                .into_iter()
                .map(|([x, y], w)| sight::lit(scene, l, basis.to_world([x, y, 0.0]), w))
                .collect()
        })
        .collect();
    let mut phi = Matrix::zeros(pixels, spots);
    let mut nodes = Vec::with_capacity(CHUNK);
    let mut add = |nodes: &mut Vec<_>| {
        let side = |walls: &[WallPoint], point| {
            walls.iter().map(|w| w.towards(kernel, point)).sum::<f64>()
        };
        let camera = Matrix::from_fn(pixels, nodes.len(), |p, q| {
            let (point, _): &(_, f64) = &nodes[q];
            side(&seen[p], point)
        });
        let laser = Matrix::from_fn(nodes.len(), spots, |q, l| {
            nodes[q].1 * side(&lit[l], &nodes[q].0)
        });
        phi.gemm(1.0, &camera, &laser, 1.0);
        nodes.clear();
    };
    for (_, surface) in scene.hidden() {
        let [nu, nv] = surface.albedo.smooth_cells();
        let area = surface.shape.area() / (nu * nv) as f64;
        for cell in 0..nu * nv {
            if surface.albedo.cell_mean(cell) <= 0.0 {
                continue;
            }
            for ([a, b], w) in plane_nodes(hidden) {
                let uv = [
                    ((cell % nu) as f64 + a) / nu as f64,
                    ((cell / nu) as f64 + b) / nv as f64,
                ];
                let weight = w * area * surface.albedo.albedo(uv) * std::f64::consts::FRAC_1_PI;
                nodes.push((hidden_point(surface, uv), weight));
                if nodes.len() == CHUNK {
                    add(&mut nodes);
                }
            }
        }
    }
    add(&mut nodes);
    phi
}

/// Product rule on the unit square; the weights add up to 1.
fn plane_nodes(n: usize) -> impl Iterator<Item = ([f64; 2], f64)> {
    let rule = Rule::gauss_legendre(n);
    let pairs: Vec<(f64, f64)> = rule.on(0.0, 1.0).collect();
    (0..n * n).map(move |i| {
        let ((a, wa), (b, wb)) = (pairs[i % n], pairs[i / n]);
        ([a, b], wa * wb)
    })
}

/// Offsets in the wall's plane and shares of the power; the shares add up to 1 (a Gaussian's to 1 − e^−32).
fn profile_nodes(profile: Profile, n: usize) -> Vec<([f64; 2], f64)> {
    let (reach, gaussian) = match profile {
        Profile::Ideal => return vec![([0.0, 0.0], 1.0)],
        Profile::Disc { radius } => (radius, None),
        Profile::Gaussian { radius } => (GAUSSIAN_REACH * radius, Some(radius)),
    };
    // Radially Gauss–Legendre in r, with r dr; around the circle the trapezoidal rule, exact for low orders.
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
