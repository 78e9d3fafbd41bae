//! `phicam scene`: list, check, show, view, export.

use std::fmt::Write as _;

use super::Outcome;
use super::args::{SceneArgs, SceneCommand};
use super::failure::Failure;
use super::output::{self, Talk};
use super::{portrait, trust};
use crate::report;
use crate::scene::{Role, Scene, builtins};

pub(super) fn execute(args: &SceneArgs, talk: Talk) -> Result<Outcome, Failure> {
    match &args.command {
        SceneCommand::List => output::print(&list())?,
        SceneCommand::Check { scene } => output::print(&check(&trust::load(scene)?))?,
        SceneCommand::Show { scene, output } => {
            let scene = trust::load(scene)?;
            talk.warn(&scene);
            output::deliver(&report::bench_svg(&scene), output.as_deref())?;
        }
        SceneCommand::View(view) => return portrait::execute(view, talk),
        SceneCommand::Export {
            scene,
            mitsuba,
            output,
        } => {
            let scene = trust::load(scene)?;
            let text = if *mitsuba {
                report::mitsuba_script(&scene)?
            } else {
                scene.text
            };
            output::deliver(&text, output.as_deref())?;
        }
    }
    Ok(Outcome::Done)
}

fn list() -> String {
    builtins().iter().fold(String::new(), |mut text, b| {
        let _ = writeln!(text, "{:<12} {}", b.name, b.summary);
        text
    })
}

fn check(scene: &Scene) -> String {
    let count = |role| scene.surfaces.iter().filter(|s| s.role == role).count();
    let mut text = format!(
        "{}: {} relay, {} hidden, {} occluding surfaces; {} spots; {} × {} pixels; up to {} bounces; lengths in {}\n",
        scene.name,
        count(Role::Relay),
        count(Role::Hidden),
        count(Role::Occluder),
        scene.laser.spots.len(),
        scene.camera.columns,
        scene.camera.rows,
        scene.max_bounces,
        scene.unit.symbol(),
    );
    let warnings = scene.warnings();
    for warning in &warnings {
        let _ = writeln!(text, "suspicious: {warning}");
    }
    if warnings.is_empty() {
        text += "nothing wrong, nothing suspicious\n";
    }
    text
}
