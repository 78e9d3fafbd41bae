//! `phicam recover --camera-side`: with matrices measured or computed elsewhere, without a scene.

use std::path::Path;

use super::beside::{Beside, PhotographSize, relative_errors, warn_of_exact};
use super::mask::{left_out, mask};
use super::recover_options::{self, uncertainty};
use super::recovered::{collect, recovering, tell, write};
use crate::cli::Outcome;
use crate::cli::args::RecoverArgs;
use crate::cli::console::Console;
use crate::cli::failure::Failure;
use crate::cli::load_run::{read_counted, read_undamaged, refuse_negative};
use crate::cli::run_folder::{RunFolder, SATURATED};
use crate::lab::{Certainty, Errors, Noise, by_trust, recover_with_picards};
use crate::matrix::{Matrix, npy};
use crate::model::MatrixModel;
use crate::recovery::{Method, Options};
use crate::store::memory;

/// Copies of all matrices that are held at once.
const HELD: f64 = 6.0;

/// Recovers x of Φ = C diag(x) D + noise.
pub(super) fn execute(
    args: &RecoverArgs,
    camera_side: &Path,
    named: &[Method],
    options: Options,
    console: Console,
) -> Result<Outcome, Failure> {
    let (Some(phi_file), Some(out)) = (&args.phi, &args.output) else {
        let cause = "--camera-side needs to know what to invert, and where to write";
        return Err(Failure::usage(cause, "give --phi FILE and -o FOLDER"));
    };
    let sizes = [
        Some(phi_file.as_path()),
        Some(camera_side),
        args.laser_side.as_deref(),
    ]
    .into_iter()
    .flatten();
    let entries: f64 = sizes
        .map(|file| npy::shape(file).map(|(rows, columns)| rows as f64 * columns as f64))
        .sum::<Result<_, _>>()?;
    memory::refuse("these matrices", HELD * 8.0 * entries, &[])?;
    let (pixels, spots) = npy::shape(phi_file)?;
    let camera = read_undamaged(camera_side)?;
    let laser = match &args.laser_side {
        Some(file) => read_undamaged(file)?,
        None => Matrix::from_element(camera.ncols(), spots, 1.0),
    };
    let elements = camera.ncols();
    let count = args.elements.unwrap_or([elements, 1]);
    let model = MatrixModel::of_sides(camera, laser, count)?;
    // Without a grid nobody knows which elements are neighbours.
    let alone = |method: &Method| args.elements.is_some() || !method.compares_neighbours();
    let methods: Vec<Method> = if named.is_empty() {
        Method::tried(elements).into_iter().filter(alone).collect()
    } else {
        named.to_vec()
    };
    if let Some(method) = methods.iter().find(|method| !alone(method)) {
        let cause = format!("{method} compares neighbours, and nothing says how the elements lie");
        return Err(Failure::new(cause, "give --elements NxM, or use joint"));
    }
    recover_options::checked(args, &methods, elements)?;
    let of = PhotographSize {
        name: phi_file.display().to_string(),
        grid: args.pixels,
        pixels,
        spots,
    };
    if let Some([columns, rows]) = args.pixels.filter(|[c, r]| c * r != pixels) {
        let cause = format!(
            "--pixels {columns}x{rows} are {} pixels, and {} has {}",
            columns * rows,
            of.name,
            pixels
        );
        return Err(Failure::new(
            cause,
            "give columns and rows of the photographs",
        ));
    }
    let asked = args.left_out.as_deref();
    let clipped = phi_file.with_file_name(SATURATED);
    if clipped.exists() && !args.keep_clipped && mask(asked, phi_file).is_none() {
        let cause = format!("{} says which entries mean nothing", clipped.display());
        let cure = format!(
            "--left-out {} leaves them out; --keep-clipped takes them",
            clipped.display()
        );
        return Err(Failure::new(cause, cure));
    }
    let left_out = left_out(asked, phi_file, &of, console)?;
    let phi = read_counted(phi_file, left_out.as_ref())?;
    let stderr = match (&args.stderr, args.noise) {
        (Some(file), _) => {
            let stderr = read_counted(file, left_out.as_ref())?;
            refuse_negative(file, &stderr)?;
            warn_of_exact((&phi, &stderr), left_out.as_ref(), console);
            Some(stderr)
        }
        (None, Some(noise)) => Some(relative_errors(
            (&phi, noise),
            left_out.as_ref(),
            &methods,
            console,
        )?),
        (None, None) => None,
    };
    let noise = stderr.as_ref().map_or(Noise::Unknown, |stderr| {
        let certainty = Certainty::new(Errors::Independent, args.replicates);
        Noise::StandardError(stderr, certainty)
    });
    let beside = Beside::read(&args.beside, left_out, &of)?;
    let options = Options {
        uncertainty: uncertainty(&model, console),
        frame: of.grid,
        ..options
    };
    let nuisance = beside.nuisance(&args.beside);
    let (attempts, picards) = recovering(console, "recover", &methods, |control| {
        recover_with_picards(&model, &phi, noise, nuisance, &methods, &options, control)
    });
    let mut objects = collect(attempts, named, console)?;
    if named.is_empty() {
        by_trust(&mut objects);
    }
    let _own = RunFolder::lock(out, "phicam recover")?;
    write(out, None, &objects, &picards?)?;
    console.say(format!("{}: written", out.display()));
    tell(&objects, args.json)
}
