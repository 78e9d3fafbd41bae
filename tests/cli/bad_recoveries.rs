//! Photographs and noise models from which nothing can be recovered: said by each method, with
//! cause and cure, and nothing written.

use phicam::matrix::{Matrix, npy};
use phicam::recovery::Method;

use crate::small_scene::{TINY, altered};
use crate::workspace::Workspace;

/// A folder `bench` with a scene of 6 pixels and 8 spots alone, as for measured photographs.
fn measured() -> Workspace {
    with_scene(&altered(&TINY))
}

fn with_scene(text: &str) -> Workspace {
    let workspace = Workspace::new();
    std::fs::create_dir(workspace.path("bench")).unwrap();
    workspace.write("bench/scene.toml", text);
    workspace
}

/// Writes a matrix with one entry changed.
fn write(workspace: &Workspace, name: &str, rows: usize, value: f64, at: (usize, usize, f64)) {
    let mut matrix = Matrix::from_element(rows, 8, value);
    matrix[(at.0, at.1)] = at.2;
    npy::write(&workspace.path(name), &matrix).unwrap();
}

/// `recover bench --phi phi.npy` with each method is refused.
fn every_method_refuses(workspace: &Workspace, more: &str, words: &[&str]) {
    for method in Method::ALL {
        let line = format!("recover bench --phi phi.npy --method {method} --elements 2 {more}");
        workspace.refuses(&line, words);
    }
    workspace.refuses(&format!("recover bench --phi phi.npy {more}"), words);
}

#[test]
fn entries_that_are_no_numbers() {
    for (value, name) in [(f64::NAN, "NaN"), (f64::INFINITY, "inf")] {
        let workspace = measured();
        write(&workspace, "phi.npy", 6, 1e-12, (4, 7, value));
        every_method_refuses(&workspace, "", &["phi.npy", name, "4", "7"]);
        write(&workspace, "phi.npy", 6, 1e-12, (0, 0, 1e-12));
        write(&workspace, "errors.npy", 6, 1e-14, (1, 2, value));
        every_method_refuses(&workspace, "--stderr errors.npy", &["errors.npy", name]);
    }
}

#[test]
fn another_shape() {
    let workspace = measured();
    write(&workspace, "phi.npy", 5, 1e-12, (0, 0, 1e-12));
    every_method_refuses(&workspace, "", &["phi.npy", "5 × 8", "6 pixels", "8 spots"]);
    write(&workspace, "phi.npy", 6, 1e-12, (0, 0, 1e-12));
    write(&workspace, "errors.npy", 7, 1e-14, (0, 0, 1e-14));
    let words = ["errors.npy", "7 × 8", "6 pixels", "cure: "];
    every_method_refuses(&workspace, "--stderr errors.npy", &words);
}

#[test]
fn negative_standard_errors() {
    let workspace = measured();
    write(&workspace, "phi.npy", 6, 1e-12, (0, 0, 1e-12));
    write(&workspace, "errors.npy", 6, 1e-14, (3, 5, -1e-20));
    let words = ["errors.npy", "negative", "pixel 3, spot 5", "cure: "];
    every_method_refuses(&workspace, "--stderr errors.npy", &words);
}

#[test]
fn no_noise_where_noise_is_asked_for() {
    let workspace = measured();
    write(&workspace, "phi.npy", 6, 1e-12, (0, 0, 2e-12));
    write(&workspace, "errors.npy", 6, 0.0, (0, 0, 0.0));
    for method in ["tsvd", "tikhonov", "tikhonov-gradient"] {
        let line = format!("recover bench --phi phi.npy --stderr errors.npy --method {method}");
        let words = [method, "every standard error is zero", "give", "gcv"];
        workspace.refuses(&line, &words);
    }
}

/// What a render says of its standard errors is told where it stands beside them.
#[test]
fn errors_that_are_not_to_be_trusted_are_told() {
    let workspace = measured();
    write(&workspace, "phi.npy", 6, 1e-12, (0, 0, 2e-12));
    write(&workspace, "phi.stderr.npy", 6, 1e-14, (0, 0, 1e-14));
    write(&workspace, "phi.tails.npy", 6, 0.0, (1, 2, 1.0));
    let line = "recover bench --phi phi.npy --stderr phi.stderr.npy --elements 2 --method joint";
    let words = "of 1 of 48 entries the standard error is not to be trusted, says phi.tails.npy";
    let told = |more: &str| {
        workspace
            .phicam(&format!("{line} {more}"))
            .stderr
            .contains(words)
    };
    assert!(told(""));
    assert!(!told("--left-out phi.tails.npy"));
}

/// `validate` refuses light whose standard error is 0, of which every model is infinitely far off.
#[test]
fn light_without_an_error_is_not_validated() {
    let workspace = measured();
    write(&workspace, "phi.npy", 6, 1e-12, (0, 0, 2e-12));
    write(&workspace, "errors.npy", 6, 1e-14, (1, 2, 0.0));
    let line = "validate --phi phi.npy --stderr errors.npy --against bench/scene.toml";
    workspace.refuses(
        line,
        &["1 of 48 entries", "standard error of 0", "--left-out"],
    );
}

/// `joint-tv` has no other rule: none is offered.
#[test]
fn a_total_variation_without_noise() {
    let workspace = measured();
    write(&workspace, "phi.npy", 6, 1e-12, (0, 0, 2e-12));
    write(&workspace, "errors.npy", 6, 0.0, (0, 0, 0.0));
    write(&workspace, "some.npy", 6, 1e-14, (0, 0, 1e-14));
    let line = "recover bench --phi phi.npy --method joint-tv";
    for (rest, word) in [
        ("", "needs to know the noise"),
        ("--stderr errors.npy", "every standard error is zero"),
        (
            "--stderr some.npy --weighting none",
            "leave the weighting to the noise",
        ),
    ] {
        let ended = workspace.phicam(&format!("{line} {rest}")).exits(2);
        assert!(ended.stderr.contains(word), "{}", ended.account());
        assert!(!ended.stderr.contains("gcv"), "{}", ended.account());
    }
}

/// Residuals of such numbers are NaN, and their limits zero.
#[test]
fn numbers_that_cannot_be_squared() {
    let workspace = measured();
    write(&workspace, "phi.npy", 6, 1e-12, (0, 0, 1e300));
    every_method_refuses(&workspace, "", &["phi", "1e300", "range"]);
    write(&workspace, "phi.npy", 6, 1e-12, (0, 0, 2e-12));
    write(&workspace, "errors.npy", 6, 1e-14, (1, 1, 1e-300));
    every_method_refuses(
        &workspace,
        "--stderr errors.npy",
        &["stderr", "1e-300", "range"],
    );
}

#[test]
fn settings_that_no_method_asked_for_takes() {
    let workspace = measured();
    write(&workspace, "phi.npy", 6, 1e-12, (0, 0, 2e-12));
    for (rest, setting, method) in [
        ("--method pinv --rank 3", "--rank", "tsvd"),
        ("--method pinv --damping 0.1", "--damping", "tikhonov"),
        ("--method joint --rule gcv", "--rule", "tsvd"),
        ("--method pinv --weighting entries", "--weighting", "joint"),
        (
            "--method tsvd --rank 2 --rule discrepancy",
            "--rule would change nothing",
            "--rank",
        ),
        (
            "--method pinv --integration quadrature",
            "--integration would change nothing",
            "pixel by pixel",
        ),
        (
            "--kernel published --integration quadrature",
            "--integration would change nothing",
            "published kernel",
        ),
        ("--method tsvd,joint --tolerance 0.1", "--tolerance", "pinv"),
        ("--method pinv,joint,pinv", "pinv twice", "once"),
    ] {
        let line = format!("recover bench --phi phi.npy --elements 2 {rest}");
        workspace.refuses(&line, &[setting, method]);
    }
}

#[test]
fn photographs_that_are_black() {
    let workspace = measured();
    write(&workspace, "phi.npy", 6, 0.0, (0, 0, 0.0));
    write(&workspace, "errors.npy", 6, 1e-14, (0, 0, 1e-14));
    let words = ["every entry of phi is zero", "no light", "check"];
    for more in ["", "--stderr errors.npy"] {
        every_method_refuses(&workspace, more, &words);
    }
    for rule in ["gcv", "l-curve"] {
        let line = format!("recover bench --phi phi.npy --elements 2 --rule {rule}");
        workspace.refuses(&line, &words);
    }
}

#[test]
fn a_hidden_surface_that_no_spot_lights() {
    // It faces −y at y = 8: the pixels below see it, the spots above do not light it.
    let object = "corner = [3, 11.350951966438567, 4.149048033561433], u = [4, 0, 0], v = [0, -2.82842712474619, 2.82842712474619]";
    let turned = "corner = [3, 8, 2], u = [4, 0, 0], v = [0, 0, 3]";
    let spots = "layout = \"list\"\npoints = [[1, 10], [2, 11], [3, 12], [4, 13], [5, 12], [6, 11], [7, 10], [8, 9.5]]";
    let square = [
        ("layout = \"square\"", spots),
        ("centre = [5.0, 4.373476808130942]", ""),
        ("half_width = 3.0", ""),
        ("per_side = 30", ""),
        ("stagger = [-1.0, 1.0, 0.0]", ""),
        ("pixels = [16, 16]", "pixels = [3, 2]"),
        (object, turned),
    ];
    let workspace = with_scene(&altered(&square));
    write(&workspace, "phi.npy", 6, 1e-12, (0, 0, 2e-12));
    every_method_refuses(&workspace, "", &["laser side D", "rank zero", "check"]);
}

#[test]
fn inverses_that_do_not_exist() {
    let workspace = measured();
    write(&workspace, "phi.npy", 6, 1e-12, (0, 0, 2e-12));
    // 16 elements under 8 spots, then 4.
    for (method, elements, needed) in [("right-inverse", 4, "16"), ("left-inverse", 2, "8")] {
        let line = format!("recover bench --phi phi.npy --method {method} --elements {elements}");
        let words = [method, "does not exist", "rank", needed, "pinv"];
        workspace.refuses(&line, &words);
    }
    for line in [
        "--method left-inverse --elements 4 --tolerance 0",
        "--method right-inverse --elements 2",
    ] {
        let _ = workspace
            .phicam(&format!("recover bench --phi phi.npy {line}"))
            .exits(0);
    }
}
