//! Meshes against the analytic shapes that they approximate, and against themselves.

use std::path::Path;

use phicam::geometry::{DAffine3, DQuat, DVec3, Ray};
use phicam::model::{Extent, Kernel, MatrixModel, converged};
use phicam::num::stream::Sampling;
use phicam::recovery::{Method, Options, Problem, recover};
use phicam::scene::mesh::{FaceValues, Triangles, bust, to_ply};
use phicam::scene::{Role, Scene, Texture, Warning};
use phicam::transport::Estimator;

use super::reference::{Bench, gauss};
use super::{Way, assert_same, assert_same_under, builtin, compare, matrix, relative, trace};
use phicam::lab::Errors;

mod faces;
mod textured;
mod walls;

const RECTANGLE: &str = "rectangle = { corner = [3, 11.350951966438567, 4.149048033561433], \
    u = [4, 0, 0], v = [0, -2.82842712474619, 2.82842712474619] }";
/// The same: the unit square four times as large, leant over by 135° and moved; stretched by a
/// hair, so that the mesh itself is.
const MESHED: &str = "mesh = { generate = \"rectangle\", faces = 450, scale = [4, 4.000000000001, 1], \
    rotate = [{ axis = [1, 0, 0], angle = 135 }], translate = [3, 11.350951966438567, 4.149048033561433] }";
const FEW_SPOTS: (&str, &str) = ("per_side = 30", "per_side = 3");

/// The board's rectangle as the unit square of triangles, exactly.
fn meshed(faces: u32) -> String {
    format!(
        "mesh = {{ generate = \"rectangle\", faces = {faces}, scale = 4, \
         rotate = [{{ axis = [1, 0, 0], angle = 135 }}], \
         translate = [3, 11.350951966438567, 4.149048033561433] }}"
    )
}

const CHECKS: &str = "{ checkerboard = [2, 2], dark = 0.0, light = 1.0 }";

/// The bench's text with changes.
fn changed(changes: &[(&str, &str)]) -> String {
    let mut text = Scene::load("bench").unwrap().text;
    for (old, new) in changes {
        assert!(text.contains(old), "the bench has no `{old}`");
        text = text.replacen(old, new, 1);
    }
    text
}

/// A rectangle as a quadrilateral of an OBJ file, its corners with 17 digits, and as a scene says
/// it.
fn written(corner: DVec3, u: DVec3, v: DVec3) -> (String, String) {
    let corners = [corner, corner + u, corner + u + v, corner + v];
    let lines = corners.map(|p| format!("v {:.16e} {:.16e} {:.16e}\n", p.x, p.y, p.z));
    let obj = lines.concat() + "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n";
    let [corner, u, v] = [corner, u, v].map(|x| x.to_array());
    let table = format!("rectangle = {{ corner = {corner:?}, u = {u:?}, v = {v:?} }}");
    (table, obj)
}

/// A scene file and a mesh beside it.
fn beside(name: &str, mesh: &str, text: &str) -> Result<Scene, String> {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join(name), mesh).unwrap();
    let path = dir.path().join("scene.toml");
    std::fs::write(&path, text).unwrap();
    Scene::load(&path.to_string_lossy()).map_err(|e| e.to_string())
}

/// The board of the bench as 450 triangles: every estimator agrees with the quadrature over the
/// rectangle, and with its own render of it.
#[test]
#[ignore = "slow"]
fn a_meshed_rectangle_is_the_rectangle() {
    let flat = builtin("bench", &[FEW_SPOTS]);
    let mesh = builtin("bench", &[FEW_SPOTS, (RECTANGLE, MESHED)]);
    let truth = converged(&flat, Kernel::Physical, Extent::FULL)
        .unwrap()
        .phi;
    let own = converged(&mesh, Kernel::Physical, Extent::FULL)
        .unwrap()
        .phi;
    assert!(relative(&own, &truth) < 1e-3, "{}", relative(&own, &truth));
    for (estimator, samples) in [
        (Estimator::Independent, 1024),
        (Estimator::Shared, 2048),
        (Estimator::Factored, 8192),
    ] {
        for sampling in [Sampling::Pcg, Sampling::Sobol] {
            let way = Way(estimator, sampling, 5, samples);
            let traced = trace(&mesh, way);
            let verdict = compare(&traced, &truth, way);
            assert!(verdict.agrees, "{way:?}: {verdict:?}");
            let other = trace(&flat, Way(estimator, sampling, 6, samples));
            assert_same_under(Errors::of(estimator), &traced, &other, "rectangle");
        }
    }
}

/// The same at five bounces, and a board whose mesh lies the wrong way round is dark.
#[test]
#[ignore = "slow"]
fn a_meshed_rectangle_has_more_bounces_and_one_front() {
    let deep = ("max_bounces = 3", "max_bounces = 5");
    let flat = builtin("bench", &[FEW_SPOTS, deep]);
    let mesh = builtin("bench", &[FEW_SPOTS, deep, (RECTANGLE, MESHED)]);
    let way = |seed| Way(Estimator::Shared, Sampling::Sobol, seed, 4096);
    assert_same(&trace(&mesh, way(1)), &trace(&flat, way(2)), "five bounces");
    let turned = MESHED.replace("angle = 135", "angle = -45");
    let turned = turned.replace(
        "translate = [3, 11.350951966438567, 4.149048033561433]",
        "translate = [3, 8.522524841692377, 6.977475158307623]",
    );
    // The camera sees that front: it can be no hidden surface, but an occluder in its place.
    let role = ("role = \"hidden\"", "role = \"occluder\"");
    let changes = [
        FEW_SPOTS,
        (RECTANGLE, &*turned),
        role,
        ("elements = [8, 8]", ""),
    ];
    let turned = builtin("bench", &changes);
    assert_eq!(trace(&turned, way(1)).flux.sum(), 0.0);
}

const BALL: &str =
    "\n[[surface]]\nname = \"ball\"\nrole = \"occluder\"\nmaterial = { lambertian = 0.7 }\n";

/// A bright ball between wall and object: it reflects, and it casts shadows.
#[test]
#[ignore = "slow"]
fn a_finely_meshed_sphere_is_the_sphere() {
    let scene = |shape: &str| {
        let text = builtin("bench", &[FEW_SPOTS]).text + BALL + shape;
        Scene::from_toml("ball", &text).unwrap()
    };
    let exact = scene("sphere = { centre = [6, 8, 3], radius = 1.2, face = \"outside\" }\n");
    let mesh = scene(
        "mesh = { generate = \"sphere\", faces = 300000, scale = 1.2, translate = [6, 8, 3], closed = true }\n",
    );
    assert!(
        mesh.warnings().len() == exact.warnings().len(),
        "{:?}",
        mesh.warnings()
    );
    for (estimator, samples) in [(Estimator::Shared, 4096), (Estimator::Factored, 8192)] {
        let way = |seed| Way(estimator, Sampling::Sobol, seed, samples);
        let (a, b) = (trace(&mesh, way(1)), trace(&exact, way(2)));
        assert_same_under(Errors::of(estimator), &a, &b, "sphere");
        // Both differ from the bench without it.
        let bare = trace(&builtin("bench", &[FEW_SPOTS]), way(3));
        assert!(relative(&bare.flux, &b.flux) > 0.05);
    }
}

fn placed(triangles: &Triangles, place: DAffine3) -> Triangles {
    let mut moved = triangles.clone();
    for p in &mut moved.positions {
        *p = place.transform_point3(*p);
    }
    moved
}

/// Steps of a sequence that fills [0, 1]⁶: powers of 1/φ₆, φ₆⁷ = φ₆ + 1.
const GOLDEN: [f64; 6] = [
    0.898_653_712_628_699_2,
    0.807_578_495_221_344_7,
    0.725_733_412_969_759_8,
    0.652_183_025_943_971_6,
    0.586_086_697_577_969_3,
    0.526_688_986_700_735_8,
];

/// Two busts that share one mesh, against two meshes whose vertices were moved before they were
/// written: the same rays meet the same triangles at the same places, up to rounding, and the light
/// is the same.
#[test]
#[ignore = "slow"]
fn instances_are_copies() {
    let dir = tempfile::tempdir().unwrap();
    let body = |name: &str, mesh: &str| {
        format!(
            "\n[[surface]]\nname = \"{name}\"\nrole = \"occluder\"\nmaterial = {{ lambertian = 0.5 }}\nmesh = {mesh}\n"
        )
    };
    let bench = builtin("bench", &[FEW_SPOTS]).text;
    let shared = bench.clone()
        + &body(
            "left",
            "{ file = \"bust.ply\", scale = 3, rotate = [{ axis = [0, 0, 1], angle = 30 }], translate = [1.5, 9, 0.5] }",
        )
        + &body(
            "right",
            "{ file = \"bust.ply\", scale = 2, rotate = [{ axis = [1, 1, 0], angle = 70 }], translate = [8, 9, 2] }",
        );
    let copied = bench
        + &body("left", "{ file = \"left.ply\" }")
        + &body("right", "{ file = \"right.ply\" }");
    let turn =
        |axis: DVec3, degrees: f64| DQuat::from_axis_angle(axis.normalize(), degrees.to_radians());
    let place = |s: f64, q, t| DAffine3::from_scale_rotation_translation(DVec3::splat(s), q, t);
    let left = place(3.0, turn(DVec3::Z, 30.0), DVec3::new(1.5, 9.0, 0.5));
    let right = place(
        2.0,
        turn(DVec3::new(1.0, 1.0, 0.0), 70.0),
        DVec3::new(8.0, 9.0, 2.0),
    );
    let own = bust(4000);
    let write = |name: &str, bytes: &[u8]| std::fs::write(dir.path().join(name), bytes).unwrap();
    write("bust.ply", &to_ply(&own, FaceValues::default()));
    write(
        "left.ply",
        &to_ply(&placed(&own, left), FaceValues::default()),
    );
    write(
        "right.ply",
        &to_ply(&placed(&own, right), FaceValues::default()),
    );
    let load = |name: &str, text: &str| {
        write(name, text.as_bytes());
        let path: &Path = &dir.path().join(name);
        Scene::load(&path.to_string_lossy()).unwrap_or_else(|e| panic!("{e}"))
    };
    let (shared, copied) = (load("shared.toml", &shared), load("copied.toml", &copied));
    let busts = shared
        .surfaces
        .iter()
        .filter(|s| s.role == Role::Occluder)
        .count();
    assert_eq!(busts, 2);
    let unit = |k: usize, d: usize| (0.5 + k as f64 * GOLDEN[d]).fract();
    let mut met = 0;
    for k in 0..20_000 {
        let from = DVec3::from_array([0, 1, 2].map(|d| 12.0 * unit(k, d)));
        let to = DVec3::from_array([3, 4, 5].map(|d| 12.0 * unit(k, d)));
        let ray = Ray::new(from, (to - from).normalize());
        let [a, b] = [&shared, &copied].map(|scene| scene.bvh().closest(&ray, None));
        assert_eq!(
            a.map(|h| (h.shape, h.triangle)),
            b.map(|h| (h.shape, h.triangle))
        );
        if let (Some(a), Some(b)) = (a, b) {
            let [p, q] = [(&shared, a), (&copied, b)].map(|(s, h)| s.bvh().point(&ray, h));
            assert!((p.position - q.position).length() < 1e-9);
            assert!((p.normal - q.normal).length() < 1e-9);
            met += usize::from(shared.surfaces[a.shape as usize].role == Role::Occluder);
        }
    }
    assert!(met > 100, "{met} rays met a bust");
    for estimator in [Estimator::Shared, Estimator::Factored] {
        let a = trace(&shared, Way(estimator, Sampling::Sobol, 3, 1024));
        let b = trace(&copied, Way(estimator, Sampling::Sobol, 4, 1024));
        assert_same_under(Errors::of(estimator), &a, &b, "copies");
    }
}

/// Cells of the mesh's texture coordinates are cells of the rectangle, clipped out of triangles
/// that straddle them: the same G12, G23, areas and albedos. One element to each triangle makes
/// nearly the integral.
#[test]
fn elements_of_a_mesh_are_those_of_the_surface() {
    let four = ("elements = [8, 8]", "elements = [4, 4]");
    let model = |scene: &Scene| MatrixModel::new(scene, Kernel::Physical, None).unwrap();
    let flat = model(&builtin("bench", &[FEW_SPOTS, four]));
    let mesh = model(&builtin("bench", &[FEW_SPOTS, four, (RECTANGLE, MESHED)]));
    assert!(relative(&mesh.g12, &flat.g12) < 1e-6 && relative(&mesh.g23, &flat.g23) < 1e-6);
    assert!(relative(&mesh.laser_side, &flat.laser_side) < 1e-6);
    assert!(relative(&mesh.camera_side, &flat.camera_side) < 1e-6);
    assert_eq!(mesh.albedo, flat.albedo);
    let faces = ("elements = [8, 8]", "elements = \"faces\"");
    let fine = MESHED.replace("faces = 450", "faces = 2048");
    let scene = builtin("bench", &[FEW_SPOTS, faces, (RECTANGLE, &fine)]);
    let by_faces = model(&scene);
    assert_eq!(by_faces.g12.nrows(), 2048);
    let truth = converged(
        &builtin("bench", &[FEW_SPOTS]),
        Kernel::Physical,
        Extent::FULL,
    );
    let error = relative(&by_faces.phi(), &truth.unwrap().phi);
    assert!(error < 1e-3, "{error}");
}

/// A plate that reflects on both sides is two plates back to back.
#[test]
fn two_sides_are_two_surfaces() {
    let plate = |name: &str, corners: &str, sides: &str| {
        format!(
            "\n[[surface]]\nname = \"{name}\"\nrole = \"occluder\"\n{corners}\n{sides}material = {{ lambertian = 0.6 }}\n"
        )
    };
    let front = "rectangle = { corner = [5, 7, 1], u = [3, 0, 1], v = [0, 1, 2] }";
    let back = "rectangle = { corner = [5, 7, 1], u = [0, 1, 2], v = [3, 0, 1] }";
    let bench = builtin(
        "bench",
        &[FEW_SPOTS, ("max_bounces = 3", "max_bounces = 4")],
    )
    .text;
    let scene = |more: String| Scene::from_toml("plate", &(bench.clone() + &more)).unwrap();
    let one = scene(plate("plate", front, "sides = \"two\"\n"));
    let two = scene(plate("plate", front, "") + &plate("other", back, ""));
    let half = scene(plate("plate", front, ""));
    let way = Way(Estimator::Shared, Sampling::Sobol, 1, 2048);
    let [one, two, half] = [one, two, half].map(|s| trace(&s, way).flux);
    assert!(relative(&one, &two) < 1e-9, "{}", relative(&one, &two));
    assert!(
        relative(&half, &two) > 1e-3,
        "the back gives nothing: {}",
        relative(&half, &two)
    );
}
