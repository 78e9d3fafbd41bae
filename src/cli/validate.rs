//! `phicam validate`: traced against modelled.

use super::args::ValidateArgs;
use super::failure::Failure;
use super::finished::{read_matrix, read_run, read_stderr};
use super::folder::{PHI, STDERR};
use super::output::{self, Talk};
use super::{Outcome, settings};
use crate::report;
use crate::scene::Scene;
use crate::study::{Agreement, validate};

pub(super) fn execute(args: &ValidateArgs, talk: Talk) -> Result<Outcome, Failure> {
    let (own, record) = read_run(&args.dir)?;
    let phi = read_matrix(&args.dir.join(PHI), &own)?;
    let stderr = read_stderr(&args.dir.join(STDERR), &own)?;
    let mut scene = match &args.against {
        Some(other) => Scene::load(other)?,
        None => own,
    };
    if let Some(by) = args.shift_spots {
        scene = scene.with_shifted_spots(by)?;
    }
    let test = settings::test(&args.test, &record.plan()?, talk)?;
    let kernel = settings::kernel(args.test.kernel);
    let integration = settings::integration(args.test.integration);
    let found = validate(&scene, &phi, &stderr, kernel, integration, test)?;
    let text = if args.json {
        output::json(&found.agreement)?
    } else {
        report::verdict_table(&found.agreement)
    };
    output::print(&text)?;
    Ok(outcome(&found.agreement))
}

/// Exit code of a verdict.
pub(super) fn outcome(agreement: &Agreement) -> Outcome {
    if agreement.agrees {
        Outcome::Done
    } else {
        Outcome::Disagreed
    }
}
