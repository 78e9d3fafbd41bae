//! `phicam scene view`: the scene in ordinary light.

use crate::cli::Outcome;
use crate::cli::args::PreviewArgs;
use crate::cli::console::Console;
use crate::cli::failure::Failure;
use crate::cli::output;
use crate::cli::progress;
use crate::geometry::DVec3;
use crate::lab::{PreviewPlan, ViewOptions, Work, auto_viewpoint, preview};
use crate::report;

pub(super) fn execute(args: &PreviewArgs, console: Console) -> Result<Outcome, Failure> {
    let scene = console.load_scene(&args.scene)?;
    output::refuse_taken(&args.output, args.force)?;
    output::refuse_other_kind(&args.output, "png")?;
    let options = ViewOptions {
        from: args.from.map(DVec3::from_array),
        to: args.to.map(DVec3::from_array),
        up: Some(DVec3::from_array(args.up)),
        field: Some(args.fov),
    };
    let plan = PreviewPlan {
        viewpoint: auto_viewpoint(&scene, args.size, &options)?,
        size: args.size,
        samples: args.samples,
        overlay: args.mark,
    };
    let [w, h] = args.size;
    let total = (w * h) as u64 * u64::from(args.samples);
    let work = Work::Samples(total);
    let made = progress::run(console, "looking", work, |control| {
        preview(&scene, &plan, control)
    });
    let made = made.map_err(|e| Failure::from(e).if_stopped("no picture was written"))?;
    output::write_new(&args.output, report::preview_png(&made)?, args.force)?;
    let place = |p: DVec3| format!("{:.4},{:.4},{:.4}", p.x, p.y, p.z);
    console.say(format!(
        "{}: {w} × {h} pixels of scene `{}`, seen with --from {} --to {} (in {})",
        args.output.display(),
        scene.name,
        place(plan.viewpoint.from),
        place(plan.viewpoint.to),
        scene.unit.symbol()
    ));
    Ok(Outcome::Done)
}
