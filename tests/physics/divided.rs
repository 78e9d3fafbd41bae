//! Laws of what is seen past an obstacle by wide spots and coarse pixels.

use phicam::matrix::Matrix;
use phicam::model::{Converged, Effort, Extent, Kernel, MatrixModel, Occlusion, converged};
use phicam::scene::Scene;

/// A wall in the plane x = 0 of the file, a board beside it, and a plate between.
pub(super) fn scene(laser: &str, view: &str, plate: &str) -> Scene {
    let text = format!(
        "name = \"divided\"\nunit = \"cm\"\nmax_bounces = 3\naxes = {{ x = [0, 0, 1], y = [0, 1, 0] }}\n\
         [laser]\npower = 1.0\nwavelength = 500e-9\n{laser}\n\
         [camera]\nposition = [-25.0, -10.0, -5.0]\naperture_area = 0.1\n{view}\n\
         [[surface]]\nname = \"wall\"\nrole = \"relay\"\n\
         rectangle = {{ corner = [0, 0, 10], u = [0, 15, 0], v = [0, 0, -20] }}\n\
         material = {{ lambertian = 0.6 }}\n\
         [[surface]]\nname = \"board\"\nrole = \"hidden\"\n\
         rectangle = {{ corner = [-12, 2, -1], u = [0, 8, 0], v = [0, 0, 8] }}\n\
         material = {{ lambertian = 0.7 }}\nelements = [3, 2]\n\
         [[surface]]\nname = \"plate\"\nrole = \"occluder\"\n{plate}\nsides = \"two\"\n\
         material = {{ lambertian = 0.0 }}\n"
    );
    Scene::from_toml("divided", &text).unwrap_or_else(|e| panic!("{e}"))
}

pub(super) fn by_quadrature(scene: &Scene) -> Converged {
    converged(scene, Kernel::Physical, Extent::FULL).unwrap()
}

/// By the elements' factors.
fn by_elements(scene: &Scene) -> Matrix {
    let (kernel, occlusion) = (Kernel::Physical, Occlusion::Considered);
    let model = MatrixModel::over_areas(scene, kernel, None, occlusion, Effort::USUAL);
    model.unwrap().phi()
}

/// What a pixel sees is the sum of what its parts see, to 5e-4 and within the stated bounds.
#[test]
fn a_pixel_past_a_plate_is_the_sum_of_its_parts() {
    let of = |side: usize| {
        scene(
            "position = [-3.0, 25.0, 9.0]\nspots = { layout = \"list\", points = [[-9, 1], [-8, 12]] }",
            &format!("view = {{ x = [-6, 4], y = [2, 8] }}\npixels = [{side}, {side}]"),
            "rectangle = { corner = [-5, 4.5, -1.5], u = [0, 3, 0], v = [0, 0, 3] }",
        )
    };
    const PARTS: usize = 12;
    for side in [1, 2] {
        let (coarse, fine) = (of(side), of(side * PARTS));
        let pixels = by_quadrature(&coarse);
        let parts = by_quadrature(&fine);
        let pixel = |k: usize| k % (side * PARTS) / PARTS + k / (side * PARTS) / PARTS * side;
        let sum = |of: &Matrix| {
            let mut sum = Matrix::zeros(side * side, 2);
            for (k, row) in of.row_iter().enumerate() {
                for (l, x) in row.iter().enumerate() {
                    sum[(pixel(k), l)] += x;
                }
            }
            sum
        };
        let (truth, unsure) = (sum(&parts.phi), sum(&parts.bound));
        let elements = by_elements(&coarse);
        for k in 0..truth.len() {
            let off = (pixels.phi[k] - truth[k]).abs();
            assert!(off < 5e-4 * truth[k], "{side} {k}: {:.1e}", off / truth[k]);
            let bound = pixels.bound[k] + unsure[k];
            assert!(off <= bound, "{side} {k}: {off:.1e} beyond {bound:.1e}");
            let off = (elements[k] / truth[k] - 1.0).abs();
            assert!(off < 2e-3, "{side} {k}, by elements: {off:.1e}");
        }
    }
}

/// What a wide spot lights past a plate close to it is the mean of what its points light: some
/// 5 % of it more and less than by the 32 points of a rule that holds with nothing in the way.
#[test]
fn a_wide_spot_past_a_plate_is_the_mean_of_its_points() {
    const POINTS: usize = 1500;
    let radius = 1.5;
    let of = |spots: &str| {
        scene(
            &format!("position = [-3.0, 8.0, -30.0]\n{spots}"),
            "view = { x = [3, 3.4], y = [2, 2.3] }\npixels = [1, 1]",
            "rectangle = { corner = [-0.6, 0.5, -7.3], u = [0, 12, 0], v = [0, 0, 0.5] }",
        )
    };
    let targets = [[-7.0, 4.0], [-6.5, 9.0]];
    let wide = of(&format!(
        "spot_diameter = {}\nprofile = \"disc\"\nspots = {{ layout = \"list\", points = {targets:?} }}",
        2.0 * radius
    ));
    let (found, elements) = (by_quadrature(&wide), by_elements(&wide));
    for (l, target) in targets.iter().enumerate() {
        // Points of equal shares of the disc, each turned by the golden angle.
        let point = |k: usize| {
            let r = radius * ((k as f64 + 0.5) / POINTS as f64).sqrt();
            let (sin, cos) = libm::sincos(k as f64 * 2.399_963_229_728_653);
            [target[0] + r * cos, target[1] + r * sin]
        };
        let points: Vec<[f64; 2]> = (0..POINTS).map(point).collect();
        let single = of(&format!(
            "spots = {{ layout = \"list\", points = {points:?} }}"
        ));
        let truth = by_quadrature(&single).phi.mean();
        for (what, phi) in [("areas", found.phi[l]), ("elements", elements[l])] {
            let off = (phi / truth - 1.0).abs();
            assert!(off < 5e-3, "{l}, {what}: {off:.1e}");
        }
    }
}
