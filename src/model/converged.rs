//! The three-bounce integral itself, by quadrature over spots, hidden surfaces and footprints.

use std::f64::consts::FRAC_1_PI;

use super::ModelError;
use super::kernel::{HiddenPoint, Kernel};
use super::wall_point::{self, WallPoint};
use crate::geometry::{Basis, DVec3, Instance, Shape};
use crate::matrix::Matrix;
use crate::num::quadrature::Rule;
use crate::scene::{Element, Profile, Scene, Surface};

/// Φcam by quadrature, and how far it can be trusted.
#[derive(Clone, Debug)]
pub struct Converged {
    /// Pixels × spots, W.
    pub phi: Matrix,
    /// What the last refinement changed in each entry, W: an estimate of the error of the step
    /// before, and far more than that of `phi` itself where the rule converges at all.
    pub bound: Matrix,
    /// Relative Frobenius norm of that change.
    pub change: f64,
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

/// Refinement stops below this relative change.
const TARGET: f64 = 1e-10;
/// Nodes on all hidden surfaces together beyond which no finer rule is tried.
const MOST_NODES: usize = 400_000;
/// A picture of more texels than that is taken at the middles of at most so many parts a side, each
/// with its mean albedo.
const COARSE: usize = 512;
/// Nodes a side of a footprint beyond which no finer rule is tried.
const MOST_FOOTPRINT_NODES: usize = 8;
/// Nodes handled at once.
const CHUNK: usize = 4096;
/// The Gaussian profile is cut at this many of its 1/e² radii, beyond which lies e^−32 of the
/// power.
const GAUSSIAN_REACH: f64 = 4.0;

/// The matrix model's integral: Gauss–Legendre over each smooth texture cell of each hidden
/// surface, over each footprint and over each spot's profile, as far as `extent` asks for it,
/// refined together until Φcam changes by less than 1e-10 or the rules are as large as they may be.
/// As in the matrix model there is no occlusion, light meets three surfaces, and the hidden ones
/// are Lambertian: one that is not is taken for [`Surface::lambertian_equivalent`].
///
/// # Errors
/// [`ModelError::NothingHidden`].
pub fn converged(scene: &Scene, kernel: Kernel, extent: Extent) -> Result<Converged, ModelError> {
    let cells: usize = scene.hidden().map(|(_, s)| pieces(s)).sum();
    if cells == 0 {
        return Err(ModelError::NothingHidden);
    }
    let finest = (((MOST_NODES / cells) as f64).sqrt() as usize).max(1);
    let mut nodes = Nodes {
        extent,
        hidden: 2.min(finest),
        footprint: 1,
        spread: 2,
    };
    let mut phi = integrate(scene, kernel, nodes);
    loop {
        let finer = Nodes {
            extent,
            hidden: (nodes.hidden + 2 + nodes.hidden / 4).min(finest),
            footprint: nodes.footprint + 1,
            spread: nodes.spread + 2,
        };
        let next = integrate(scene, kernel, finer);
        let bound = (&next - &phi).abs();
        let change = bound.norm() / next.norm().max(f64::MIN_POSITIVE);
        let exhausted = finer.hidden == nodes.hidden || finer.footprint >= MOST_FOOTPRINT_NODES;
        if change < TARGET || exhausted {
            return Ok(Converged {
                phi: next,
                bound,
                change,
            });
        }
        (phi, nodes) = (next, finer);
    }
}

/// Nodes a side of each rule.
#[derive(Clone, Copy)]
struct Nodes {
    extent: Extent,
    hidden: usize,
    footprint: usize,
    spread: usize,
}

/// One quadrature: Φ = Σ_q C\[p,q\]·D\[q,l\] over the nodes q of the hidden surfaces, in chunks.
fn integrate(scene: &Scene, kernel: Kernel, nodes: Nodes) -> Matrix {
    let (pixels, spots) = (scene.camera.pixels(), scene.laser.spots.len());
    let footprint = match nodes.extent.footprints {
        Take::Centre => 1,
        Take::Integral => nodes.footprint,
    };
    let seen = |p| {
        let nodes = plane_nodes(footprint);
        nodes
            .map(|(ab, w)| wall_point::seen(scene, p, ab, w))
            .collect::<Vec<_>>()
    };
    let seen: Vec<Vec<WallPoint>> = (0..pixels).map(seen).collect();
    let profile = match nodes.extent.spots {
        Take::Centre => Profile::Ideal,
        Take::Integral => scene.laser.profile,
    };
    let offsets = profile_nodes(profile, nodes.spread);
    let lit = |l: usize| {
        let basis = Basis::around(scene.laser.spots[l].target.normal);
        let lit = |([x, y], w): &([f64; 2], f64)| {
            wall_point::lit(scene, l, basis.to_world([*x, *y, 0.0]), *w)
        };
        offsets.iter().map(lit).collect::<Vec<_>>()
    };
    let lit: Vec<Vec<WallPoint>> = (0..spots).map(lit).collect();
    let side = |walls: &[WallPoint], point| {
        walls
            .iter()
            .map(|w| w.towards(scene, kernel, point))
            .sum::<f64>()
    };
    let mut phi = Matrix::zeros(pixels, spots);
    for chunk in hidden_nodes(scene, nodes).chunks(CHUNK) {
        let camera = Matrix::from_fn(pixels, chunk.len(), |p, q| side(&seen[p], &chunk[q].0));
        let laser = Matrix::from_fn(chunk.len(), spots, |q, l| {
            chunk[q].1 * side(&lit[l], &chunk[q].0)
        });
        phi.gemm(1.0, &camera, &laser, 1.0);
    }
    phi
}

/// Points of the hidden surfaces with area · albedo/π.
fn hidden_nodes(scene: &Scene, nodes: Nodes) -> Vec<(HiddenPoint, f64)> {
    let mut found = Vec::new();
    let mut add = |element: &Element| {
        if element.albedo > 0.0 && element.area > 0.0 {
            let weight = element.area * element.albedo * FRAC_1_PI;
            found.push((HiddenPoint::from(element), weight));
        }
    };
    for (_, surface) in scene.hidden() {
        let surface = &*surface.lambertian_equivalent();
        let whole = surface.shape.area();
        match (nodes.extent.elements, &surface.shape) {
            (Take::Centre, _) => {
                let elements = surface.divided(surface.elements);
                elements.iter().for_each(&mut add);
            }
            (Take::Integral, Shape::Instance(body)) => {
                triangle_nodes(surface, body, nodes.hidden, |e| add(&e));
            }
            (Take::Integral, _) if texels(surface) > MOST_NODES => {
                surface.divided(coarse(surface)).iter().for_each(&mut add);
            }
            (Take::Integral, _) => {
                let [nu, nv] = surface.albedo.smooth_cells();
                let area = whole / (nu * nv) as f64;
                for cell in 0..nu * nv {
                    for ([a, b], w) in plane_nodes(nodes.hidden) {
                        let uv = [
                            ((cell % nu) as f64 + a) / nu as f64,
                            ((cell / nu) as f64 + b) / nv as f64,
                        ];
                        let area = w * area;
                        add(&Element {
                            area,
                            ..surface.element_at(uv)
                        });
                    }
                }
            }
        }
    }
    found
}

/// Parts of a hidden surface within which the integrand is smooth.
fn pieces(surface: &Surface) -> usize {
    match &surface.shape {
        Shape::Instance(body) => body.mesh().triangles().len(),
        _ if texels(surface) > MOST_NODES => coarse(surface).iter().product(),
        _ => texels(surface),
    }
}

/// Cells along u and v of a texture with too many of them.
fn coarse(surface: &Surface) -> [usize; 2] {
    surface.albedo.smooth_cells().map(|n| n.min(COARSE))
}

/// Cells of a hidden surface's texture within which it is smooth.
fn texels(surface: &Surface) -> usize {
    surface.albedo.smooth_cells().iter().product()
}

/// Every triangle by the product rule of n × n nodes on the square that is folded onto it: (u, v) →
/// (1 − u, u·(1 − v), u·v), whose area element is twice the triangle's area times u. With one node
/// its centroid.
fn triangle_nodes(surface: &Surface, body: &Instance, n: usize, mut visit: impl FnMut(Element)) {
    for t in 0..body.mesh().triangles().len() as u32 {
        let [a, b, c] = body.corners(t);
        let area = body.triangle_area(t);
        let mut node = |weights: [f64; 3], share: f64| {
            let [x, y, z] = weights;
            let point = body.on_triangle(t, a * x + b * y + c * z);
            visit(Element {
                position: point.position,
                normal: point.normal,
                area: area * share,
                u_axis: DVec3::X,
                albedo: surface.albedo.albedo(point.uv),
            });
        };
        if area <= 0.0 {
            continue;
        }
        if n == 1 {
            node([1.0 / 3.0; 3], 1.0);
            continue;
        }
        for ([u, v], w) in plane_nodes(n) {
            node([1.0 - u, u * (1.0 - v), u * v], 2.0 * u * w);
        }
    }
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
