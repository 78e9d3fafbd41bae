//! What is finished is vouched for: a byte that changes anywhere in a run folder is found.

use crate::workspace::{Workspace, assert_same};

/// The command that reads a file of a run, and finds it changed.
fn reader(name: &str) -> &'static str {
    match name {
        "run.json" | "phi.npy" | "phi.stderr.npy" | "phi.tails.npy" => "validate done",
        "exposed/phi.npy" | "exposed/phi.stderr.npy" => {
            "recover done --phi done/exposed/phi.npy --stderr done/exposed/phi.stderr.npy --method tikhonov --keep-clipped -o o"
        }
        _ => "stack done",
    }
}

#[test]
fn a_flipped_bit_is_found_in_every_file_of_a_run() {
    let workspace = Workspace::with_scenes();
    let _ = workspace.phicam("run small.toml -o done --samples 64");
    let _ = workspace
        .phicam("expose done --sensor machine-vision --exposure 1")
        .exits(0);
    let whole = workspace.contents("done");
    assert!(whole.len() > 60, "{:?}", whole.keys());
    for (name, bytes) in &whole {
        if name.ends_with('/') {
            continue;
        }
        let file = format!("done/{name}");
        for at in [0, bytes.len() / 3, bytes.len() - 1] {
            let mut changed = bytes.clone();
            changed[at] ^= 4;
            workspace.write(&file, &changed);
            if name == "scene.toml" {
                // Sensors may be written into it. What the light depends on may not change.
                let ended = workspace.phicam("validate done");
                let told = ended.stderr.contains("scene.toml");
                assert!(told, "byte {at} of {name}: {}", ended.account());
            } else {
                let ended = workspace.phicam(reader(name));
                let told = ended.code == 2 && ended.stderr.contains(name.as_str());
                assert!(told, "byte {at} of {name}: {}", ended.account());
            }
        }
        workspace.write(&file, bytes);
    }
    let _ = workspace.phicam("stack done").exits(0);
}

/// What lies in a run folder under names that are not phicam's is nobody's: it is neither read nor
/// vouched for.
#[test]
fn strays_are_not_vouched_for() {
    let workspace = Workspace::with_scenes();
    let run = "run small.toml -o done --samples 64";
    let expose = "expose done --sensor machine-vision --exposure 1";
    let _ = workspace.phicam(run);
    let _ = workspace.phicam(expose).exits(0);
    std::fs::create_dir_all(workspace.path("done/files")).unwrap();
    let strays = [
        "frames/foreign.exr",
        "frames/spot-0024.exr",
        "frames/spot-00001.exr",
        "files/foreign.ply",
        "model/foreign.npy",
        "recovered/foreign.npy",
        "exposed/foreign.npy",
        "exposed/counts/foreign.exr",
    ];
    // A run that is not whole is finished, and vouched for, once more.
    std::fs::remove_file(workspace.path("done/phi.npy")).unwrap();
    for stray in strays {
        let file = std::fs::File::create(workspace.path("done").join(stray)).unwrap();
        file.set_len(1 << 20).unwrap();
    }
    let ended = workspace.phicam("render small.toml -o done --samples 64");
    assert_eq!(ended.code, 0, "{}", ended.account());
    let _ = workspace.phicam(expose).exits(0);
    let _ = workspace.phicam("model small.toml -o done").exits(0);
    let _ = workspace.phicam("recover done --method joint");
    let record = workspace.json("done/run.json");
    let files = record["files"].as_object().unwrap();
    for own in [
        "frames/spot-0023.exr",
        "model/phi.npy",
        "recovered/joint.npy",
        "exposed/phi.npy",
        "exposed/counts/spot-0023.png",
    ] {
        assert!(files.contains_key(own), "{own}: {:?}", files.keys());
    }
    for stray in strays {
        assert!(!files.contains_key(stray), "{stray}");
    }
}

#[test]
fn an_edited_record_is_found() {
    let workspace = Workspace::with_scenes();
    let _ = workspace
        .phicam("render tiny.toml -o done --samples 64")
        .exits(0);
    let record = workspace.text("done/run.json");
    for (old, new) in [
        ("\"samples\": 64", "\"samples\": 640"),
        ("\"blocks\": 32", "\"blocks\": 64"),
        ("\"finished\": 8", "\"finished\": 7"),
        ("\"seed\": 1", "\"seed\": 2"),
    ] {
        if record.contains(old) {
            workspace.write("done/run.json", record.replace(old, new));
            let words = ["run.json", "damaged"];
            workspace.refuses("validate done", &words);
            workspace.refuses("render tiny.toml -o done --samples 64", &words);
        }
    }
    assert!(record.contains("\"seed\": 1") && record.contains("\"finished\": 8"));
}

/// A part that was kept and has changed is no part: its spots are traced again.
#[test]
fn changed_parts_count_as_none() {
    let workspace = Workspace::with_scenes();
    let line = "render tiny.toml --samples 64";
    let _ = workspace.phicam(&format!("{line} -o whole")).exits(0);
    let whole = workspace.rendered("whole");
    for share in [0.0, 0.2, 0.5, 0.99] {
        let out = format!("cut-{share}");
        let _ = workspace
            .phicam(&format!("{line} -o {out} --spots 0..3"))
            .exits(0);
        let part = format!("{out}/partial/spots-0000-0003.phs");
        let mut bytes = workspace.read(&part);
        let at = (share * bytes.len() as f64) as usize;
        bytes[at] ^= 1;
        workspace.write(&part, bytes);
        // A frame that changed meanwhile is made again, too.
        let frame = format!("{out}/frames/spot-0001.exr");
        let mut bytes = workspace.read(&frame);
        let last = bytes.len() - 1;
        bytes[last] ^= 1;
        workspace.write(&frame, bytes);
        let _ = workspace.phicam(&format!("{line} -o {out}")).exits(0);
        assert_same(&whole, &workspace.rendered(&out), &out);
    }
}
