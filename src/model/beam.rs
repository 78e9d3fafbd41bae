//! What of the laser's beams reaches the wall past what stands in the way.

use std::cell::LazyCell;

use super::cut::{lit, profile_cells, reach};
use super::wall_point::{self, WallPoint};
use crate::geometry::{Basis, Ray};
use crate::scene::Scene;

/// Rays from the middle of a spot to its rim, of 4 nodes and more: 256 in the cell of each.
const RAYS: usize = 64;
/// Places of its rim at which an edge is looked for.
const RIM: usize = 64;

/// The points of each spot by `nodes` from its middle to its rim, each with the share of the light
/// of its cell that reaches the wall. Of a spot without a size, and of one whose nodes and rim all
/// are reached or all are not, that is 1 or 0; of others a mean over rays.
pub(super) fn reached(scene: &Scene, nodes: usize) -> Vec<Vec<(WallPoint, f64)>> {
    let profile = scene.laser.profile;
    let side = RAYS.div_ceil(nodes);
    // Few scenes have a spot that is cut.
    let cells = LazyCell::new(|| profile_cells(profile, nodes, side * side));
    let is_free = |w: &WallPoint| {
        let ray = Ray::between(scene.laser.position, w.position);
        ray.is_some_and(|ray| !scene.bvh().blocked(&ray, [None, w.surface]))
    };
    let rim = |k: usize| {
        let (sin, cos) = libm::sincos(std::f64::consts::TAU * k as f64 / RIM as f64);
        [cos, sin].map(|x| reach(profile) * x)
    };
    let spot = |(l, points): (usize, Vec<WallPoint>)| -> Vec<(WallPoint, f64)> {
        let basis = Basis::around(scene.laser.spots[l].target.normal);
        let is_reached = |[x, y]: [f64; 2]| {
            let offset = basis.to_world([x, y, 0.0]);
            is_free(&wall_point::lit(scene, l, offset, 1.0))
        };
        let free: Vec<bool> = points.iter().map(is_free).collect();
        let is_other = |own: bool| free.first().is_some_and(|first| *first != own);
        let is_cut = points.len() > 1
            && (free.iter().any(|own| is_other(*own))
                || (0..RIM).any(|k| is_other(is_reached(rim(k)))));
        let share = |i: usize| match (is_cut, free[i]) {
            (true, _) => {
                let reached = cells[i].iter().filter(|at| is_reached(**at));
                reached.count() as f64 / cells[i].len() as f64
            }
            (false, true) => 1.0,
            (false, false) => 0.0,
        };
        let shares: Vec<f64> = (0..points.len()).map(share).collect();
        points.into_iter().zip(shares).collect()
    };
    let spots = lit(scene, profile, nodes).into_iter().enumerate();
    spots.map(spot).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A plate half way up whose shadow ends at x = e: of a disc of radius r it leaves
    /// ½ + (e √(r² − e²)/r² + asin(e/r))/π, of a Gaussian of 1/e² radius w what is below e of a
    /// normal distribution of deviation w/2; wherever e lies, to 1.5e-3, though a node is 3 %.
    #[test]
    fn a_beam_loses_what_an_edge_cuts_off() {
        let scene = |profile: &str, e: f64| {
            let text = format!(
                "name = \"cut\"\nunit = \"in\"\nmax_bounces = 3\n\
                 [laser]\npower = 0.005\nwavelength = 632.8e-9\nposition = [0, 0, 10]\n\
                 spot_diameter = 1.0\nprofile = \"{profile}\"\n\
                 spots = {{ layout = \"list\", points = [[0, 0], [-9, 1], [9, 0]] }}\n\
                 [camera]\nposition = [-20, 2, 10]\naperture_area = 0.05\npixels = [2, 2]\n\
                 view = {{ x = [-3, -2], y = [-1, 1] }}\n\
                 [[surface]]\nname = \"wall\"\nrole = \"relay\"\nmaterial = {{ lambertian = 0.8 }}\n\
                 rectangle = {{ corner = [-30, -30, 0], u = [60, 0, 0], v = [0, 60, 0] }}\n\
                 [[surface]]\nname = \"plate\"\nrole = \"occluder\"\nsides = \"two\"\n\
                 rectangle = {{ corner = [{}, -20, 5], u = [20, 0, 0], v = [0, 40, 0] }}\n\
                 material = {{ lambertian = 0.0 }}\n",
                0.5 * e
            );
            Scene::from_toml("cut", &text).unwrap()
        };
        for e in [-0.41, -0.2, -0.013, 0.0, 0.07, 0.33, 0.47] {
            for profile in ["disc", "gaussian"] {
                let scene = scene(profile, e);
                let shares: Vec<f64> = reached(&scene, 4)
                    .iter()
                    .map(|spot| {
                        let all: f64 = spot.iter().map(|(w, _)| w.weight).sum();
                        spot.iter().map(|(w, share)| share * w.weight).sum::<f64>() / all
                    })
                    .collect();
                let r = 0.5f64;
                let want = if profile == "disc" {
                    0.5 + (e * (r * r - e * e).sqrt() / (r * r) + libm::asin(e / r))
                        / std::f64::consts::PI
                } else {
                    0.5 * libm::erfc(-e / (0.5 * r) * std::f64::consts::FRAC_1_SQRT_2)
                };
                let off = (shares[0] - want).abs();
                assert!(off < 1.5e-3, "{profile} {e}: {} for {want}", shares[0]);
                assert_eq!(shares[1..], [1.0, 0.0], "{profile} {e}");
            }
        }
    }
}
