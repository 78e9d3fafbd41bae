//! Laws that every light transport obeys.

use phicam::geometry::DVec3;
use phicam::lab::Errors;
use phicam::num::stream::Sampling;
use phicam::scene::Scene;
use phicam::transport::Estimator::{Factored, Independent, Shared};

use crate::{Way, assert_same, assert_same_under, builtin, relative, trace, trace_spots};

/// An occluder that stands between wall and object and reflects, and room for light to go five
/// ways.
const SHELF: &str = r#"
[[surface]]
name = "shelf"
role = "occluder"
rectangle = { corner = [2.5, 8.5, 1.5], u = [2.5, 0, 0], v = [0, -1.0, 0.8] }
material = { lambertian = 0.6 }
[[surface]]
name = "shelf's other side"
role = "occluder"
rectangle = { corner = [2.5, 7.5, 2.3], u = [2.5, 0, 0], v = [0, 1.0, -0.8] }
material = { lambertian = 0.3 }
"#;

fn shelf(changes: &[(&str, &str)]) -> Scene {
    let mut text = builtin("bench", changes).text + SHELF;
    text = text.replacen("max_bounces = 3 ", "max_bounces = 5 ", 1);
    text = text.replacen("per_side = 30", "per_side = 3", 1);
    text = text.replacen("pixels = [16, 16]", "pixels = [4, 4]", 1);
    Scene::from_toml("shelf", &text).unwrap()
}

/// All estimators, samplers and strategies see the same light: reflecting occluders, five bounces,
/// a wide spot.
#[test]
#[ignore = "slow"]
fn estimators_agree_with_each_other() {
    for diameter in ["spot_diameter = 0.0", "spot_diameter = 0.8"] {
        let scene = shelf(&[("spot_diameter = 0.0", diameter)]);
        let base = trace(&scene, Way(Independent, Sampling::Pcg, 1, 16384));
        for way in [
            Way(Shared, Sampling::Pcg, 2, 32768),
            Way(Shared, Sampling::Sobol, 3, 32768),
            Way(Independent, Sampling::Sobol, 4, 16384),
        ] {
            assert_same(&trace(&scene, way), &base, "estimators");
        }
        for sampling in [Sampling::Pcg, Sampling::Sobol] {
            let factored = trace(&scene, Way(Factored, sampling, 5, 1 << 17));
            assert_same_under(Errors::Everywhere, &factored, &base, "factored");
        }
    }
}

/// Power: exactly proportional. Albedo: light of n bounces by the product of what it met; powers of
/// two are exact.
#[test]
fn flux_is_linear_in_power_and_albedos() {
    let way = Way(Independent, Sampling::Sobol, 5, 64);
    let base = trace(&shelf(&[]), way);
    let double = trace(&shelf(&[("power = 5.0e-3", "power = 10.0e-3")]), way);
    assert_eq!(double.flux, &base.flux * 2.0);
    assert_eq!(double.stderr, &base.stderr * 2.0);

    // Wall and object only: three bounces meet the wall twice and the object once, five the wall
    // three times and the object twice.
    let bench = |changes: &[(&str, &str)]| {
        let five = [("max_bounces = 3 ", "max_bounces = 5 ")];
        trace_spots(&builtin("bench", &[&five, changes].concat()), way, 0..4)
    };
    let base = bench(&[]);
    let wall = bench(&[("lambertian = 0.8", "lambertian = 0.4")]);
    let object = bench(&[("light = 1.0", "light = 0.5")]);
    assert!(base.bounces[2].amax() > 0.0 && base.bounces[4].amax() > 0.0);
    for (n, by_wall, by_object) in [(3, 0.25, 0.5), (5, 0.125, 0.25)] {
        assert_eq!(
            wall.bounces[n - 1],
            &base.bounces[n - 1] * by_wall,
            "{n} bounces, wall"
        );
        assert_eq!(
            object.bounces[n - 1],
            &base.bounces[n - 1] * by_object,
            "{n} bounces, object"
        );
    }
    for n in [1, 2, 4] {
        assert_eq!(
            base.bounces[n - 1].amax(),
            0.0,
            "{n} bounces on a bench of two planes"
        );
    }
}

/// Helmholtz: with spot and pixel point exchanged, flux per étendue stays. The footprint is so
/// small that it is a point.
#[test]
fn spot_and_pixel_can_be_exchanged() {
    let points = [[4.1, 3.3], [7.2, 1.9]];
    let scene = |spot: [f64; 2], pixel: [f64; 2]| {
        let s = 5e-4;
        let [x, y] = pixel;
        let view = format!(
            "view = {{ x = [{}, {}], y = [{}, {}] }}",
            x - s,
            x + s,
            y - s,
            y + s
        );
        let mut text = shelf(&[]).text;
        let start = text.find("layout = ").unwrap();
        let end = text.find("[camera]").unwrap();
        text.replace_range(
            start..end,
            &format!("layout = \"list\"\npoints = [{spot:?}]\n"),
        );
        let text = text
            .replacen("view = { x = [3.25, 6.5], y = [2.75, 6.0] }", &view, 1)
            .replacen("pixels = [4, 4]", "pixels = [1, 1]", 1);
        Scene::from_toml("exchange", &text).unwrap()
    };
    let way = |seed| Way(Independent, Sampling::Pcg, seed, 1 << 20);
    let etendue = |[x, y]: [f64; 2]| {
        let d2 = (DVec3::new(-20.0, 10.0, 15.0) - DVec3::new(x, y, 0.0)).length_squared();
        225.0 / (d2 * d2)
    };
    let mut there = trace(&scene(points[0], points[1]), way(1));
    let mut back = trace(&scene(points[1], points[0]), way(2));
    for (traced, pixel) in [(&mut there, points[1]), (&mut back, points[0])] {
        traced.flux /= etendue(pixel);
        traced.stderr /= etendue(pixel);
    }
    assert!(there.stderr[0] < 5e-3 * there.flux[0], "too noisy to tell");
    assert_same(&there, &back, "reciprocity");
}

/// The same bits for 1, 2 and 3 threads and for any part of the spots; other bits for another seed.
#[test]
#[ignore = "slow"]
fn bits_do_not_depend_on_threads_or_spot_ranges() {
    let bench = |diameter| {
        let small = [
            ("per_side = 30", "per_side = 3"),
            ("pixels = [16, 16]", "pixels = [4, 4]"),
            ("spot_diameter = 0.0", diameter),
        ];
        builtin("bench", &small)
    };
    let satin = [
        ("per_side = 30", "per_side = 3"),
        ("pixels = [16, 16]", "pixels = [4, 4]"),
    ];
    let scenes = [
        shelf(&[]),
        builtin("satin", &satin),
        bench("spot_diameter = 0.0"),
        bench("spot_diameter = 0.3"),
    ];
    let ways = [Independent, Shared, Factored].map(|e| [(e, Sampling::Pcg), (e, Sampling::Sobol)]);
    for scene in &scenes {
        for (estimator, sampling) in ways.into_iter().flatten() {
            let way = Way(estimator, sampling, 9, 64);
            let on = |threads| {
                let pool = rayon::ThreadPoolBuilder::new()
                    .num_threads(threads)
                    .build()
                    .unwrap();
                pool.install(|| trace(scene, way))
            };
            let one = on(1);
            assert_eq!(one, on(2));
            assert_eq!(one, on(3));
            for range in [5..6, 5..8] {
                let part = trace_spots(scene, way, range.clone());
                let own = (range.start, range.len());
                assert_eq!(part.flux, one.flux.columns(own.0, own.1).into_owned());
                assert_eq!(part.stderr, one.stderr.columns(own.0, own.1).into_owned());
            }
            let other = trace(scene, Way(estimator, sampling, 10, 64));
            assert!(relative(&other.flux, &one.flux) > 1e-6);
        }
    }
}

/// The bench with three hidden or occluding things in many ways: a scene for tests of what must not
/// matter.
fn cluttered(role: &str, elements: &str) -> Scene {
    let extra = format!(
        "[[surface]]\nname = \"ramp\"\nrole = \"{role}\"\n{elements}material = {{ lambertian = {{ ramp = [0.2, 0.9] }} }}\n\
         rectangle = {{ corner = [8, 15.5, 0], u = [2.5, 0, 0], v = [0.3, -1.5, 1.5] }}\n\
         [[surface]]\nname = \"ball\"\nrole = \"occluder\"\nmaterial = {{ lambertian = 0.7 }}\n\
         sphere = {{ centre = [4, 8, 2.5], radius = 0.8, face = \"outside\" }}\n"
    );
    let mut text = builtin("bench", &[]).text + &extra;
    text = text.replacen("role = \"hidden\"", &format!("role = \"{role}\""), 1);
    text = text.replacen("elements = [8, 8]", elements.trim(), 1);
    text = text.replacen("max_bounces = 3 ", "max_bounces = 5 ", 1);
    text = text.replacen("per_side = 30", "per_side = 3", 1);
    text = text.replacen("pixels = [16, 16]", "pixels = [4, 4]", 1);
    Scene::from_toml("cluttered", &text).unwrap_or_else(|e| panic!("{e}"))
}

/// Roles choose the sampling, not the light: the same surfaces as hidden (sampled by area) and as
/// occluders (found by the cosine lobe) give the same flux. One of them touches the wall.
#[test]
#[ignore = "slow"]
fn roles_do_not_change_the_light() {
    let hidden = cluttered("hidden", "elements = [4, 4]\n");
    let occluder = cluttered("occluder", "");
    let a = trace(&hidden, Way(Shared, Sampling::Sobol, 1, 1 << 15));
    let b = trace(&occluder, Way(Shared, Sampling::Sobol, 2, 1 << 17));
    assert_same(&a, &b, "roles");
}
