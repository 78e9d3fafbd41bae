//! `phicam scene`: list, check, show, view, export.

use std::fmt::Write as _;

use serde_json::json;

use super::preview;
use crate::cli::Outcome;
use crate::cli::args::{SceneArgs, SceneCommand};
use crate::cli::console::{Console, concise};
use crate::cli::failure::Failure;
use crate::cli::output;
use crate::cli::suspicious::dark;
use crate::jobs::need;
use crate::lab::from_wall_to_wall;
use crate::report;
use crate::scene::{Builtin, Role, Scene, builtins};

pub(in crate::cli) fn execute(args: &SceneArgs, console: Console) -> Result<Outcome, Failure> {
    match &args.command {
        SceneCommand::List { json: false } => output::print(&list())?,
        SceneCommand::List { json: true } => {
            let each = |b: &Builtin| json!({ "name": b.name, "summary": b.summary });
            let all: Vec<_> = builtins().iter().map(each).collect();
            output::print(&output::json(&all)?)?;
        }
        SceneCommand::Check { scene, json: false } => {
            let scene = console.load_any_scene(scene)?;
            need::frames(&scene)?;
            output::print(&check(&scene)?)?;
        }
        SceneCommand::Check { scene, json: true } => {
            let loaded = console.load_any_scene(scene).map_err(Failure::from);
            let loaded = loaded.and_then(|scene| Ok(need::frames(&scene).map(|()| scene)?));
            output::print(&match &loaded {
                Ok(loaded) => checked(scene, loaded)?,
                Err(failure) => output::json(&json!({
                    "scene": scene,
                    "ok": false,
                    "error": concise(failure.message()),
                }))?,
            })?;
            let _ = loaded?;
        }
        SceneCommand::Show {
            scene,
            output,
            force,
        } => {
            if let Some(path) = output {
                output::refuse_other_kind(path, "svg")?;
            }
            let scene = console.load_any_scene(scene)?;
            need::frames(&scene)?;
            console.warn(&scene);
            output::deliver(&report::bench_svg(&scene), output.as_deref(), *force)?;
        }
        SceneCommand::View(view) => return preview::execute(view, console),
        SceneCommand::Export {
            scene,
            mitsuba,
            output,
            force,
        } => {
            let scene = console.load_any_scene(scene)?;
            let text = if *mitsuba {
                let scene = scene.known()?;
                need::mitsuba(&scene)?;
                report::mitsuba_script(&scene)?
            } else {
                scene.text
            };
            output::deliver(&text, output.as_deref(), *force)?;
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

/// What [`check`] says, for programs; `given` is the name or path that was asked for.
fn checked(given: &str, scene: &Scene) -> Result<String, Failure> {
    let surfaces = |role| -> Vec<&str> {
        let of_role = scene.surfaces.iter().filter(|s| s.role == role);
        of_role.map(|s| s.name.as_str()).collect()
    };
    let warnings = suspicious(scene)?;
    output::json(&json!({
        "scene": given,
        "ok": true,
        "name": scene.name,
        "hash": scene.hash,
        "surfaces": {
            "relay": surfaces(Role::Relay),
            "hidden": surfaces(Role::Hidden),
            "occluder": surfaces(Role::Occluder),
        },
        "spots": scene.laser.spots.len(),
        "pixels": [scene.camera.columns, scene.camera.rows],
        "max_bounces": scene.max_bounces,
        "unit": scene.unit.symbol(),
        "suspicious": warnings,
    }))
}

/// What is suspicious, also in what the model lacks and in what a few samples find.
fn suspicious(scene: &Scene) -> Result<Vec<String>, Failure> {
    let mut found: Vec<String> = scene.warnings().iter().map(ToString::to_string).collect();
    if scene.hidden().next().is_some() {
        let lacks = |light| format!("frames hold what no model or recovery has: {light}");
        found.extend(from_wall_to_wall(scene).into_iter().map(lacks));
    }
    found.extend(dark(scene)?.map(|dark| dark.to_string()));
    Ok(found)
}

/// What lights the scene.
fn light(scene: &Scene) -> String {
    let columns = scene.laser.spots.len();
    match scene.shining() {
        None => format!("{columns} spots"),
        Some((_, surface)) if columns == 1 => format!("`{}` shines", surface.name),
        Some((_, surface)) => format!("the {columns} elements of `{}` shine in turn", surface.name),
    }
}

fn check(scene: &Scene) -> Result<String, Failure> {
    let count = |role| scene.surfaces.iter().filter(|s| s.role == role).count();
    let mut text = format!(
        "{}: {} relay, {} hidden, {} occluding surfaces; {}; {} × {} pixels; up to {} bounces; lengths in {}\n",
        scene.name,
        count(Role::Relay),
        count(Role::Hidden),
        count(Role::Occluder),
        light(scene),
        scene.camera.columns,
        scene.camera.rows,
        scene.max_bounces,
        scene.unit.symbol(),
    );
    let warnings = suspicious(scene)?;
    for warning in &warnings {
        let _ = writeln!(text, "suspicious: {warning}");
    }
    if warnings.is_empty() {
        text += "nothing wrong, nothing suspicious\n";
    }
    Ok(text)
}
