//! Photographs of a run or an import, for what takes their reflectances for unknown.

use std::path::Path;

use super::beside::{PhotographSize, certainty};
use super::mask::read_mask;
use crate::cli::console::Console;
use crate::cli::failure::Failure;
use crate::cli::load_run::{read_left_out, read_photographs, read_stderr};
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

/// The photographs of the folder `dir`; other light in each frame is a polynomial of degree
/// `polynomial`, and there may be a `background` that all frames share.
pub(super) fn of_run(
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
pub(super) fn of_files(
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
