//! `-D KEY=VALUE`: a scene with another value of a key.

use crate::small_scene::altered;
use crate::workspace::Workspace;

/// The scene edited by hand and the one with the key defined are one scene: the same run.
#[test]
fn a_defined_key_is_that_of_an_edited_file() {
    let workspace = Workspace::new();
    let pairs = [
        ("pixels = [16, 16]", "pixels = [4, 3]"),
        ("per_side = 30", "per_side = 2"),
    ];
    workspace.write("edited.toml", altered(&pairs));
    let line = "render edited.toml -o out --samples 32";
    let _ = workspace.phicam(line).exits(0);
    let same = "-q render bench -o out --samples 32 -D camera.pixels=[4,3] -D laser.spots.per_side=2 --json";
    let ended = workspace.phicam(same).exits(0);
    assert!(ended.stderr.is_empty(), "{}", ended.account());
    let other = "render bench -o out --samples 32 -D camera.pixels=[4,4] -D laser.spots.per_side=2";
    let ended = workspace.phicam(other).exits(2);
    assert!(
        ended.stderr.contains("another scene"),
        "{}",
        ended.account()
    );
    // Words need no quotes.
    let named = "scene export bench -D name=other";
    let text = workspace.phicam(named).exits(0).stdout;
    assert!(text.contains("name = \"other\""), "{text}");
}

#[test]
fn a_definition_that_means_nothing_is_refused() {
    let workspace = Workspace::with_scenes();
    for (line, words) in [
        (
            "scene check bench -D camera.pixel=[4,4]",
            &["pixel", "cure"][..],
        ),
        ("scene check bench -D camera.pixels", &["KEY=VALUE"]),
        (
            "scene check bench -D camera.pixels=[4,",
            &["no value in TOML"],
        ),
        (
            "scene check bench -D surface.door.elements=[4,4]",
            &["door", "wall"],
        ),
        ("run bench -D camera.pixels=[0,4] -o out", &["pixels"]),
        (
            "scene check bench -D laser.power=5mW -D name=other -D laser.power=10mW",
            &["-D gives laser.power twice", "cure: "],
        ),
    ] {
        workspace.refuses(line, words);
    }
    let _ = workspace
        .phicam("render tiny.toml -o run --samples 32")
        .exits(0);
    for command in [
        "recover run",
        "stack run",
        "validate run",
        "expose run",
        "locate run",
    ] {
        let line = format!("{command} -D camera.pixels=[4,4]");
        workspace.refuses(&line, &["nothing here names one"]);
    }
    let line = "validate run --against tiny.toml -D laser.power=1";
    let ended = workspace.phicam(line).exits(1);
    assert!(ended.stdout.contains("DISAGREE"), "{}", ended.account());
}
