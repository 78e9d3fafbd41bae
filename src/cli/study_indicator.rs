//! `phicam study indicator`: what predicts how well the published inversion works.

use super::args::IndicatorArgs;
use super::failure::Failure;
use super::interrupt::stop_flag;
use super::output::{self, Talk};
use super::study_noise::{methods, sides};
use super::{Outcome, progress, settings};
use crate::model::Kernel;
use crate::report;
use crate::scene::Scene;
use crate::store::ensure_writable;
use crate::study::{self, IndicatorPlan, Layout, NoiseAxis};

/// The largest half-width that is still a bench, in.
const WIDEST: f64 = 1000.0;
/// The most spots a layout is asked for.
const MOST_SPOTS: usize = 10_000;

pub(super) fn execute(args: &IndicatorArgs, talk: Talk) -> Result<Outcome, Failure> {
    let scene = Scene::load(&args.scene)?;
    let plan = plan(args)?;
    let pool = settings::pool(args.threads)?;
    ensure_writable(&args.output)?;
    let bar = progress::steps(talk, &format!("indicators on {}", scene.name));
    let tick = |done: usize, all: usize| {
        bar.set_length(all as u64);
        bar.set_position(done as u64);
    };
    let found = pool.install(|| study::indicator(&scene, &plan, stop_flag(), &tick))?;
    bar.finish_and_clear();
    let Some(found) = found else {
        return Err(Failure::Stopped(
            "nothing was written; run it again".to_owned(),
        ));
    };
    let json = output::json(&found)?;
    for (file, text) in [
        ("indicator.json", &json),
        ("indicator.csv", &report::indicator_csv(&found)),
        ("indicator-noise.csv", &report::indicator_noise_csv(&found)),
        ("indicator.svg", &report::indicator_svg(&found)),
    ] {
        output::deliver(text, Some(&args.output.join(file)))?;
    }
    output::print(&if args.json {
        json
    } else {
        report::indicator_table(&found)
    })?;
    Ok(Outcome::Done)
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
