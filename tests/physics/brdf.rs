//! Surfaces that are not Lambertian: tracer and matrix model against each other and against
//! quadratures of f·G·f·G·f that the tests write out themselves. What the BRDFs are is tested
//! beside them, against another program and closed forms; here it is where they enter and between
//! which directions.

use phicam::geometry::DVec3;
use phicam::matrix::Matrix;
use phicam::model::{Extent, Kernel, converged};
use phicam::num::stream::Sampling;
use phicam::scene::Scene;
use phicam::transport::Estimator::{Factored, Independent, Shared};
use phicam::transport::unsupported_surface;

use crate::closed_forms::TWO_WALLS;
use crate::reference::gauss;
use crate::studies::budget;
use crate::{Way, assert_same, builtin, compare, relative, trace};

const PAINT: &str = "{ paint = 0.8, roughness = 0.3, ior = 1.5 }";
const MATT: &str = "{ lambertian = { checkerboard = [2, 2], dark = 0.0, light = 1.0 } }";

/// The satin bench with few pixels and spots, a wall of `wall`, and S2 of `object`.
fn bench(wall: &str, object: &str) -> Scene {
    let changes = [
        ("per_side = 30", "per_side = 2"),
        ("pixels = [16, 16]", "pixels = [4, 4]"),
        (PAINT, wall),
        (MATT, object),
    ];
    builtin("satin", &changes)
}

/// cosθ cosθ′/d² and the unit vector from a to b.
fn form(a: DVec3, normal_a: DVec3, b: DVec3, normal_b: DVec3) -> (f64, DVec3) {
    let to = b - a;
    let d2 = to.dot(to);
    let w = to / d2.sqrt();
    let cosines = normal_a.dot(w).max(0.0) * (-normal_b.dot(w)).max(0.0);
    (cosines / d2, w)
}

const DEVICE: DVec3 = DVec3::new(-20.0, 10.0, 15.0);

/// Φ[p,l] = P Σ_x E Σ_y A f3(eye, x → y) G(x, y) f2(x, s) G(y, s) f1(y, laser) of the 4 × 4 pixels
/// of [`bench`], by Gauss–Legendre over footprints and over the 2 × 2 checks of S2.
fn brute_force(scene: &Scene) -> Matrix {
    let (wall, object) = (&scene.surfaces[0], &scene.surfaces[1]);
    let h = 0.5f64.sqrt();
    let facing = DVec3::new(0.0, -h, -h);
    let mut hidden = Vec::new();
    for cell in 0..4 {
        for (a, wa) in gauss(14) {
            for (b, wb) in gauss(14) {
                let [u, v] = [(cell % 2) as f64 + a, (cell / 2) as f64 + b].map(|x| 0.5 * x);
                let d = 5.86764 + 4.0 * v;
                let y = DVec3::new(3.0 + 4.0 * u, 15.5 - d * h, d * h);
                hidden.push((y, 4.0 * wa * wb, object.albedo.albedo([u, v])));
            }
        }
    }
    let mut phi = Matrix::zeros(16, scene.laser.spots.len());
    let pixel = 3.25 / 4.0;
    let on_wall = |x: DVec3, to: DVec3| {
        wall.brdf(
            wall.albedo.albedo([0.5, 0.5]),
            DVec3::Z,
            (DEVICE - x).normalize(),
            to,
        )
    };
    for p in 0..16 {
        for (a, wa) in gauss(5) {
            for (b, wb) in gauss(5) {
                let column = 3.25 + pixel * ((p % 4) as f64 + a);
                let x = DVec3::new(column, 2.75 + pixel * ((p / 4) as f64 + b), 0.0);
                let d2 = (DEVICE - x).length_squared();
                let etendue = 0.05 * 225.0 / (d2 * d2) * pixel * pixel * wa * wb;
                for &(y, area, rho) in &hidden {
                    let (g23, up) = form(x, DVec3::Z, y, facing);
                    let seen = etendue * on_wall(x, up) * g23 * area;
                    for (l, spot) in scene.laser.spots.iter().enumerate() {
                        let s = spot.target.position;
                        let (g12, rise) = form(s, DVec3::Z, y, facing);
                        let lit = 5e-3 * on_wall(s, rise) * g12;
                        phi[(p, l)] += seen * object.brdf(rho, facing, -rise, -up) * lit;
                    }
                }
            }
        }
    }
    phi
}

fn model(scene: &Scene) -> Matrix {
    converged(scene, Kernel::Physical, Extent::FULL)
        .unwrap()
        .phi
}

fn ways(independent: u64, shared: u64, factored: u64) -> [Way; 3] {
    [
        Way(Independent, Sampling::Pcg, 1, independent),
        Way(Shared, Sampling::Sobol, 2, shared),
        Way(Factored, Sampling::Sobol, 3, factored),
    ]
}

/// How far two Gauss–Legendre rules may be apart, where the BRDF is smooth and where its derivative
/// jumps: Oren and Nayar's does where the azimuths are at right angles and where the polar angles
/// are equal.
const SMOOTH: f64 = 1e-7;
const KINKED: f64 = 1e-5;

/// The known model is the quadrature, the tracer agrees with it, and the same test rejects the wall
/// that is Lambertian of equal albedo, also at its best single scale.
fn known_is_accepted_and_lambertian_rejected(wall: &str, rounding: f64) {
    let scene = bench(wall, MATT);
    let known = model(&scene);
    let error = relative(&known, &brute_force(&scene));
    assert!(error < rounding, "{wall}: {error:e}");
    let lambertian = model(&scene.with_lambertian_relay());
    let scale = known.dot(&lambertian) / lambertian.norm_squared();
    for way in ways(1 << 13, 1 << 14, 1 << 15) {
        let traced = trace(&scene, way);
        let verdict = compare(&traced, &known, way);
        assert!(verdict.agrees, "{wall}, {way:?}: {verdict:?}");
        for wrong in [lambertian.clone(), &lambertian * scale] {
            let verdict = compare(&traced, &wrong, way);
            assert!(!verdict.agrees, "{wall}, {way:?}: {verdict:?}");
        }
    }
}

#[test]
fn a_satin_wall_is_known_and_not_lambertian() {
    known_is_accepted_and_lambertian_rejected(PAINT, SMOOTH);
}

#[test]
fn a_rough_matt_wall_is_known_and_not_lambertian() {
    known_is_accepted_and_lambertian_rejected("{ oren_nayar = 0.8, roughness = 0.6 }", KINKED);
}

#[test]
fn a_wall_of_rough_metal_is_known_and_not_lambertian() {
    let metal = "{ conductor = { eta = 0.2, k = 3.9 }, roughness = 0.4, reflectance = 0.9 }";
    known_is_accepted_and_lambertian_rejected(metal, SMOOTH);
}

#[test]
fn a_wall_of_a_mixture_is_known_and_not_lambertian() {
    let mixture = "{ mixture = [{ weight = 0.6, material = { lambertian = 0.7 } }, \
                   { weight = 0.4, material = { coated = 0.3, roughness = 0.25 } }] }";
    known_is_accepted_and_lambertian_rejected(mixture, SMOOTH);
}

/// From a spot on a slope straight to a floor, both in satin paint: Σ E f(eye, x → s) G(x, s) f(x,
/// laser).
#[test]
fn two_bounces_take_both_brdfs() {
    let text = TWO_WALLS
        .replace("lambertian = 0.7", "coated = 0.7, roughness = 0.3")
        .replace(
            "lambertian = 0.4",
            "coated = 0.4, roughness = 0.5, ior = 1.7",
        );
    let scene = Scene::from_toml("two walls", &text).unwrap();
    let h = 0.5f64.sqrt();
    let slope = DVec3::new(-h, 0.0, h);
    let [eye, laser] = [DVec3::new(-1.0, 0.5, 4.0), DVec3::new(3.0, 0.5, 6.0)];
    let truth = Matrix::from_fn(8, 2, |p, l| {
        let [sx, sy] = [[4.5, 0.4], [4.2, 0.9]][l];
        let s = DVec3::new(sx, sy, 0.5 + (sx - 4.0));
        let mut sum = 0.0;
        for (a, wa) in gauss(10) {
            for (b, wb) in gauss(10) {
                let [column, row] = [(p % 4) as f64 + a, (p / 4) as f64 + b];
                let x = DVec3::new(0.5 + column * 0.5, row * 0.5, 0.0);
                let d2 = (eye - x).length_squared();
                let etendue = 1e-4 * 16.0 / (d2 * d2) * 0.25 * wa * wb;
                let (g, w) = form(x, DVec3::Z, s, slope);
                let seen = scene.surfaces[0].brdf(0.7, DVec3::Z, w, (eye - x).normalize());
                let lit = scene.surfaces[1].brdf(0.4, slope, (laser - s).normalize(), -w);
                sum += 2.0 * etendue * seen * g * lit;
            }
        }
        sum
    });
    for way in ways(1 << 12, 1 << 12, 1 << 12) {
        let verdict = compare(&trace(&scene, way), &truth, way);
        assert!(verdict.agrees, "{way:?}: {verdict:?}");
    }
}

/// Helmholtz on a satin wall: laser and camera exchanged, and with them spot and pixel, flux per
/// étendue stays. They stand apart, so that each BRDF meets other directions before and after.
#[test]
fn laser_and_camera_can_be_exchanged() {
    let devices = [DVec3::new(-20.0, 10.0, 15.0), DVec3::new(16.0, 14.0, 9.0)];
    let points = [[4.1, 3.3], [7.2, 1.9]];
    let traced = |from: usize, seed: u64| {
        let to = 1 - from;
        let [x, y] = points[to];
        let s = 5e-4;
        let [x0, x1, y0, y1] = [x - s, x + s, y - s, y + s];
        let mut text = bench(PAINT, MATT).text;
        let start = text.find("[laser]").unwrap();
        let end = text.find("[[surface]]").unwrap();
        let place = |p: DVec3| format!("position = [{}, {}, {}]", p.x, p.y, p.z);
        let own = format!(
            "[laser]\npower = 5e-3\nwavelength = 632.8e-9\n{}\n[laser.spots]\nlayout = \"list\"\npoints = [{:?}]\n\
             [camera]\n{}\naperture_area = 0.05\nview = {{ x = [{x0}, {x1}], y = [{y0}, {y1}] }}\npixels = [1, 1]\n",
            place(devices[from]),
            points[from],
            place(devices[to]),
        );
        text.replace_range(start..end, &own);
        let scene = Scene::from_toml("exchange", &text).unwrap();
        let mut traced = trace(&scene, Way(Independent, Sampling::Pcg, seed, 1 << 18));
        let d = devices[to] - DVec3::new(x, y, 0.0);
        let d2 = d.length_squared();
        let etendue = d.z * d.z / (d2 * d2);
        traced.flux /= etendue;
        traced.stderr /= etendue;
        traced
    };
    let (there, back) = (traced(0, 1), traced(1, 2));
    assert!(there.stderr[0] < 5e-3 * there.flux[0], "too noisy to tell");
    assert_same(&there, &back, "reciprocity");
}

const GLOSSY: &str = "{ coated = 0.5, roughness = 0.3 }";

/// S2 in satin paint: both estimators that can trace it find the quadrature of its BRDF; the model,
/// which takes it for Lambertian of equal white-sky albedo, is the quadrature of that and is
/// rejected; `factored` is refused by name.
#[test]
#[ignore = "slow"]
fn a_glossy_hidden_surface_is_traced_as_it_is() {
    let scene = bench("{ lambertian = 0.8 }", GLOSSY);
    let truth = brute_force(&scene);
    let albedo = scene.surfaces[1].material.white_sky_albedo(0.5);
    let matt = bench(
        "{ lambertian = 0.8 }",
        &format!("{{ lambertian = {albedo} }}"),
    );
    let model = model(&scene);
    let error = relative(&model, &brute_force(&matt));
    assert!(error < 1e-7, "{error:e}");
    let [independent, shared, factored] = ways(1 << 14, 1 << 15, 1 << 10);
    for way in [independent, shared, factored] {
        assert_eq!(unsupported_surface(&scene, &way.plan()), None);
        let traced = trace(&scene, way);
        let verdict = compare(&traced, &truth, way);
        assert!(verdict.agrees, "{way:?}: {verdict:?}");
        assert!(!compare(&traced, &model, way).agrees, "{way:?}");
    }
    // A path that goes on from a point of all pixels cannot know where it goes to.
    let four = |scene: &Scene| {
        let mut scene = scene.clone();
        scene.max_bounces = 4;
        unsupported_surface(&scene, &factored.plan()).map(str::to_owned)
    };
    assert_eq!(four(&scene).as_deref(), Some("object"));
    assert_eq!(four(&matt), None);
}

/// The budget's row for it is the difference of the two quadratures, ‖f − Lambertian‖/‖Lambertian‖,
/// and the parts add up with it. Standard errors are those of 8 renders: Student's t of 7 degrees
/// of freedom exceeds 7 once in 5000 times.
#[test]
#[ignore = "slow"]
fn the_budget_knows_a_glossy_hidden_surface() {
    let scene = bench("{ lambertian = 0.8 }", GLOSSY);
    let matt = scene.with_lambertian_hidden();
    let expected = relative(&brute_force(&scene), &brute_force(&matt));
    let found = budget(&scene, 1 << 17);
    let row = |name: &str| found.terms.iter().find(|t| t.name == name).unwrap().size;
    let own = row("S2 not Lambertian");
    assert!(
        (own.value - expected).abs() < 7.0 * own.stderr && own.stderr < 1e-3 * expected,
        "{own:?} for {expected:e}"
    );
    let occlusion = row("occlusion");
    assert!(occlusion.value < 7.0 * occlusion.stderr, "{occlusion:?}");
    assert!(found.closure.closes, "{:?}", found.closure);
}
