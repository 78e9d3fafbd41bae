//! `phicam study noise`: every method under growing noise, gone on with where it was left.

use std::fs;
use std::io::ErrorKind;
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::OnceLock;
use std::time::{Duration, Instant};

use super::findings::Findings;
use super::job::{Count, Job};
use crate::cli::args::{AxisName, NoiseArgs, StudyArgs};
use crate::cli::failure::Failure;
use crate::cli::interrupt::stop_flag;
use crate::cli::output::{self, Talk};
use crate::cli::trust;
use crate::cli::{Outcome, progress, settings};
use crate::num::stream::Sampling;
use crate::recovery::Method;
use crate::report::{self, Asked, Measure};
use crate::scene::{Scene, Spread};
use crate::store::ensure_writable;
use crate::study::{
    NamedSensor, NoiseAxis, NoiseFinding, NoisePlan, NoiseTasks, Trial, read_ledger, write_ledger,
};
use crate::transport::Control;

/// Finished trials are on disk from the first few on, and at least this often.
const KEEP_EVERY: Duration = Duration::from_secs(5);

pub(super) fn execute(args: &NoiseArgs, whole: &StudyArgs, talk: Talk) -> Result<Outcome, Failure> {
    let scene = trust::load(&args.scene)?;
    let job = job(args, &scene, super::asked(whole, &scene))?;
    let pool = settings::pool(args.threads)?;
    let path = args.output.join("noise.csv");
    let name = job.division.name();
    let known = known(&path, &name)?;
    ensure_writable(&args.output)?;
    talk.warn(&scene);
    if !known.is_empty() {
        talk.say(format!(
            "going on from {} trials in {}",
            known.len(),
            path.display()
        ));
    }

    let mut trials = known.clone();
    let mut failed = None;
    let mut last: Option<Instant> = None;
    let bar = progress::steps(talk, &job.what);
    bar.set_length(job.division.trials() as u64);
    let mut keep = |new: &[Trial]| {
        trials.extend_from_slice(new);
        bar.inc(new.len() as u64);
        if last.is_none_or(|l| l.elapsed() >= KEEP_EVERY) {
            last = Some(Instant::now());
            if let Err(failure) = output::deliver(&write_ledger(&name, &trials), Some(&path)) {
                failed = Some(failure);
                return ControlFlow::Break(());
            }
        }
        ControlFlow::Continue(())
    };
    let tick = |_| bar.tick();
    let control = Control {
        progress: &tick,
        stop: stop_flag(),
    };
    let found = pool.install(|| job.division.go_on(&known, control, &mut keep))?;
    bar.finish_and_clear();
    if let Some(failure) = failed {
        return Err(failure);
    }
    let Some(found) = found else {
        output::deliver(&write_ledger(&name, &trials), Some(&path))?;
        return Err(Failure::Stopped(format!(
            "{} trials are finished and kept in {}; go on with the same command",
            trials.len(),
            path.display()
        )));
    };
    job.leave(&found, &args.output)
}

/// The study, ready: also without what an earlier run has finished.
pub(super) fn job(
    args: &NoiseArgs,
    scene: &Scene,
    asked: Asked,
) -> Result<Job<NoiseTasks>, Failure> {
    let plan = plan(args, scene)?;
    for &samples in &args.render_samples {
        settings::budget("--render-samples", samples, Sampling::Sobol)?;
    }
    Ok(Job {
        division: NoiseTasks::new(scene, plan, args.render_samples.clone()),
        ground: OnceLock::new(),
        asked,
        what: format!("noise on {}", scene.name),
        count: Count::Tasks,
        threads: args.threads,
        output: args.output.clone(),
        json: args.json,
        findings: |NoiseFinding { study, ledger }| {
            let mut findings = Findings::new(
                "noise",
                study,
                report::noise_table(study),
                report::noise_account(study),
            )?
            .with("noise.csv", ledger.clone())
            .with("noise-curves.csv", report::noise_csv(study));
            for measure in Measure::ALL {
                let figure = report::noise_svg(study, measure);
                findings = findings.with(&format!("noise-{}.svg", measure.name()), figure);
            }
            Ok((findings, Outcome::Done))
        },
    })
}

fn plan(args: &NoiseArgs, scene: &Scene) -> Result<NoisePlan, Failure> {
    let axis = axis(args, scene)?;
    if let Some((level, cure)) = args.noise.iter().find_map(|l| Some((l, axis.refuses(*l)?))) {
        return Err(Failure::new(
            format!("--noise {level} has no meaning on the axis {}", axis.name()),
            cure,
        ));
    }
    if !args.render_samples.is_empty() && axis.of_relative(1.0).is_none() {
        return Err(Failure::new(
            format!(
                "the noise of renders has no place on the axis {}",
                axis.name()
            ),
            "use --axis relative or photons, or leave out --render-samples",
        ));
    }
    let mut plan = NoisePlan {
        boards: sides("--boards", &args.boards, 2)?,
        elements: sides("--elements", &args.elements, 1)?,
        methods: methods(&args.method)?,
        kernel: settings::kernel(args.kernel),
        axis,
        levels: args.noise.clone(),
        seeds: args.seeds,
        first_seed: args.seed,
    };
    if plan.levels.is_empty() {
        plan.levels = plan.default_levels(scene)?;
    }
    plan.levels.sort_by(|a, b| plan.axis.quiet_first(*a, *b));
    plan.levels.dedup();
    Ok(plan)
}

/// The axis, with its sensor where it has one.
fn axis(args: &NoiseArgs, scene: &Scene) -> Result<NoiseAxis, Failure> {
    let without = |option: &str, given: bool, axes: &str| match given {
        false => Ok(()),
        true => Err(Failure::new(
            format!("{option} has no meaning on this axis"),
            format!("leave it out, or use {axes}"),
        )),
    };
    if args.axis != AxisName::Glare {
        without("--falloff", args.falloff.is_some(), "--axis glare")?;
    }
    let camera = || {
        let (sensor, name) = settings::studied_sensor(args.sensor.as_deref(), scene)?;
        Ok::<_, Failure>(NamedSensor { name, sensor })
    };
    let plain = match args.axis {
        AxisName::Relative => NoiseAxis::Relative,
        AxisName::Photons => NoiseAxis::Photons,
        AxisName::Bits => NoiseAxis::Bits,
        AxisName::Exposure => return Ok(NoiseAxis::Exposure(camera()?)),
        AxisName::Glare => {
            let spread = match args.falloff {
                None => Spread::Uniform,
                Some(d0) => {
                    settings::falloff(d0)?;
                    Spread::Falloff(d0)
                }
            };
            return Ok(NoiseAxis::Glare(camera()?, spread));
        }
    };
    without(
        "--sensor",
        args.sensor.is_some(),
        "--axis exposure or glare",
    )?;
    Ok(plain)
}

/// Numbers of checks or elements a side, sorted, each once.
pub(super) fn sides(option: &str, given: &[usize], least: usize) -> Result<Vec<usize>, Failure> {
    if let Some(bad) = given.iter().find(|n| !(least..=1024).contains(*n)) {
        return Err(Failure::new(
            format!("{option} {bad} is out of range"),
            format!("use whole numbers from {least} to 1024"),
        ));
    }
    let mut sides = given.to_vec();
    sides.sort_unstable();
    sides.dedup();
    Ok(sides)
}

/// Methods by name, each once, in the order of [`Method::ALL`].
pub(super) fn methods(names: &[String]) -> Result<Vec<Method>, Failure> {
    let asked: Vec<Method> = names.iter().map(|n| n.parse()).collect::<Result<_, _>>()?;
    Ok(Method::ALL
        .into_iter()
        .filter(|m| asked.contains(m))
        .collect())
}

/// The trials that an earlier run of this study has finished.
fn known(path: &Path, name: &str) -> Result<Vec<Trial>, Failure> {
    let text = match fs::read_to_string(path) {
        Ok(text) => text,
        Err(e) if e.kind() == ErrorKind::NotFound || e.kind() == ErrorKind::NotADirectory => {
            return Ok(Vec::new());
        }
        Err(e) => {
            let cause = format!("cannot read {}: {e}", path.display());
            return Err(Failure::new(
                cause,
                "make it readable, or choose another folder (-o)",
            ));
        }
    };
    read_ledger(name, &text)
        .map_err(|e| Failure::Error(format!("cannot go on from {}: {e}", path.display())))
}
