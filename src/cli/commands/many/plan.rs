//! `phicam plan`.

use std::path::Path;

use super::planned::{Planned, work};
use super::work::Work;
use crate::cli::args::PlanArgs;
use crate::cli::console::Console;
use crate::cli::failure::Failure;
use crate::cli::output;
use crate::cli::run_folder::SCENE;
use crate::cli::{Outcome, settings};
use crate::folder::write_scene;
use crate::jobs::{PlanFile, Settings};
use crate::store::{self, ensure_writable};

/// Shards of a plan unless told otherwise.
const USUAL_SHARDS: u64 = 32;

pub(in crate::cli) fn execute(args: &PlanArgs, console: Console) -> Result<Outcome, Failure> {
    let settings = asked(args, console)?;
    let work = &*work(&settings, args.scene.as_deref(), false, console)?;
    let most = work.blocks().min(PlanFile::MOST_SHARDS);
    let shards = args.shards.unwrap_or(most.min(USUAL_SHARDS));
    if !(1..=most).contains(&shards) {
        let cause = format!(
            "--shards {shards} is not possible: the work has {} blocks",
            work.blocks()
        );
        return Err(Failure::usage(cause, format!("use 1 to {most}")));
    }
    let file = PlanFile::new(work.identity(), settings, work.blocks(), shards);
    let dir = &args.output;
    let earlier = PlanFile::read(&dir.join(PlanFile::NAME))?;
    if let Some(earlier) = &earlier
        && let Some((name, there, asked)) = earlier.identity.difference(&file.identity)
    {
        let cause = format!(
            "{} holds another plan: its {name} is {there}, and {asked} was asked for",
            dir.display()
        );
        return Err(Failure::new(cause, "plan into another folder (-o)"));
    }
    if earlier.is_none() && !is_free(dir, work) {
        let cause = format!("{} holds a {SCENE} that is not of a plan", dir.display());
        return Err(Failure::new(cause, "plan into another folder (-o)"));
    }
    ensure_writable(dir)?;
    work.warn(console)?;
    if let Some(scene) = work.scene() {
        write_scene(dir, scene)?;
    }
    file.write(&dir.join(PlanFile::NAME))?;
    ensure_writable(&dir.join("shards"))?;
    // What was written is what every machine will read.
    let read = Planned::open(dir, console)?.folder;
    if args.json {
        output::print(&output::json(&read.file)?)?;
    } else {
        let PlanFile { blocks, shards, .. } = read.file;
        let (id, dir) = (read.id().short(), dir.display());
        output::print(&format!(
            "{dir}: plan {id}, {blocks} blocks in {shards} shards\n  \
             each:     phicam shard {dir} --index 0 … {}\n  \
             missing:  phicam status {dir}\n  \
             together: phicam merge {dir} -o OUT\n",
            shards - 1
        ))?;
    }
    Ok(Outcome::Done)
}

/// Whether no scene is in `dir`, or the very same: what a process leaves that was killed while it
/// planned.
fn is_free(dir: &Path, work: &dyn Work) -> bool {
    let path = dir.join(SCENE);
    let own = work.scene().map(|s| s.text.as_bytes());
    let most = own.map_or(0, <[u8]>::len) as u64;
    match store::read(&path, most) {
        Err(e) => e.is_missing(),
        Ok(there) => own == Some(&*there),
    }
}

/// A render of the scene, or the command after `--`.
fn asked(args: &PlanArgs, console: Console) -> Result<Settings, Failure> {
    match (&args.scene, args.command.is_empty()) {
        (Some(name), true) => {
            let scene = console.load_scene(name)?;
            let plan = settings::plan(&args.paths, None, &scene, console)?;
            settings::remark_rounding(&args.paths, &plan, console);
            Ok(Settings::render(&plan))
        }
        (None, false) => Ok(Settings::Command(args.command.clone())),
        _ => Err(Failure::usage(
            "a plan is of a scene that is rendered, or of a command after `--`",
            "phicam plan SCENE -o DIR, or phicam plan -o DIR -- study noise SCENE …",
        )),
    }
}
