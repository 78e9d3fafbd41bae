//! Photographs of a run or an import, for what takes their reflectances for unknown.

use std::path::Path;

use super::beside::{PhotographSize, certainty};
use super::mask::{read_mask, refuse_clipped};
use super::spelled::Spelled;
use crate::cli::args::PhotographsArgs;
use crate::cli::console::Console;
use crate::cli::failure::Failure;
use crate::cli::load_run::{read_left_out, read_photographs, read_run_or_scene, read_stderr};
use crate::cli::run_folder::{PHI, STDERR};
use crate::folder::Record;
use crate::lab::{Certainty, Photographs, fewer, polynomials};
use crate::matrix::Matrix;
use crate::scene::Scene;

/// Other light in a frame of the scene's camera, a polynomial of this degree.
fn patterns(scene: &Scene, degree: Option<u8>) -> Option<Matrix> {
    let size = [scene.camera.columns, scene.camera.rows];
    degree.map(|degree| polynomials(size, usize::from(degree)))
}

/// The elements in place of the scene's: those `asked` for, else fewer where it has many.
pub(super) fn elements(
    asked: Option<[usize; 2]>,
    scene: &Scene,
    console: Console,
) -> Option<[usize; 2]> {
    let found = fewer(scene).filter(|_| asked.is_none());
    let Some(([nu, nv], own)) = found else {
        return asked;
    };
    console.say(format!(
        "{nu} × {nv} elements in place of {own} (--elements)"
    ));
    Some([nu, nv])
}

/// The scene of these photographs, its record where it is theirs.
pub(super) fn scene_of(
    args: &PhotographsArgs,
    console: Console,
) -> Result<(Scene, Option<Record>), Failure> {
    let (scene, record) = read_run_or_scene(&args.dir, args.phi.as_deref(), console)?;
    Ok((scene, record.filter(|_| args.phi.is_none())))
}

/// The photographs of `scene`, of the run of this record or of files of their own.
pub(super) fn photographs(
    args: &PhotographsArgs,
    (scene, record): (&Scene, Option<&Record>),
) -> Result<Photographs, Failure> {
    let (left_out, polynomial) = (args.left_out.as_deref(), args.frame_polynomial);
    match (&args.phi, record) {
        (None, Some(record)) => {
            let beside = (polynomial, args.background);
            of_run(&args.dir, (scene, record), left_out, beside)
        }
        (phi, _) => {
            let phi = phi.clone().unwrap_or_else(|| args.dir.join(PHI));
            if args.phi.is_some() && left_out.is_none() {
                refuse_clipped(&phi, scene, "")?;
            }
            let beside = [args.stderr.as_deref(), left_out];
            of_files(&phi, beside, scene, (polynomial, args.replicates))
        }
    }
}

/// How to ask for them again.
pub(super) fn asked(args: &PhotographsArgs, options: Spelled) -> Spelled {
    options
        .with("--integration", args.integration)
        .file("--phi", args.phi.as_deref())
        .file("--stderr", args.stderr.as_deref())
        .maybe("--replicates", args.replicates)
        .file("--left-out", args.left_out.as_deref())
        .maybe("--frame-polynomial", args.frame_polynomial)
        .flag("--background", args.background)
        .pair("--elements", args.elements, "x")
        .flag("--no-occlusion", args.occlusion.no_occlusion)
}

/// The photographs of the folder `dir`; other light in each frame is a polynomial of degree
/// `polynomial`, and there may be a `background` that all frames share.
fn of_run(
    dir: &Path,
    (scene, record): (&Scene, &Record),
    left_out: Option<&Path>,
    (polynomial, background): (Option<u8>, bool),
) -> Result<Photographs, Failure> {
    let file = dir.join(STDERR);
    // Of imported photographs the noise may be unknown.
    let is_unknown = record.is_imported() && !file.exists();
    let left_out = match left_out {
        Some(file) => Some(read_mask(file, &PhotographSize::of_scene(scene))?),
        None => read_left_out(dir, scene)?,
    };
    let stderr = (!is_unknown).then_some(file);
    new(
        (&dir.join(PHI), stderr.as_deref()),
        (left_out, certainty(&record.origin, background)),
        (scene, polynomial),
    )
}

/// Those of files of their own; without `stderr` the noise is unknown, else known as from so many
/// `replicates`, where that is said.
fn of_files(
    phi: &Path,
    [stderr, left_out]: [Option<&Path>; 2],
    scene: &Scene,
    (polynomial, replicates): (Option<u8>, Option<u32>),
) -> Result<Photographs, Failure> {
    let size = PhotographSize::of_scene(scene);
    let left_out = left_out.map(|file| read_mask(file, &size)).transpose()?;
    let known = (left_out, Certainty::STATED.or(replicates));
    new((phi, stderr), known, (scene, polynomial))
}

fn new(
    (phi, stderr): (&Path, Option<&Path>),
    (left_out, certainty): (Option<Matrix>, Certainty),
    (scene, polynomial): (&Scene, Option<u8>),
) -> Result<Photographs, Failure> {
    let flags = left_out.as_ref();
    Ok(Photographs {
        phi: read_photographs(phi, flags, scene)?,
        stderr: stderr
            .map(|file| read_stderr(file, flags, scene))
            .transpose()?,
        certainty,
        patterns: patterns(scene, polynomial),
        left_out,
    })
}
