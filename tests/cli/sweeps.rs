//! `phicam study noise` and `phicam study indicator`: files, refusals, going on.

use crate::workspace::{Workspace, assert_same};

const NOISE: &str =
    "study noise small.toml --boards 2,4 --elements 2,4 --noise 1e-6,0.01 --method pinv,joint";

#[test]
fn noise_is_a_table_figures_and_json() {
    let workspace = Workspace::with_scenes();
    let ended = workspace
        .phicam(&format!("{NOISE} -o n --seeds 3 --render-samples 16"))
        .exits(0);
    for word in ["4 × 4", "joint", "norm. 0.5", "shared"] {
        assert!(
            ended.stdout.contains(word),
            "no `{word}`: {}",
            ended.account()
        );
    }
    // Objects (2, 2), (2, 4) and (4, 4), two methods, two levels, three draws; two lines above
    // them.
    assert_eq!(
        workspace.text("n/noise.csv").lines().count(),
        3 * 2 * 2 * 3 + 2
    );
    assert_eq!(
        workspace.text("n/noise-curves.csv").lines().count(),
        3 * 2 * 2 + 1
    );
    let json = workspace.json("n/noise.json");
    assert_eq!(json["curves"].as_array().unwrap().len(), 6, "{json}");
    assert_eq!(json["render_noise"].as_array().unwrap().len(), 2, "{json}");
    for measure in ["mtf-raw", "mtf-normalized", "correlation", "rmse"] {
        let figure = workspace.text(&format!("n/noise-{measure}.svg"));
        assert!(
            figure.contains("joint") && !figure.contains("NaN"),
            "{measure}"
        );
    }
}

/// A finished study is not computed again, and what is not whole of it is: the bytes stay those of
/// one that ran through on other threads.
#[test]
fn finished_noise_is_kept() {
    let workspace = Workspace::with_scenes();
    let _ = workspace
        .phicam(&format!("{NOISE} -o one --seeds 4 --threads 1"))
        .exits(0);
    let line = format!("{NOISE} -o two --seeds 4");
    let first = workspace.phicam(&line).exits(0);
    let whole = |folder| {
        let mut contents = workspace.contents(folder);
        let kept = contents.remove("noise.phs").expect("the finished tasks");
        (contents, kept)
    };
    let [(one, _), (two, kept)] = ["one", "two"].map(whole);
    assert_same(&one, &two, "one thread and all");
    let again = workspace.phicam(&line).exits(0);
    assert!(
        again.stderr.contains("going on from 6 of 6 tasks"),
        "{}",
        again.account()
    );
    assert_eq!(again.stdout, first.stdout);
    assert!(whole("two") == (two, kept.clone()), "written again");
    workspace.write("two/noise.phs", &kept[..kept.len() - 1]);
    let anew = workspace.phicam(&line).exits(0);
    assert!(!anew.stderr.contains("going on"), "{}", anew.account());
    assert_same(&one, &whole("two").0, "straight and anew");
}

/// Every axis says in table, JSON, CSV and figure what its levels are.
#[test]
fn every_axis_of_noise_names_its_levels() {
    let workspace = Workspace::with_scenes();
    for (axis, column, title) in [
        ("photons", "photons_per_pixel", "photons per pixel"),
        ("exposure", "exposure_s", "exposure of a frame / s"),
        ("glare", "glare_over_signal", "glare over signal, even"),
        ("bits", "bits", "bits of the converter"),
        ("scale", "scale_error", "error of the absolute scale"),
    ] {
        let line = "study noise small.toml --boards 2 --elements 2 --method pinv,joint --seeds 2";
        let ended = workspace
            .phicam(&format!("{line} --axis {axis} -o {axis}"))
            .exits(0);
        let table = &ended.stdout;
        assert!(
            table.contains(title) && table.contains("The best method"),
            "{table}"
        );
        let curves = workspace.text(&format!("{axis}/noise-curves.csv"));
        let header = curves.lines().next().unwrap();
        assert!(header.split(',').any(|name| name == column), "{header}");
        let json = workspace.json(&format!("{axis}/noise.json"));
        assert_eq!(json["best"].as_array().unwrap().len(), 1, "{json}");
        assert!(
            json["curves"][0]["points"][0]["cramer_rao"]
                .as_f64()
                .unwrap()
                > 0.0
        );
        let figure = workspace.text(&format!("{axis}/noise-rmse.svg"));
        assert!(figure.contains(title) && figure.contains("Cramér–Rao") && !figure.contains("NaN"));
    }
}

#[test]
fn noise_of_another_study_is_not_mixed_in() {
    let workspace = Workspace::with_scenes();
    let _ = workspace
        .phicam(&format!("{NOISE} -o n --seeds 1"))
        .exits(0);
    let other = format!("{NOISE} -o n --seeds 1 --kernel published");
    let words = ["another study", "--kernel", "published", "(-o)"];
    workspace.refuses(&other, &words);
    workspace.refuses("study noise tiny.toml -o n", &["another study", "scene"]);
    let photons = format!("{NOISE} -o n --seeds 1 --axis photons").replace("1e-6,0.01", "1e6");
    workspace.refuses(&photons, &["another study", "(-o)"]);
    let glare = |rest: &str| {
        let line = format!("{NOISE} --seeds 1 -o g --axis glare {rest}");
        line.replace("1e-6,0.01", "0.01")
    };
    let _ = workspace.phicam(&glare("--sensor ccd")).exits(0);
    let _ = workspace.phicam(&glare("--sensor ccd")).exits(0);
    for (rest, word) in [("--sensor dslr", "dslr"), ("--falloff 2", "ccd")] {
        workspace.refuses(&glare(rest), &["another study", word, "(-o)"]);
    }
    workspace.write("n/noise.phs", "a letter");
    workspace.refuses(&format!("{NOISE} -o n --seeds 1"), &["is no shard"]);
}

#[test]
fn bad_sweeps_are_refused() {
    let workspace = Workspace::with_scenes();
    for (line, words) in [
        ("noise small.toml -o n --noise 0", ["--noise 0", "cure"]),
        (
            "noise small.toml -o n --noise 1e-3,-1",
            ["--noise -1", "cure"],
        ),
        ("noise small.toml -o n --noise nan", ["--noise NaN", "cure"]),
        (
            "noise small.toml -o n --axis photons --noise 0",
            ["--noise 0", "above 0"],
        ),
        (
            "noise small.toml -o n --axis bits --levels 8.5",
            ["--noise 8.5", "from 4 to 24"],
        ),
        (
            "noise small.toml -o n --axis bits --sensor ccd",
            ["--sensor", "--axis exposure or glare"],
        ),
        (
            "noise small.toml -o n --axis exposure --falloff 1",
            ["--falloff", "--axis glare"],
        ),
        (
            "noise small.toml -o n --axis glare --falloff -1",
            ["--falloff -1", "above 0"],
        ),
        (
            "noise small.toml -o n --axis glare --sensor eye",
            ["`eye`", "use one of"],
        ),
        (
            "noise small.toml -o n --axis exposure --noise 1e30",
            ["saturates", "use exposures below"],
        ),
        (
            "noise small.toml -o n --axis bits --render-samples 16",
            ["axis bits", "--render-samples"],
        ),
        (
            "noise small.toml -o n --axis scale --noise 1.5",
            ["--noise 1.5", "not above 1"],
        ),
        ("noise small.toml -o n --boards 1", ["--boards 1", "cure"]),
        (
            "noise small.toml -o n --elements 0",
            ["--elements 0", "cure"],
        ),
        (
            "noise small.toml -o n --elements 3",
            ["multiple", "use e.g."],
        ),
        (
            "noise small.toml -o n --method lsqr",
            ["lsqr", "choose one of"],
        ),
        ("noise small.toml -o n --seeds 0", ["--seeds", "0"]),
        (
            "noise small.toml -o n --render-samples 0",
            ["--render-samples 0", "cure"],
        ),
        ("noise small.toml -o n --threads 0", ["--threads", "use 1"]),
        ("indicator small.toml -o n --spots 0", ["--spots 0", "cure"]),
        (
            "indicator small.toml -o n --half-widths -3",
            ["--half-widths -3", "cure"],
        ),
        (
            "indicator small.toml -o n --half-widths inf",
            ["--half-widths inf", "cure"],
        ),
        (
            "indicator small.toml -o n --elements 7",
            ["multiple", "use e.g."],
        ),
        ("indicator small.toml -o n --noise 2", ["--noise 2", "cure"]),
        (
            "indicator small.toml -o n --method lsqr",
            ["lsqr", "choose one of"],
        ),
        ("indicator small.toml -o n --every 0", ["--every", "0"]),
        ("indicator small.toml -o n --seeds 1", ["--seeds", "1"]),
    ] {
        let ended = workspace.phicam(&format!("study {line}")).exits(2);
        for word in words {
            assert!(
                ended.stderr.contains(word),
                "no `{word}`: {}",
                ended.account()
            );
        }
        assert!(
            !workspace.path("n/noise.json").exists()
                && !workspace.path("n/indicator.json").exists()
        );
    }
    for study in ["noise", "indicator"] {
        let ended = workspace
            .phicam(&format!("study {study} furnace -o f"))
            .exits(2);
        assert!(ended.stderr.contains("hidden"), "{}", ended.account());
    }
}

#[test]
fn indicator_is_a_table_a_figure_and_json() {
    let workspace = Workspace::with_scenes();
    let line = "study indicator small.toml -o i --spots 8,40 --half-widths 2,5 --elements 2,4 --boards 2 --noise 1e-4 --every 11 --seeds 20";
    let ended = workspace.phicam(line).exits(0);
    for word in [
        "condition number",
        "Spearman",
        "joint-unbounded",
        "96 configurations",
    ] {
        assert!(
            ended.stdout.contains(word),
            "no `{word}`: {}",
            ended.account()
        );
    }
    let json = workspace.json("i/indicator.json");
    // Six layouts, two numbers, two half-widths, two numbers of elements, two kernels; under noise
    // each eleventh by four methods.
    assert_eq!(
        json["configurations"].as_array().unwrap().len(),
        96,
        "{json}"
    );
    assert_eq!(workspace.text("i/indicator.csv").lines().count(), 97);
    assert_eq!(json["points"].as_array().unwrap().len(), 9 * 4);
    assert_eq!(
        workspace.text("i/indicator-noise.csv").lines().count(),
        9 * 4 + 1
    );
    let page = workspace.text("i/report.html");
    assert!(
        page.contains("predicted best by") && page.contains("download=\"indicator-noise.csv\"")
    );
    let figure = workspace.text("i/indicator.svg");
    assert!(figure.contains("condition number") && !figure.contains("NaN"));
}

/// Ctrl-C as soon as the first tasks are on disk: exit code 130, they are kept, and the same
/// command goes on from them to the bytes of one that ran through.
#[cfg(unix)]
#[test]
fn ctrl_c_keeps_the_finished_tasks() {
    use std::process::{Command, Stdio};
    use std::time::{Duration, Instant};

    let workspace = Workspace::with_scenes();
    let child = Command::new(env!("CARGO_BIN_EXE_phicam"))
        .args(NOISE.split_whitespace())
        .args(["-o", "cut", "--seeds", "400"])
        .current_dir(workspace.path(""))
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    let start = Instant::now();
    while !workspace.path("cut/noise.phs").exists() && start.elapsed() < Duration::from_secs(60) {
        std::thread::sleep(Duration::from_millis(1));
    }
    // A process that has ended is not reaped before `wait_with_output`, so its id is nobody else's.
    let signal = format!("kill -INT {}", child.id());
    let sent = Command::new("sh").args(["-c", &signal]).status();
    assert!(sent.expect("a shell").success());
    let output = child.wait_with_output().expect("it ends");
    let words = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(130), "{words}");
    for word in ["stopped", "kept in cut", "same command"] {
        assert!(words.contains(word), "no `{word}` in {words}");
    }
    assert!(!workspace.path("cut/noise.json").exists());
    assert!(!workspace.path("cut/noise.csv").exists());
    let at = words.find("stopped: ").expect("how far it came") + 9;
    let kept: String = words[at..]
        .chars()
        .take_while(char::is_ascii_digit)
        .collect();
    assert!(kept.parse::<u64>().expect("a number") > 0, "{words}");
    workspace.refuses(&format!("{NOISE} -o cut --seeds 2"), &["another study"]);
    let line = |folder| format!("{NOISE} --seeds 400 -o {folder}");
    let ended = workspace.phicam(&line("cut")).exits(0);
    let going_on = format!("going on from {kept} of 600 tasks");
    assert!(ended.stderr.contains(&going_on), "{}", ended.account());
    let _ = workspace.phicam(&line("whole")).exits(0);
    let [mut cut, mut whole] = ["cut", "whole"].map(|folder| workspace.contents(folder));
    assert!(cut.remove("noise.phs").is_some() && whole.remove("noise.phs").is_some());
    assert_same(&cut, &whole, "gone on and straight");
}
