//! `phicam calibrate`: the geometry, from the photographs.

use std::path::Path;

use super::beside::frame_gain;
use super::recovered::of_surface;
use super::spelled::Spelled;
use super::unexplained::{asked, elements, photographs, scene_of};
use crate::cli::args::CalibrateArgs;
use crate::cli::console::Console;
use crate::cli::failure::{Failure, NOTHING_KEPT};
use crate::cli::findings;
use crate::cli::output;
use crate::cli::process::pool;
use crate::cli::run_folder::{CALIBRATED, PHI, RunFolder, STDERR};
use crate::cli::{Outcome, progress};
use crate::folder::write_copies;
use crate::jobs::need;
use crate::lab::finding::Describe;
use crate::lab::options::OptionError;
use crate::lab::{Calibration, CalibrationPlan, Found, Free, Work};
use crate::matrix::{Matrix, npy};
use crate::recovery::Method;
use crate::report::Invocation;
use crate::scene::Scene;
use crate::store::write_together;

pub(in crate::cli) fn execute(args: &CalibrateArgs, console: Console) -> Result<Outcome, Failure> {
    let of = &args.photographs;
    if args.starts == 1 {
        let given = [
            ("seed", args.seed.is_some()),
            ("spread", args.spread.is_some()),
        ];
        OptionError::refuse_idle(&given, "--starts 1 has no start at random")?;
    }
    let (scene, record) = scene_of(of, console)?;
    let origin = record.as_ref().map(|record| &record.origin);
    let plan = CalibrationPlan {
        frame_gain: frame_gain(args.frame_gain, origin, console),
        ..plan(args, &scene, console)
    };
    need::calibrate(&scene, plan.elements)?;
    let photographs = photographs(of, (&scene, record.as_ref()))?;
    let output = args.output.clone();
    let output = output.unwrap_or_else(|| of.dir.join(CALIBRATED));
    output::refuse_run(&output)?;
    let lock = RunFolder::lock(&output, "phicam calibrate")?;
    let pool = pool(of.threads)?;
    let what = format!("calibrate {}", scene.name);
    let found = progress::run(console, &what, Work::Tasks(plan.work()), |control| {
        pool.install(|| plan.calibrate(&scene, &photographs.unexplained(), control))
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
        json: serde_json::to_string_pretty(&calibration)?,
        finding: calibration.describe(),
        agrees: calibration.is_found(),
    };
    let again = invocation(args, &plan.free, &scene);
    write_together(&output, |staged| {
        findings::write("calibration", &found, staged, &again)?;
        write_copies(staged, &scene)?;
        write_picture(staged, &calibration)
    })?;
    let outcome = findings::tell(&found, of.json)?;
    console.say(format!(
        "{0}: written; scene.toml there is the calibrated scene, {2}.npy the picture by it, whose errors have those of \
         the geometry in: `phicam recover {0}{1}` compares other pictures, whose errors have not",
        output.display(),
        recovering(args, plan.frame_gain),
        Method::JointGp
    ));
    Ok(outcome)
}

/// Writes the picture with the calibrated geometry as `phicam recover` names its files,
/// joint-gp.npy and joint-gp.stderr.npy (nv × nu), joint-gp.covariance.npy (own elements × elements
/// of all surfaces) where it is made, all with the errors of the geometry; joint-gp-0, … where
/// several surfaces are hidden. Numbers are those of `grids` in calibration.json. Returns the names
/// of those that are not made.
fn write_picture(folder: &Path, calibration: &Calibration) -> Result<Vec<String>, Failure> {
    let mut stale = Vec::new();
    let mut first = 0;
    for (i, grid) in calibration.grids.iter().enumerate() {
        let [nu, nv] = grid.count;
        let suffix = of_surface([i, calibration.grids.len()]);
        let name = |what: &str| format!("{}{suffix}.{what}", Method::JointGp);
        for (what, values) in [("npy", &grid.values), ("stderr.npy", &grid.stderr)] {
            let picture = Matrix::from_row_slice(nv, nu, values);
            npy::write(&folder.join(name(what)), &picture)?;
        }
        let own = name("covariance.npy");
        match &calibration.covariance {
            Some(all) => npy::write(&folder.join(&own), &all.rows(first, nu * nv).into_owned())?,
            None => stale.push(own),
        }
        first += nu * nv;
    }
    Ok(stale)
}

/// With what the same photographs are recovered by the calibrated scene.
fn recovering(args: &CalibrateArgs, frame_gain: Option<f64>) -> Spelled {
    let of = &args.photographs;
    let own = |name: &str| Some(of.dir.join(name)).filter(|file| file.exists());
    let (phi, stderr) = match &of.phi {
        Some(phi) => (phi.clone(), of.stderr.clone()),
        None => (of.dir.join(PHI), own(STDERR)),
    };
    Spelled::default()
        .file("--phi", Some(&phi))
        .file("--stderr", stderr.as_deref())
        .file("--left-out", of.left_out.as_deref())
        .maybe("--replicates", of.replicates)
        .maybe("--frame-polynomial", of.frame_polynomial)
        .flag("--background", of.background)
        .flag("--free-scale", args.free_scale)
        .maybe("--method", args.error_field.then_some("joint-gp"))
        .flag("--error-field", args.error_field)
        .maybe("--frame-gain", frame_gain)
}

/// What is to be done, with what is not given.
fn plan(args: &CalibrateArgs, scene: &Scene, console: Console) -> CalibrationPlan {
    let of = &args.photographs;
    CalibrationPlan {
        free: free(&args.free, scene),
        frame_gain: args.frame_gain,
        is_scale_free: args.free_scale,
        error_field: args.error_field,
        background: of.background,
        elements: elements(of.elements, scene, console),
        occlusion: of.occlusion.occlusion(),
        integration: of.integration,
        starts: usize::from(args.starts),
        spread: args.spread.unwrap_or(1.0),
        seed: args.seed.unwrap_or(1),
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
    let of = |f: &Free| match f.sigma {
        Some(sigma) => format!("{}={sigma}", f.name),
        None => f.name.clone(),
    };
    let free: Vec<String> = free.iter().map(of).collect();
    let options = Spelled::default()
        .with("--free", free.join(","))
        .with("--starts", args.starts)
        .maybe("--spread", args.spread)
        .maybe("--seed", args.seed)
        .maybe("--frame-gain", args.frame_gain)
        .flag("--free-scale", args.free_scale)
        .flag("--error-field", args.error_field);
    let of = &args.photographs;
    asked(of, options).of_folder("calibrate", &of.dir, scene)
}
