//! Small doors: names that would steer a terminal, folders named as commands, strays among shards,
//! lines without end, an output that is full.

use std::fs;
use std::process::{Command, Stdio};

use crate::small_scene::{TINY, altered};
use crate::workspace::Workspace;

/// Colours the terminal red, sets its title, and turns the direction of what follows.
const WILD: &str = "a\\u001b[31m\\u001b]0;pwned\\u0007\\u202e\\u2066b";

/// No character that a terminal obeys, or that turns what follows.
fn is_harmless(text: &str) -> bool {
    let obeyed = |c: char| {
        (c.is_control() && c != '\n' && c != '\t')
            || "\u{61c}\u{200e}\u{200f}\u{202a}\u{202b}\u{202c}\u{202d}\u{202e}\u{2066}\u{2067}\u{2068}\u{2069}"
                .contains(c)
    };
    !text.contains(obeyed)
}

#[test]
fn names_are_shown_and_never_obeyed() {
    let w = Workspace::new();
    let scene = altered(&TINY)
        .replacen("name = \"bench\"", &format!("name = \"{WILD}\""), 1)
        .replacen("name = \"object\"", &format!("name = \"{WILD}c\""), 1);
    assert_eq!(scene.matches("pwned").count(), 2);
    w.write("wild.toml", &scene);
    w.write("broken.toml", scene.replace("power = ", "pow\u{202e}er = "));
    for (code, line) in [
        (0, "scene check wild.toml"),
        (0, "scene check wild.toml --json"),
        (2, "scene check broken.toml"),
        (2, "scene check broken.toml --json"),
        (2, "scene check absent\u{202e}\u{1b}[31m.toml"),
        (2, "absent\u{202e}\u{1b}[31m"),
        (
            0,
            "render wild.toml -o done --samples 64 --estimator shared",
        ),
        (
            0,
            "render wild.toml -o done --samples 64 --estimator shared --json",
        ),
        (0, "run wild.toml -o whole --samples 64 --estimator shared"),
        (0, "stack done -o stacked\u{202e}\u{1b}[31m"),
        (0, "recover done --method joint"),
        (0, "recover done --method joint --json"),
        (
            0,
            "expose done --sensor ideal --exposure 1 -o photos\u{202e}",
        ),
        (0, "study tolerance wild.toml -o study --json"),
        (0, "view done/frames/spot-0000.exr -o seen.png"),
    ] {
        let ended = w.phicam(line);
        let shown = is_harmless(&ended.stdout) && is_harmless(&ended.stderr);
        assert!(shown, "{line:?}: {:?} {:?}", ended.stdout, ended.stderr);
        let _ = ended.exits(code);
    }
    for (name, bytes) in w.contents("") {
        let text = ["json", "csv", "svg", "html"]
            .iter()
            .any(|e| name.ends_with(e));
        let text = text.then(|| String::from_utf8(bytes).unwrap());
        assert!(text.is_none_or(|t| is_harmless(&t)), "{name}");
    }
    // What a program reads is the name itself.
    assert_eq!(
        w.json("done/run.json")["scene"]
            .as_str()
            .unwrap()
            .chars()
            .last(),
        Some('b')
    );
    assert!(
        w.json("done/run.json")["scene"]
            .as_str()
            .unwrap()
            .contains("\u{1b}]0;pwned\u{7}\u{202e}")
    );
    // A scene that is asked for comes as it is.
    assert_eq!(w.phicam("scene export wild.toml").exits(0).stdout, scene);
}

/// What `slurm --dry-run` prints is fed to bash: it calls sbatch, and nothing that a folder is
/// named.
#[test]
#[cfg(unix)]
fn a_folder_named_as_a_command_is_not_run() {
    let w = Workspace::with_scenes();
    let _ = w
        .phicam("plan tiny.toml -o job --shards 2 --samples 64")
        .exits(0);
    w.write("sbatch", "#!/bin/sh\necho 7\n");
    let program = |line: &str| {
        let mut command = Command::new("bash");
        command.args(["-c", line, env!("CARGO_BIN_EXE_phicam")]);
        command.current_dir(w.path(""));
        command
    };
    assert!(program("chmod 755 sbatch").status().unwrap().success());
    for name in [
        "$(touch pwned)",
        "`touch pwned`",
        "';touch pwned;'",
        "\";touch pwned;\"",
        "a\ntouch pwned\n",
        "a\nEND_OF_SCRIPT\ntouch pwned\ncat <<'END_OF_SCRIPT'\n",
        "'\nEND_OF_SCRIPT\ntouch pwned\n#",
        "-rf",
        "--output=pwned",
        "a & touch pwned &",
        "*",
        "\u{202e}\u{1b}[31m",
        "~",
        "#",
    ] {
        fs::create_dir_all(w.path("at")).unwrap();
        let place = w.path("at").join(name);
        fs::rename(w.path("job"), &place).unwrap();
        for inside in ["", "/out"] {
            let called = program("exec \"$0\" slurm \"$1\" -o \"$2\" --dry-run")
                .arg(&place)
                .arg(format!("{}{inside}", place.display()))
                .output()
                .unwrap();
            assert!(called.status.success(), "{name}: {called:?}");
            let script = String::from_utf8(called.stdout).unwrap();
            assert!(is_harmless(&script), "{script:?}");
            let ran = program("PATH=$PWD:$PATH; cd at && bash -c \"$1\"")
                .arg(&script)
                .output();
            let ran = ran.unwrap();
            assert!(ran.status.success(), "{name}: {ran:?}\n{script}");
            // The scripts are where they belong, and name the folder and nothing else.
            assert!(place.join("slurm/merge.sh").is_file(), "{script}");
            let merge = place.join("slurm/merge.sh");
            let shown =
                program("set -- \"$1\"; exec() { printf '%s\\n' \"$*\" >called; }; . \"$1\"")
                    .arg(&merge)
                    .status();
            assert!(shown.unwrap().success());
            let called = w.text("called");
            let wanted = format!("merge {} -o {}{inside}\n", place.display(), place.display());
            assert!(called.ends_with(&wanted), "{called:?}");
        }
        for pwned in ["pwned", "at/pwned"] {
            assert!(!w.path(pwned).exists(), "{name}");
        }
        fs::rename(&place, w.path("job")).unwrap();
        fs::remove_dir_all(w.path("job/slurm")).unwrap();
    }
}

/// A shard that was cut off is missing; what is none of the plan is refused: by all alike.
#[test]
fn strays_among_the_shards_are_judged_alike() {
    let w = Workspace::with_scenes();
    let _ = w
        .phicam("plan tiny.toml -o job --shards 2 --samples 64 --seed 5")
        .exits(0);
    let _ = w
        .phicam("plan tiny.toml -o other --shards 2 --samples 64 --seed 6")
        .exits(0);
    for line in [
        "shard job --index 0",
        "shard job --index 1",
        "shard other --index 0",
    ] {
        let _ = w.phicam(line).exits(0);
    }
    let shard = |folder: &str| {
        let name = w.contents(folder).into_keys().find(|n| n.contains("-0-"));
        format!("{folder}/{}", name.unwrap())
    };
    let judged = |codes: [i32; 3], words: &[&str]| {
        let lines = ["status job", "slurm job --dry-run", "merge job -o merged"];
        for (line, code) in lines.into_iter().zip(codes) {
            let ended = w.phicam(line).exits(code);
            for word in words {
                assert!(
                    ended.stderr.contains(word),
                    "no `{word}`: {}",
                    ended.account()
                );
            }
        }
    };
    let (own, foreign) = (shard("job/shards"), shard("other/shards"));
    let whole = w.read(&own);
    w.write(&own, &whole[..whole.len() - 7]);
    judged([3, 0, 66], &["is cut off", own.rsplit('/').next().unwrap()]);
    w.write(&own, &whole);
    judged([0, 0, 0], &[]);
    fs::remove_dir_all(w.path("merged")).unwrap();
    for (name, bytes) in [
        (foreign.rsplit('/').next().unwrap(), w.read(&foreign)),
        ("notes.phs", b"something else".to_vec()),
        ("empty.phs", Vec::new()),
    ] {
        let stray = format!("job/shards/{name}");
        w.write(&stray, bytes);
        judged([65; 3], &[name]);
        fs::remove_file(w.path(&stray)).unwrap();
    }
    judged([0, 0, 0], &[]);
}

#[test]
fn clean_goes_on_past_what_it_cannot_remove() {
    let w = Workspace::with_scenes();
    let _ = w
        .phicam("plan tiny.toml -o job --shards 3 --samples 96")
        .exits(0);
    for k in 0..3 {
        let _ = w.phicam(&format!("shard job --index {k}")).exits(0);
    }
    let shards: Vec<String> = w.contents("job/shards").into_keys().collect();
    // A folder in the place of the second is nothing that can be removed as a file.
    let second = w.path("job/shards").join(&shards[1]);
    fs::remove_file(&second).unwrap();
    fs::create_dir(&second).unwrap();
    let ended = w.phicam("clean job --shards").exits(74);
    for k in [0, 2] {
        assert!(ended.stdout.contains(&shards[k]), "{}", ended.account());
        assert!(!w.path("job/shards").join(&shards[k]).exists());
    }
    assert!(!ended.stdout.contains(&shards[1]) && second.is_dir());
    let told = ended.stderr.contains(&shards[1]) && ended.stderr.contains("cannot remove");
    assert!(told, "{}", ended.account());
}

#[test]
fn a_line_without_end_is_cut_around_its_column() {
    let w = Workspace::new();
    let long = "x".repeat(1_000_000);
    let list = format!("{}nan", "1.0, ".repeat(200_000));
    for text in [
        format!("name = \"a\", {long}"),
        format!("{long} = 1"),
        format!("name = \"{long}\"\nunit = \"cm\""),
        format!("name = \"a\"\nunit = \"{long}\""),
        format!("name = \"a\"\nmax_bounces = [{list}]"),
    ] {
        w.write("long.toml", text);
        for line in ["scene check long.toml", "scene check long.toml --json"] {
            let ended = w.phicam(line).exits(2);
            let said = ended.stdout.len() + ended.stderr.len();
            assert!(said < 6000, "{said} bytes");
            assert!(ended.stderr.contains("long.toml:") && ended.stderr.contains("cure: "));
        }
    }
    let column = format!("name = \"{}\" oops \"{long}\"", "y".repeat(1000));
    w.write("long.toml", column);
    let ended = w.phicam("scene check long.toml").exits(2);
    let shown = ended.stderr.lines().find(|l| l.contains(" | ")).unwrap();
    assert!(
        shown.contains("oops") && shown.chars().count() < 220,
        "{shown}"
    );
}

#[test]
#[cfg(target_os = "linux")]
fn a_full_output_is_named() {
    let w = Workspace::with_scenes();
    let _ = w
        .phicam("plan tiny.toml -o job --shards 2 --samples 64")
        .exits(0);
    for (code, line) in [
        (2, "scene list"),
        (2, "scene export bench"),
        (2, "scene check tiny.toml"),
        (2, "--help"),
        (2, "render --help"),
        (74, "status job"),
        (74, "slurm job --dry-run"),
    ] {
        let full = fs::File::options().write(true).open("/dev/full").unwrap();
        let mut command = Command::new(env!("CARGO_BIN_EXE_phicam"));
        command.args(line.split(' ')).current_dir(w.path(""));
        let ended = command
            .stdout(full)
            .stderr(Stdio::piped())
            .output()
            .unwrap();
        let said = String::from_utf8(ended.stderr).unwrap();
        assert_eq!(ended.status.code(), Some(code), "{line}: {said}");
        for word in [
            "error: cannot write to standard output",
            "No space left",
            "cure: ",
        ] {
            assert!(said.contains(word), "{line}: {said}");
        }
        // A reader that has gone away is no error.
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let ended = command.stdout(writer).output().unwrap();
        let done = if line.starts_with("status") { 3 } else { 0 };
        assert_eq!(ended.status.code(), Some(done), "{line}: {ended:?}");
    }
}
