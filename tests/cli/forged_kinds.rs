//! What has the name of a file and is none, or one of 3 GB: in a run's folder and in a plan's.
//! Every command answers, at once and in little memory, and says what is wrong with what.

use std::fs::{self, File};
use std::os::unix::fs::symlink;
use std::os::unix::net::UnixListener;
use std::path::Path;

use crate::small_scene::{TINY, altered};
use crate::workspace::{Ended, Workspace};

/// What may have the name of a file.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Pipe,
    Socket,
    Device,
    Folder,
    /// A link to something that is not there.
    Dangling,
    /// 3 GB, of which none is on the disk.
    Huge,
}

impl Kind {
    const ALL: [Self; 6] = [
        Self::Pipe,
        Self::Socket,
        Self::Device,
        Self::Folder,
        Self::Dangling,
        Self::Huge,
    ];

    /// Puts it in the place of what is at `path`.
    fn put(self, path: &Path) {
        if path.is_dir() {
            fs::remove_dir_all(path).unwrap();
        } else if path.symlink_metadata().is_ok() {
            fs::remove_file(path).unwrap();
        }
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        match self {
            Self::Pipe => {
                let made = std::process::Command::new("mkfifo").arg(path).status();
                assert!(made.unwrap().success());
            }
            Self::Socket => drop(UnixListener::bind(path).unwrap()),
            Self::Device => symlink("/dev/zero", path).unwrap(),
            Self::Folder => fs::create_dir(path).unwrap(),
            Self::Dangling => symlink("nowhere", path).unwrap(),
            Self::Huge => File::create(path).unwrap().set_len(3_000_000_000).unwrap(),
        }
    }

    fn remove(self, path: &Path) {
        match self {
            Self::Folder => fs::remove_dir(path).unwrap(),
            _ => fs::remove_file(path).unwrap(),
        }
    }
}

const PAINTED: (&str, &str) = (
    "lambertian = { checkerboard = [2, 2], dark = 0.0, light = 1.0 }",
    "lambertian = { image = \"edge.png\", transfer = \"linear\" }",
);
const PATHS: &str = "--samples 64 --estimator shared";

/// A workspace with a tiny scene that names a picture, and what `lines` make of it.
fn with(lines: &[&str]) -> Workspace {
    let workspace = Workspace::new();
    workspace.write("own.toml", altered(TINY.iter().chain([&PAINTED])));
    let picture = "target edge -o edge.png --linear --size 2,2";
    for line in [&[picture][..], lines].concat() {
        let _ = workspace.phicam(line).exits(0);
    }
    workspace
}

/// Every kind in the place of `name`; each of the commands ends with the code that stands before it
/// and names the file, but where it needs no such file (code 0).
fn each_kind(workspace: &Workspace, name: &str, commands: &[(i32, &str)]) {
    let path = workspace.path(name);
    let aside = workspace.path("aside");
    let there = path.exists();
    if there {
        fs::rename(&path, &aside).unwrap();
    }
    for kind in Kind::ALL {
        kind.put(&path);
        for (code, line) in commands {
            let ended: Ended = workspace.answers(line);
            let account = format!("{kind:?} as {name}: {}", ended.account());
            // A link to nothing is nothing, which may be told in other words.
            if kind == Kind::Dangling {
                assert!([0, 2, 3, 64, 65, 66].contains(&ended.code), "{account}");
                continue;
            }
            assert_eq!(ended.code, *code, "{account}");
            // Of a copy the scene's own name of the file.
            let last = name.rsplit(['/', '-']).next().unwrap();
            assert!(*code == 0 || ended.stderr.contains(last), "{account}");
        }
        kind.remove(&path);
    }
    if there {
        fs::rename(&aside, &path).unwrap();
    }
}

fn copy_of_the_picture(workspace: &Workspace, folder: &str) -> String {
    let mut copies = workspace.contents(&format!("{folder}/files")).into_keys();
    format!("{folder}/files/{}", copies.next().unwrap())
}

#[test]
fn in_a_run() {
    let render = format!("render own.toml -o done {PATHS}");
    let w = with(&[&render]);
    let validate = "validate done";
    let recover = "recover done --method joint";
    let expose = "expose done --sensor ideal --exposure 1 -o photos";
    let all = [(2, validate), (2, recover), (2, expose)];
    each_kind(&w, "done/run.json", &[all[0], all[1], (2, &render)]);
    each_kind(
        &w,
        "done/scene.toml",
        &[all[0], (2, "scene check done/scene.toml")],
    );
    each_kind(
        &w,
        "done/phi.npy",
        &[&all[..], &[(2, "stack done -o again")]].concat(),
    );
    each_kind(&w, "done/phi.stderr.npy", &[all[0], all[2]]);
    each_kind(&w, "done/phi.tails.npy", &[(2, validate)]);
    let frame = "done/frames/spot-0003.exr";
    let view = format!("view {frame} -o seen.png");
    each_kind(&w, frame, &[(2, "stack done -o again"), (2, &view)]);
    // The scene's own picture is gone: the run's copy is what is read.
    fs::remove_file(w.path("edge.png")).unwrap();
    each_kind(&w, &copy_of_the_picture(&w, "done"), &[(2, validate)]);
}

#[test]
fn in_an_unfinished_run() {
    let render = format!("render own.toml -o part {PATHS}");
    let w = with(&[&format!("{render} --spots 0..2")]);
    // A part that cannot be read is rendered again; another thing under its name is not replaced.
    let resume = format!("{render} --spots 0..1");
    each_kind(&w, "part/partial/spots-0000-0002.phs", &[(0, &resume)]);
    each_kind(&w, "part/partial/spots-0001-0002.phs", &[(0, &resume)]);
}

/// A plan is refused as a whole (65) where it, its scene, or a shard is something else; what stands
/// beside them is nobody's business.
#[test]
fn in_a_plan() {
    let plan = "plan own.toml -o job --shards 2 --samples 64";
    let shards = ["shard job --index 0", "shard job --index 1"];
    let w = with(&[plan, shards[0], shards[1]]);
    let commands = |code| {
        let lines = [
            "status job",
            shards[0],
            "merge job -o merged",
            "slurm job --dry-run",
            "clean job --dry-run",
        ];
        lines.map(|line| (code, line))
    };
    each_kind(&w, "job/plan.json", &commands(65));
    each_kind(&w, "job/scene.toml", &commands(65));
    fs::remove_file(w.path("edge.png")).unwrap();
    each_kind(&w, &copy_of_the_picture(&w, "job"), &commands(65));
    each_kind(&w, "job/files/stray", &commands(0));
    each_kind(&w, "job/shards/stray", &commands(0));
}

/// 1 GB, which some frame or mesh may have, and this one cannot: its length says so.
#[test]
fn a_gigabyte_where_a_few_bytes_are_due() {
    let w = with(&[&format!("render own.toml -o done {PATHS}")]);
    fs::remove_file(w.path("edge.png")).unwrap();
    let copy = copy_of_the_picture(&w, "done");
    let frame = "done/frames/spot-0003.exr".to_owned();
    let length = "its length is not that in run.json";
    for (name, line, words) in [
        (&frame, "stack done -o again", "1000000000 bytes"),
        (&copy, "stack done -o again", length),
        (&copy, "validate done", length),
    ] {
        let own = w.read(name);
        let file = File::create(w.path(name)).unwrap();
        file.set_len(1_000_000_000).unwrap();
        let ended = w.answers(line).exits(2);
        let told = ended.stderr.contains(name.as_str()) && ended.stderr.contains(words);
        assert!(told, "{}", ended.account());
        w.write(name, own);
    }
    let _ = w.phicam("stack done -o again").exits(0);
}

/// The header is whole and promises what is there: 3 GB of zeros, of another shape than the run.
#[test]
fn a_matrix_of_three_gigabytes() {
    let w = with(&[&format!("render own.toml -o done {PATHS}")]);
    let mut header =
        String::from("{'descr': '<f8', 'fortran_order': False, 'shape': (46875000, 8), }");
    header += &" ".repeat(117 - header.len());
    let start = [b"\x93NUMPY\x01\x00\x76\x00", header.as_bytes(), b"\n"].concat();
    w.write("huge.npy", &start);
    let file = File::options()
        .write(true)
        .open(w.path("huge.npy"))
        .unwrap();
    file.set_len(128 + 3_000_000_000).unwrap();
    let pair = "--phi huge.npy --stderr huge.npy";
    for line in [
        format!("validate {pair} --against own.toml --replicates 8"),
        format!("validate done {pair} --replicates 8"),
        "recover done --phi huge.npy --noise 0.1 --method joint".to_owned(),
        "recover done --stderr huge.npy --method joint".to_owned(),
        "view huge.npy -o seen.png".to_owned(),
    ] {
        let ended = w.answers(&line).exits(2);
        assert!(ended.stderr.contains("huge.npy"), "{}", ended.account());
    }
    for name in ["phi.npy", "phi.stderr.npy", "phi.tails.npy"] {
        let place = format!("done/{name}");
        let own = w.read(&place);
        fs::remove_file(w.path(&place)).unwrap();
        symlink("../huge.npy", w.path(&place)).unwrap();
        let ended = w.answers("validate done").exits(2);
        assert!(ended.stderr.contains(name), "{}", ended.account());
        fs::remove_file(w.path(&place)).unwrap();
        w.write(&place, own);
    }
}
