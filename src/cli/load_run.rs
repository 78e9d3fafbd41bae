//! A finished run, read back.

use std::path::Path;

use crate::cli::console::Console;
use crate::cli::failure::Failure;
use crate::cli::run_folder::{CALIBRATION, IMPORT, IMPORT_PNG, LEFT_OUT, SCENE, TAILS};
use crate::folder::Record;
use crate::jobs::need;
use crate::matrix::Matrix;
use crate::matrix::npy::{self, NpyError};
use crate::scene::{COPIES, Scene, builtins};
use crate::store;

/// The scene and the record of a finished run.
pub(super) fn read_run(dir: &Path, console: Console) -> Result<(Scene, Record), Failure> {
    let record = Record::read(dir)?.ok_or_else(|| {
        let shown = dir.display();
        let cause = if dir.exists() {
            format!(
                "{shown} is not the folder of a run: it has no {}",
                Record::FILE
            )
        } else {
            format!("{shown} is not the folder of a run: it is not there")
        };
        Failure::new(cause, folder_meant(dir))
    })?;
    record.check_lengths(dir, COPIES)?;
    let path = dir.join(SCENE);
    let name = path.to_string_lossy();
    // Photographs need no albedo.
    let scene = if record.is_imported() {
        console.of_folders().load_any_scene(&name)?
    } else {
        console.of_folders().load_scene(&name)?
    };
    if record.check(dir, SCENE).is_err() {
        console.say(format!(
            "warning: {} was edited after the run was finished",
            path.display()
        ));
    }
    record.check_scene(dir, &scene)?;
    // No other command reads how photographs were imported.
    for name in [IMPORT, IMPORT_PNG] {
        if dir.join(name).exists() {
            record.check(dir, name)?;
        }
    }
    Ok((scene, record))
}

/// The scene of photographs that come without a run. It is told where `phicam calibrate` wrote it
/// and it has changed since.
fn read_bare_scene(dir: &Path, console: Console) -> Result<Scene, Failure> {
    let path = dir.join(SCENE);
    let scene = console.load_any_scene(&path.to_string_lossy())?;
    if is_calibrated(dir)? == Some(false) {
        console.say(format!(
            "warning: {} is not what `phicam calibrate` wrote: it, or {}, was changed since",
            path.display(),
            dir.join(CALIBRATION).display()
        ));
    }
    Ok(scene)
}

/// Whether the scene in a folder is as `phicam calibrate` wrote it there, by the digest in its
/// account; none where there is no account.
pub(super) fn is_calibrated(dir: &Path) -> Result<Option<bool>, Failure> {
    let account = dir.join(CALIBRATION);
    if !account.exists() {
        return Ok(None);
    }
    let found: serde_json::Value =
        serde_json::from_slice(&store::read(&account, Record::LARGEST)?).unwrap_or_default();
    let written = found["scene_sha256"].as_str();
    let there = store::digest(&dir.join(SCENE)).ok();
    Ok(Some(written.is_some() && written == there.as_deref()))
}

/// The scene and the account of a run, or where photographs are given, which measured ones come
/// without, the scene in a folder.
pub(super) fn read_run_or_scene(
    dir: &Path,
    phi: Option<&Path>,
    console: Console,
) -> Result<(Scene, Option<Record>), Failure> {
    if phi.is_some() && !dir.join(Record::FILE).exists() {
        return Ok((read_bare_scene(dir, console)?, None));
    }
    let (scene, record) = read_run(dir, console)?;
    Ok((scene, Some(record)))
}

/// What to give where `given` is not the folder of a run.
fn folder_meant(given: &Path) -> String {
    let name = given.to_string_lossy();
    let of_file = given
        .ancestors()
        .skip(1)
        .find(|dir| dir.join(Record::FILE).is_file());
    match of_file {
        Some(dir) if given.is_file() && !dir.as_os_str().is_empty() => {
            format!("give its folder: `{}`", dir.display())
        }
        _ if name.ends_with(".toml") || builtins().iter().any(|b| b.name == name) => format!(
            "that is a scene: compute it first, `phicam run {name} -o out`, then give the folder `out`"
        ),
        _ if given.join("phi.npy").is_file() && given.join("scene.toml").is_file() => {
            format!(
                "photographs that phicam did not write: `phicam recover`, `calibrate`, `locate` and `validate` (with --stderr) take \
                 them with `--phi {}`, other commands take the folder that `phicam import` makes of the camera's files",
                given.join("phi.npy").display()
            )
        }
        _ => "give a folder that `phicam run`, `phicam render` or, from a camera's files, `phicam import` has written".to_owned(),
    }
}

/// Refuses a file that the run vouches for to which it belongs (that of its folder, or of the two
/// above), and that is not what was written.
pub(super) fn refuse_damaged(path: &Path) -> Result<(), Failure> {
    let full = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    for dir in full.ancestors().skip(1).take(3) {
        let name = full.strip_prefix(dir).ok().and_then(Path::to_str);
        // A run.json that cannot be read may be another program's.
        if let (Some(name), Ok(Some(record))) = (name, Record::read(dir)) {
            return Ok(record.check(dir, &name.replace('\\', "/"))?);
        }
    }
    Ok(())
}

/// Anything of the shape of Φcam: finite, pixels × spots of `scene`; of a run, what it wrote.
pub(super) fn read_matrix(path: &Path, scene: &Scene) -> Result<Matrix, Failure> {
    // By its header, before memory is taken for its numbers.
    refuse_shape(path, npy::shape(path)?, scene)?;
    need::photographs(scene, 1.0)?;
    read_undamaged(path)
}

/// A finite matrix of whatever shape; of a run, what it wrote.
pub(super) fn read_undamaged(path: &Path) -> Result<Matrix, Failure> {
    let matrix = npy::read_finite(path)?;
    refuse_damaged(path)?;
    Ok(matrix)
}

/// Φcam as [`read_matrix`]; what is not finite may stand where `left_out` says that an entry does
/// not count.
pub(super) fn read_photographs(
    path: &Path,
    left_out: Option<&Matrix>,
    scene: &Scene,
) -> Result<Matrix, Failure> {
    refuse_shape(path, npy::shape(path)?, scene)?;
    need::photographs(scene, 1.0)?;
    read_counted(path, left_out)
}

/// [`read_undamaged`], of which what is left out need not be finite.
pub(super) fn read_counted(path: &Path, left_out: Option<&Matrix>) -> Result<Matrix, Failure> {
    let matrix = counted(path, left_out)?;
    refuse_damaged(path)?;
    Ok(matrix)
}

fn counted(path: &Path, left_out: Option<&Matrix>) -> Result<Matrix, Failure> {
    npy::read_counted(path, left_out).map_err(|e| match e {
        NpyError::NotFinite {
            row, column, value, ..
        } => Failure::new(
            format!(
                "{} has the value {value} at row {row}, column {column}",
                path.display()
            ),
            "mend it, or mark that entry in the file of --left-out: only finite numbers count",
        ),
        other => other.into(),
    })
}

/// Refuses a matrix that is not pixels × spots of `scene`.
pub(super) fn refuse_shape(
    path: &Path,
    (rows, columns): (usize, usize),
    scene: &Scene,
) -> Result<(), Failure> {
    let expected = (scene.camera.pixels(), scene.laser.spots.len());
    let of = format!("scene `{}`", scene.name);
    refuse_other_shape(path, (rows, columns), expected, &of)
}

/// Refuses a matrix that is not pixels × spots of what is called `of`.
pub(super) fn refuse_other_shape(
    path: &Path,
    (rows, columns): (usize, usize),
    (pixels, spots): (usize, usize),
    of: &str,
) -> Result<(), Failure> {
    if (rows, columns) == (pixels, spots) {
        return Ok(());
    }
    let cause = format!(
        "{} is {rows} × {columns}, but {of} has {pixels} pixels and {spots} spots",
        path.display()
    );
    let cure = "give the matrix that belongs to it, pixels × spots";
    Err(Failure::new(cause, cure))
}

/// Standard errors of Φcam: as [`read_photographs`], and none negative.
pub(super) fn read_stderr(
    path: &Path,
    left_out: Option<&Matrix>,
    scene: &Scene,
) -> Result<Matrix, Failure> {
    // By its header, before memory is taken for its numbers.
    refuse_shape(path, npy::shape(path)?, scene)?;
    let matrix = counted(path, left_out)?;
    refuse_negative(path, &matrix)?;
    refuse_damaged(path)?;
    Ok(matrix)
}

/// Refuses standard errors below 0.
pub(super) fn refuse_negative(path: &Path, matrix: &Matrix) -> Result<(), Failure> {
    let Some(at) = matrix.iter().position(|x| *x < 0.0) else {
        return Ok(());
    };
    let (pixel, spot) = (at % matrix.nrows(), at / matrix.nrows());
    let cause = format!(
        "{} has the negative standard error {} at pixel {pixel}, spot {spot}",
        path.display(),
        matrix[at]
    );
    Err(Failure::new(
        cause,
        "give standard errors, or render or stack again",
    ))
}

/// Which entries of a run do not count: of a render those whose standard error is not to be
/// trusted, of photographs those that are left out; `None` if nothing says so.
pub(super) fn read_left_out(dir: &Path, scene: &Scene) -> Result<Option<Matrix>, Failure> {
    let paths = [TAILS, LEFT_OUT].map(|name| dir.join(name));
    let there = paths.iter().find(|path| path.exists());
    there.map(|path| read_matrix(path, scene)).transpose()
}
