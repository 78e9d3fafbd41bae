//! What stands in the way, on the seam, or beside the wall.

use phicam::geometry::DVec3;
use phicam::lab::Errors;
use phicam::model::{Extent, Kernel, converged};
use phicam::num::quadrature::Rule;
use phicam::num::stream::Sampling;
use phicam::scene::Scene;
use phicam::transport::Estimator::{Factored, Independent, Shared};

use crate::{Way, assert_same, assert_same_under, builtin, trace, trace_spots};

/// The trap of overlapping hidden faces: what stands behind another hidden face must add nothing,
/// and what is seen partly must add up: Φ(both) = Φ(front, black back) + Φ(back behind a black
/// front) for three bounces.
#[test]
#[ignore = "slow"]
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

/// A beam that something stands in lights that, and no longer the wall; pixels whose sight is
/// blocked see what blocks it.
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

/// A wall cut into 3 × 4 tiles and an object cut into 3 × 3, with spots exactly on the seams and
/// through the BVH, is the wall and the object.
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
    let factored = trace(&cut, Way(Factored, Sampling::Sobol, 3, 1 << 14));
    assert_same_under(
        Errors::Everywhere,
        &factored,
        &trace(&whole, way(2)),
        "seams, factored",
    );
}

/// A spot that hangs over the wall's edge loses what falls beside it: a disc cut at its middle
/// keeps half its power, so that a symmetric pair of half discs makes one whole.
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
    // The lost half lies on the far side; its centroid is 4r/3π beside the edge: to first order the
    // kept half is half the light of a point at the kept centroid. The second order, (r/R)² ≈
    // (0.2/8)², bounds the error.
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
    let model = converged(&scene, Kernel::Physical, Extent::FULL).unwrap();
    assert!(
        (model.phi.sum() / half - 1.0).abs() < 5e-3,
        "{:e} modelled",
        model.phi.sum()
    );
}

/// A ball for a wall, and a blind that takes the camera's sight of parts of pixels whose middles
/// are free: the model against iterated quadrature of its own, each row of a footprint up to the
/// blind's edge, which is found by halving.
#[test]
fn a_curved_wall_is_seen_past_an_edge_by_parts() {
    let text = "name = \"ball\"\nunit = \"in\"\nmax_bounces = 3\n\
        [laser]\npower = 0.005\nwavelength = 632.8e-9\nposition = [4, -20, 15]\n\
        [laser.spots]\nlayout = \"list\"\npoints = [[1.5, 1.5], [7.5, 4.0]]\n\
        [camera]\nposition = [-20, 10, 15]\naperture_area = 0.05\npixels = [4, 4]\n\
        view = { x = [2.25, 5.5], y = [2.75, 6.0] }\n\
        [[surface]]\nname = \"wall\"\nrole = \"relay\"\nmaterial = { lambertian = 0.8 }\n\
        sphere = { centre = [4, 4, -25], radius = 25, face = \"outside\" }\n\
        [[surface]]\nname = \"card\"\nrole = \"hidden\"\nelements = [2, 2]\n\
        rectangle = { corner = [3, 9, 2], u = [0.5, 0.5, -1], v = [1, -0.5, 0.25] }\n\
        material = { lambertian = 0.7 }\n\
        [[surface]]\nname = \"blind\"\nrole = \"occluder\"\nsides = \"two\"\n\
        rectangle = { corner = [-9, -30, 8.5], u = [0, 60, 0], v = [0, 0, 60] }\n\
        material = { lambertian = 0.0 }\n";
    let scene = Scene::from_toml("ball", text).unwrap();
    let found = converged(&scene, Kernel::Physical, Extent::FULL).unwrap();

    let (centre, radius, pi) = (DVec3::new(4.0, 4.0, -25.0), 25.0, std::f64::consts::PI);
    let camera = DVec3::new(-20.0, 10.0, 15.0);
    let above = |x: f64, y: f64| {
        let z: f64 = radius * radius - (x - 4.0) * (x - 4.0) - (y - 4.0) * (y - 4.0);
        DVec3::new(x, y, z.sqrt() - 25.0)
    };
    let (u, v) = (DVec3::new(0.5, 0.5, -1.0), DVec3::new(1.0, -0.5, 0.25));
    let facing = u.cross(v).normalize();
    let g = |wall: DVec3, hidden: DVec3| {
        let r = hidden - wall;
        let cosines = r.dot((wall - centre) / radius).max(0.0) * (-r.dot(facing)).max(0.0);
        cosines / r.length_squared().powi(2)
    };
    // What the camera sees is aimed at in the plane that touches the ball in the view's middle.
    let middle = above(3.875, 4.375);
    let n = (middle - centre) / radius;
    let aim = |x: f64, y: f64| {
        let z = middle.z - (n.x * (x - middle.x) + n.y * (y - middle.y)) / n.z;
        DVec3::new(x, y, z) - camera
    };
    let is_free = |x: f64, y: f64| camera.z + 11.0 / (x + 20.0) * aim(x, y).z < 8.5;
    let rule = Rule::gauss_legendre(8);
    for p in 0..16 {
        let [x0, y0] = [
            2.25 + 0.8125 * (p % 4) as f64,
            2.75 + 0.8125 * (p / 4) as f64,
        ];
        let mut seen = Vec::new();
        for (y, wy) in rule.on(y0, y0 + 0.8125) {
            let (mut low, mut high) = (x0, x0 + 0.8125);
            if is_free(high, y) {
                low = high;
            }
            for _ in 0..50 {
                let half = 0.5 * (low + high);
                if is_free(half, y) {
                    low = half;
                } else {
                    high = half;
                }
            }
            for (x, wx) in rule.on(x0, low) {
                let line = aim(x, y);
                let d2 = line.length_squared();
                let share = 0.05 * line.dot(n).powi(2) / (d2 * d2) * wx * wy / n.z;
                let from = camera - centre;
                let b = line.dot(from) / d2;
                let t = -b - (b * b - (from.length_squared() - radius * radius) / d2).sqrt();
                seen.push((camera + line * t, share));
            }
        }
        for (l, spot) in [above(1.5, 1.5), above(7.5, 4.0)].into_iter().enumerate() {
            let mut sum = 0.0;
            for (a, wa) in rule.on(0.0, 1.0) {
                for (b, wb) in rule.on(0.0, 1.0) {
                    let at = DVec3::new(3.0, 9.0, 2.0) + u * a + v * b;
                    let to: f64 = seen.iter().map(|(wall, share)| share * g(*wall, at)).sum();
                    sum += wa * wb * u.cross(v).length() * g(spot, at) * to;
                }
            }
            let truth = 0.005 * sum * (0.8 / pi) * (0.8 / pi) * (0.7 / pi);
            let (phi, bound) = (found.phi[(p, l)], found.bound[(p, l)]);
            let error = (phi - truth).abs();
            assert!(error < 1e-3 * truth, "{p}, {l}: {phi:e} for {truth:e}");
            assert!(
                error <= bound + 1e-6 * truth,
                "{p}, {l}: {error:e} beyond {bound:e}"
            );
        }
    }
    // Parts of the last column are hidden, and no pixel's middle is.
    assert!((0..4).all(|k| {
        let y = 3.15625 + 0.8125 * k as f64;
        is_free(5.09375, y) && !is_free(5.5, y)
    }));
}
