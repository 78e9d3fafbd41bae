//! `phicam study brdf`: the model on a wall that is not Lambertian.

use std::sync::OnceLock;

use super::findings::Findings;
use super::job::{Count, Job};
use super::noise::methods;
use crate::cli::args::BrdfArgs;
use crate::cli::failure::Failure;
use crate::cli::{Outcome, settings};
use crate::num::stream::Sampling;
use crate::report::{self, Asked};
use crate::scene::Scene;
use crate::study::{BrdfError, BrdfPlan, BrdfTasks, NoiseAxis};

pub(super) fn job(args: &BrdfArgs, scene: &Scene, asked: Asked) -> Result<Job<BrdfTasks>, Failure> {
    if scene.relay_is_lambertian() {
        return Err(BrdfError::Lambertian.into());
    }
    let axis = NoiseAxis::Relative;
    if let Some((level, cure)) = args.noise.iter().find_map(|l| Some((l, axis.refuses(*l)?))) {
        return Err(Failure::new(
            format!("--noise {level} has no meaning here"),
            cure,
        ));
    }
    let plan = BrdfPlan {
        samples: args.samples,
        seed: args.seed,
        significance: settings::significance(args.significance)?,
        noise: args.noise.clone(),
        methods: methods(&args.method)?,
        draws: args.seeds,
    };
    settings::budget("--samples", args.samples, Sampling::Sobol)?;
    Ok(Job {
        division: BrdfTasks::new(scene, plan),
        ground: OnceLock::new(),
        asked,
        what: format!("wall BRDFs on {}", scene.name),
        count: Count::Tasks,
        threads: args.threads,
        output: args.output.clone(),
        json: args.json,
        findings: |found| {
            let findings = Findings::new(
                "brdf",
                found,
                report::brdf_table(found),
                report::brdf_account(found),
            )?
            .with("brdf.csv", report::brdf_csv(found))
            .with("brdf.svg", report::brdf_svg(found));
            Ok(match found.known().agreement.agrees {
                true => (findings, Outcome::Done),
                false => (findings, Outcome::Disagreed),
            })
        },
    })
}
