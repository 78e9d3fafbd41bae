//! What the program says of itself: the reference of the scene file, a scene to start from,
//! completions, manual pages.

use crate::workspace::Workspace;

#[test]
fn the_whole_reference_follows_the_help_of_the_command() {
    let workspace = Workspace::new();
    let own = workspace.phicam("scene --help").exits(0).stdout;
    let all = workspace.phicam("help scene").exits(0).stdout;
    assert!(all.starts_with(&own), "{all}");
    assert!(own.contains("phicam help scene camera.view"), "{own}");
    for key in phicam::scene::reference::keys() {
        let head = format!("\n{}  (", key.path);
        assert_eq!(all.matches(&head).count(), 1, "{}", key.path);
    }
    assert!(all.lines().all(|line| line.chars().count() <= 100));
    // Commands keep their help.
    let command = workspace.phicam("help scene check").exits(0).stdout;
    assert_eq!(
        command,
        workspace.phicam("scene check --help").exits(0).stdout
    );
    assert_eq!(
        workspace.phicam("help run").exits(0).stdout,
        workspace.phicam("run --help").exits(0).stdout
    );
}

#[test]
fn the_licences_of_all_that_is_linked_are_told() {
    let told = Workspace::new().phicam("notices").exits(0).stdout;
    // Crates of the command alone and of the library, and a library of the pages, each with its
    // text.
    for words in [
        "clap 4",
        "faer 0",
        "three",
        "Permission is hereby granted",
        "Redistribution and use",
    ] {
        assert!(told.contains(words), "{words}");
    }
}

#[test]
fn a_key_has_its_type_unit_default_and_what_stands_below_it() {
    let workspace = Workspace::new();
    for (keys, words) in [
        (
            "camera.view",
            &[
                "camera.view  (table, required)",
                "camera.view.x  (2 numbers, length, required)",
            ][..],
        ),
        (
            "laser.spots.per_side",
            &["(whole number, required)", "each side"],
        ),
        ("laser.power", &["number, W, required", "units: W, kW, mW"]),
        (
            "surface.material",
            &[
                "surface.material.roughness  (number, rad",
                "surface.material.conductor.eta",
            ],
        ),
        (
            "surface.wall.material.lambertian",
            &["surface.material.lambertian.checkerboard"],
        ),
        ("sensor.exposure", &["default 1", "min"]),
        ("[laser]", &["laser.wavelength"]),
        ("material", &["material.paint"]),
        ("unit name", &["unit  (", "name  ("]),
    ] {
        let line = format!("help scene {keys}");
        let ended = workspace.phicam(&line).exits(0);
        for word in words {
            assert!(
                ended.stdout.contains(word),
                "no `{word}` in {}",
                ended.account()
            );
        }
    }
}

/// What it writes passes its own check, and the main job recovers the board.
#[test]
fn a_new_scene_is_checked_and_computed() {
    let workspace = Workspace::new();
    let _ = workspace.phicam("new corner").exits(0);
    let text = workspace.text("corner.toml");
    assert!(
        text.contains("name = \"corner\"") && text.contains("# "),
        "{text}"
    );
    let check = workspace.phicam("scene check corner.toml").exits(0).stdout;
    assert!(
        check.contains("corner: ") && check.contains("nothing suspicious"),
        "{check}"
    );
    let run = workspace.phicam("run corner.toml -o out").exits(0);
    assert!(
        run.stdout.contains("traced and physical model agree"),
        "{}",
        run.account()
    );
    // A run keeps numbers.
    let kept = workspace.text("out/scene.toml");
    assert!(
        kept.contains("power = 0.005") && !kept.contains("mW"),
        "{kept}"
    );
    let _ = workspace.phicam("expose out").exits(0);
    workspace.refuses("new corner", &["corner.toml is there already", "--force"]);
    let odd = workspace.phicam("new corner(2)").exits(0);
    let next = "`phicam run 'corner(2).toml' -o 'corner(2)'`";
    assert!(odd.stderr.contains(next), "{}", odd.account());
    let _ = workspace
        .phicam("new corner.toml --from card --force")
        .exits(0);
    let copy = workspace.text("corner.toml");
    let card = workspace.phicam("scene export card").exits(0).stdout;
    assert_eq!(
        copy,
        card.replacen("name = \"card\"", "name = \"corner\"", 1)
    );
    for builtin in phicam::scene::builtins()
        .iter()
        .filter(|b| b.name != "room")
    {
        let line = format!("new copy --force --from {}", builtin.name);
        let _ = workspace.phicam(&line).exits(0);
        let _ = workspace
            .phicam("scene show copy.toml -o copy.svg --force")
            .exits(0);
    }
}

#[test]
fn shells_are_told_commands_options_values_and_scenes() {
    let workspace = Workspace::new();
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let line = format!("completions {shell}");
        let script = workspace.phicam(&line).exits(0).stdout;
        for word in ["validate", "samples", "calibrate"] {
            assert!(script.contains(word), "{shell}: {word}");
        }
        if shell != "elvish" && shell != "powershell" {
            for word in ["independent", "quadrature", "periscope"] {
                assert!(script.contains(word), "{shell}: {word}");
            }
        }
    }
}

/// bash itself completes by the script.
#[cfg(unix)]
#[test]
fn bash_completes_scenes_methods_and_options() {
    let workspace = Workspace::new();
    let script = workspace.phicam("completions bash").exits(0).stdout;
    workspace.write("phicam.bash", script);
    for (words, wanted) in [
        ("phicam vali", "validate"),
        ("phicam run peri", "periscope"),
        ("phicam run --estimator fac", "factored"),
        ("phicam scene che", "check"),
    ] {
        let list: Vec<&str> = words.split(' ').collect();
        let (last, before) = (list[list.len() - 1], list[list.len() - 2]);
        let program = format!(
            "source phicam.bash; COMP_WORDS=({words}); COMP_CWORD={}; COMP_LINE='{words}'; \
             _phicam phicam '{last}' '{before}'; echo \"${{COMPREPLY[@]}}\"",
            list.len() - 1
        );
        let done = std::process::Command::new("bash")
            .args(["--norc", "-c", &program])
            .current_dir(workspace.path(""))
            .output()
            .expect("bash runs");
        let reply = String::from_utf8_lossy(&done.stdout).into_owned();
        assert!(
            reply.split_whitespace().any(|w| w == wanted),
            "{words}: {reply} {done:?}"
        );
    }
}

#[test]
fn every_command_has_a_manual_page() {
    let workspace = Workspace::new();
    let main = workspace.phicam("man").exits(0).stdout;
    assert!(main.contains(".TH") && main.contains("phicam"), "{main}");
    let _ = workspace.phicam("man pages").exits(0);
    let pages = workspace.contents("pages");
    for name in [
        "phicam.1",
        "phicam-run.1",
        "phicam-scene-check.1",
        "phicam-study-noise.1",
    ] {
        let text = String::from_utf8_lossy(&pages[name]);
        assert!(text.contains(".SH SYNOPSIS"), "{name}: {text}");
    }
    workspace.refuses("man pages", &["is there already", "--force"]);
    let _ = workspace.phicam("man pages --force").exits(0);
    assert_eq!(pages, workspace.contents("pages"));
}
