//! `phicam target`: the built-in target pictures as PNG.

use std::fmt::Write as _;
use std::path::PathBuf;

use super::Outcome;
use super::args::TargetArgs;
use super::failure::Failure;
use super::output::{self, Talk};
use crate::image::Transfer;
use crate::report;
use crate::scene::target::Target;
use crate::store::write_whole;

pub(super) fn execute(args: &TargetArgs, talk: Talk) -> Result<Outcome, Failure> {
    let Some(name) = &args.name else {
        output::print(&list())?;
        return Ok(Outcome::Done);
    };
    let target = Target::by_name(name).ok_or_else(|| {
        let names = Target::ALL.map(Target::name).join(", ");
        Failure::new(
            format!("there is no target `{name}`"),
            format!("use one of {names}"),
        )
    })?;
    let size = args.size.unwrap_or_else(|| target.usual_size());
    let picture = target.picture(size).ok_or_else(|| {
        let [w, h] = size;
        Failure::new(
            format!("a target of {w} × {h} pixels"),
            "use 1 to 4096 a side",
        )
    })?;
    let (transfer, word) = if args.linear {
        (Transfer::Linear, "linear")
    } else {
        (Transfer::Srgb, "srgb")
    };
    let png = report::target_png(&picture, transfer)?;
    let path = args
        .output
        .clone()
        .unwrap_or_else(|| PathBuf::from(format!("{name}.png")));
    write_whole(&path, |file| file.write_all(&png))?;
    talk.say(format!(
        "{}: {} × {} pixels, transfer = \"{word}\"",
        path.display(),
        size[0],
        size[1]
    ));
    Ok(Outcome::Done)
}

fn list() -> String {
    Target::ALL.iter().fold(String::new(), |mut text, t| {
        let [w, h] = t.usual_size();
        let _ = writeln!(text, "{:<8} {:>3} × {:<3}  {}", t.name(), w, h, t.summary());
        text
    })
}
