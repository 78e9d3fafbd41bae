//! `phicam target`: list, write.

use crate::workspace::Workspace;

const NAMES: [&str; 6] = ["card", "letters", "siemens", "edge", "usaf", "ramp"];
const MESHES: [&str; 4] = ["mesh", "sphere", "rectangle", "box"];

#[test]
fn targets_are_listed_and_written() {
    let workspace = Workspace::new();
    let ended = workspace.phicam("target").exits(0);
    let first = ended
        .stdout
        .lines()
        .filter_map(|l| l.split_whitespace().next());
    let names: Vec<&str> = NAMES.into_iter().chain(MESHES).collect();
    assert_eq!(first.collect::<Vec<_>>(), names, "{}", ended.account());
    for name in NAMES {
        let ended = workspace
            .phicam(&format!("target {name} --size 47,31"))
            .exits(0);
        assert!(ended.stderr.contains("47 × 31"), "{}", ended.account());
        let bytes = workspace.read(&format!("{name}.png"));
        // Signature, then the chunk IHDR: width, height, 16 bits, grey.
        assert_eq!(&bytes[..8], b"\x89PNG\r\n\x1a\n");
        assert_eq!(&bytes[16..26], [0, 0, 0, 47, 0, 0, 0, 31, 16, 0]);
    }
    for (option, file) in [("--linear", "linear"), ("", "srgb")] {
        let line = format!("target ramp {option} -o {file}.png");
        let ended = workspace.phicam(&line).exits(0);
        let stated = format!("transfer = \"{file}\"");
        assert!(ended.stderr.contains(&stated), "{}", ended.account());
    }
    assert_ne!(workspace.read("linear.png"), workspace.read("srgb.png"));
}

/// A target mesh has as many triangles as asked for, or a few more, and a scene takes it.
#[test]
fn target_meshes_are_written_and_read() {
    let workspace = Workspace::new();
    for name in MESHES {
        let faces = match name {
            "box" => "",
            _ => "--faces 500",
        };
        let ended = workspace.phicam(&format!("target {name} {faces}")).exits(0);
        let file = format!("{name}.ply");
        let bytes = workspace.read(&file);
        let mut nothing = |_: &str| Err(String::new());
        let mesh = phicam::scene::mesh::read(&file, &bytes, &mut nothing).unwrap();
        let count = mesh.triangles.len();
        let fits = match name {
            "box" => count == 12,
            _ => (500..700).contains(&count),
        };
        assert!(fits, "{name}: {count}");
        assert!(
            ended.stderr.contains(&format!("{count} triangles")),
            "{}",
            ended.account()
        );
    }
    workspace.refuses("target box --faces 20", &["12 triangles"]);
    workspace.refuses("target sphere --linear", &["--linear"]);
    workspace.refuses("target card --faces 20", &["--faces"]);
}

#[test]
fn what_is_no_target_is_refused() {
    let workspace = Workspace::new();
    workspace.refuses("target joker", &["no target `joker`", "card"]);
    workspace.refuses("target card --size 0,4", &["W,H"]);
    workspace.refuses("target --linear", &["NAME"]);
}
