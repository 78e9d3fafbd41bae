//! `phicam calibrate`: the geometry, from the photographs.

use std::path::{Path, PathBuf};

use super::args::CalibrateArgs;
use super::beside::frame_gain;
use super::console::Console;
use super::failure::{Failure, NOTHING_KEPT};
use super::findings::deliver;
use super::load_run::{read_bare_scene, read_run};
use super::process::{pool, version};
use super::run_folder::{CALIBRATED, PHI, RunFolder, STDERR};
use super::unexplained::{Photographs, elements};
use super::{Outcome, progress};
use crate::folder::{Record, write_copies};
use crate::jobs::need;
use crate::lab::finding::Describe;
use crate::lab::{CalibrationPlan, Found, Free, Work};
use crate::report::Invocation;
use crate::scene::Scene;

pub(super) fn execute(args: &CalibrateArgs, console: Console) -> Result<Outcome, Failure> {
    let (scene, record) = if args.phi.is_some() && !args.dir.join(Record::FILE).exists() {
        (read_bare_scene(&args.dir, console)?, None)
    } else {
        let (scene, record) = read_run(&args.dir, console)?;
        (scene, Some(record))
    };
    let own = record.as_ref().filter(|_| args.phi.is_none());
    let origin = own.map(|record| &record.origin);
    let plan = CalibrationPlan {
        frame_gain: frame_gain(args.frame_gain, origin, console),
        ..plan(args, &scene, console)
    };
    need::calibrate(&scene, plan.elements)?;
    let (left_out, polynomial) = (args.left_out.as_deref(), args.frame_polynomial);
    let photographs = match (&args.phi, &record) {
        (None, Some(record)) => {
            let beside = (polynomial, args.background);
            Photographs::read(&args.dir, (&scene, record), left_out, beside)?
        }
        (phi, _) => {
            let phi = phi.clone().unwrap_or_else(|| args.dir.join(PHI));
            let beside = [args.stderr.as_deref(), left_out];
            Photographs::of_files(&phi, beside, &scene, polynomial)?
        }
    };
    let output = args
        .output
        .clone()
        .unwrap_or_else(|| args.dir.join(CALIBRATED));
    let lock = RunFolder::lock(&output, "phicam calibrate")?;
    let pool = pool(args.threads)?;
    let what = format!("calibrate {}", scene.name);
    let found = progress::run(console, &what, Work::Tasks(plan.work()), |control| {
        pool.install(|| plan.calibrate(&scene, &photographs.unexplained(args.replicates), control))
    });
    let calibration = match found {
        Ok(calibration) => calibration,
        Err(e) => {
            drop(lock);
            // Nothing is left where nothing was done.
            let _ = std::fs::remove_dir(&output);
            return Err(Failure::of(e.into()).if_stopped(NOTHING_KEPT));
        }
    };
    let found = Found {
        json: serde_json::to_string_pretty(&calibration).map_err(|e| Failure::of(e.into()))?,
        finding: calibration.describe(),
        agrees: calibration.is_found(),
    };
    let asked = invocation(args, &plan.free, &scene);
    deliver("calibration", &found, &output, &asked, args.json)?;
    write_copies(&output, &scene)?;
    console.say(format!(
        "{}: written; scene.toml there is the calibrated scene: `{}`",
        output.display(),
        recovering(args, plan.frame_gain, &output)
    ));
    Ok(if found.agrees {
        Outcome::Done
    } else {
        Outcome::Disagreed
    })
}

/// The command that recovers by the calibrated scene from the same photographs.
fn recovering(args: &CalibrateArgs, frame_gain: Option<f64>, calibrated: &Path) -> String {
    let own = |name: &str| Some(args.dir.join(name)).filter(|file| file.exists());
    let (phi, stderr) = match &args.phi {
        Some(phi) => (phi.clone(), args.stderr.clone()),
        None => (args.dir.join(PHI), own(STDERR)),
    };
    let mut command = format!(
        "phicam recover {} --phi {}",
        calibrated.display(),
        phi.display()
    );
    for (option, file) in [("--stderr", stderr), ("--left-out", args.left_out.clone())] {
        if let Some(file) = file {
            command += &format!(" {option} {}", file.display());
        }
    }
    if let Some(replicates) = args.replicates {
        command += &format!(" --replicates {replicates}");
    }
    if let Some(degree) = args.frame_polynomial {
        command += &format!(" --frame-polynomial {degree}");
    }
    for (option, is_set) in [
        ("--background", args.background),
        ("--free-scale", args.free_scale),
    ] {
        if is_set {
            command += &format!(" {option}");
        }
    }
    if args.error_field {
        command += " --method joint-gp --error-field";
    }
    if let Some(gain) = frame_gain {
        command += &format!(" --frame-gain {gain}");
    }
    command
}

/// What is to be done, with what is not given.
fn plan(args: &CalibrateArgs, scene: &Scene, console: Console) -> CalibrationPlan {
    CalibrationPlan {
        free: free(&args.free, scene),
        frame_gain: args.frame_gain,
        is_scale_free: args.free_scale,
        error_field: args.error_field,
        background: args.background,
        elements: elements(args.elements, scene, console),
        occlusion: args.occlusion.occlusion(),
        integration: args.integration,
        starts: usize::from(args.starts),
        spread: args.spread,
        seed: args.seed,
    }
}

/// What is free, with what the scene knows of it; all that it is uncertain of unless something is
/// named.
fn free(given: &[Free], scene: &Scene) -> Vec<Free> {
    let stated = |name: &str| {
        let own = scene.uncertainty.iter().find(|(own, _)| own == name);
        own.map(|(_, sigma)| *sigma)
    };
    if given.is_empty() {
        let all = scene.uncertainty.iter();
        return all
            .map(|(name, sigma)| Free {
                name: name.clone(),
                sigma: Some(*sigma),
            })
            .collect();
    }
    let known = |free: &Free| Free {
        sigma: free.sigma.or_else(|| stated(&free.name)),
        ..free.clone()
    };
    given.iter().map(known).collect()
}

/// How to ask for it again.
fn invocation(args: &CalibrateArgs, free: &[Free], scene: &Scene) -> Invocation {
    let dir = args.dir.file_name().unwrap_or(args.dir.as_os_str());
    let of = |f: &Free| match f.sigma {
        Some(sigma) => format!("{}={sigma}", f.name),
        None => f.name.clone(),
    };
    let free: Vec<String> = free.iter().map(of).collect();
    let mut options = vec![
        ("--free".to_owned(), free.join(",")),
        ("--starts".to_owned(), args.starts.to_string()),
        ("--spread".to_owned(), args.spread.to_string()),
        ("--seed".to_owned(), args.seed.to_string()),
        (
            "--integration".to_owned(),
            args.integration.name().to_owned(),
        ),
    ];
    let mut given = |name: &str, value: Option<String>| {
        options.extend(value.map(|value| (name.to_owned(), value)));
    };
    let path = |p: &Option<PathBuf>| p.as_ref().map(|p| p.to_string_lossy().into_owned());
    given("--phi", path(&args.phi));
    given("--stderr", path(&args.stderr));
    given("--replicates", args.replicates.map(|n| n.to_string()));
    given("--frame-gain", args.frame_gain.map(|x| x.to_string()));
    given("--free-scale", args.free_scale.then(String::new));
    given("--error-field", args.error_field.then(String::new));
    given("--background", args.background.then(String::new));
    given(
        "--elements",
        args.elements.map(|n| n.map(|x| x.to_string()).join("x")),
    );
    given(
        "--frame-polynomial",
        args.frame_polynomial.map(|n| n.to_string()),
    );
    given("--left-out", path(&args.left_out));
    options.extend(args.occlusion.again());
    Invocation {
        command: vec!["calibrate".to_owned(), dir.to_string_lossy().into_owned()],
        scene: scene.clone(),
        file: "scene.toml".to_owned(),
        options,
        version: version().to_owned(),
    }
}
