//! `phicam study coverage`: how often the bands of recovered reflectances cover the truth.

use std::convert::Infallible;

use super::findings::{Findings, stepped};
use super::noise::{methods, sides};
use crate::cli::args::CoverageArgs;
use crate::cli::failure::Failure;
use crate::cli::interrupt::stop_flag;
use crate::cli::output::Talk;
use crate::cli::trust;
use crate::cli::{Outcome, settings};
use crate::model::{Kernel, MatrixModel};
use crate::report;
use crate::store::ensure_writable;
use crate::study::{self, CoveragePlan};

pub(super) fn execute(args: &CoverageArgs, talk: Talk) -> Result<Outcome, Failure> {
    let scene = trust::load(&args.scene)?;
    let pool = settings::pool(args.threads)?;
    let within = |name: &str, x: f64, range: &str, fine: bool| match fine {
        true => Ok(()),
        false => Err(Failure::new(
            format!("{name} {x} has no meaning"),
            format!("use a number {range}"),
        )),
    };
    let (noise, confidence) = (args.noise, args.confidence);
    within(
        "--noise",
        noise,
        "above 0, e.g. 0.01",
        noise > 0.0 && noise.is_finite(),
    )?;
    let probable = confidence > 0.0 && confidence < 1.0;
    within(
        "--confidence",
        confidence,
        "between 0 and 1, e.g. 0.95",
        probable,
    )?;
    let plan = CoveragePlan {
        noise,
        confidence,
        methods: methods(&args.method)?,
        seeds: args.seeds,
        first_seed: args.seed,
    };
    let elements = match args.elements {
        Some(n) => sides("--elements", &[n], 1)?.first().map(|n| [*n, *n]),
        None => None,
    };
    let model = MatrixModel::new(&scene, Kernel::Physical, elements)?;
    ensure_writable(&args.output)?;
    let what = format!("coverage on {}", scene.name);
    let found = stepped(talk, &pool, &what, |steps| {
        let names = (&*scene.name, &*scene.hash);
        Ok::<_, Infallible>(study::coverage(names, &model, &plan, stop_flag(), steps))
    })?;
    Findings::new("coverage", &found, report::coverage_table(&found))?
        .deliver(&args.output, args.json)?;
    Ok(Outcome::Done)
}
