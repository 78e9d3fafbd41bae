//! `phicam locate`: where the hidden surface is.

use super::spelled::Spelled;
use super::unexplained::{asked, elements, photographs, scene_of};
use crate::cli::args::LocateArgs;
use crate::cli::console::Console;
use crate::cli::failure::{Failure, NOTHING_KEPT};
use crate::cli::findings;
use crate::cli::output;
use crate::cli::process::pool;
use crate::cli::run_folder::{LOCATED, RunFolder};
use crate::cli::{Outcome, progress};
use crate::jobs::need;
use crate::lab::finding::Describe;
use crate::lab::options::OptionError;
use crate::lab::{Found, LocatedPlan, Work};
use crate::report::Invocation;
use crate::scene::Scene;
use crate::store::write_together;

/// The range unless given: part of the distance to the view, and degrees.
const PART: f64 = 0.3;
const DEGREES: f64 = 15.0;

pub(in crate::cli) fn execute(args: &LocateArgs, console: Console) -> Result<Outcome, Failure> {
    let of = &args.photographs;
    if args.orders == 0 {
        let why = "--orders 0 tries none";
        OptionError::refuse_idle(&[("seed", args.seed.is_some())], why)?;
    }
    let (scene, record) = scene_of(of, console)?;
    let plan = plan(args, &scene, console);
    need::locate(&scene, plan.elements)?;
    let photographs = photographs(of, (&scene, record.as_ref()))?;
    let output = args.output.clone();
    let output = output.unwrap_or_else(|| of.dir.join(LOCATED));
    output::refuse_run(&output)?;
    let _lock = RunFolder::lock(&output, "phicam locate")?;
    let pool = pool(of.threads)?;
    let what = format!("locate in {}", scene.name);
    let found = progress::run(console, &what, Work::Tasks(plan.work()), |control| {
        pool.install(|| plan.locate(&scene, &photographs.unexplained(), control))
    });
    let located = found.map_err(|e| Failure::of(e.into()).if_stopped(NOTHING_KEPT))?;
    let found = Found {
        json: serde_json::to_string_pretty(&located)?,
        finding: located.describe(),
        agrees: located.is_found(),
    };
    let again = invocation(args, &scene);
    write_together(&output, |staged| {
        findings::write("locate", &found, staged, &again)?;
        Ok::<_, Failure>(Vec::new())
    })?;
    let outcome = findings::tell(&found, of.json)?;
    console.say(format!("{}: written", output.display()));
    Ok(outcome)
}

/// What is to be done, with what is not given.
fn plan(args: &LocateArgs, scene: &Scene, console: Console) -> LocatedPlan {
    let far = if ["angle", "yaw"].contains(&args.what) {
        DEGREES
    } else {
        let seen = scene.camera.view.at([0.5; 2]).position;
        let hidden = scene.hidden().next();
        let distance = hidden.map(|(_, s)| (s.shape.at([0.5; 2]).position - seen).length());
        PART * distance.unwrap_or(1.0)
    };
    let of = &args.photographs;
    LocatedPlan {
        what: args.what,
        range: args.range.unwrap_or([-far, far]),
        steps: usize::from(args.steps),
        elements: elements(of.elements, scene, console),
        occlusion: of.occlusion.occlusion(),
        integration: of.integration,
        background: of.background,
        orders: u64::from(args.orders),
        seed: args.seed.unwrap_or(1),
    }
}

/// How to ask for it again.
fn invocation(args: &LocateArgs, scene: &Scene) -> Invocation {
    let options = Spelled::default()
        .with("--what", args.what)
        .with("--steps", args.steps)
        .with("--orders", args.orders)
        .maybe("--seed", args.seed)
        .pair("--range", args.range, ",");
    let of = &args.photographs;
    asked(of, options).of_folder("locate", &of.dir, scene)
}
