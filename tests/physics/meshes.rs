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

const RECTANGLE: &str = "rectangle = { corner = [3, 11.350951966438567, 4.149048033561433], \
    u = [4, 0, 0], v = [0, -2.82842712474619, 2.82842712474619] }";
/// The same: the unit square four times as large, leant over by 135° and moved; stretched by a
/// hair, so that the mesh itself is.
const MESHED: &str = "mesh = { generate = \"rectangle\", faces = 450, scale = [4, 4.000000000001, 1], \
    rotate = [{ axis = [1, 0, 0], angle = 135 }], translate = [3, 11.350951966438567, 4.149048033561433] }";
const FEW_SPOTS: (&str, &str) = ("per_side = 30", "per_side = 3");

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

/// The board's rectangle as the unit square of triangles, exactly.
fn meshed(faces: u32) -> String {
    format!(
        "mesh = {{ generate = \"rectangle\", faces = {faces}, scale = 4, \
         rotate = [{{ axis = [1, 0, 0], angle = 135 }}], \
         translate = [3, 11.350951966438567, 4.149048033561433] }}"
    )
}

/// How much of [a, b] lies in cell k of n, over its length.
fn overlap([a, b]: [f64; 2], k: usize, n: usize) -> f64 {
    let [low, high] = [k, k + 1].map(|k| k as f64 / n as f64);
    (b.min(high) - a.max(low)).max(0.0) / (b - a)
}

/// Mean albedo over a rectangle of parameters.
type Mean = fn(&Texture, [f64; 2], [f64; 2]) -> f64;

/// Textures whose means are written down here: every third column white, checks that no element
/// respects, a ramp, and a picture between the centres of its texels.
const TEXTURES: [(&str, Mean); 4] = [
    ("{ cells = [[0, 0, 1, 0, 0, 1, 0, 0, 1]] }", |_, u, _| {
        [2, 5, 8].iter().map(|k| overlap(u, *k, 9)).sum()
    }),
    (
        "{ checkerboard = [3, 5], dark = 0.1, light = 0.9 }",
        |_, u, v| {
            let share = |odd: usize| -> f64 {
                let of = |x, n: usize, odd| -> f64 {
                    (0..n)
                        .filter(|k| k % 2 == odd)
                        .map(|k| overlap(x, k, n))
                        .sum()
                };
                (0..2).map(|i| of(u, 3, i) * of(v, 5, (i + odd) % 2)).sum()
            };
            0.1 * share(0) + 0.9 * share(1)
        },
    ),
    ("{ ramp = [0.2, 0.9] }", |_, [a, b], _| {
        0.2 + 0.7 * 0.5 * (a + b)
    }),
    // 12 × 12 half-texels, in each of which the mean is the value in the middle.
    (
        "{ target = \"letters\", size = [6, 6], filter = \"bilinear\" }",
        |t, [a, b], [c, d]| {
            let at = |[a, b]: [f64; 2], k: usize| a + (b - a) * (k as f64 + 0.5) / 3.0;
            let points = (0..9).map(|k| t.albedo([at([a, b], k % 3), at([c, d], k / 3)]));
            points.sum::<f64>() / 9.0
        },
    ),
];

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

/// The condition number of Σ_j C\[p,j\] ρ_j D\[j,l\] as a function of ρ: its Gram matrix is
/// (CᵀC) ∘ (D Dᵀ).
fn condition(model: &MatrixModel) -> f64 {
    let (c, d) = (&model.camera_side, &model.laser_side);
    let gram = (c.transpose() * c).component_mul(&(d * d.transpose()));
    let sigma = phicam::num::linalg::svd(&gram).unwrap().sigma;
    (sigma[0] / sigma[sigma.len() - 1]).sqrt()
}

/// Truth, model and recovery of a mesh of the rectangle are the rectangle's, whatever texture the
/// elements straddle, and the truth is the mean albedo: to 1e-12 where the corners are read from a
/// file. Where they are computed in another order, and rounded otherwise, the recovery differs by
/// that rounding times the condition number κ of the inversion, and by no more than 10·ε·κ.
#[test]
fn a_mesh_of_the_rectangle_has_its_truth_model_and_recovery() {
    let board = DVec3::new(3.0, 11.350951966438567, 4.149048033561433);
    let (along, up) = (
        4.0 * DVec3::X,
        DVec3::new(0.0, -2.82842712474619, 2.82842712474619),
    );
    // The board's sides a little shorter: sums of corner and sides are exact.
    let exact = DVec3::new(3.0, 11.375, 4.125);
    let exact = written(exact, along, DVec3::new(0.0, -2.75, 2.75));
    let rounded = written(board, along, up);
    for (texture, mean) in TEXTURES {
        let scene = |shape: &str, obj: &str| {
            let text = changed(&[
                ("per_side = 30", "per_side = 12"),
                ("elements = [8, 8]", "elements = [4, 4]"),
                (CHECKS, texture),
                (RECTANGLE, shape),
            ]);
            beside("board.obj", obj, &text).unwrap()
        };
        let model = |shape: &str, obj: &str| {
            MatrixModel::new(&scene(shape, obj), Kernel::Physical, None).unwrap()
        };
        let side = |i: usize| [i as f64 / 4.0, (i + 1) as f64 / 4.0];
        let painted = scene(RECTANGLE, "");
        let albedo = &painted.hidden().next().unwrap().1.albedo;
        let truth = (0..16).map(|j| mean(albedo, side(j % 4), side(j / 4)));
        let truth: Vec<f64> = truth.collect();
        let apart = |a: &[f64], b: &[f64]| {
            let each = a.iter().zip(b).map(|(a, b)| (a - b).abs());
            each.fold(0.0, f64::max)
        };
        let read = "mesh = { file = \"board.obj\" }";
        let (two, many) = (meshed(2), meshed(450));
        for (name, rectangle, mesh, obj) in [
            ("exact corners", &*exact.0, read, &*exact.1),
            ("rounded corners", &*rounded.0, read, &*rounded.1),
            ("2 faces, turned", RECTANGLE, &*two, ""),
            ("450 faces, turned", RECTANGLE, &*many, ""),
        ] {
            let (flat, mesh) = (model(rectangle, ""), model(mesh, obj));
            let photographs = flat.phi();
            let recovered = |model: &MatrixModel| {
                let sides = (&model.camera_side, &model.laser_side);
                let problem = Problem::new(&photographs, sides.0, sides.1, None).unwrap();
                let found = recover(Method::Joint, &problem, &Options::default()).unwrap();
                found.reflectance.as_slice().to_vec()
            };
            let of_truth = apart(&flat.albedo, &truth).max(apart(&mesh.albedo, &truth));
            let of_model = relative(&mesh.phi(), &flat.phi());
            let of_recovery = apart(&recovered(&mesh), &recovered(&flat));
            let kappa = condition(&flat);
            println!(
                "{texture}, {name}: truth {of_truth:.1e}, model {of_model:.1e}, recovery {of_recovery:.1e}, κ {kappa:.1e}"
            );
            assert!(of_truth < 1e-12, "{texture}, {name}: truth {of_truth:e}");
            assert!(of_model < 1e-12, "{texture}, {name}: model {of_model:e}");
            let limit = match name {
                "exact corners" | "rounded corners" => 1e-12,
                _ => 10.0 * f64::EPSILON * kappa,
            };
            assert!(
                of_recovery < limit,
                "{texture}, {name}: recovery {of_recovery:e}, limit {limit:e}"
            );
        }
    }
}

/// The mean albedo of a triangle that is an element is that over all of it.
#[test]
fn a_face_has_its_mean_albedo() {
    let faces = |texture: &str| {
        let changes = [
            FEW_SPOTS,
            ("elements = [8, 8]", "elements = \"faces\""),
            (
                "{ checkerboard = [2, 2], dark = 0.0, light = 1.0 }",
                texture,
            ),
            (RECTANGLE, &*meshed(2)),
        ];
        let scene = builtin("bench", &changes);
        MatrixModel::new(&scene, Kernel::Physical, None)
            .unwrap()
            .albedo
    };
    // Right of x the lower triangle (v < u) has 1 − x² of its area, the upper (1 − x)².
    let halves = faces("{ cells = [[0, 0, 1]] }");
    let x = 2.0 / 3.0;
    for (found, share) in halves.iter().zip([1.0 - x * x, (1.0 - x) * (1.0 - x)]) {
        assert!((found - share).abs() < 1e-14, "{found}, {share}");
    }
    let ramp = faces("{ ramp = [0.0, 0.9] }");
    for (found, mean) in ramp.iter().zip([0.6, 0.3]) {
        assert!((found - mean).abs() < 1e-14, "{found}, {mean}");
    }
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

/// A scene file and a mesh beside it.
fn beside(name: &str, mesh: &str, text: &str) -> Result<Scene, String> {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join(name), mesh).unwrap();
    let path = dir.path().join("scene.toml");
    std::fs::write(&path, text).unwrap();
    Scene::load(&path.to_string_lossy()).map_err(|e| e.to_string())
}

/// The board of the bench as a quadrilateral of an OBJ file whose coordinates go from `low` to
/// `high`, with a texture and elements.
fn board(low: [f64; 2], high: [f64; 2], texture: &str, elements: &str) -> Result<Scene, String> {
    let uv = [
        [low[0], low[1]],
        [high[0], low[1]],
        [high[0], high[1]],
        [low[0], high[1]],
    ];
    let uv: String = uv.iter().map(|[u, v]| format!("vt {u} {v}\n")).collect();
    let square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
    let mesh = meshed(2).replace(
        "generate = \"rectangle\", faces = 2",
        "file = \"board.obj\"",
    );
    let text = changed(&[
        FEW_SPOTS,
        (RECTANGLE, &mesh),
        (CHECKS, texture),
        ("elements = [8, 8]", elements),
    ]);
    beside(
        "board.obj",
        &format!("{square}{uv}f 1/1 2/2 3/3 4/4\n"),
        &text,
    )
}

/// Coordinates that go on beyond 1: elements are taken where the texture is. Shifted by a quarter
/// of a repeated picture the elements are the rectangle's in another order; over several tiles they
/// would lie in several places, and are refused; by faces the light is that of the rectangle with
/// the tiles painted out.
#[test]
fn coordinates_over_several_tiles() {
    let letters = "{ target = \"letters\", size = [24, 24], wrap = \"repeat\" }";
    let model = |scene: &Scene| MatrixModel::new(scene, Kernel::Physical, None).unwrap();
    let shifted = board([0.25, 0.0], [1.25, 1.0], letters, "elements = [4, 4]").unwrap();
    let plain = board([0.0, 0.0], [1.0, 1.0], letters, "elements = [4, 4]").unwrap();
    let (shifted, plain) = (model(&shifted), model(&plain));
    for j in 0..16 {
        // Cell u of the picture is a quarter further left on the board.
        let place = (j % 4 + 3) % 4 + j / 4 * 4;
        assert!((shifted.albedo[j] - plain.albedo[j]).abs() < 1e-12);
        let apart = (shifted.g12.row(j) - plain.g12.row(place)).norm();
        assert!(
            apart < 1e-12 * plain.g12.row(place).norm(),
            "element {j}: {apart:e}"
        );
    }
    let checks = "{ target = \"letters\", size = [4, 4], wrap = \"repeat\", dark = 0.1 }";
    let error = board([0.0; 2], [3.0; 2], checks, "elements = [12, 12]").unwrap_err();
    assert!(
        error.contains("lie in several places") && error.contains("faces"),
        "{error}"
    );
    assert!(error.contains("u = 0 to 3"), "{error}");
    let tiled = board([0.0; 2], [3.0; 2], checks, "elements = \"faces\"").unwrap();
    let one = board([0.0; 2], [1.0; 2], checks, "elements = \"faces\"").unwrap();
    let albedo = &one.hidden().next().unwrap().1.albedo;
    let texel = |i: usize, j: usize| {
        let at = [i % 4, j % 4].map(|k| (k as f64 + 0.5) / 4.0);
        albedo.albedo(at).to_string()
    };
    let row = |j: usize| {
        let row: Vec<String> = (0..12).map(|i| texel(i, j)).collect();
        format!("[{}]", row.join(", "))
    };
    let rows: Vec<String> = (0..12).map(row).collect();
    let painted = format!("{{ cells = [{}] }}", rows.join(", "));
    let flat = builtin(
        "bench",
        &[
            FEW_SPOTS,
            (
                "{ checkerboard = [2, 2], dark = 0.0, light = 1.0 }",
                &painted,
            ),
        ],
    );
    let phi = |scene: &Scene| converged(scene, Kernel::Physical, Extent::FULL).unwrap();
    let (tiled, flat) = (phi(&tiled), phi(&flat));
    let error = relative(&tiled.phi, &flat.phi);
    assert!(error < 1e-9, "{error:e}");
    // Held to the border, what lies beyond 1 belongs to the last cells, as its albedo does.
    let held = "{ cells = [[0.1, 0.2, 0.4, 0.8]] }";
    let held = board([0.0, 0.0], [2.0, 1.0], held, "elements = [4, 1]").unwrap();
    let held = held.hidden().next().unwrap().1.divided([4, 1]);
    for (element, (share, albedo)) in
        held.iter()
            .zip([(1.0, 0.1), (1.0, 0.2), (1.0, 0.4), (5.0, 0.8)])
    {
        assert!(
            (element.area - 2.0 * share).abs() < 1e-12,
            "{}",
            element.area
        );
        assert!((element.albedo - albedo).abs() < 1e-15);
    }
}

/// An M-shaped face in the board's place, its corners counted from each in turn: its light is that
/// of a quadrature over the M, for the model and for the tracer.
#[test]
fn a_concave_face_has_its_light_whatever_its_first_corner() {
    let corners = [[0, 0], [1, 0], [2, 2], [3, 0], [4, 0], [4, 4], [0, 4]];
    let vertices = corners.map(|[x, y]| format!("v {x} {y} 0\n")).concat();
    let mesh = meshed(2).replace(
        "generate = \"rectangle\", faces = 2, scale = 4",
        "file = \"m.obj\"",
    );
    let text = changed(&[
        FEW_SPOTS,
        ("pixels = [16, 16]", "pixels = [3, 3]"),
        (RECTANGLE, &mesh),
        (CHECKS, "0.7"),
        ("elements = [8, 8]", "elements = \"faces\""),
    ]);
    // Below 2 there is a wedge between 1 + ½y and 3 − ½y.
    let mut points = Vec::new();
    let mut strip = |[low, high]: [f64; 2], range: &dyn Fn(f64) -> [f64; 2]| {
        for (b, wb) in gauss(12) {
            let y = low + b * (high - low);
            let [from, to] = range(y);
            for (a, wa) in gauss(12) {
                let weight = wa * wb * (to - from) * (high - low);
                points.push(([from + a * (to - from), y], 0.7 * weight));
            }
        }
    };
    strip([0.0, 2.0], &|y| [0.0, 1.0 + 0.5 * y]);
    strip([0.0, 2.0], &|y| [3.0 - 0.5 * y, 4.0]);
    strip([2.0, 4.0], &|_| [0.0, 4.0]);
    for first in 0..7 {
        let list: Vec<String> = (0..7).map(|k| ((first + k) % 7 + 1).to_string()).collect();
        let obj = format!("{vertices}f {}\n", list.join(" "));
        let scene = beside("m.obj", &obj, &text).unwrap();
        let bench = Bench {
            pixels: [3, 3],
            spots: (scene.laser.spots.iter())
                .map(|s| s.target.position.truncate().to_array())
                .collect(),
            ..Bench::new(3.0, 2)
        };
        let truth = matrix(&bench.phi_of(&points, 4));
        let own = converged(&scene, Kernel::Physical, Extent::FULL).unwrap();
        let error = relative(&own.phi, &truth);
        assert!(error < 1e-6, "from corner {first}: model {error:e}");
        let way = Way(Estimator::Factored, Sampling::Sobol, 1, 8192);
        let traced = trace(&scene, way);
        let verdict = compare(&traced, &truth, way);
        assert!(verdict.agrees, "from corner {first}: {verdict:?}");
        let error = (traced.flux.sum() / truth.sum() - 1.0).abs();
        println!(
            "from corner {first}: {:.4e} W, quadrature {:.4e} W",
            traced.flux.sum(),
            truth.sum()
        );
        assert!(error < 1e-3, "from corner {first}: tracer {error:e}");
    }
}

/// A board that shows its back to all spots and all of the view is told, as a rectangle or as a
/// mesh; where its front is seen by the camera, the cure is one that a mesh has.
#[test]
fn a_mesh_with_its_back_to_everything_is_told() {
    let rectangle = "rectangle = { corner = [9.5, 9, 1], u = [0, 4, 0], v = [0, 0, 4] }";
    let mesh = "mesh = { generate = \"rectangle\", faces = 8, scale = 4, \
        rotate = [{ axis = [1, 1, 1], angle = 120 }], translate = [9.5, 9, 1]";
    let with = |shape: &str| {
        let text = Scene::load("bench").unwrap().text;
        Scene::from_toml("turned", &text.replacen(RECTANGLE, shape, 1))
    };
    let warnings = |shape: &str| with(shape).unwrap().warnings();
    let (flat, meshed) = (warnings(rectangle), warnings(&format!("{mesh} }}")));
    assert_eq!(flat, meshed);
    assert!(
        matches!(&flat[..], [Warning::SpotsBehind(spots, _), Warning::ViewBehind(_)] if spots.len() == 120),
        "{flat:?}"
    );
    let error = with(&format!("{mesh}, flip = true }}"))
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("camera sees the front") && error.contains("`flip = true`"),
        "{error}"
    );
    assert!(!error.contains("u × v"), "{error}");
}

/// The board wound the wrong way round and flipped is the board.
#[test]
fn a_flipped_mesh_is_the_mesh_wound_the_other_way() {
    let turned = meshed(8).replace("angle = 135", "angle = -45");
    let turned = turned.replace(
        "translate = [3, 11.350951966438567, 4.149048033561433]",
        "translate = [3, 8.522524841692377, 6.977475158307623], flip = true",
    );
    let grey = ("{ checkerboard = [2, 2], dark = 0.0, light = 1.0 }", "0.5");
    let phi = |shape: &str| {
        let scene = builtin("bench", &[FEW_SPOTS, grey, (RECTANGLE, shape)]);
        let model = MatrixModel::new(&scene, Kernel::Physical, None).unwrap();
        let traced = trace(&scene, Way(Estimator::Shared, Sampling::Sobol, 1, 1024));
        (model.phi(), traced.flux.sum())
    };
    let (found, expected) = (phi(&turned), phi(RECTANGLE));
    assert!(relative(&found.0, &expected.0) < 1e-12);
    assert!(
        (found.1 / expected.1 - 1.0).abs() < 1e-2,
        "{} {}",
        found.1,
        expected.1
    );
}

/// A closed ball that reflects inwards only is dark: its shell stands in the way, for the model
/// too.
#[test]
fn a_ball_turned_inside_out_is_dark() {
    let ball = |flip: bool| {
        let ball = format!(
            "mesh = {{ generate = \"sphere\", faces = 40, scale = 1.2, translate = [9, 9, 3], flip = {flip} }}"
        );
        let text = Scene::load("bench").unwrap().text;
        let few = ("pixels = [16, 16]", "pixels = [4, 4]");
        let changes = [
            FEW_SPOTS,
            few,
            ("elements = [8, 8]", "elements = \"faces\""),
            (RECTANGLE, &ball),
        ];
        let text = changes
            .iter()
            .fold(text, |text, (old, new)| text.replacen(old, new, 1));
        let plate = "\n[[surface]]\nname = \"plate\"\nrole = \"occluder\"\n\
            material = { lambertian = 0.0 }\n\
            rectangle = { corner = [2, 5, 4], u = [0, 8, 0], v = [0, 0, 4.5] }\n";
        let scene = Scene::from_toml("ball", &(text + plate)).unwrap_or_else(|e| panic!("{e}"));
        let model = MatrixModel::new(&scene, Kernel::Physical, None).unwrap();
        let traced = trace(&scene, Way(Estimator::Shared, Sampling::Sobol, 1, 256));
        [model.phi().sum(), traced.flux.sum()]
    };
    let (lit, dark) = (ball(false), ball(true));
    assert!(
        lit[0] > 0.0 && (lit[1] / lit[0] - 1.0).abs() < 0.1,
        "{lit:?}"
    );
    assert!(
        dark[1] == 0.0 && dark[0] < 1e-3 * lit[0],
        "{dark:?}, {lit:?}"
    );
}

/// Points are stratified by the texture's cells on a mesh as on the rectangle: at equal points the
/// standard errors are within a factor of two.
#[test]
#[ignore = "slow"]
fn a_mesh_of_the_rectangle_has_its_noise() {
    // The corners as a program writes them that rounds to six digits, one of them badly.
    let rounded = "v 3 11.350952 4.149048\nv 7 11.350952 4.149048\nv 7 8.522524 6.977475\n\
        v 3 8.522525 6.977476\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n";
    let mut worst: f64 = 0.0;
    for n in [[8, 8], [3, 5]] {
        let checks = format!("checkerboard = {n:?}");
        let few = ("pixels = [16, 16]", "pixels = [4, 4]");
        let text = |shape: &str| {
            let changes = [
                FEW_SPOTS,
                few,
                ("checkerboard = [2, 2]", &*checks),
                (RECTANGLE, shape),
            ];
            let text = Scene::load("bench").unwrap().text;
            changes
                .iter()
                .fold(text, |text, (old, new)| text.replacen(old, new, 1))
        };
        let made = |shape: &str| Scene::from_toml("made", &text(shape)).unwrap();
        let read = text("mesh = { file = \"board.obj\" }");
        let read = beside("board.obj", rounded, &read).unwrap();
        let (flat, meshes) = (
            made(RECTANGLE),
            [made(&meshed(2)), made(&meshed(450)), read],
        );
        for (estimator, samples) in [(Estimator::Shared, 2048), (Estimator::Factored, 8192)] {
            for sampling in [Sampling::Sobol, Sampling::Pcg] {
                let noise = |scene| {
                    let traced = trace(scene, Way(estimator, sampling, 3, samples));
                    traced.stderr.norm() / traced.flux.norm()
                };
                let flat = noise(&flat);
                let ratios: Vec<f64> = meshes.iter().map(|mesh| noise(mesh) / flat).collect();
                println!("{n:?} {estimator:?} {sampling:?}: {flat:.1e}, times {ratios:.3?}");
                worst = ratios.into_iter().fold(worst, f64::max);
            }
        }
    }
    assert!(worst < 2.0, "{worst}");
}

/// A ball of few and one of many faces, hidden from the camera by a plate, in a texture whose edges
/// no face respects: the quadrature over area and normals says how far it can be trusted, which is
/// less than 1e-4, and the tracer agrees within that. Errors of `independent` are independent
/// between entries, so that the mean of the ratios of traced to modelled flux has a standard error
/// below 4e-5. The weights of that mean are equal: by standard errors that were estimated with the
/// flux itself they would favour entries that came out low.
#[test]
#[ignore = "slow"]
fn a_textured_sphere_is_integrated_within_its_bound() {
    let plate = "\n[[surface]]\nname = \"plate\"\nrole = \"occluder\"\nmaterial = { lambertian = 0.0 }\n\
        rectangle = { corner = [2, 5, 4], u = [0, 8, 0], v = [0, 0, 4.5] }\n";
    for faces in [320, 300_000] {
        for side in [8, 32] {
            let ball = format!(
                "mesh = {{ generate = \"sphere\", faces = {faces}, scale = 1.2, translate = [9, 9, 3] }}"
            );
            let checks = format!("{{ checkerboard = [{side}, {side}], dark = 0.1, light = 0.9 }}");
            let text = changed(&[
                ("layout = \"square\"", "layout = \"grid\""),
                ("per_side = 30", "per_side = 2"),
                ("stagger = [-1.0, 1.0, 0.0]", ""),
                ("pixels = [16, 16]", "pixels = [2, 2]"),
                (CHECKS, &checks),
                ("elements = [8, 8]", &format!("elements = [{side}, {side}]")),
                (RECTANGLE, &ball),
            ]);
            let scene = Scene::from_toml("ball", &(text + plate)).unwrap_or_else(|e| panic!("{e}"));
            let start = std::time::Instant::now();
            let found = converged(&scene, Kernel::Physical, Extent::FULL).unwrap();
            let (_, bound) = found.worst().unwrap();
            let modelled = start.elapsed().as_secs_f64();
            let way = Way(Estimator::Independent, Sampling::Sobol, 1, 1 << 19);
            let traced = trace(&scene, way);
            let took = start.elapsed().as_secs_f64() - modelled;
            let count = found.phi.len() as f64;
            let apart = traced.flux.component_div(&found.phi).sum() / count - 1.0;
            let sigma = traced.stderr.component_div(&found.phi).norm() / count;
            let verdict = compare(&traced, &found.phi, way);
            println!(
                "{faces} faces, {side} × {side}: bound {bound:.1e} ({modelled:.1} s), apart {apart:.1e}, σ {sigma:.1e} ({took:.1} s), {verdict:?}"
            );
            assert!(bound < 1e-4, "{faces} faces, {side}: bound {bound:e}");
            assert!(sigma < 4e-5, "{faces} faces, {side}: σ {sigma:e}");
            assert!(
                apart.abs() < bound + 4.0 * sigma,
                "{faces} faces, {side}: {apart:e}, σ {sigma:e}"
            );
            assert!(verdict.agrees, "{faces} faces, {side}: {verdict:?}");
        }
    }
}
