//! `phicam study indicator`: what predicts how well the published inversion works.

use std::sync::OnceLock;

use super::findings::Findings;
use super::job::{Count, Job};
use super::noise::{methods, sides};
use crate::cli::Outcome;
use crate::cli::args::IndicatorArgs;
use crate::cli::failure::Failure;
use crate::model::Kernel;
use crate::report::{self, Asked};
use crate::scene::Scene;
use crate::study::{IndicatorPlan, IndicatorTasks, Layout, NoiseAxis};

/// The largest half-width that is still a bench, in.
const WIDEST: f64 = 1000.0;
/// The most spots a layout is asked for.
const MOST_SPOTS: usize = 10_000;

pub(super) fn job(
    args: &IndicatorArgs,
    scene: &Scene,
    asked: Asked,
) -> Result<Job<IndicatorTasks>, Failure> {
    Ok(Job {
        division: IndicatorTasks::new(scene, plan(args)?)?,
        ground: OnceLock::new(),
        asked,
        what: format!("indicators on {}", scene.name),
        count: Count::Tasks,
        threads: args.threads,
        output: args.output.clone(),
        json: args.json,
        findings: |found| {
            let findings = Findings::new(
                "indicator",
                found,
                report::indicator_table(found),
                report::indicator_account(found),
            )?
            .with("indicator.csv", report::indicator_csv(found))
            .with("indicator-noise.csv", report::indicator_noise_csv(found))
            .with("indicator.svg", report::indicator_svg(found));
            Ok((findings, Outcome::Done))
        },
    })
}

fn plan(args: &IndicatorArgs) -> Result<IndicatorPlan, Failure> {
    if let Some(bad) = args.spots.iter().find(|n| !(1..=MOST_SPOTS).contains(*n)) {
        return Err(Failure::new(
            format!("--spots {bad} is out of range"),
            format!("use whole numbers from 1 to {MOST_SPOTS}"),
        ));
    }
    if let Some(bad) = args
        .half_widths
        .iter()
        .find(|h| !(**h > 0.0 && **h <= WIDEST))
    {
        return Err(Failure::new(
            format!("--half-widths {bad} is not a size of a layout"),
            format!("use inches above 0 and up to {WIDEST}"),
        ));
    }
    let axis = NoiseAxis::Relative;
    if let Some((level, cure)) = args.noise.iter().find_map(|l| Some((l, axis.refuses(*l)?))) {
        return Err(Failure::new(
            format!("--noise {level} has no meaning here"),
            cure,
        ));
    }
    Ok(IndicatorPlan {
        layouts: Layout::ALL.to_vec(),
        spots: args.spots.clone(),
        half_widths: args.half_widths.clone(),
        elements: sides("--elements", &args.elements, 1)?,
        boards: sides("--boards", &args.boards, 2)?,
        kernels: vec![Kernel::Physical, Kernel::Published],
        methods: methods(&args.method)?,
        noise: args.noise.clone(),
        every: usize::try_from(args.every).unwrap_or(usize::MAX),
        seeds: args.seeds,
        first_seed: args.seed,
    })
}
