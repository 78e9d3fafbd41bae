//! `phicam study brdf`: the model on a wall that is not Lambertian.

use super::findings::{Findings, traced};
use super::noise::methods;
use super::{paths, sum};
use crate::cli::args::BrdfArgs;
use crate::cli::failure::Failure;
use crate::cli::output::Talk;
use crate::cli::trust;
use crate::cli::{Outcome, settings};
use crate::report;
use crate::store::ensure_writable;
use crate::study::{self, BrdfError, BrdfPlan, NoiseAxis};

pub(super) fn execute(args: &BrdfArgs, talk: Talk) -> Result<Outcome, Failure> {
    let scene = trust::load(&args.scene)?;
    if scene.relay_is_lambertian() {
        return Err(BrdfError::Lambertian.into());
    }
    let pool = settings::pool(args.threads)?;
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
    // Two renders.
    let each = sum("--samples", &[args.samples])?;
    ensure_writable(&args.output)?;
    talk.warn(&scene);
    let total = paths(&scene, each.saturating_mul(2), 0);
    let work = (&*format!("wall BRDFs on {}", scene.name), total);
    let found = traced(talk, &pool, work, |control| {
        study::brdf(&scene, &plan, control)
    })?;
    Findings::new("brdf", &found, report::brdf_table(&found))?
        .with("brdf.csv", report::brdf_csv(&found))
        .with("brdf.svg", report::brdf_svg(&found))
        .deliver(&args.output, args.json)?;
    Ok(match found.known().agreement.agrees {
        true => Outcome::Done,
        false => Outcome::Disagreed,
    })
}
