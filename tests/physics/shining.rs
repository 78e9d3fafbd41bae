//! Hidden surfaces that shine, against a closed form and a quadrature of this file's own.

use std::f64::consts::PI;

use phicam::lab::{Against, Certainty, Integration, Measured, Test, validate};
use phicam::matrix::Matrix;
use phicam::model::{Kernel, MatrixModel, Occlusion};
use phicam::num::stream::Sampling;
use phicam::recovery::{Method, Options, Problem, recover};
use phicam::scene::Scene;
use phicam::transport::Estimator::{Factored, Independent, Shared};
use phicam::transport::Traced;

use crate::reference::gauss;
use crate::{Way, assert_same, builtin, compare, relative, trace};

/// ρ3, M, A_lens and the camera's place.
const WALL: f64 = 0.7;
const EXITANCE: f64 = 20.0;
const APERTURE: f64 = 1e-4;
const CAMERA: [f64; 3] = [2.0, 0.3, 1.5];
/// Side of the one pixel's square: what is seen varies by its square.
const SIDE: f64 = 1e-4;

/// One pixel around (x, y) of a wall, and a hidden surface that shines on it.
fn scene([x, y]: [f64; 2], shape: &str, material: &str) -> Scene {
    let ([cx, cy, cz], h) = (CAMERA, 0.5 * SIDE);
    let [x0, x1, y0, y1] = [x - h, x + h, y - h, y + h];
    let text = format!(
        r#"
name = "shining"
unit = "m"
max_bounces = 2
[camera]
position = [{cx}, {cy}, {cz}]
aperture_area = {APERTURE}
view = {{ x = [{x0}, {x1}], y = [{y0}, {y1}] }}
pixels = [1, 1]
[[surface]]
name = "wall"
role = "relay"
rectangle = {{ corner = [-3, -3, 0], u = [6, 0, 0], v = [0, 6, 0] }}
material = {{ lambertian = {WALL} }}
[[surface]]
name = "lamp"
role = "hidden"
elements = [2, 2]
{shape}
material = {{ exitance = {EXITANCE}, {material} }}
"#
    );
    Scene::from_toml("shining", &text).unwrap_or_else(|e| panic!("{e}"))
}

/// Étendue of the pixel, A_lens·cos²θ·A_pixel/d², times f_r of the wall.
fn seen([x, y]: [f64; 2]) -> f64 {
    let d = [x - CAMERA[0], y - CAMERA[1], -CAMERA[2]];
    let d2: f64 = d.iter().map(|c| c * c).sum();
    let cos = CAMERA[2] / d2.sqrt();
    APERTURE * cos * cos * SIDE * SIDE / d2 * WALL / PI
}

/// All estimators and both samplers.
fn ways(samples: u64) -> [Way; 4] {
    [
        Way(Independent, Sampling::Sobol, 3, samples),
        Way(Independent, Sampling::Pcg, 4, samples),
        Way(Shared, Sampling::Sobol, 5, samples),
        Way(Factored, Sampling::Sobol, 6, samples),
    ]
}

/// The irradiance right below the middle of a parallel disc that shines evenly is
/// M·R²/(R² + h²): M times the configuration factor.
#[test]
fn a_disc_shines_by_its_configuration_factor() {
    for (radius, height) in [(0.5f64, 1.0f64), (0.3, 0.4)] {
        let at = [0.2, -0.1];
        let disc = format!(
            "disc = {{ centre = [{}, {}, {height}], normal = [0, 0, -1], radius = {radius} }}",
            at[0], at[1]
        );
        let scene = scene(at, &disc, "shining = 1.0");
        let factor = radius * radius / (radius * radius + height * height);
        let truth = Matrix::from_element(1, 1, seen(at) * EXITANCE * factor);
        for way in ways(1 << 14) {
            let traced = trace(&scene, way);
            let verdict = compare(&traced, &truth, way);
            assert!(verdict.agrees, "{way:?}: {verdict:?}");
            assert!(relative(&traced.flux, &truth) < 0.02, "{way:?}");
            assert_eq!(traced.bounces[0].amax(), 0.0, "the lamp itself is not seen");
        }
        let model = MatrixModel::new(&scene, Kernel::Physical, Some([64, 64])).unwrap();
        let off = relative(&model.phi(), &truth);
        assert!(off < 2e-3, "{off}");
    }
}

/// E = ∫ x M/π cosⁿʰθ_h cosⁿᵛθ_v cosθ cosθ′/R² dA over a rectangle, by Gauss and Legendre. The
/// lamp's normal is −z, u runs along −x and v along y: seen from the lamp the wall point lies at
/// (−dx, dy) along u and v, and −dz along the normal.
#[test]
fn light_falls_off_along_u_and_along_v() {
    let ([width, tall, height], corner) = ([0.6, 0.4, 0.9], [0.3, -0.1]);
    let at = [0.75, 0.45];
    for [nh, nv] in [[0.0f64, 0.0f64], [2.0, 2.0], [1.0, 18.0], [18.0, 1.0]] {
        let rectangle = format!(
            "rectangle = {{ corner = [{}, {}, {height}], u = [-{width}, 0, 0], v = [0, {tall}, 0] }}",
            corner[0], corner[1]
        );
        let picture = "shining = { ramp = [0.2, 0.9] }";
        let scene = scene(
            at,
            &rectangle,
            &format!("falloff = [{nh}, {nv}], {picture}"),
        );
        let mut irradiance = 0.0;
        for (s, ws) in gauss(24) {
            for (t, wt) in gauss(24) {
                let x = 0.2 + 0.7 * s;
                let along = [
                    at[0] - (corner[0] - width * s),
                    at[1] - (corner[1] + tall * t),
                ];
                let r2 = along[0] * along[0] + along[1] * along[1] + height * height;
                let fall = |d: f64, n: f64| (height / (height * height + d * d).sqrt()).powf(n);
                let f = fall(along[0], nh) * fall(along[1], nv);
                let kernel = height * height / (r2 * r2);
                irradiance += ws * wt * width * tall * x * EXITANCE / PI * f * kernel;
            }
        }
        let truth = Matrix::from_element(1, 1, seen(at) * irradiance);
        for way in ways(1 << 13) {
            let traced = trace(&scene, way);
            let verdict = compare(&traced, &truth, way);
            assert!(verdict.agrees, "{nh} {nv} {way:?}: {verdict:?}");
            assert!(relative(&traced.flux, &truth) < 0.02, "{nh} {nv} {way:?}");
        }
        let model = MatrixModel::new(&scene, Kernel::Physical, Some([48, 48])).unwrap();
        let off = relative(&model.phi(), &truth);
        assert!(off < 1e-3, "{nh} {nv}: {off}");
    }
}

/// The built-in scene with few pixels, and other changes.
fn small(changes: &[(&str, &str)]) -> Scene {
    let few = [("pixels = [24, 24]", "pixels = [3, 3]")];
    builtin("screen", &[&few, changes].concat())
}

fn agrees(scene: &Scene, traced: &Traced, way: Way, occlusion: Occlusion) -> bool {
    let test = Test {
        significance: 1e-4,
        known: Certainty::of(&way.plan()),
    };
    let measured = Measured::new(&traced.flux, &traced.stderr, None);
    let (kernel, integration) = (Kernel::Physical, Integration::Quadrature);
    let against = Against {
        kernel,
        integration,
        occlusion,
    };
    validate(scene, measured, against, test)
        .unwrap()
        .agreement
        .agrees
}

/// Past a plate, with a picture and a fall-off; without the plate they must not agree.
#[test]
fn tracer_and_model_agree_past_an_occluder() {
    let scene = replaced(
        &small(&[]).text,
        PICTURE_START,
        "shining = { checkerboard = [2, 2], dark = 0.1, light = 1.0 } }",
    );
    let way = Way(Independent, Sampling::Pcg, 7, 1 << 12);
    let traced = trace(&scene, way);
    assert!(agrees(&scene, &traced, way, Occlusion::Considered));
    assert!(!agrees(&scene, &traced, way, Occlusion::Ignored));
}

/// What the plate reflects is traced with the fourth bounce, by every estimator alike, and does not
/// change the light of two.
#[test]
fn more_bounces_add_to_the_light_of_two() {
    let bright = (
        "material = { lambertian = 0.05 }",
        "material = { lambertian = 0.9 }",
    );
    let deep = small(&[bright, ("max_bounces = 2", "max_bounces = 4")]);
    let two = trace(&small(&[]), Way(Independent, Sampling::Pcg, 1, 1024));
    let each = ways(1024).map(|way| (way, trace(&deep, way)));
    for (way, traced) in &each {
        assert_same(&each[0].1, traced, &format!("{way:?}"));
        let off = relative(&traced.bounces[1], &two.flux);
        assert!(off < 0.05, "{way:?}: {off}");
        // The plate's front looks away from the wall: what it sends there has met the wall before.
        assert_eq!(traced.bounces[2].amax(), 0.0, "{way:?}");
        let by_plate = traced.bounces[3].sum();
        assert!(by_plate > 0.0, "{way:?}: no light by the plate");
    }
}

/// Columns of the elements alone are the transport matrix times their light: they add up to a white
/// picture's, and a picture of 0 and 1 to the sum of those where it is 1.
#[test]
fn columns_of_elements_add_up() {
    let coarse = small(&[("elements = [8, 8]", "elements = [4, 4]")]).text;
    let scene = |shining: &str| replaced(&coarse, PICTURE_START, shining);
    let each = scene("shining = 1.0, light = \"elements\" }");
    let (white, board) = (
        scene("shining = 1.0 }"),
        scene("shining = { checkerboard = [4, 4], dark = 0.0, light = 1.0 } }"),
    );
    let way = Way(Independent, Sampling::Sobol, 2, 1024);
    let (each, white) = (trace(&each, way), trace(&white, way));
    assert_eq!(each.flux.shape(), (9, 16));
    let sum = Traced {
        flux: Matrix::from_fn(9, 1, |p, _| each.flux.row(p).sum()),
        stderr: Matrix::from_fn(9, 1, |p, _| each.stderr.row(p).norm()),
        ..white.clone()
    };
    assert_same(&sum, &white, "sum of elements");
    let picture = trace(&board, way);
    let x = Matrix::from_fn(16, 1, |j, _| f64::from(u8::from((j + j / 4) % 2 == 1)));
    let off = relative(&(&each.flux * x), &picture.flux);
    assert!(off < 0.02, "{off}");
}

/// Where the picture stands in the built-in scene.
const PICTURE_START: &str = "[surface.material]";

/// The text with the monitor's material replaced.
fn replaced(text: &str, from: &str, to: &str) -> Scene {
    let start = text.find(from).unwrap();
    let end = start + text[start..].find("] }").unwrap() + 3;
    let material = format!("material = {{ exitance = 100.0, falloff = [1.0, 2.0], {to}");
    let text = format!("{}{material}{}", &text[..start], &text[end..]);
    Scene::from_toml("screen", &text).unwrap_or_else(|e| panic!("{e}\n{text}"))
}

/// One photograph of traced light, by the traced transport: an L comes back. With the plate gone
/// what is recovered is another picture, for nothing tells the elements apart.
#[test]
fn a_letter_comes_back_from_one_photograph() {
    let letter: [f64; 16] = [
        0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
    ];
    let rows: Vec<String> = letter.chunks(4).map(|row| format!("{row:?}")).collect();
    let picture = format!("shining = {{ cells = [{}] }} }}", rows.join(", "));
    let changes = [
        ("elements = [8, 8]", "elements = [4, 4]"),
        ("pixels = [3, 3]", "pixels = [8, 8]"),
    ];
    let text = small(&changes).text;
    let bare = text.replace("corner = [0.41, 0.26, 0.5]", "corner = [-0.41, 0.26, 0.5]");
    let wrong = |text: &str| {
        let photograph = replaced(text, PICTURE_START, &picture);
        let transport = "shining = 1.0, light = \"elements\" }";
        let transport = replaced(text, PICTURE_START, transport);
        let way = |seed| Way(Shared, Sampling::Sobol, seed, 2048);
        let (photograph, transport) = (trace(&photograph, way(11)), trace(&transport, way(12)));
        let ones = Matrix::from_element(16, 1, 1.0);
        let (phi, stderr) = (&photograph.flux, Some(&photograph.stderr));
        let problem = Problem::new(phi, &transport.flux, &ones, stderr).unwrap();
        let found = recover(Method::JointUnbounded, &problem, &Options::default()).unwrap();
        let off = found
            .reflectance
            .iter()
            .zip(&letter)
            .map(|(x, t)| (x - t).abs());
        off.fold(0.0, f64::max)
    };
    let off = wrong(&text);
    assert!(off < 0.3, "{off}");
    let off = wrong(&bare);
    assert!(off > 0.5, "{off} without the plate");
}
