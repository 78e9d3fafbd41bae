//! The same seed gives the same bytes, whatever the threads and the division of the work.

use crate::small_scene::{TINY, altered};
use crate::workspace::{Contents, Workspace, assert_same};

const PLANS: [&str; 4] = [
    "--estimator independent --sampler sobol",
    "--estimator independent --sampler pcg",
    "--estimator shared --sampler sobol",
    "--estimator shared --sampler pcg",
];

/// The tiny scene with light of 3, 5 and 7 bounces: the order in which three numbers are added
/// shows in the last bit.
fn workspace() -> Workspace {
    let workspace = Workspace::new();
    let bounces = ("max_bounces = 3", "max_bounces = 7");
    workspace.write("tiny.toml", altered(TINY.iter().chain([&bounces])));
    workspace
}

/// Renders into `dir`, and returns all files but the record, which has the times.
fn rendered(workspace: &Workspace, dir: &str, settings: &str) -> Contents {
    let line = format!("render tiny.toml -o {dir} --samples 200 {settings}");
    let _ = workspace.phicam(&line).exits(0);
    workspace.rendered(dir)
}

fn assert_complete(files: &Contents) {
    let names: Vec<&str> = files.keys().map(String::as_str).collect();
    assert_eq!(names.iter().filter(|n| n.ends_with(".exr")).count(), 8);
    assert!(
        names.contains(&"phi.npy") && names.contains(&"phi.stderr.npy"),
        "{names:?}"
    );
}

#[test]
#[ignore = "slow"]
fn threads_change_no_byte() {
    let workspace = workspace();
    for (n, plan) in PLANS.iter().enumerate() {
        let of = |threads: usize| {
            let settings = format!("{plan} --threads {threads}");
            rendered(&workspace, &format!("{n}-{threads}"), &settings)
        };
        let one = of(1);
        assert_complete(&one);
        for threads in [2, 3] {
            assert_same(
                &one,
                &of(threads),
                &format!("{plan}, 1 and {threads} threads"),
            );
        }
    }
}

#[test]
#[ignore = "slow"]
fn another_seed_changes_every_result() {
    let workspace = workspace();
    for (n, plan) in PLANS.iter().enumerate() {
        let of = |seed: u64| {
            rendered(
                &workspace,
                &format!("{n}-{seed}"),
                &format!("{plan} --seed {seed}"),
            )
        };
        let (a, b) = (of(1), of(2));
        for name in a
            .keys()
            .filter(|n| n.ends_with("exr") || n.ends_with("npy"))
            // No entry of either may be in doubt.
            .filter(|n| !n.ends_with("tails.npy"))
        {
            assert_ne!(a[name], b[name], "{plan}: {name}");
        }
        // Not only what the header says of the seed.
        let [a, b] = [1, 2].map(|seed| workspace.matrix(&format!("{n}-{seed}/phi.npy")));
        assert!(a.iter().zip(&b).all(|(a, b)| a != b), "{plan}");
    }
}

#[test]
#[ignore = "slow"]
fn parts_of_a_run_in_any_order_give_its_bytes() {
    let workspace = workspace();
    for (n, plan) in PLANS.iter().enumerate() {
        let whole = rendered(&workspace, &format!("{n}-whole"), plan);
        assert_complete(&whole);
        let orders: [&[&str]; 4] = [
            &["--spots 0..3", "--spots 3..8"],
            &["--spots 5..8", "--spots 0..2", "--spots 2..5"],
            &["--spots 0..3", "--resume"],
            &[
                "--spots 2..4",
                "--spots 6..7 --resume",
                "--resume --threads 1",
            ],
        ];
        // How the work is divided is the estimator's; the sampler sees nothing of it but the first
        // order, for certainty.
        let tried = if plan.contains("sobol") { 4 } else { 1 };
        for (k, parts) in orders.iter().take(tried).enumerate() {
            let dir = format!("{n}-parts-{k}");
            let mut last = Contents::new();
            for part in *parts {
                assert!(
                    !last.contains_key("phi.npy"),
                    "phi.npy before the last part"
                );
                last = rendered(&workspace, &dir, &format!("{plan} {part}"));
            }
            assert_same(&whole, &last, &format!("{plan}: {parts:?}"));
        }
    }
}

#[test]
fn a_part_rendered_again_leaves_a_whole_run() {
    let workspace = workspace();
    let whole = rendered(&workspace, "out", "");
    let _ = rendered(&workspace, "out", "--spots 0..3");
    let again = rendered(&workspace, "out", "--resume");
    assert_same(&whole, &again, "a part rendered again");
    assert_eq!(workspace.json("out/run.json")["finished"], 8);
}

#[test]
fn a_damaged_part_is_rendered_again() {
    let workspace = workspace();
    let whole = rendered(&workspace, "whole", "");
    let _ = rendered(&workspace, "out", "--spots 0..3");
    let kept = workspace.read("out/partial/spots-0000-0003.phs");
    workspace.write("out/partial/spots-0000-0003.phs", &kept[..kept.len() / 2]);
    assert_same(&whole, &rendered(&workspace, "out", "--resume"), "resumed");
}

/// Elementary functions of the system's C library are chosen by the processor's features, and their
/// last bits differ; those of the tracer come from elsewhere. Seen from outside: with the features
/// taken away, the bytes stay. (Where the C library is not glibc, nothing is taken away.)
#[test]
#[ignore = "slow"]
fn processor_features_change_no_byte() {
    let workspace = workspace();
    // Wide spots: each path draws a point of a Gaussian beam.
    let wide = |text: String| {
        if text.contains("spot_diameter = 0.0") {
            text.replace("spot_diameter = 0.0", "spot_diameter = 0.5")
        } else {
            text.replace("[laser]", "[laser]\nspot_diameter = 0.5")
        }
    };
    workspace.write("tiny.toml", wide(workspace.text("tiny.toml")));
    let _ = workspace
        .phicam("scene export satin -o satin.toml")
        .exits(0);
    let satin = workspace
        .text("satin.toml")
        .replace("per_side = 30", "per_side = 2")
        .replace("pixels = [16, 16]", "pixels = [4, 4]");
    workspace.write("satin.toml", wide(satin));
    let render = |scene: &str, dir: &str, plan: &str, features: &str| {
        let line = format!("render {scene} -o {dir} --samples 1024 {plan}");
        let status = std::process::Command::new(env!("CARGO_BIN_EXE_phicam"))
            .args(line.split_whitespace())
            .current_dir(workspace.path(""))
            .env("GLIBC_TUNABLES", features)
            .output()
            .expect("the program starts");
        assert!(status.status.success(), "{line}: {status:?}");
        let mut files = workspace.contents(dir);
        assert!(files.remove("run.json").is_some());
        files
    };
    let none =
        "glibc.cpu.hwcaps=-AVX512F,-AVX512VL,-AVX2,-AVX,-FMA,-FMA4,-SSE4_2,-SSE4_1,-BMI2,-ERMS";
    for (n, (scene, plan)) in [
        ("tiny.toml", "--estimator independent"),
        ("tiny.toml", "--estimator factored"),
        ("satin.toml", "--estimator shared"),
        ("satin.toml", "--estimator factored"),
    ]
    .into_iter()
    .enumerate()
    {
        let all = render(scene, &format!("all-{n}"), plan, "");
        let few = render(scene, &format!("few-{n}"), plan, none);
        assert_same(&all, &few, &format!("{scene} {plan}"));
    }
}
