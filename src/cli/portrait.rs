//! `phicam scene view`: the scene in ordinary light.

use super::Outcome;
use super::args::{PortraitArgs, YesNo};
use super::failure::Failure;
use super::interrupt::stop_flag;
use super::output::Talk;
use super::{progress, trust};
use crate::geometry::DVec3;
use crate::report;
use crate::store::write_whole;
use crate::study::{Marking, PortraitPlan, Wishes, portrait, stand};
use crate::transport::Control;

pub(super) fn execute(args: &PortraitArgs, talk: Talk) -> Result<Outcome, Failure> {
    let scene = trust::load(&args.scene)?;
    let wishes = Wishes {
        from: args.from.map(DVec3::from_array),
        to: args.to.map(DVec3::from_array),
        up: Some(DVec3::from_array(args.up)),
        field: Some(args.fov),
    };
    let plan = PortraitPlan {
        viewpoint: stand(&scene, args.size, &wishes)?,
        size: args.size,
        samples: args.samples,
        marking: match args.mark {
            YesNo::Yes => Marking::Marked,
            YesNo::No => Marking::Bare,
        },
    };
    let [w, h] = args.size;
    let total = (w * h) as u64 * u64::from(args.samples);
    let bar = progress::samples(talk, "looking", total);
    let control = Control {
        progress: &|n| bar.inc(n),
        stop: stop_flag(),
    };
    let made = portrait(&scene, &plan, control)?;
    bar.finish_and_clear();
    let Some(made) = made else {
        return Err(Failure::Stopped("no picture was written".to_owned()));
    };
    let png = report::portrait_png(&made)?;
    write_whole(&args.output, |file| file.write_all(&png))?;
    let place = |p: DVec3| format!("{:.4},{:.4},{:.4}", p.x, p.y, p.z);
    talk.say(format!(
        "{}: {w} × {h} pixels of scene `{}`, seen with --from {} --to {} (in {})",
        args.output.display(),
        scene.name,
        place(plan.viewpoint.from),
        place(plan.viewpoint.to),
        scene.unit.symbol()
    ));
    Ok(Outcome::Done)
}
