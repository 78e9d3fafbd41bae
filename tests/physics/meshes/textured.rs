//! Textures and elements of meshes: truth, model, recovery and noise.

use super::*;

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
