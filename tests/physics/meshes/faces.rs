//! Faces of meshes: their coordinates, corners and sides.

use super::*;

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
