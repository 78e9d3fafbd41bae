//! A whole run, written at once and read back.

use std::path::{Path, PathBuf};

use rayon::prelude::*;

use super::error::FolderError;
use super::frames::{columns, frame, frame_max, refuse_beyond_f32};
use super::names::{FRAMES, LEFT_OUT, PHI, SCENE, STDERR, TAILS, is_frame};
use super::record::Record;
use crate::film::{self, frame_name};
use crate::lab::Tails;
use crate::matrix::{Matrix, npy};
use crate::scene::{COPIES, Scene};
use crate::store::{FolderLock, ensure_writable, flush, write_whole};
use crate::transport::{Plan, Traced};

/// A run as it lies in its folder.
#[derive(Debug)]
pub struct Run {
    /// Its scene.
    pub scene: Scene,
    /// What was rendered, and how.
    pub record: Record,
    /// Φcam, pixels × spots, W.
    pub flux: Matrix,
    /// Its standard error; none of photographs of unknown noise.
    pub stderr: Option<Matrix>,
    /// What does not count, pixels × spots: where it is not 0.
    pub left_out: Option<Matrix>,
    /// Light that met exactly 1, 2, … surfaces, pixels × spots, W, to the f32 of the frames; none
    /// where there are no frames.
    pub bounces: Option<Vec<Matrix>>,
}

/// Writes the scene, whole: with copies of the files that it names.
///
/// # Errors
/// [`FolderError`].
pub fn write_scene(folder: &Path, scene: &Scene) -> Result<(), FolderError> {
    write_copies(folder, scene)?;
    let text = scene.text.as_bytes();
    Ok(write_whole(&folder.join(SCENE), |file| {
        file.write_all(text)
    })?)
}

/// Copies the files that the scene names into `folder`.
///
/// # Errors
/// [`FolderError`].
pub fn write_copies(folder: &Path, scene: &Scene) -> Result<(), FolderError> {
    let copies = folder.join(COPIES);
    for file in &scene.files {
        ensure_writable(&copies)?;
        let to = copies.join(file.copy_name());
        if to.canonicalize().is_ok_and(|to| to == file.path) {
            continue;
        }
        let bytes = file
            .again()
            .map_err(|(cause, cure)| FolderError::new(cause, cure))?;
        write_whole(&to, |file| file.write_all(&bytes))?;
    }
    Ok(())
}

/// Writes Φcam, its standard error and how far that is to be trusted, and that the run is complete;
/// the record vouches for its files from now on.
///
/// # Errors
/// [`FolderError`].
pub fn finish(
    folder: &Path,
    scene: &Scene,
    record: &mut Record,
    [phi, stderr, tails]: [&Matrix; 3],
) -> Result<(), FolderError> {
    record.tails = Some(Tails::of(tails));
    npy::write(&folder.join(TAILS), tails)?;
    npy::write(&folder.join(STDERR), stderr)?;
    npy::write(&folder.join(PHI), phi)?;
    flush(&folder.join(FRAMES))?;
    let spots = record.spots;
    record.finished = spots;
    record.files.clear();
    record.vouch(folder, [SCENE, PHI, STDERR, TAILS])?;
    record.vouch_all(folder, FRAMES, |name| is_frame(name, spots))?;
    record.vouch_all(folder, COPIES, |name| {
        scene.files.iter().any(|file| file.copy_name() == name)
    })?;
    record.write(folder)
}

/// Writes a whole run into `folder`, which is made, or is there and empty: scene, frames, matrices,
/// and the record last, so that nothing else is taken for a run.
///
/// # Errors
/// [`FolderError`].
pub fn write_run(
    folder: &Path,
    scene: &Scene,
    plan: &Plan,
    traced: &Traced,
    (seconds, threads): (f64, usize),
) -> Result<(), FolderError> {
    refuse_beyond_f32(traced)?;
    ensure_writable(folder)?;
    let alone = || -> Result<(), FolderError> {
        let ours =
            |entry: &std::fs::DirEntry| !entry.file_name().to_string_lossy().starts_with('.');
        let mut there = std::fs::read_dir(folder).into_iter().flatten().flatten();
        if let Some(entry) = there.find(ours) {
            let cause = format!("{} holds {}", folder.display(), entry.path().display());
            return Err(FolderError::new(
                cause,
                "choose a folder that is not there, or empty",
            ));
        }
        Ok(())
    };
    let _lock = FolderLock::take(folder, &(0..u64::MAX), "phicam", alone)?;
    let mut record = Record::new(scene, plan, 0, threads, seconds);
    let frames = folder.join(FRAMES);
    ensure_writable(&frames)?;
    write_scene(folder, scene)?;
    let kept: Vec<Matrix> = columns(traced).collect();
    kept.par_iter().enumerate().try_for_each(|(spot, kept)| {
        let path = frames.join(frame_name(spot as u32));
        film::exr::write(&path, &frame(scene, &record, spot, kept))
    })?;
    let matrices = [&traced.flux, &traced.stderr, &traced.tails];
    finish(folder, scene, &mut record, matrices)
}

/// Reads the run in `folder`, each file as its record vouches for it; its scene may read files in
/// the folders `also` too.
///
/// # Errors
/// [`FolderError`]: no run, an unfinished one, or one that is not what was written.
pub fn read_run(folder: &Path, also: &[PathBuf]) -> Result<Run, FolderError> {
    let record = Record::read(folder)?.ok_or_else(|| {
        let cause = format!(
            "{} is not the folder of a run: it has no {}",
            folder.display(),
            Record::FILE
        );
        FolderError::new(
            cause,
            "give a folder that `phicam run`, `phicam render`, `phicam import` or `Phi.save` has written",
        )
    })?;
    record.check_lengths(folder, COPIES)?;
    let scene = Scene::load_with(&folder.join(SCENE).to_string_lossy(), also)?;
    record.check_scene(folder, &scene)?;
    let matrix = |name: &str| -> Result<Matrix, FolderError> {
        let path = folder.join(name);
        let found = npy::read_finite(&path)?;
        record.check(folder, name)?;
        let expected = (scene.camera.pixels(), scene.laser.spots.len());
        if found.shape() == expected {
            return Ok(found);
        }
        let (rows, columns) = found.shape();
        let cause = format!(
            "{} is {rows} × {columns}, but the scene has {} pixels and {} spots",
            path.display(),
            expected.0,
            expected.1
        );
        Err(FolderError::new(cause, "restore it, or render again"))
    };
    let maybe = |name: &&str| folder.join(name).exists();
    let left_out = [TAILS, LEFT_OUT].into_iter().find(maybe);
    let stderr = (!record.is_imported() || maybe(&STDERR)).then_some(STDERR);
    let (flux, stderr) = (matrix(PHI)?, stderr.map(matrix).transpose()?);
    if stderr.as_ref().is_some_and(|s| s.iter().any(|x| *x < 0.0)) {
        let cause = format!(
            "{} has negative standard errors",
            folder.join(STDERR).display()
        );
        return Err(FolderError::new(cause, "restore it, or render again"));
    }
    let left_out = left_out.map(matrix).transpose()?;
    let framed = !record.is_imported() && folder.join(FRAMES).is_dir();
    let bounces = framed.then(|| bounces(folder, &scene, &record));
    let bounces = bounces.transpose()?;
    Ok(Run {
        scene,
        record,
        flux,
        stderr,
        left_out,
        bounces,
    })
}

/// Light by the number of surfaces met, from the frames, each as the record vouches for it.
fn bounces(folder: &Path, scene: &Scene, record: &Record) -> Result<Vec<Matrix>, FolderError> {
    let stack = film::stack_within(folder, frame_max(scene))?;
    for spot in 0..record.spots {
        let name = frame_name(spot as u32);
        record.check(folder, &format!("{FRAMES}/{name}"))?;
    }
    let expected = (scene.camera.pixels(), scene.laser.spots.len());
    if stack.phi.shape() != expected || stack.run.scene_hash != record.scene_hash {
        let place = folder.join(FRAMES);
        let cause = format!("the frames in {} are of another run", place.display());
        return Err(FolderError::new(cause, "restore them, or render again"));
    }
    let named = |n: usize| film::frame::bounce_channel(n + 1);
    let found = stack.bounces.into_iter().enumerate();
    let found = found.take_while(|(n, (name, _))| *name == named(*n));
    Ok(found.map(|(_, (_, matrix))| matrix).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::file::SceneFile;
    use crate::transport::{Budget, Control, Estimator, Sampling, render};

    /// What is read back is what was written: the light of each number of surfaces to the f32 of
    /// the frames; none of a run without frames; a frame that was changed is refused.
    #[test]
    fn light_by_bounces_is_read_back() {
        let mut file = SceneFile {
            max_bounces: 5,
            ..SceneFile::default()
        };
        file.laser.as_mut().unwrap().spots.per_side = Some(2);
        let scene = Scene::new(&file, None).unwrap();
        let plan = Plan {
            estimator: Estimator::Shared,
            sampling: Sampling::Pcg,
            seed: 1,
            budget: Budget::new(8, Sampling::Pcg).unwrap(),
        };
        let spots = scene.laser.spots.len();
        let traced = render(&scene, &plan, 0..spots, Control::none()).unwrap();
        assert!(traced.bounces[4].amax() > 0.0);
        let dir = tempfile::tempdir().unwrap();
        let folder = dir.path().join("run");
        write_run(&folder, &scene, &plan, &traced, (1.0, 1)).unwrap();
        let found = read_run(&folder, &[]).unwrap();
        assert_eq!(found.flux, traced.flux);
        let f32_of = |m: &Matrix| m.map(|x| f64::from(x as f32));
        let wanted: Vec<Matrix> = traced.bounces.iter().map(f32_of).collect();
        assert_eq!(found.bounces, Some(wanted));
        let frame = folder.join(FRAMES).join(frame_name(1));
        let other = std::fs::read(folder.join(FRAMES).join(frame_name(0))).unwrap();
        let own = std::fs::read(&frame).unwrap();
        std::fs::write(&frame, &other).unwrap();
        assert!(read_run(&folder, &[]).is_err());
        let mut changed = own;
        let last = changed.len() - 1;
        changed[last] ^= 1;
        std::fs::write(&frame, &changed).unwrap();
        assert!(read_run(&folder, &[]).is_err());
        std::fs::remove_dir_all(folder.join(FRAMES)).unwrap();
        assert_eq!(read_run(&folder, &[]).unwrap().bounces, None);
    }
}
