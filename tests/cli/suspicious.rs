//! What is suspicious in a scene is said before the hours are spent, and nothing that is not true.

use crate::scenes::BUILT_IN;
use crate::small_scene::{TINY, altered};
use crate::workspace::Workspace;

/// The tiny bench with one more replacement: what `scene check` and a render say of it.
fn said(change: (&str, &str), render: &str) -> [String; 2] {
    let workspace = Workspace::new();
    workspace.write("odd.toml", altered(&[TINY[0], TINY[1], change]));
    let check = workspace.phicam("scene check odd.toml").exits(0).stdout;
    let line = format!("render odd.toml -o out {render}");
    [check, workspace.phicam(&line).exits(0).stderr]
}

#[test]
fn a_laser_in_other_units_is_told() {
    for (change, words) in [
        (
            ("wavelength = 632.8e-9", "wavelength = 632.8"),
            "a wavelength of 6.328e2 m",
        ),
        (
            ("wavelength = 632.8e-9", "wavelength = 632.8e-12"),
            "a wavelength of 6.328e-10 m",
        ),
        (("power = 5.0e-3", "power = 5.0e9"), "a laser of 5e9 W"),
        (("power = 5.0e-3", "power = 5.0e-12"), "a laser of 5e-12 W"),
    ] {
        let [check, render] = said(change, "--samples 1");
        assert!(check.contains(&format!("suspicious: {words}")), "{check}");
        assert!(render.contains(&format!("warning: {words}")), "{render}");
    }
}

/// 3 × 2 pixels and 8 spots are 48 values: fewer than 8 × 8 elements.
#[test]
fn fewer_values_than_elements_are_told() {
    let words = "48 photographed values (pixels × spots) for 64 elements";
    let [check, render] = said(("elements = [8, 8]", "elements = [8, 8] # "), "--samples 1");
    assert!(check.contains(words), "{check}");
    assert!(render.contains(words), "{render}");
    let [check, _] = said(("elements = [8, 8]", "elements = [6, 8]"), "--samples 1");
    assert!(!check.contains("photographed values"), "{check}");
}

/// Two surfaces at most, and what lies between the walls takes a third: no light can come back, and
/// that is known from where the surfaces lie.
#[test]
fn a_dark_scene_is_told() {
    let change = ("max_bounces = 3 ", "max_bounces = 2 ");
    let [check, render] = said(change, "--samples 65536 --estimator shared");
    for text in [check, render] {
        assert!(text.contains("no light reaches the camera"), "{text}");
        assert!(text.contains("max_bounces is 2: "), "{text}");
    }
}

/// A wall at right angles to the first sends light of its spots to the part that the camera sees,
/// which no model has; turned about, it faces neither.
#[test]
fn light_from_wall_to_wall_is_told() {
    let wall = |u: &str, v: &str| {
        format!(
            "[[surface]]\nname = \"side\"\nrole = \"relay\"\nmaterial = {{ lambertian = 0.8 }}\n\
             rectangle = {{ corner = [13, -4, 0], u = {u}, v = {v} }}\n"
        )
    };
    let checked = |wall: &str| {
        let workspace = Workspace::new();
        workspace.write("walls.toml", altered(&TINY[..2]) + "\n" + wall);
        workspace.phicam("scene check walls.toml").exits(0).stdout
    };
    let words = "no model or recovery has: light of three bounces that `side` sends";
    let facing = checked(&wall("[0, 0, 8]", "[0, 19.5, 0]"));
    assert!(facing.contains(words), "{facing}");
    let away = checked(&wall("[0, 19.5, 0]", "[0, 0, 8]"));
    assert!(!away.contains("no model or recovery has"), "{away}");
    assert!(!checked("").contains("no model or recovery has"));
}

/// An OBJ that names a material library: its colours are not used, and how else an albedo is given
/// is said; the same file without that line is not suspicious.
#[test]
fn colours_of_a_mesh_are_told_and_not_used() {
    let square = "v 3 11 4\nv 7 11 4\nv 7 9 6\nv 3 9 6\nf 1 2 3 4\n";
    let scene = altered(&TINY)
        + "\n[[surface]]\nname = \"sheet\"\nrole = \"occluder\"\nmaterial = { lambertian = 0.5 }\n\
           mesh = { file = \"sheet.obj\" }\n";
    let check = |obj: &str| {
        let workspace = Workspace::new();
        workspace.write("sheet.obj", obj);
        workspace.write("odd.toml", &scene);
        workspace.phicam("scene check odd.toml").exits(0).stdout
    };
    let told = check(&format!("mtllib paint.mtl\n{square}"));
    for words in [
        "suspicious: the mesh of `sheet` comes with materials in `paint.mtl`, which are not used",
        "its albedo is what `material` says",
        "image = \"picture.png\"",
    ] {
        assert!(told.contains(words), "{told}");
    }
    assert!(!check(square).contains("not used"));
}

/// A sphere that nearly touches the wall in view, by few samples: what is foretold of the overall
/// standard error is what the render then states, within a factor of two; without the sphere
/// nothing is.
#[test]
fn a_coarse_result_is_foretold() {
    let workspace = Workspace::new();
    let pixels = [("pixels = [16, 16]", "pixels = [48, 48]"), TINY[1]];
    let sphere = "\n[[surface]]\nname = \"ball\"\nrole = \"occluder\"\n\
        sphere = { centre = [5.0, 4.4, 0.3], radius = 0.25, face = \"outside\" }\n\
        material = { lambertian = 0.9 }\n";
    workspace.write("plain.toml", altered(&pixels));
    workspace.write("ball.toml", altered(&pixels) + sphere);
    let line = "--estimator factored --samples 64";
    let plain = workspace.phicam(&format!("render plain.toml -o plain {line}"));
    let plain = plain.exits(0);
    assert!(!plain.stderr.contains("foretell"), "{}", plain.account());
    let ball = workspace
        .phicam(&format!("render ball.toml -o ball {line}"))
        .exits(0);
    let number = |text: &str, before: &str| {
        let rest = text.split(before).nth(1)?;
        rest.split_whitespace().next()?.parse::<f64>().ok()
    };
    let foretold = number(&ball.stderr, "standard error of about ");
    let found = number(&ball.stdout, "standard error ");
    let (Some(foretold), Some(found)) = (foretold, found) else {
        panic!("{}", ball.account());
    };
    let ratio = foretold / found;
    assert!((0.5..=2.0).contains(&ratio), "{}", ball.account());
}

/// None of the built-in scenes is told anything by its first samples that its defaults do not bear
/// out: by default none of them is dark, and none as coarse as 10 %.
#[test]
fn built_in_scenes_are_lit() {
    let workspace = Workspace::new();
    // The million triangles of `room` take their time.
    for scene in BUILT_IN.iter().filter(|scene| **scene != "room") {
        let check = workspace.phicam(&format!("scene check {scene}")).exits(0);
        for word in ["no light", "met no light", "wavelength of", "a laser of"] {
            assert!(!check.stdout.contains(word), "{}", check.account());
        }
    }
}

/// Light that the scene has and the model of a recovery does not is told before its picture.
#[test]
fn light_that_a_recovery_does_not_model_is_told() {
    let workspace = Workspace::new();
    for (bounces, told) in [("max_bounces = 3 ", false), ("max_bounces = 5 ", true)] {
        let change = ("max_bounces = 3 ", bounces);
        workspace.write("deep.toml", altered(&[TINY[0], TINY[1], change]));
        let line = format!("render deep.toml -o {told} --samples 64");
        let _ = workspace.phicam(&line).exits(0);
        let ended = workspace.phicam(&format!("recover {told} --method pinv"));
        let words = "the model of a recovery does not know";
        assert_eq!(ended.stderr.contains(words), told, "{}", ended.stderr);
        assert_eq!(ended.stderr.contains("light of 4 to 5 bounces"), told);
    }
}
