//! Laws that every light transport obeys.

use phicam::geometry::DVec3;
use phicam::num::stream::Sampling;
use phicam::scene::Scene;
use phicam::transport::Estimator::{Independent, Shared};

use crate::{Way, assert_same, builtin, relative, trace, trace_spots};

/// An occluder that stands between wall and object and reflects, and room for light to go five ways.
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

/// All estimators, samplers and strategies see the same light: reflecting occluders, five bounces, a wide spot.
#[test]
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
    }
}

/// Power: exactly proportional. Albedo: light of n bounces by the product of what it met; powers of two are exact.
#[test]
fn flux_is_linear_in_power_and_albedos() {
    let way = Way(Independent, Sampling::Sobol, 5, 64);
    let base = trace(&shelf(&[]), way);
    let double = trace(&shelf(&[("power = 5.0e-3", "power = 10.0e-3")]), way);
    assert_eq!(double.flux, &base.flux * 2.0);
    assert_eq!(double.stderr, &base.stderr * 2.0);

    // Wall and object only: three bounces meet the wall twice and the object once, five the wall three times and the object
    // twice.
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

/// Helmholtz: with spot and pixel point exchanged, flux per étendue stays. The footprint is so small that it is a point.
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

/// The trap of overlapping hidden faces: what stands behind another hidden face must add nothing, and what is seen partly
/// must add up: Φ(both) = Φ(front, black back) + Φ(back behind a black front) for three bounces.
#[test]
fn hidden_faces_that_overlap_are_not_counted_twice() {
    let with_back = |front: &str, back: &str, shrink: f64| {
        let h = 0.5f64.sqrt();
        let at = |d: f64, lift: f64| [0.0, 15.5 - d * h + lift * h, d * h + lift * h];
        let corner = at(7.86764 - 2.0 * shrink, 0.6);
        let v = [0.0, -4.0 * shrink * h, 4.0 * shrink * h];
        let text = builtin("bench", &[])
            .text
            .replacen(
                "lambertian = { checkerboard = [2, 2], dark = 0.0, light = 1.0 }",
                &format!("lambertian = {front}"),
                1,
            )
            .replacen("per_side = 30", "per_side = 3", 1)
            .replacen("pixels = [16, 16]", "pixels = [3, 3]", 1)
            + &format!(
                "[[surface]]\nname = \"back\"\nrole = \"hidden\"\nelements = [2, 2]\nmaterial = {{ lambertian = {back} }}\n\
                 rectangle = {{ corner = [{}, {}, {}], u = [{}, 0, 0], v = {v:?} }}\n",
                5.0 - 2.0 * shrink,
                corner[1],
                corner[2],
                4.0 * shrink
            );
        Scene::from_toml("overlap", &text).unwrap()
    };
    let way = |seed| Way(Independent, Sampling::Pcg, seed, 1 << 15);
    // A back face of 0.3 the size, 0.6 in. behind, is covered from everywhere on the wall.
    let covered = trace(&with_back("0.9", "0.9", 0.3), way(1));
    let alone = trace(&with_back("0.9", "0.0", 0.3), way(2));
    assert_same(&covered, &alone, "covered");
    // One of twice the size is seen around the front.
    let both = trace(&with_back("0.9", "0.9", 2.0), way(3));
    let mut parts = trace(&with_back("0.9", "0.0", 2.0), way(4));
    let behind = trace(&with_back("0.0", "0.9", 2.0), way(5));
    assert!(behind.flux.sum() > 0.1 * parts.flux.sum());
    parts.flux += &behind.flux;
    parts.stderr = parts
        .stderr
        .zip_map(&behind.stderr, |a, b| (a * a + b * b).sqrt());
    assert_same(&both, &parts, "parts");
}

/// The same bits for 1, 2 and 3 threads and for any part of the spots; other bits for another seed.
#[test]
fn bits_do_not_depend_on_threads_or_spot_ranges() {
    let scene = shelf(&[]);
    for estimator in [Independent, Shared] {
        for sampling in [Sampling::Pcg, Sampling::Sobol] {
            let way = Way(estimator, sampling, 9, 64);
            let on = |threads| {
                let pool = rayon::ThreadPoolBuilder::new()
                    .num_threads(threads)
                    .build()
                    .unwrap();
                pool.install(|| trace(&scene, way))
            };
            let one = on(1);
            assert_eq!(one, on(2));
            assert_eq!(one, on(3));
            let part = trace_spots(&scene, way, 5..8);
            assert_eq!(part.flux, one.flux.columns(5, 3).into_owned());
            assert_eq!(part.stderr, one.stderr.columns(5, 3).into_owned());
            let other = trace(&scene, Way(estimator, sampling, 10, 64));
            assert!(relative(&other.flux, &one.flux) > 1e-6);
        }
    }
}

/// A beam that something stands in lights that, and no longer the wall; pixels whose sight is blocked see what blocks it.
#[test]
fn what_stands_in_the_way_stops_the_light() {
    let black =
        "[[surface]]\nname = \"screen\"\nrole = \"occluder\"\nmaterial = { lambertian = 0.0 }\n";
    let add = |rectangle: &str| {
        let text = builtin("bench", &[]).text + black + rectangle;
        Scene::from_toml("screen", &text).unwrap()
    };
    let way = Way(Independent, Sampling::Pcg, 1, 32);
    // Right in front of the laser, which stands where the camera stands: everything is dark.
    let dark = trace_spots(
        &add("rectangle = { corner = [-19, 0, 5], u = [0, 0, 15], v = [0, 20, 0] }"),
        way,
        0..3,
    );
    assert_eq!(dark.flux.amax(), 0.0);
    // On the left half of the view, close to the wall and below every other line.
    let half =
        add("rectangle = { corner = [3.25, 2.75, 1e-6], u = [1.625, 0, 0], v = [0, 3.25, 0] }");
    let traced = trace_spots(&half, way, 0..3);
    for p in 0..256 {
        let covered = p % 16 < 8;
        assert_eq!(traced.flux[(p, 0)] == 0.0, covered, "pixel {p}");
    }
}

/// The bench with three hidden or occluding things in many ways: a scene for tests of what must not matter.
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

/// Roles choose the sampling, not the light: the same surfaces as hidden (sampled by area) and as occluders (found by the
/// cosine lobe) give the same flux. One of them touches the wall.
#[test]
fn roles_do_not_change_the_light() {
    let hidden = cluttered("hidden", "elements = [4, 4]\n");
    let occluder = cluttered("occluder", "");
    let a = trace(&hidden, Way(Shared, Sampling::Sobol, 1, 1 << 15));
    let b = trace(&occluder, Way(Shared, Sampling::Sobol, 2, 1 << 17));
    assert_same(&a, &b, "roles");
}

/// A wall cut into 3 × 4 tiles and an object cut into 3 × 3, with spots exactly on the seams and through the BVH, is the wall
/// and the object.
#[test]
fn cut_surfaces_are_whole_ones() {
    let spots = "layout = \"list\"\npoints = [[4, 2], [8, 6], [2, 8], [3, 1], [4, 10]]\n";
    let with = |walls: String, objects: String| {
        let text = builtin("bench", &[("pixels = [16, 16]", "pixels = [3, 3]")]).text;
        let (head, rest) = text.split_once("layout = ").unwrap();
        let (_, rest) = rest.split_once("[camera]").unwrap();
        let (camera, _) = rest.split_once("[[surface]]").unwrap();
        Scene::from_toml(
            "cut",
            &format!("{head}{spots}[camera]{camera}{walls}{objects}"),
        )
        .unwrap_or_else(|e| panic!("{e}"))
    };
    let wall = |i: u32, j: u32, n: u32, m: u32| {
        let (w, h) = (12.0 / f64::from(n), 16.0 / f64::from(m));
        format!(
            "[[surface]]\nname = \"wall {i} {j}\"\nrole = \"relay\"\nmaterial = {{ lambertian = 0.8 }}\n\
             rectangle = {{ corner = [{}, {}, 0], u = [{w}, 0, 0], v = [0, {h}, 0] }}\n",
            f64::from(i) * w,
            f64::from(j) * h
        )
    };
    let object = |i: u32, j: u32, n: u32| {
        let (s, n) = (2.82842712474619 / f64::from(n), f64::from(n));
        format!(
            "[[surface]]\nname = \"object {i} {j}\"\nrole = \"hidden\"\nelements = [2, 2]\nmaterial = {{ lambertian = 0.9 }}\n\
             rectangle = {{ corner = [{}, {}, {}], u = [{}, 0, 0], v = [0, {}, {s}] }}\n",
            3.0 + f64::from(i) * 4.0 / n,
            11.35 - f64::from(j) * s,
            4.15 + f64::from(j) * s,
            4.0 / n,
            -s
        )
    };
    let all = |n: u32, m: u32, f: &dyn Fn(u32, u32) -> String| {
        (0..n * m).map(|k| f(k % n, k / n)).collect::<String>()
    };
    let whole = with(wall(0, 0, 1, 1), object(0, 0, 1));
    let cut = with(
        all(3, 4, &|i, j| wall(i, j, 3, 4)),
        all(3, 3, &|i, j| object(i, j, 3)),
    );
    let way = |seed| Way(Shared, Sampling::Sobol, seed, 1 << 14);
    assert_same(&trace(&cut, way(1)), &trace(&whole, way(2)), "seams");
}

/// A spot that hangs over the wall's edge loses what falls beside it: a disc cut at its middle keeps half its power, so that a
/// symmetric pair of half discs makes one whole.
#[test]
fn what_misses_the_wall_is_lost() {
    let at = |x: f64| {
        let text = builtin(
            "bench",
            &[
                ("spot_diameter = 0.0", "spot_diameter = 0.4"),
                ("pixels = [16, 16]", "pixels = [2, 2]"),
            ],
        )
        .text;
        let (head, rest) = text.split_once("layout = ").unwrap();
        let (_, rest) = rest.split_once("[camera]").unwrap();
        let text = format!("{head}layout = \"list\"\npoints = [[{x}, 7.0]]\n[camera]{rest}");
        Scene::from_toml("edge", &text).unwrap()
    };
    let scene = at(11.5);
    assert!(
        scene
            .warnings()
            .iter()
            .any(|w| w.to_string().contains("edge"))
    );
    let way = Way(Shared, Sampling::Sobol, 1, 1 << 15);
    let half = trace(&scene, way).flux.sum();
    // The lost half lies on the far side; its centroid is 4r/3π beside the edge: to first order the kept half is half the light
    // of a point at the kept centroid. The second order, (r/R)² ≈ (0.2/8)², bounds the error.
    let centroid = 11.5 - 4.0 * 0.2 / (3.0 * std::f64::consts::PI);
    let point = builtin("bench", &[("pixels = [16, 16]", "pixels = [2, 2]")]).text;
    let (head, rest) = point.split_once("layout = ").unwrap();
    let (_, rest) = rest.split_once("[camera]").unwrap();
    let text = format!("{head}layout = \"list\"\npoints = [[{centroid}, 7.0]]\n[camera]{rest}");
    let point = trace(&Scene::from_toml("point", &text).unwrap(), way)
        .flux
        .sum();
    assert!(
        (half / (0.5 * point) - 1.0).abs() < 2e-3,
        "{half:e} for half of {point:e}"
    );
    // And the model says the same.
    let model = phicam::model::converged(
        &scene,
        phicam::model::Kernel::Physical,
        phicam::model::Extent::FULL,
    )
    .unwrap();
    assert!(
        (model.phi.sum() / half - 1.0).abs() < 5e-3,
        "{:e} modelled",
        model.phi.sum()
    );
}
