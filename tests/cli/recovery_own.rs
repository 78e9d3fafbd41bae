//! `phicam recover` of photographs from elsewhere: matrices of one's own, entries left out, light
//! that is not the surface's.

use phicam::matrix::{Matrix, npy};

use crate::workspace::Workspace;

/// The model of the small scene, by centres.
fn with_model() -> Workspace {
    let workspace = Workspace::with_scenes();
    let _ = workspace.phicam("model small.toml -o done").exits(0);
    workspace
}

/// Matrices given in place of a model's are the model's: the same bytes come back.
#[test]
fn matrices_of_one_s_own_are_inverted_as_a_model_s() {
    let workspace = with_model();
    let phi = "--phi done/model/phi.npy --noise 0.01 --method joint,tsvd,joint-gp";
    let own = "--camera-side done/model/camera_side.npy --laser-side done/model/laser_side.npy";
    let line = format!("recover {own} {phi} --elements 8x8 -o own");
    let _ = workspace.phicam(&line).exits(0);
    let line = format!("recover done {phi} --integration centres -o theirs");
    let _ = workspace.phicam(&line).exits(0);
    for method in ["joint", "tsvd"] {
        let of = |folder: &str| workspace.read(&format!("{folder}/{method}.npy"));
        assert!(of("own") == of("theirs"), "{method}");
    }
    // Their places are not known; those of a grid are alike but for its size.
    let of = |folder: &str| workspace.matrix(&format!("{folder}/joint-gp.npy"));
    let off = (of("own") - of("theirs")).amax();
    assert!(off < 0.05, "{off}");
    assert!(!workspace.path("own/truth.npy").exists());
}

/// A surface that shines is one photograph of C x: a matrix of random numbers gives x back.
#[test]
fn a_surface_that_shines_needs_a_camera_side_alone() {
    let workspace = Workspace::new();
    let c = Matrix::from_fn(40, 6, |p, j| {
        1.0 + libm::sin(0.37 * ((7 * p + 1) * (j + 1)) as f64)
    });
    let x = Matrix::from_column_slice(6, 1, &[0.1, 0.9, 0.4, 0.0, 1.0, 0.6]);
    npy::write(&workspace.path("a.npy"), &c).unwrap();
    npy::write(&workspace.path("phi.npy"), &(&c * &x)).unwrap();
    let line = "recover --camera-side a.npy --phi phi.npy --noise 0.001 --method joint -o out";
    let _ = workspace.phicam(line).exits(0);
    let found = workspace.matrix("out/joint.npy");
    assert!((found - x.transpose()).amax() < 1e-6);
    for (line, words) in [
        ("recover", ["DIR", "required"]),
        ("recover --camera-side a.npy -o o", ["--phi", "required"]),
        (
            "recover --camera-side a.npy --phi phi.npy -o o --elements 5",
            ["6 columns", "5 × 5"],
        ),
        (
            "recover --camera-side a.npy --laser-side a.npy --phi phi.npy -o o",
            ["6 columns", "40 rows"],
        ),
        (
            "recover --camera-side a.npy --phi phi.npy -o o --frame-polynomial 1 --method joint",
            ["--pixels", "--frame-patterns"],
        ),
        (
            "recover --camera-side a.npy --phi phi.npy -o o --method joint-gp",
            ["neighbours", "--elements"],
        ),
        (
            "recover --camera-side a.npy --phi phi.npy -o o --kernel published",
            ["--camera-side", "--kernel"],
        ),
        (
            "recover --camera-side a.npy --phi phi.npy -o o --pixels 3x4",
            ["12 pixels", "has 40"],
        ),
    ] {
        workspace.refuses(line, &words);
    }
}

/// A field of errors that neighbours share is found where it is asked for and the noise is not
/// known, and told in words and numbers; else refused with the reason.
#[test]
fn a_field_of_errors_is_told_and_refused_with_the_reason() {
    let workspace = with_model();
    let model = workspace.matrix("done/model/phi.npy");
    // Waves over the 8 × 8 pixels, and a hash of pixel and spot in place of noise.
    let bright = model.amax();
    let lit = model.map_with_location(|p, l, x| {
        let (u, v) = ((p % 8) as f64, (p / 8) as f64);
        let wave = libm::sin(0.5 * u + l as f64) + libm::sin(0.4 * v + 1.7 * l as f64);
        let hash = ((p * 7919 + l * 104_729) % 997) as f64 / 997.0 - 0.5;
        x + bright * (0.01 * wave + 0.002 * hash)
    });
    npy::write(&workspace.path("lit.npy"), &lit).unwrap();
    let line = "recover done --integration centres --method joint-gp --phi lit.npy --error-field";
    let ended = workspace.phicam(&format!("{line} --json -o field"));
    let found: serde_json::Value = serde_json::from_str(&ended.stdout).unwrap();
    let words = found[0]["parameter"].as_str().unwrap();
    assert!(words.contains("that neighbours share over"), "{words}");
    let choice: serde_json::Value =
        serde_json::from_slice(&workspace.read("field/joint-gp.choice.json")).unwrap();
    let measures = &choice["choice"]["measures"];
    let of = |name: &str| measures[name].as_f64().unwrap() / bright;
    let (pixel, shared) = (
        of("error of a pixel alone"),
        of("error that neighbours share"),
    );
    assert!(
        pixel < 0.003 && (0.003..0.1).contains(&shared),
        "{measures}"
    );
    assert!(measures["pixels over which"].as_f64().unwrap() > 1.0);
    workspace.refuses(
        &format!("{line} --noise 0.01 -o o"),
        &[
            "the noise of the photographs is known",
            "leave out --error-field",
        ],
    );
    workspace.refuses(
        &format!("{line} --frame-gain 0.1 -o o"),
        &["finds no field of errors", "leave out --error-field"],
    );
    workspace.refuses(
        "recover done --method joint --phi lit.npy --error-field -o o",
        &["--error-field", "joint-gp"],
    );
}

/// Entries that are wrong by a thousand times the light do not count where they are left out, and
/// spoil the picture where they are not; a polynomial over each frame is told from the object.
#[test]
fn what_is_not_the_surface_s_light_is_left_out_or_estimated() {
    let workspace = with_model();
    let model = workspace.matrix("done/model/phi.npy");
    let flags = model.map_with_location(|p, l, _| f64::from(u8::from((p * 5 + l * 3) % 13 == 0)));
    let bright = model.amax();
    let spoilt = model.zip_map(&flags, |x, flag| x + 1e3 * bright * flag);
    npy::write(&workspace.path("flags.npy"), &flags).unwrap();
    npy::write(&workspace.path("spoilt.npy"), &spoilt).unwrap();
    let rmse = |more: &str| {
        let line = format!("recover done --integration centres --method joint --json {more}");
        let ended = workspace.phicam(&line);
        let found: serde_json::Value = serde_json::from_str(&ended.stdout).unwrap();
        (ended, found[0]["rmse"].as_f64().unwrap())
    };
    let (ended, found) = rmse("--phi spoilt.npy --left-out flags.npy");
    assert!(found < 1e-3, "{found}");
    assert!(ended.stderr.contains("are left out"), "{}", ended.account());
    assert!(rmse("--phi spoilt.npy").1 > 0.1);
    let holes = model.zip_map(&flags, |x, flag| x / (1.0 - flag));
    npy::write(&workspace.path("holes.npy"), &holes).unwrap();
    let (_, without) = rmse("--phi holes.npy --left-out flags.npy");
    assert!(without < 1e-3, "{without}");
    let exact = flags.zip_map(&model, |flag, x| 0.01 * x * (1.0 - flag));
    npy::write(&workspace.path("exact.npy"), &exact).unwrap();
    let marked = flags.iter().filter(|flag| **flag > 0.0).count();
    let told = format!("{marked} of {} entries hold light", flags.len());
    let (ended, _) = rmse("--phi done/model/phi.npy --stderr exact.npy");
    assert!(ended.stderr.contains(&told), "{}", ended.account());
    let (ended, _) = rmse("--phi done/model/phi.npy --stderr exact.npy --left-out flags.npy");
    assert!(!ended.stderr.contains("hold light"), "{}", ended.account());

    // Pixel p of the 8 × 8 is column p % 8: x² and y, different in each frame.
    let lit = model.map_with_location(|p, l, x| {
        let (u, v) = ((p % 8) as f64, (p / 8) as f64);
        x + bright * (1.0 + l as f64) * (3.0 + u * u - 2.0 * v)
    });
    npy::write(&workspace.path("lit.npy"), &lit).unwrap();
    let (ended, found) = rmse("--phi lit.npy --frame-polynomial 2");
    assert!(found < 1e-3, "{found}: {}", ended.account());
    assert!(rmse("--phi lit.npy --frame-polynomial 1").1 > 0.1);
    let strengths = workspace.path("done").join("recovered-lit");
    let folder = workspace.contents("done").into_keys();
    let written = folder.filter(|name| name.ends_with("joint.frame_patterns.npy"));
    assert!(written.count() > 0, "{}", strengths.display());
    // The same from a file of patterns.
    let patterns = Matrix::from_fn(64, 4, |p, k| {
        let (u, v) = ((p % 8) as f64, (p / 8) as f64);
        [1.0, u, u * u, v][k]
    });
    npy::write(&workspace.path("patterns.npy"), &patterns).unwrap();
    assert!(rmse("--phi lit.npy --frame-patterns patterns.npy").1 < 1e-3);
    workspace.refuses(
        "recover done --phi lit.npy --frame-patterns flags.npy --method pinv",
        &["--frame-patterns", "joint"],
    );
    // As many patterns as pixels can be any photograph.
    npy::write(&workspace.path("any.npy"), &Matrix::identity(64, 64)).unwrap();
    workspace.refuses(
        "recover done --phi lit.npy --frame-patterns any.npy --method joint",
        &["other light of this form could be all of the model's light"],
    );
    npy::write(&workspace.path("dark.npy"), &model.map(|_| 0.0)).unwrap();
    for option in ["--frame-patterns", "--glare-pattern"] {
        workspace.refuses(
            &format!("recover done --phi lit.npy {option} dark.npy --method joint"),
            &["dark.npy is 0 everywhere"],
        );
    }
    workspace.refuses(
        "recover done --phi lit.npy --left-out patterns.npy --method joint",
        &["64 × 4", "pixels"],
    );
    workspace.refuses(
        "recover done --phi lit.npy --frame-polynomial 9",
        &["0..=8"],
    );
    npy::write(&workspace.path("all.npy"), &model.map(|_| 1.0)).unwrap();
    workspace.refuses(
        "recover done --phi lit.npy --left-out all.npy --method joint",
        &["every entry of phi is left out"],
    );
}

/// A mask of NumPy's truths or integers is the mask of the same entries as numbers.
#[test]
fn a_mask_may_hold_truths_or_integers() {
    let workspace = with_model();
    let model = workspace.matrix("done/model/phi.npy");
    let (pixels, spots) = model.shape();
    let is_left_out = |p: usize, l: usize| (5 * p + 3 * l).is_multiple_of(11);
    let spoilt = Matrix::from_fn(pixels, spots, |p, l| {
        model[(p, l)] * if is_left_out(p, l) { 1000.0 } else { 1.0 }
    });
    npy::write(&workspace.path("spoilt.npy"), &spoilt).unwrap();
    let flags = Matrix::from_fn(pixels, spots, |p, l| f64::from(is_left_out(p, l)));
    npy::write(&workspace.path("f8.npy"), &flags).unwrap();
    let write = |name: &str, of: &str, shape: &str, entry: &dyn Fn(bool) -> Vec<u8>| {
        let head = format!("{{'descr': '{of}', 'fortran_order': False, 'shape': ({shape}), }}\n");
        let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
        bytes.extend((head.len() as u16).to_le_bytes());
        bytes.extend(head.bytes());
        let places = (0..pixels).flat_map(|p| (0..spots).map(move |l| (p, l)));
        bytes.extend(places.flat_map(|(p, l)| entry(is_left_out(p, l))));
        workspace.write(name, bytes);
    };
    let shape = format!("{pixels}, {spots}");
    write("truths.npy", "|b1", &shape, &|is| vec![u8::from(is)]);
    write("integers.npy", ">i2", &shape, &|is| {
        (if is { -7i16 } else { 0 }).to_be_bytes().to_vec()
    });
    let line = |mask: &str| {
        format!(
            "recover done --phi spoilt.npy --noise 0.01 --method joint --left-out {mask}.npy -o {mask}"
        )
    };
    for mask in ["f8", "truths", "integers"] {
        let _ = workspace.phicam(&line(mask)).exits(0);
    }
    for mask in ["truths", "integers"] {
        let of = |mask: &str| workspace.read(&format!("{mask}/joint.npy"));
        assert!(of(mask) == of("f8"), "{mask}");
    }
    let cube = format!("2, {}, {spots}", pixels / 2);
    write("cube.npy", "|b1", &cube, &|is| vec![u8::from(is)]);
    workspace.refuses(&line("cube"), &["has the shape [2,", "cure: "]);
    let turned = format!("{spots}, {pixels}");
    write("turned.npy", "|b1", &turned, &|is| vec![u8::from(is)]);
    workspace.refuses(&line("turned"), &["24 × 64", "64 pixels"]);
}
