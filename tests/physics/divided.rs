//! Laws of what is seen past an obstacle by wide spots and coarse pixels.

use phicam::geometry::DVec3;
use phicam::matrix::Matrix;
use phicam::model::{Converged, Effort, Extent, Kernel, MatrixModel, Occlusion, converged};
use phicam::num::quadrature::Rule;
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
    by_elements_within(scene).0
}

/// The same, and what is stated of it.
fn by_elements_within(scene: &Scene) -> (Matrix, f64) {
    let (kernel, occlusion) = (Kernel::Physical, Occlusion::Considered);
    let model = MatrixModel::over_areas(scene, kernel, None, occlusion, Effort::USUAL).unwrap();
    (model.phi(), model.factors.unwrap().change)
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

/// A step of half an inch in the wall within the view: pixels of the third column see the upper
/// wall up to its edge at x = 4 and the lower one, farther away, behind it.
#[test]
fn a_step_in_the_wall_parts_what_is_seen() {
    let low = "[[surface]]\nname = \"low\"\nrole = \"relay\"\nmaterial = { lambertian = 0.8 }\n\
        rectangle = { corner = [4, -30, -0.5], u = [30, 0, 0], v = [0, 60, 0] }\n";
    let board = [[3.0, 11.0, 4.0], [4.0, 0.0, 0.0], [0.0, -3.0, 3.0]];
    parted_at_4((34.0, low, -0.5), board, [[1.0, 1.5], [-2.0, 3.0]]);
}

/// A board in the plane x = 4, which sends light to what lies beyond it alone.
#[test]
fn the_plane_of_a_board_parts_what_is_seen() {
    let board = [[4.0, 7.0, 2.0], [0.0, 2.0, 0.0], [0.0, 0.0, 2.0]];
    parted_at_4((60.0, "", 0.0), board, [[7.0, 1.5], [9.0, 3.0]]);
}

/// The model, by parts that see one wall and one side of the board, against product rules on both
/// sides of x = 4 in the view, where the wall lies at z = 0 and beyond at `height`.
fn parted_at_4(
    (width, low, height): (f64, &str, f64),
    board @ [corner, u, v]: [[f64; 3]; 3],
    spots: [[f64; 2]; 2],
) {
    let text = format!(
        "name = \"parted\"\nunit = \"in\"\nmax_bounces = 3\n\
        [laser]\npower = 0.005\nwavelength = 632.8e-9\nposition = [-20, 10, 15]\n\
        [laser.spots]\nlayout = \"list\"\npoints = {spots:?}\n\
        [camera]\nposition = [-20, 10, 15]\naperture_area = 0.05\npixels = [4, 4]\n\
        view = {{ x = [2.25, 5.5], y = [2.75, 6.0] }}\n\
        [[surface]]\nname = \"wall\"\nrole = \"relay\"\nmaterial = {{ lambertian = 0.8 }}\n\
        rectangle = {{ corner = [-30, -30, 0], u = [{width}, 0, 0], v = [0, 60, 0] }}\n{low}\
        [[surface]]\nname = \"board\"\nrole = \"hidden\"\nelements = [2, 2]\n\
        rectangle = {{ corner = {corner:?}, u = {u:?}, v = {v:?} }}\n\
        material = {{ lambertian = 0.7 }}\n"
    );
    let scene = Scene::from_toml("parted", &text).unwrap();
    let found = by_quadrature(&scene);
    let (camera, pi) = (DVec3::new(-20.0, 10.0, 15.0), std::f64::consts::PI);
    let [corner, u, v] = board.map(DVec3::from_array);
    let facing = u.cross(v).normalize();
    let g = |wall: DVec3, hidden: DVec3| {
        let r = hidden - wall;
        r.z.max(0.0) * (-r.dot(facing)).max(0.0) / r.length_squared().powi(2)
    };
    let rule = Rule::gauss_legendre(12);
    for p in 0..16 {
        let [x0, y0] = [p % 4, p / 4].map(|k| 0.8125 * k as f64);
        let ([x0, y0], [x1, y1]) = ([2.25 + x0, 2.75 + y0], [3.0625 + x0, 3.5625 + y0]);
        let parting = 4.0f64.clamp(x0, x1);
        let mut seen = Vec::new();
        for (y, wy) in rule.on(y0, y1) {
            for (z, [from, to]) in [(0.0, [x0, parting]), (height, [parting, x1])] {
                for (x, wx) in rule.on(from, to) {
                    let line = DVec3::new(x, y, 0.0) - camera;
                    let share = 0.05 * line.z * line.z / line.length_squared().powi(2) * wx * wy;
                    seen.push((camera + line * ((15.0 - z) / 15.0), share));
                }
            }
        }
        for (l, spot) in spots.into_iter().enumerate() {
            let mut sum = 0.0;
            for (a, wa) in rule.on(0.0, 1.0) {
                for (b, wb) in rule.on(0.0, 1.0) {
                    let at = corner + u * a + v * b;
                    let to: f64 = seen.iter().map(|(wall, share)| share * g(*wall, at)).sum();
                    let from = g(DVec3::new(spot[0], spot[1], 0.0), at);
                    sum += wa * wb * u.cross(v).length() * from * to;
                }
            }
            let truth = 0.005 * sum * (0.8 / pi) * (0.8 / pi) * (0.7 / pi);
            let (phi, bound) = (found.phi[(p, l)], found.bound[(p, l)]);
            let error = (phi - truth).abs();
            assert!(error <= 1e-6 * truth, "{p}, {l}: {phi:e} for {truth:e}");
            assert!(
                error <= bound + 1e-9 * truth,
                "{p}, {l}: {error:e} beyond {bound:e}"
            );
        }
    }
}

/// A pixel and a spot in one place see the same half of a board past a plate, so that the mean of
/// what both see of a cell is not the product of their means: the model against a product rule over
/// the half, and by few cells, where the product came close only like the size of a cell.
#[test]
fn pixel_and_spot_see_the_same_part_of_a_cell() {
    let (scene, truth) = seen_up_to(7.0 / 3.0);
    let found = by_quadrature(&scene);
    let (phi, bound) = (found.phi[0], found.bound[0]);
    let error = (phi - truth).abs();
    assert!(error < 1e-3 * truth, "{phi:e} for {truth:e}");
    assert!(error <= bound, "{error:e} beyond {bound:e}");
    let points = found.visible.unwrap().points;
    assert!(points <= 1 << 16, "{points} cells");
}

/// The same by elements, wherever in their cells the edge lies: by the product of the means the
/// light was off by up to 5 %, and up to a hundred times as much as the last halving changed.
#[test]
fn pixel_and_spot_see_the_same_part_of_an_element() {
    const EDGES: usize = 48;
    for k in 0..EDGES {
        let (scene, truth) = seen_up_to(2.0 + 0.51 * (k as f64 + 0.7) / EDGES as f64);
        let (phi, change) = by_elements_within(&scene);
        let error = (phi[0] / truth - 1.0).abs();
        assert!(error < 5e-4, "{k}: {error:.1e}");
        assert!(error <= change, "{k}: {error:.1e} beyond {change:.1e}");
    }
}

/// A pixel and a spot at x = 1 that see a board past a plate up to a + x = `end`, and the light by a
/// product rule.
fn seen_up_to(end: f64) -> (Scene, f64) {
    let text = format!(
        "name = \"same\"\nunit = \"in\"\nmax_bounces = 3\n\
        [laser]\npower = 0.005\nwavelength = 632.8e-9\nposition = [-20, 2, 10]\n\
        [laser.spots]\nlayout = \"list\"\npoints = [[1.0, 2.0]]\n\
        [camera]\nposition = [-20, 2, 10]\naperture_area = 0.05\npixels = [1, 1]\n\
        view = {{ x = [0.99, 1.01], y = [1.99, 2.01] }}\n\
        [[surface]]\nname = \"wall\"\nrole = \"relay\"\nmaterial = {{ lambertian = 0.8 }}\n\
        rectangle = {{ corner = [-30, -30, 0], u = [60, 0, 0], v = [0, 60, 0] }}\n\
        [[surface]]\nname = \"board\"\nrole = \"hidden\"\nelements = [2, 2]\n\
        rectangle = {{ corner = [0, 0, 6], u = [0, 4, 0], v = [4, 0, 0] }}\n\
        material = {{ lambertian = 0.7 }}\n\
        [[surface]]\nname = \"plate\"\nrole = \"occluder\"\nsides = \"two\"\n\
        rectangle = {{ corner = [{}, -20, 3], u = [20, 0, 0], v = [0, 40, 0] }}\n\
        material = {{ lambertian = 0.0 }}\n",
        0.5 * end
    );
    let (rule, pi) = (Rule::gauss_legendre(12), std::f64::consts::PI);
    // From (x, y, 0) to the board's plane both cosines are 6/R.
    let g = |[x, y]: [f64; 2], [a, b]: [f64; 2]| {
        let r2 = (a - x) * (a - x) + (b - y) * (b - y) + 36.0;
        36.0 / (r2 * r2)
    };
    let mut sum = 0.0;
    for (y, wy) in rule.on(1.99, 2.01) {
        for (from, to) in [(0.99, 1.0), (1.0, 1.01)] {
            for (x, wx) in rule.on(from, to) {
                let d2: f64 = (x + 20.0) * (x + 20.0) + (y - 2.0) * (y - 2.0) + 100.0;
                let share = 0.05 * 100.0 / (d2 * d2) * wx * wy;
                // The plate's edge lies half way up.
                for (a, wa) in rule.on(0.0, end - x.max(1.0)) {
                    for (b, wb) in rule.on(0.0, 4.0) {
                        sum += share * wa * wb * g([x, y], [a, b]) * g([1.0, 2.0], [a, b]);
                    }
                }
            }
        }
    }
    let truth = 0.005 * sum * (0.8 / pi) * (0.8 / pi) * (0.7 / pi);
    (Scene::from_toml("same", &text).unwrap(), truth)
}
