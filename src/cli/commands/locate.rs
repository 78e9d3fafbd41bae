//! `phicam locate`: where the hidden surface is.

use super::spelled::Spelled;
use super::unexplained::{elements, of_run};
use crate::cli::args::LocateArgs;
use crate::cli::console::Console;
use crate::cli::failure::{Failure, NOTHING_KEPT};
use crate::cli::findings::deliver;
use crate::cli::load_run::read_run;
use crate::cli::output;
use crate::cli::process::pool;
use crate::cli::run_folder::{LOCATED, RunFolder};
use crate::cli::{Outcome, progress};
use crate::jobs::need;
use crate::lab::finding::Describe;
use crate::lab::{Found, LocatedPlan, Work};
use crate::report::Invocation;
use crate::scene::Scene;

/// The range unless given: part of the distance to the view, and degrees.
const PART: f64 = 0.3;
const DEGREES: f64 = 15.0;

pub(in crate::cli) fn execute(args: &LocateArgs, console: Console) -> Result<Outcome, Failure> {
    let (scene, record) = read_run(&args.dir, console)?;
    let plan = plan(args, &scene, console);
    need::locate(&scene, plan.elements)?;
    let photographs = of_run(
        &args.dir,
        (&scene, &record),
        args.left_out.as_deref(),
        (args.frame_polynomial, args.background),
    )?;
    let output = args
        .output
        .clone()
        .unwrap_or_else(|| args.dir.join(LOCATED));
    output::refuse_run(&output)?;
    let _lock = RunFolder::lock(&output, "phicam locate")?;
    let pool = pool(args.threads)?;
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
    let asked = invocation(args, &scene);
    let outcome = deliver("locate", &found, &output, &asked, args.json)?;
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
    LocatedPlan {
        what: args.what,
        range: args.range.unwrap_or([-far, far]),
        steps: usize::from(args.steps),
        elements: elements(args.elements, scene, console),
        occlusion: args.occlusion.occlusion(),
        integration: args.integration,
        background: args.background,
        orders: u64::from(args.orders),
        seed: args.seed,
    }
}

/// How to ask for it again.
fn invocation(args: &LocateArgs, scene: &Scene) -> Invocation {
    Spelled::default()
        .with("--what", args.what)
        .with("--steps", args.steps)
        .with("--orders", args.orders)
        .with("--seed", args.seed)
        .with("--integration", args.integration)
        .pair("--range", args.range, ",")
        .pair("--elements", args.elements, "x")
        .maybe("--frame-polynomial", args.frame_polynomial)
        .flag("--background", args.background)
        .file("--left-out", args.left_out.as_deref())
        .flag("--no-occlusion", args.occlusion.no_occlusion)
        .of_folder("locate", &args.dir, scene)
}
