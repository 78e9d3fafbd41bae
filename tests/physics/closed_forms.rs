//! Scenes whose answer is a formula.

use std::f64::consts::PI;

use phicam::matrix::Matrix;
use phicam::num::stream::Sampling;
use phicam::scene::Scene;
use phicam::transport::Estimator::{Factored, Independent, Shared};

use crate::reference::gauss;
use crate::{Way, builtin, compare, relative, trace};

/// The étendue of pixel (column, row) of the furnace's camera by its closed form: ∫ cos²θ dA/d²
/// over a rectangle as a signed sum of four corner values.
fn furnace_etendue(column: usize, row: usize) -> f64 {
    let (camera, aperture) = ([1.0f64, -0.5, 6.0], 0.01);
    let (x0, y0, step) = (-0.75, -0.75, 1.5 / 4.0);
    let corner = |s: f64, t: f64| {
        let h = camera[2];
        let (a, b) = ((h * h + s * s).sqrt(), (h * h + t * t).sqrt());
        0.5 * (s / a * (t / a).atan() + t / b * (s / b).atan())
    };
    let x = |i: usize| x0 + step * i as f64 - camera[0];
    let y = |j: usize| y0 + step * j as f64 - camera[1];
    let [l, r, b, t] = [x(column), x(column + 1), y(row), y(row + 1)];
    aperture * (corner(r, t) - corner(l, t) - corner(r, b) + corner(l, b))
}

/// Φcam_n = Φ·aⁿ·E_p/(4π²R²): the derivation stands in scenes/furnace.toml.
#[test]
fn the_furnace_glows_as_an_integrating_sphere() {
    for (a, changes) in [
        (0.8f64, vec![]),
        (0.5, vec![("lambertian = 0.8", "lambertian = 0.5")]),
    ] {
        let scene = builtin("furnace", &changes);
        for way in [
            Way(Independent, Sampling::Pcg, 1, 512),
            Way(Shared, Sampling::Sobol, 1, 512),
            Way(Factored, Sampling::Sobol, 1, 512),
        ] {
            let traced = trace(&scene, way);
            let orders: f64 = (2..=8).map(|n| a.powi(n)).sum();
            let truth = Matrix::from_fn(16, 3, |p, _| {
                orders * furnace_etendue(p % 4, p / 4) / (4.0 * PI * PI * 25.0)
            });
            let verdict = compare(&traced, &truth, way);
            assert!(verdict.agrees, "{verdict:?}");
            assert!(relative(&traced.flux, &truth) < 2e-3);
            // Every further reflection multiplies by the albedo, sample by sample.
            for n in 2..8 {
                let next = &traced.bounces[n - 1] * a;
                assert!(relative(&traced.bounces[n], &next) < 1e-12, "{n} bounces");
            }
            assert_eq!(traced.bounces[0].amax(), 0.0, "no spot is in view");
        }
    }
}

pub(crate) const TWO_WALLS: &str = r#"
name = "two walls"
unit = "m"
max_bounces = 2
[laser]
power = 2.0
wavelength = 5e-7
position = [3.0, 0.5, 6.0]
spots = { layout = "list", points = [[4.5, 0.4], [4.2, 0.9]] }
[camera]
position = [-1.0, 0.5, 4.0]
aperture_area = 1e-4
view = { x = [0.5, 2.5], y = [0.0, 1.0] }
pixels = [4, 2]
[[surface]]
name = "floor"
role = "relay"
rectangle = { corner = [0, 0, 0], u = [3, 0, 0], v = [0, 1, 0] }
material = { lambertian = 0.7 }
[[surface]]
name = "slope"
role = "relay"
rectangle = { corner = [4, 0, 0.5], u = [1, 0, 1], v = [0, 1, 0] }
material = { lambertian = 0.4 }
"#;

/// Light from a spot on a slope straight to a floor: Φ·(ρ1/π)·cosθ·cosθ′/d²·(ρ3/π)·E_p, integrated
/// over the footprint by the test's own quadrature. Inverse square and both cosines, with a tilted
/// wall.
#[test]
fn two_bounces_follow_the_inverse_square_law() {
    let scene = Scene::from_toml("two walls", TWO_WALLS).unwrap();
    let h = 0.5f64.sqrt();
    let truth = Matrix::from_fn(8, 2, |p, l| {
        let [sx, sy] = [[4.5, 0.4], [4.2, 0.9]][l];
        let s = [sx, sy, 0.5 + (sx - 4.0)];
        let mut sum = 0.0;
        for (a, wa) in gauss(6) {
            for (b, wb) in gauss(6) {
                let x = [0.5 + ((p % 4) as f64 + a) * 0.5, ((p / 4) as f64 + b) * 0.5];
                let r = [x[0] - s[0], x[1] - s[1], -s[2]];
                let d2: f64 = r.iter().map(|c| c * c).sum();
                // Normal of the slope: u × v = (1, 0, 1) × (0, 1, 0) = (−1, 0, 1).
                let cos_slope = h * (r[2] - r[0]) / d2.sqrt();
                let cos_floor = s[2] / d2.sqrt();
                let c = [-1.0 - x[0], 0.5 - x[1], 4.0];
                let c2: f64 = c.iter().map(|q| q * q).sum();
                let etendue = 1e-4 * 16.0 / (c2 * c2) * 0.25 * wa * wb;
                sum += etendue * (cos_slope * cos_floor / d2).max(0.0);
            }
        }
        sum * 2.0 * 0.4 / PI * 0.7 / PI
    });
    for way in [
        Way(Shared, Sampling::Sobol, 1, 2048),
        Way(Independent, Sampling::Pcg, 1, 2048),
        Way(Factored, Sampling::Sobol, 1, 2048),
        Way(Factored, Sampling::Pcg, 1, 2048),
    ] {
        let verdict = compare(&trace(&scene, way), &truth, way);
        assert!(verdict.agrees, "{verdict:?}");
    }
}

/// A spot in the view sends Φ·(ρ/π)·cosθ·A_lens·cosθ/d² straight into its own pixel and nothing
/// into the others.
#[test]
fn a_spot_in_the_view_is_seen_directly() {
    let square = "layout = \"square\"\ncentre = [5.0, 4.373476808130942]\nhalf_width = 3.0\nper_side = 30\n\
        stagger = [-1.0, 1.0, 0.0]";
    let scene = builtin(
        "bench",
        &[
            (
                square,
                "layout = \"list\"\npoints = [[3.3, 2.8], [6.45, 5.9]]",
            ),
            ("         # offsets cycled along each side", ""),
            ("max_bounces = 3 ", "max_bounces = 1 "),
        ],
    );
    let traced = trace(&scene, Way(Independent, Sampling::Pcg, 1, 32));
    for (l, (x, y, pixel)) in [(3.3f64, 2.8f64, 0usize), (6.45, 5.9, 255)]
        .into_iter()
        .enumerate()
    {
        let d2 = (x + 20.0) * (x + 20.0) + (y - 10.0) * (y - 10.0) + 225.0;
        let flux = 5e-3 * 0.8 / PI * 0.05 * 225.0 / (d2 * d2);
        assert!((traced.flux[(pixel, l)] / flux - 1.0).abs() < 1e-12);
        assert!(
            (traced.flux.column(l).sum() / flux - 1.0).abs() < 1e-12,
            "light in other pixels"
        );
    }
}

/// A Gaussian spot beside the view: its tail lights the wall in view by Φ·2/(πw²)·exp(−2r²/w²),
/// down to a millionth of the middle, and every pixel's share is its own integral. A disc in view
/// is uniform inside its edge.
#[test]
fn wide_spots_are_seen_directly_down_to_their_tails() {
    let square = "layout = \"square\"\ncentre = [5.0, 4.373476808130942]\nhalf_width = 3.0\nper_side = 30\n\
        stagger = [-1.0, 1.0, 0.0]";
    let (sx, sy) = (2.5f64, 2.4f64);
    for (profile, diameter) in [("gaussian", 1.2f64), ("disc", 3.0)] {
        let wide = format!("spot_diameter = {diameter}");
        let name = format!("profile = \"{profile}\"");
        let scene = builtin(
            "bench",
            &[
                (square, "layout = \"list\"\npoints = [[2.5, 2.4]]"),
                ("         # offsets cycled along each side", ""),
                ("max_bounces = 3 ", "max_bounces = 1 "),
                ("spot_diameter = 0.0", &wide),
                ("profile = \"disc\"", &name),
            ],
        );
        let w = 0.5 * diameter;
        let rule = gauss(if profile == "disc" { 40 } else { 8 });
        let truth = Matrix::from_fn(256, 1, |p, _| {
            let mut sum = 0.0;
            for (a, wa) in &rule {
                for (b, wb) in &rule {
                    let x = 3.25 + ((p % 16) as f64 + a) * 3.25 / 16.0;
                    let y = 2.75 + ((p / 16) as f64 + b) * 3.25 / 16.0;
                    let r2 = ((x - sx) * (x - sx) + (y - sy) * (y - sy)) / (w * w);
                    let irradiance = match profile {
                        "disc" if r2 <= 1.0 => 1.0 / (PI * w * w),
                        "disc" => 0.0,
                        _ => 2.0 / (PI * w * w) * (-2.0 * r2).exp(),
                    };
                    let d2 = (x + 20.0) * (x + 20.0) + (y - 10.0) * (y - 10.0) + 225.0;
                    sum += wa * wb * irradiance * 0.05 * 225.0 / (d2 * d2)
                        * (3.25f64 / 16.0)
                        * (3.25 / 16.0);
                }
            }
            5e-3 * 0.8 / PI * sum
        });
        let way = Way(Independent, Sampling::Sobol, 1, 4096);
        let traced = trace(&scene, way);
        if profile == "gaussian" {
            // Each pixel within its own error bar, which is small against its own flux however
            // faint that is.
            let verdict = compare(&traced, &truth, way);
            assert!(verdict.agrees, "{verdict:?}");
            let relative = traced.stderr.component_div(&truth).amax();
            assert!(
                relative < 0.05,
                "a pixel known to {relative} of itself only"
            );
        } else {
            // Pixels cut by the disc's edge to what 40 nodes a side resolve.
            let off = (&traced.flux - &truth).amax();
            assert!(off < 0.05 * truth.amax(), "{off:e} of {:e}", truth.amax());
        }
        assert!(
            (traced.flux.sum() / truth.sum() - 1.0).abs() < 2e-3,
            "{profile}"
        );
    }
}
