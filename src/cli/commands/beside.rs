//! What photographs hold beside the light of the hidden surface.

use std::path::Path;

use crate::cli::args::BesideArgs;
use crate::cli::console::Console;
use crate::cli::failure::Failure;
use crate::cli::load_run::{read_undamaged, refuse_other_shape};
use crate::cli::run_folder::TAILS;
use crate::cli::settings::within;
use crate::folder::Origin;
use crate::lab::{Certainty, Errors, polynomials};
use crate::matrix::{self, Matrix, npy};
use crate::num::digits::figure;
use crate::recovery::{Method, Nuisance, Setting};
use crate::scene::Scene;

/// Patterns that may be estimated in each frame.
const MOST_PATTERNS: usize = 64;
/// Patterns of all frames together that may be estimated beside a background: a matrix of as many
/// columns, 128 MiB.
const MOST_COUPLED: usize = 4096;

/// The size of Φcam.
pub(super) struct PhotographSize {
    /// What has it.
    pub name: String,
    /// Columns and rows of a photograph, where they are known.
    pub grid: Option<[usize; 2]>,
    pub pixels: usize,
    pub spots: usize,
}

impl PhotographSize {
    /// Of photographs of a scene.
    pub(super) fn of_scene(scene: &Scene) -> Self {
        Self {
            name: format!("scene `{}`", scene.name),
            grid: Some([scene.camera.columns, scene.camera.rows]),
            pixels: scene.camera.pixels(),
            spots: scene.laser.spots.len(),
        }
    }

    /// A matrix of the same size.
    pub(super) fn read(&self, path: &Path) -> Result<Matrix, Failure> {
        // By its header, before memory is taken for its numbers.
        let expected = (self.pixels, self.spots);
        refuse_other_shape(path, npy::shape(path)?, expected, &self.name)?;
        read_undamaged(path)
    }
}

/// The matrices that the arguments name.
pub(super) struct Beside {
    glare: Option<Matrix>,
    patterns: Option<Matrix>,
    left_out: Option<Matrix>,
}

impl Beside {
    /// Reads them; `left_out` says which entries do not count.
    pub(super) fn read(
        args: &BesideArgs,
        left_out: Option<Matrix>,
        of: &PhotographSize,
    ) -> Result<Self, Failure> {
        refuse_meaningless(args)?;
        let glare = args.glare_pattern.as_ref();
        let patterns = patterns(args, of)?;
        // A background ties the terms of all frames together.
        let of_frame = patterns.as_ref().map_or(0, Matrix::ncols);
        if args.background && of_frame.saturating_mul(of.spots) > MOST_COUPLED {
            let cause = format!(
                "--background and {of_frame} patterns in each of {} frames are too many to estimate together",
                of.spots
            );
            let cure = format!(
                "leave --background out, or use fewer patterns: {MOST_COUPLED} in all frames together"
            );
            return Err(Failure::new(cause, cure));
        }
        let glare = glare.map(|file| {
            let pattern = of.read(file)?;
            refuse_dark(file, &pattern)?;
            Ok::<_, Failure>(pattern)
        });
        Ok(Self {
            glare: glare.transpose()?,
            patterns,
            left_out,
        })
    }

    /// What is to be estimated.
    pub(super) fn nuisance(&self, args: &BesideArgs) -> Nuisance<'_> {
        Nuisance {
            frame_constant: args.frame_constant,
            frame_patterns: self.patterns.as_ref(),
            background: args.background,
            glare: self.glare.as_ref(),
            free_scale: args.free_scale,
            frame_gain: args.frame_gain,
            scale_error: args.scale_error,
            left_out: self.left_out.as_ref(),
        }
    }
}

/// Refuses patterns that are 0 everywhere: they would change nothing.
fn refuse_dark(file: &Path, pattern: &Matrix) -> Result<(), Failure> {
    if pattern.iter().any(|x| *x != 0.0) {
        return Ok(());
    }
    let cause = format!("{} is 0 everywhere", file.display());
    Err(Failure::new(
        cause,
        "leave it out, or give the pattern that was meant",
    ))
}

/// Patterns whose strength in each frame is estimated: those of a polynomial, then those of a file.
fn patterns(args: &BesideArgs, of: &PhotographSize) -> Result<Option<Matrix>, Failure> {
    let smooth = match (args.frame_polynomial, of.grid) {
        (Some(degree), Some(grid)) => Some(polynomials(grid, usize::from(degree))),
        (Some(_), None) => {
            let cause = "nothing says how the pixels lie in the photograph";
            let cure = "give --pixels COLUMNSxROWS, or the polynomials as --frame-patterns";
            return Err(Failure::new(cause, cure));
        }
        (None, _) => None,
    };
    let Some(file) = &args.frame_patterns else {
        return Ok(smooth);
    };
    let (pixels, count) = npy::shape(file)?;
    if pixels != of.pixels {
        let cause = format!(
            "{} is {pixels} × {count}, but {} has {} pixels",
            file.display(),
            of.name,
            of.pixels
        );
        return Err(Failure::new(cause, "give pixels × patterns"));
    }
    if count > MOST_PATTERNS {
        let cause = format!("{} holds {count} patterns", file.display());
        let cure = format!("give at most {MOST_PATTERNS}");
        return Err(Failure::new(cause, cure));
    }
    let own: Matrix = read_undamaged(file)?;
    refuse_dark(file, &own)?;
    Ok(Some(match smooth {
        None => own,
        Some(smooth) => {
            let all: Vec<_> = smooth.column_iter().chain(own.column_iter()).collect();
            Matrix::from_columns(&all)
        }
    }))
}

impl BesideArgs {
    /// The same for the photographs of `origin`, whose gains may be known roughly, where nothing is
    /// said of them.
    pub(super) fn of_photographs(&self, origin: &Origin, console: Console) -> Self {
        Self {
            frame_gain: frame_gain(self.frame_gain, Some(origin), console),
            ..self.clone()
        }
    }
}

/// How well the gain of each frame is known: as is `said`, or of photographs as it was imported.
pub(super) fn frame_gain(
    said: Option<f64>,
    origin: Option<&Origin>,
    console: Console,
) -> Option<f64> {
    let own = origin.and_then(Origin::frame_gain);
    if let (None, Some(own)) = (said, own) {
        console.say(format!(
            "the gains of these photographs are known to {own}: --frame-gain {own}"
        ));
    }
    said.or(own)
}

/// What is known of the errors of a run's own photographs. A `background` takes what all spots of a
/// pixel share.
pub(super) fn certainty(origin: &Origin, background: bool) -> Certainty {
    match origin.plan() {
        Some(plan) => Certainty::of(plan),
        None => {
            let shared = origin.shares_by_pixel() && !background;
            Certainty {
                unknown: origin.noise_unknown(),
                ..Certainty::new(Errors::of_photographs(shared), None)
            }
        }
    }
}

/// Standard errors of photographs with `noise` relative to each entry, for `methods`. Those that
/// work pixel by pixel weigh no entry by them, and may read photographs by rows.
pub(super) fn relative_errors(
    (phi, noise): (&Matrix, f64),
    left_out: Option<&Matrix>,
    methods: &[Method],
    console: Console,
) -> Result<Matrix, Failure> {
    if !methods.iter().any(|method| method.is_joint()) {
        return Ok(phi.map(|x| noise * x.abs()));
    }
    let (stderr, too_dark) = matrix::relative_errors(phi, noise, left_out)?;
    if too_dark > matrix::TOO_DARK {
        console.say(format!(
            "warning: fewer than 8 pixels or spots do not tell what light to expect: the noise is taken \
             relative to the entries with their noise, and where they are weighted one by one (joint-gp, \
             --weighting entries, errors that are no product of one by pixel and one by spot) the whole is too \
             dark by {} of its standard errors; give --stderr",
            figure(too_dark, 2)
        ));
    }
    Ok(stderr)
}

/// Tells of entries that count and hold light, and whose standard errors are 0.
pub(super) fn warn_of_exact(
    (phi, stderr): (&Matrix, &Matrix),
    left_out: Option<&Matrix>,
    console: Console,
) {
    let counts = |at: usize| left_out.is_none_or(|flags| flags[at] == 0.0);
    let exact = |at: &usize| stderr[*at] == 0.0 && phi[*at] != 0.0 && counts(*at);
    let all = phi.len().min(stderr.len());
    let (exact, known) = (
        (0..all).filter(exact).count(),
        stderr.iter().any(|s| *s > 0.0),
    );
    if exact > 0 && known {
        console.say(format!(
            "warning: {exact} of {} entries hold light and have a standard error of 0: they count for the picture like \
             others of their pixel and spot, and no test of it sees them; leave them out (--left-out), or give their \
             errors",
            phi.len()
        ));
    }
}

/// Tells of standard errors of traced light that are not to be trusted, by what lies beside them.
pub(super) fn warn_of_untrusted(
    stderr: &Path,
    of: &PhotographSize,
    console: Console,
) -> Result<(), Failure> {
    let tails = stderr.with_file_name(TAILS);
    if !tails.exists() {
        return Ok(());
    }
    let flags = of.read(&tails)?;
    let count = flags.iter().filter(|x| **x != 0.0).count();
    if count > 0 {
        console.say(format!(
            "warning: of {count} of {} entries the standard error is not to be trusted, says {}: whether a picture \
             fits, and its errors, count them like others; render with more --samples, or leave them out of joint \
             methods (--left-out {})",
            flags.len(),
            tails.display(),
            tails.display()
        ));
    }
    Ok(())
}

/// Refuses deviations without a meaning.
pub(super) fn refuse_meaningless(args: &BesideArgs) -> Result<(), Failure> {
    let given = [
        (Setting::FrameGain, args.frame_gain),
        (Setting::ScaleError, args.scale_error),
    ];
    for (setting, value) in given {
        let range = setting.range().unwrap_or_default();
        within(setting.name(), value, |value| setting.allows(value), range)?;
    }
    Ok(())
}
