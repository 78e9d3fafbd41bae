//! `phicam study coverage`: how often the bands of recovered reflectances cover the truth.

use std::sync::OnceLock;

use super::findings::Findings;
use super::job::{Count, Job};
use super::noise::{methods, sides};
use crate::cli::Outcome;
use crate::cli::args::CoverageArgs;
use crate::cli::failure::Failure;
use crate::model::{Kernel, MatrixModel};
use crate::report::{self, Asked};
use crate::scene::Scene;
use crate::study::{CoveragePlan, CoverageTasks};

pub(super) fn job(
    args: &CoverageArgs,
    scene: &Scene,
    asked: Asked,
) -> Result<Job<CoverageTasks>, Failure> {
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
    let model = MatrixModel::new(scene, Kernel::Physical, elements)?;
    Ok(Job {
        division: CoverageTasks::new((&scene.name, &scene.hash), model, plan),
        ground: OnceLock::new(),
        asked,
        what: format!("coverage on {}", scene.name),
        count: Count::Tasks,
        threads: args.threads,
        output: args.output.clone(),
        json: args.json,
        findings: |found| {
            let findings = Findings::new(
                "coverage",
                found,
                report::coverage_table(found),
                report::coverage_account(found),
            )?;
            Ok((findings, Outcome::Done))
        },
    })
}
