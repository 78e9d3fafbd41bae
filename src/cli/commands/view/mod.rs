//! `phicam view`: a frame, a picture or a matrix in false colour.

mod source;
mod terminal;

use std::path::{Path, PathBuf};

use crate::cli::Outcome;
use crate::cli::args::{Terminal, ViewArgs};
use crate::cli::console::Console;
use crate::cli::failure::Failure;
use crate::cli::output;
use crate::report::{Law, Map, Scale, Shown, iterm, kitty};
use source::Source;

/// Without --exposure and --range a logarithmic scale spans what is above 0; with --exposure so
/// many decades.
const DECADES: i32 = 4;

pub(in crate::cli) fn execute(args: &ViewArgs, console: Console) -> Result<Outcome, Failure> {
    if args.file.is_dir() {
        let dir = args.file.display();
        let cure = format!("name a frame or a matrix in it, as {dir}/phi.npy");
        return Err(Failure::new(format!("{dir} is a folder"), cure));
    }
    let source = Source::read(args, console)?;
    let scale = scale(args, &source)?;
    let shown = Shown::new(source.panel, scale, source.unit);
    let png = || {
        if args.bare {
            shown.bare_png()
        } else {
            shown.sheet_png()
        }
    };
    let terminal = match (&args.output, args.terminal) {
        (Some(_), _) => None,
        (None, Some(Terminal::Auto)) => Some(terminal::chosen()),
        (None, given @ Some(_)) => given,
        (None, None) => terminal::detected(),
    };
    let columns = terminal::columns();
    match terminal {
        Some(Terminal::Kitty) => output::draw(&kitty(&png()?, columns))?,
        Some(Terminal::Iterm) => output::draw(&iterm(&png()?, columns))?,
        Some(Terminal::Blocks | Terminal::Auto) => output::draw(&shown.blocks(columns))?,
        None => {
            let path = args.output.clone().unwrap_or_else(|| beside(&args.file));
            output::refuse_other_kind(&path, "png")?;
            let png = png()?;
            output::write_new(&path, &png, args.force)?;
            console.say(format!("{}: written", path.display()));
            for (_, words) in shown.outside() {
                console.say(words);
            }
        }
    }
    Ok(Outcome::Done)
}

/// FILE.png: nothing that a run has written has such a name.
fn beside(file: &Path) -> PathBuf {
    let mut name = file.as_os_str().to_owned();
    name.push(".png");
    name.into()
}

fn scale(args: &ViewArgs, source: &Source) -> Result<Scale, Failure> {
    let law = args.scale;
    let plain = args.range.is_none() && args.exposure.is_none() && law == Law::Linear;
    let grey = args.map.is_none_or(|map| map == Map::Grey);
    if source.reflectance && plain && grey {
        return Ok(Scale::reflectance());
    }
    let map = args.map.unwrap_or(Map::Viridis);
    let finite = || {
        source
            .panel
            .values
            .iter()
            .copied()
            .filter(|v| v.is_finite())
    };
    let largest = finite().fold(f64::NEG_INFINITY, f64::max);
    let range = match (args.range, args.exposure) {
        (Some(range), _) => range,
        (None, _) if law == Law::Logarithmic && largest <= 0.0 => {
            let cause = format!("{}: no value is above 0", args.file.display());
            return Err(Failure::new(cause, "use --scale linear, or give --range"));
        }
        (None, Some(ev)) if map == Map::Diverging => {
            let most = finite().map(f64::abs).fold(0.0, f64::max) * libm::exp2(-ev);
            [-most, most]
        }
        (None, Some(ev)) => {
            let high = largest * libm::exp2(-ev);
            match law {
                Law::Linear => [0.0, high],
                Law::Logarithmic => [high * 0.1f64.powi(DECADES), high],
            }
        }
        (None, None) if map == Map::Diverging => {
            return Ok(Scale::symmetric(finite().map(f64::abs).fold(0.0, f64::max)));
        }
        (None, None) if law == Law::Logarithmic => {
            let low = finite().filter(|v| *v > 0.0).fold(largest, f64::min);
            // Of equal values, a decade.
            if low < largest {
                [low, largest]
            } else {
                [0.1 * largest, largest]
            }
        }
        (None, None) => Scale::sequential(&source.panel.values).range(),
    };
    Scale::between(map, law, range).ok_or_else(|| {
        let [low, high] = range;
        let above = if law == Law::Logarithmic {
            ", and LOW above 0"
        } else {
            ""
        };
        Failure::new(
            format!("a scale from {low:e} to {high:e}"),
            format!("give --range LOW,HIGH with LOW below HIGH{above}, or a smaller --exposure"),
        )
    })
}
