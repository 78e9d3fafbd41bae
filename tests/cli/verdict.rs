//! `phicam validate`: what it accepts and what it rejects.

use std::sync::OnceLock;

use crate::workspace::Workspace;

/// A finished run of the small scene in `done`; nobody writes to it.
fn run() -> &'static Workspace {
    static RUN: OnceLock<Workspace> = OnceLock::new();
    RUN.get_or_init(|| {
        let workspace = Workspace::with_scenes();
        let _ = workspace
            .phicam("render small.toml -o done --samples 1024")
            .exits(0);
        let other = workspace
            .text("small.toml")
            .replace("lambertian = 0.8", "lambertian = 0.79");
        workspace.write("grey.toml", other);
        workspace
    })
}

fn verdict(settings: &str, code: i32) -> serde_json::Value {
    let ended = run()
        .phicam(&format!("validate done --json {settings}"))
        .exits(code);
    let value: serde_json::Value =
        serde_json::from_str(&ended.stdout).unwrap_or_else(|e| panic!("{e}: {}", ended.account()));
    assert_eq!(value["agrees"], code == 0, "{}", ended.account());
    value
}

fn number(value: &serde_json::Value, key: &str) -> f64 {
    let found = value[key].as_f64();
    found.unwrap_or_else(|| panic!("no number {key} in {value}"))
}

#[test]
fn light_agrees_with_the_physical_model() {
    for settings in [
        "",
        "--kernel physical",
        "--integration quadrature",
        "--against small.toml",
    ] {
        let value = verdict(settings, 0);
        assert_eq!(value["kernel"], "physical");
        assert_eq!(value["entries"], 64 * 24);
        assert!(number(&value, "largest_z") <= number(&value, "z_limit"));
        assert!(number(&value, "chi2_per_dof") < 1.2, "{value}");
        assert!((number(&value, "best_scale") - 1.0).abs() < 0.01, "{value}");
        for key in [
            "significance",
            "dof",
            "chi2_p",
            "largest_p",
            "relative_difference",
            "relative_noise",
            "relative_discretisation",
        ] {
            assert!(number(&value, key).is_finite(), "{key}");
        }
        assert!(value["worst"][0]["z"].is_number());
    }
    // By quadrature the difference is noise alone: the χ² of 1536 entries per degree of freedom
    // scatters by √(2/1536) = 0.036, so five of that.
    let value = verdict("--integration quadrature", 0);
    assert!(
        (number(&value, "chi2_per_dof") - 1.0).abs() < 0.18,
        "{value}"
    );
    // The bound is what the last refinement changed: below the 1e-10 at which refinement stops.
    assert!(number(&value, "relative_discretisation") < 1e-10, "{value}");
}

#[test]
fn it_disagrees_with_the_published_kernel() {
    for integration in ["centres", "quadrature"] {
        let value = verdict(
            &format!("--kernel published --integration {integration}"),
            1,
        );
        assert_eq!(value["kernel"], "published");
        // The two kernels differ by tens of per cent, before and after a single scale (18 % at
        // half-width 6).
        assert!(number(&value, "relative_difference") > 0.1, "{value}");
        assert!(number(&value, "largest_z") > number(&value, "z_limit"));
    }
    let ended = run().phicam("validate done --kernel published").exits(1);
    for word in ["DISAGREE", "published", "worst entries"] {
        assert!(
            ended.stdout.contains(word),
            "no `{word}` in {}",
            ended.account()
        );
    }
}

#[test]
fn it_disagrees_where_the_spots_were_moved_in_the_model() {
    for shift in ["0.05,0", "-0.05,0", "0,0.05"] {
        let _ = verdict(&format!("--shift-spots {shift}"), 1);
    }
    let _ = verdict("--shift-spots 0,0", 0);
}

#[test]
fn it_disagrees_with_a_wall_of_another_albedo() {
    let value = verdict("--against grey.toml --integration quadrature", 1);
    // Light meets the wall twice: (0.80/0.79)².
    let scale = number(&value, "best_scale");
    assert!((scale - (0.80f64 / 0.79).powi(2)).abs() < 2e-3, "{scale}");
}

#[test]
fn the_level_decides() {
    let value = verdict("--significance 0.01", 0);
    assert_eq!(number(&value, "significance"), 0.01);
    let strict = number(&value, "z_limit");
    assert!(strict < number(&verdict("--significance 1e-9", 0), "z_limit"));
}

#[test]
#[ignore = "slow"]
fn every_plan_is_judged_by_its_own_errors() {
    let workspace = Workspace::with_scenes();
    for estimator in ["independent", "shared"] {
        for sampler in ["pcg", "sobol"] {
            let dir = format!("{estimator}-{sampler}");
            let plan = format!("--estimator {estimator} --sampler {sampler} --samples 4096");
            let _ = workspace
                .phicam(&format!("render small.toml -o {dir} {plan}"))
                .exits(0);
            let line = format!("validate {dir} --integration quadrature");
            let _ = workspace.phicam(&line).exits(0);
            let _ = workspace
                .phicam(&format!("{line} --kernel published"))
                .exits(1);
        }
    }
}

#[test]
fn frames_alone_are_enough() {
    let workspace = Workspace::with_scenes();
    let _ = workspace.phicam("render small.toml -o done").exits(0);
    for file in ["done/phi.npy", "done/phi.stderr.npy"] {
        std::fs::remove_file(workspace.path(file)).unwrap();
    }
    let _ = workspace.phicam("stack done").exits(0);
    let _ = workspace.phicam("validate done").exits(0);
    let _ = workspace
        .phicam("validate done --kernel published")
        .exits(1);
}
