//! `phicam target`: the built-in target pictures as PNG.

use std::fmt::Write as _;
use std::path::Path;

use crate::cli::Outcome;
use crate::cli::args::TargetArgs;
use crate::cli::console::Console;
use crate::cli::failure::Failure;
use crate::cli::output;
use crate::image::Transfer;
use crate::num::named::Named;
use crate::report;
use crate::scene::mesh::{FaceValues, Generator, Triangles, to_ply};
use crate::scene::target::Target;
use crate::store::memory;

pub(in crate::cli) fn execute(args: &TargetArgs, console: Console) -> Result<Outcome, Failure> {
    let Some(name) = &args.name else {
        output::print(&list())?;
        return Ok(Outcome::Done);
    };
    if let Some(mesh) = mesh(name, args)? {
        let bytes = to_ply(&mesh, FaceValues::default());
        let what = format!("{} triangles", mesh.triangles.len());
        return deliver(args, &format!("{name}.ply"), &bytes, &what, console);
    }
    if args.faces.is_some() {
        let cause = format!("`{name}` is a picture and has no --faces");
        return Err(Failure::new(cause, "leave --faces out, or write a mesh"));
    }
    let target = Target::by_name(name).ok_or_else(|| {
        let pictures = Target::ALL.map(Target::name).join(", ");
        let meshes = MESHES.map(|m| m.0).join(", ");
        let names = format!("{pictures}, or of the meshes {meshes}");
        Failure::new(
            format!("there is no target `{name}`"),
            format!("use one of {names}"),
        )
    })?;
    let [w, h] = args.size.unwrap_or_else(|| target.usual_size());
    let picture = target.picture([w, h]).ok_or_else(|| {
        let cause = format!("a target of {w} × {h} pixels");
        Failure::new(cause, "use 1 to 4096 a side")
    })?;
    let (transfer, word) = if args.linear {
        (Transfer::Linear, "linear")
    } else {
        (Transfer::Srgb, "srgb")
    };
    let png = report::target_png(&picture, transfer)?;
    let what = format!("{w} × {h} pixels, transfer = \"{word}\"");
    deliver(args, &format!("{name}.png"), &png, &what, console)
}

/// Writes the file, `usual` unless another is asked for, and says `what` is in it.
fn deliver(
    args: &TargetArgs,
    usual: &str,
    bytes: &[u8],
    what: &str,
    console: Console,
) -> Result<Outcome, Failure> {
    let path = args.output.as_deref().unwrap_or(Path::new(usual));
    let kind = Path::new(usual).extension().and_then(|e| e.to_str());
    output::refuse_other_kind(path, kind.unwrap_or_default())?;
    output::write_new(path, bytes, args.force)?;
    console.say(format!("{}: {what}", path.display()));
    Ok(Outcome::Done)
}

/// Names and summaries of the meshes.
const MESHES: [(&str, Generator, &str); 4] = [
    (
        "mesh",
        Generator::Bust,
        "PLY: a bust, head and shoulders, 1 high",
    ),
    ("sphere", Generator::Sphere, "PLY: the sphere of radius 1"),
    ("rectangle", Generator::Rectangle, "PLY: the unit square"),
    ("box", Generator::Box, "PLY: the unit cube"),
];
/// Triangles unless told.
const FACES: u64 = 1_000_000;
/// Bytes that a triangle takes: corners, their places in the texture and its half of a vertex, in
/// lists that have grown to twice what they hold, and all as a file.
const FACE: f64 = 176.0;
/// More are not made.
const MOST_FACES: u64 = 100_000_000;

/// The mesh of that name, if there is one.
fn mesh(name: &str, args: &TargetArgs) -> Result<Option<Triangles>, Failure> {
    let Some((_, generator, _)) = MESHES.iter().find(|m| m.0 == name) else {
        return Ok(None);
    };
    if args.size.is_some() || args.linear {
        let cause = format!("`{name}` is a mesh and has neither --size nor --linear");
        return Err(Failure::new(
            cause,
            "leave them out; --faces says how fine it is",
        ));
    }
    if *generator == Generator::Box && args.faces.is_some() {
        let cause = "a box has its 12 triangles, and no --faces";
        return Err(Failure::new(cause, "leave --faces out"));
    }
    let faces = args.faces.unwrap_or(FACES);
    if !(1..=MOST_FACES).contains(&faces) {
        let cause = format!("--faces {faces}");
        return Err(Failure::new(cause, format!("use 1 to {MOST_FACES}")));
    }
    if *generator != Generator::Box {
        let what = format!("{faces} triangles");
        let need = |faces: f64| FACE * faces;
        let cure: memory::Cure<'_> = ("triangles (--faces)", faces, &need);
        memory::refuse(&what, need(faces as f64), &[cure])?;
    }
    Ok(Some(generator.triangles(faces as usize)))
}

fn list() -> String {
    let mut text = String::new();
    for t in Target::ALL {
        let [w, h] = t.usual_size();
        let _ = writeln!(text, "{:<9} {:>3} × {:<3}  {}", t.name(), w, h, t.summary());
    }
    for (name, _, summary) in MESHES {
        let _ = writeln!(text, "{name:<9} {:9}  {summary}", "");
    }
    text
}
