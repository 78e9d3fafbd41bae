//! `phicam target`: the built-in target pictures as PNG.

use std::fmt::Write as _;
use std::path::PathBuf;

use super::Outcome;
use super::args::TargetArgs;
use super::failure::Failure;
use super::output::{self, Talk};
use crate::image::Transfer;
use crate::report;
use crate::scene::mesh::{FaceValues, Generator, Triangles, to_ply};
use crate::scene::target::Target;
use crate::store::write_whole;

pub(super) fn execute(args: &TargetArgs, talk: Talk) -> Result<Outcome, Failure> {
    let Some(name) = &args.name else {
        output::print(&list())?;
        return Ok(Outcome::Done);
    };
    if let Some(mesh) = mesh(name, args)? {
        return write_mesh(name, &mesh, args, talk);
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
    Ok(Some(generator.triangles(faces as usize)))
}

fn write_mesh(
    name: &str,
    mesh: &Triangles,
    args: &TargetArgs,
    talk: Talk,
) -> Result<Outcome, Failure> {
    let path = args
        .output
        .clone()
        .unwrap_or_else(|| PathBuf::from(format!("{name}.ply")));
    let bytes = to_ply(mesh, FaceValues::default());
    write_whole(&path, |file| file.write_all(&bytes))?;
    let count = mesh.triangles.len();
    talk.say(format!("{}: {count} triangles", path.display()));
    Ok(Outcome::Done)
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
