//! Scenes without a laser: the hidden surface shines.

use phicam::matrix::npy;

use crate::workspace::Workspace;

/// The built-in scene with 6 × 6 pixels, and 2 × 2 elements that shine like `shining` says.
fn scene(workspace: &Workspace, file: &str, shining: &str) {
    let text = workspace.phicam("scene export screen").exits(0).stdout;
    let start = text.find("[surface.material]").unwrap();
    let end = start + text[start..].find("] }").unwrap() + 3;
    let material = format!("material = {{ exitance = 100.0, {shining} }}");
    let text = format!("{}{material}{}", &text[..start], &text[end..])
        .replace("pixels = [24, 24]", "pixels = [6, 6]")
        .replace("elements = [8, 8]", "elements = [2, 2]");
    workspace.write(file, text);
}

const BOARD: &str = "shining = { cells = [[0.2, 1.0], [0.7, 0.0]] }";

/// The main job from the scene to the report: traced and modelled light agree, and the picture
/// comes back. The drawings show no laser.
#[test]
fn the_main_job_of_a_surface_that_shines() {
    let workspace = Workspace::new();
    scene(&workspace, "s.toml", BOARD);
    let ended = workspace.phicam("run s.toml -o out --samples 512").exits(0);
    assert!(ended.stdout.contains("agree"), "{}", ended.account());
    let found = workspace.matrix("out/recovered/joint.npy");
    for (x, truth) in found.transpose().iter().zip([0.2, 1.0, 0.7, 0.0]) {
        assert!((x - truth).abs() < 0.1, "{found}");
    }
    let page = String::from_utf8(workspace.read("out/report.html")).unwrap();
    assert!(page.contains("\"laser\":null") && !page.contains("some laser beams"));
    let _ = workspace.phicam("scene show s.toml -o s.svg").exits(0);
    let svg = String::from_utf8(workspace.read("s.svg")).unwrap();
    assert!(!svg.contains("laser") && !svg.contains("spot 0"), "{svg}");
    let ended = workspace.phicam("scene check s.toml").exits(0);
    assert!(
        ended.stdout.contains("`monitor` shines"),
        "{}",
        ended.account()
    );
}

/// The traced transport, a column an element, inverts the photograph.
#[test]
fn elements_alone_are_the_transport_matrix() {
    let workspace = Workspace::new();
    scene(&workspace, "s.toml", BOARD);
    scene(
        &workspace,
        "each.toml",
        "shining = 1.0, light = \"elements\"",
    );
    for (file, seed) in [("s", 1), ("each", 2)] {
        let line = format!("render {file}.toml -o {file} --samples 2048 --seed {seed}");
        let _ = workspace.phicam(&line).exits(0);
    }
    assert_eq!(workspace.matrix("each/phi.npy").shape(), (36, 4));
    let line = "recover --camera-side each/phi.npy --phi s/phi.npy --noise 0.01 --elements 2x2 \
                --method joint -o out";
    let _ = workspace.phicam(line).exits(0);
    let found = workspace.matrix("out/joint.npy");
    for (x, truth) in found.transpose().iter().zip([0.2, 1.0, 0.7, 0.0]) {
        assert!((x - truth).abs() < 0.1, "{found}");
    }
    let ended = workspace.phicam("scene check each.toml").exits(0);
    assert!(
        ended.stdout.contains("the 4 elements of `monitor` shine"),
        "{}",
        ended.account()
    );
}

/// A photograph from elsewhere onto a scene whose picture is not known.
#[test]
fn one_photograph_is_imported_without_spots() {
    let workspace = Workspace::new();
    scene(&workspace, "s.toml", BOARD);
    scene(&workspace, "unknown.toml", "shining = \"unknown\"");
    let _ = workspace.phicam("model s.toml -o m").exits(0);
    // A photograph's first row is the upper one.
    let phi = workspace.matrix("m/model/phi.npy");
    let photograph =
        phicam::matrix::Matrix::from_fn(6, 6, |row, column| phi[column + 6 * (5 - row)]);
    npy::write(&workspace.path("photo.npy"), &photograph).unwrap();
    let import = "import --frames photo.npy --scene unknown.toml -o in";
    let _ = workspace.phicam(import).exits(0);
    let off = (workspace.matrix("in/phi.npy") - &phi).amax();
    assert!(off < 1e-9 * phi.amax(), "{off}");
    let _ = workspace
        .phicam("recover in --noise 0.001 --method joint --free-scale")
        .exits(0);
    let found = workspace.matrix("in/recovered/joint.npy");
    for (x, truth) in found.transpose().iter().zip([0.2, 1.0, 0.7, 0.0]) {
        assert!((x - truth).abs() < 0.05, "{found}");
    }
    workspace.refuses(
        "render unknown.toml -o r",
        &["albedo of `monitor` is unknown"],
    );
    let halo = "import --frames photo.npy --scene s.toml --halo 0.1 -o h";
    workspace.refuses(halo, &["a halo about the laser's spot", "remove `halo`"]);
}

/// What needs a laser says so.
#[test]
fn what_needs_a_laser_refuses() {
    let workspace = Workspace::new();
    scene(&workspace, "s.toml", BOARD);
    let _ = workspace
        .phicam("render s.toml -o done --samples 64")
        .exits(0);
    for (line, words) in [
        (
            "study noise s.toml -o o",
            ["studies need a scene with a laser", "validate"],
        ),
        (
            "scene export s.toml --mitsuba",
            ["surface `monitor` shines", "by its laser"],
        ),
        (
            "recover done --method joint --occluder-light",
            ["no light of occluders", "--camera-side"],
        ),
    ] {
        workspace.refuses(line, &words);
    }
}
