//! A recovery that is asked for, from all of Φcam or from its rows.

use std::path::{Path, PathBuf};

use super::is_own;
use crate::cli::args::RecoverArgs;
use crate::cli::commands::beside::{
    Beside, PhotographSize, relative_errors, warn_of_exact, warn_of_untrusted,
};
use crate::cli::commands::mask::{left_out, mask, refuse_clipped};
use crate::cli::commands::recover_memory::{self, Errors, Strips};
use crate::cli::commands::recover_options::uncertainty;
use crate::cli::commands::recovered::recovering;
use crate::cli::console::Console;
use crate::cli::failure::Failure;
use crate::cli::load_run::{read_photographs, read_stderr};
use crate::cli::progress::clocked;
use crate::cli::run_folder::{PHI, STDERR};
use crate::folder::Record;
use crate::lab::{Attempt, Certainty, Integration, Noise, inverted, recover_with_picards};
use crate::model::{Effort, MatrixModel};
use crate::recovery::{Method, Options, Picard};
use crate::scene::Scene;

/// A recovery that was asked for.
pub(super) struct RecoveryRequest<'a> {
    pub(super) args: &'a RecoverArgs,
    /// Folder of the run.
    pub(super) dir: &'a Path,
    pub(super) scene: &'a Scene,
    pub(super) methods: &'a [Method],
    pub(super) options: Options,
    pub(super) certainty: Certainty,
    /// Whether the run's photographs were imported: their noise may be unknown.
    pub(super) is_imported: bool,
    /// File of Φcam.
    pub(super) phi: PathBuf,
    pub(super) console: Console<'a>,
}

impl RecoveryRequest<'_> {
    /// From all of Φcam at once, with Picard plots.
    pub(super) fn whole(&self) -> Result<(Vec<Attempt>, Vec<Picard>), Failure> {
        let Self { args, scene, .. } = *self;
        let of = PhotographSize::of_scene(scene);
        let left_out = left_out(args.left_out.as_deref(), &self.phi, &of, self.console)?;
        let phi = read_photographs(&self.phi, left_out.as_ref(), scene)?;
        self.refuse_clipped()?;
        let stderr = match self.errors() {
            Errors::Relative(noise) => {
                let known =
                    relative_errors((&phi, noise), left_out.as_ref(), self.methods, self.console)?;
                Some(known)
            }
            Errors::File(file) => {
                let stderr = read_stderr(&file, left_out.as_ref(), scene)?;
                warn_of_exact((&phi, &stderr), left_out.as_ref(), self.console);
                if left_out.is_none() {
                    warn_of_untrusted(&file, &of, self.console)?;
                }
                Some(stderr)
            }
            Errors::Unknown => {
                self.console.say(
                    "no noise model is given (--noise or --stderr): joint weights all entries alike",
                );
                None
            }
        };
        let occlusion = args.occlusion.occlusion();
        let integration = args.integration.unwrap_or(Integration::Quadrature);
        let by = (integration, Effort::FINEST);
        let model = clocked(self.console, &format!("model of {}", scene.name), || {
            inverted(scene, args.kernel, args.elements, occlusion, by)
        })?;
        let noise = stderr.as_ref().map_or(Noise::Unknown, |stderr| {
            Noise::StandardError(stderr, self.certainty)
        });
        let beside = Beside::read(&args.beside, left_out, &of)?;
        let nuisance = beside.nuisance(&args.beside);
        let options = Options {
            uncertainty: uncertainty(&model, self.console),
            frame: of.grid,
            ..self.options
        };
        let what = format!("recover {}", scene.name);
        let (attempts, picards) = recovering(self.console, &what, self.methods, |control| {
            recover_with_picards(
                &model,
                &phi,
                noise,
                nuisance,
                self.methods,
                &options,
                control,
            )
        });
        Ok((attempts, picards?))
    }

    /// From so many pixels of Φcam at a time.
    pub(super) fn strips(&self, pixels: usize) -> Result<Vec<Attempt>, Failure> {
        let Self { args, scene, .. } = *self;
        let phi = recover_memory::open(&self.phi, scene)?;
        self.refuse_clipped()?;
        if let Some(mask) = mask(args.left_out.as_deref(), &self.phi) {
            let cause = format!(
                "{} says which entries do not count, and no method that reads Φcam by rows can leave them out",
                mask.display()
            );
            let cure = "use a joint method, with enough --memory for all of Φcam";
            return Err(Failure::new(cause, cure));
        }
        let errors = match self.errors() {
            Errors::Relative(noise) => Errors::Relative(noise),
            Errors::File(file) => Errors::File(Box::new(recover_memory::open(&file, scene)?)),
            Errors::Unknown => Errors::Unknown,
        };
        let occlusion = args.occlusion.occlusion();
        let model = MatrixModel::without_photographs(scene, args.kernel, args.elements, occlusion)?;
        self.console.say(
            "Φcam is read by rows: no covariance, resolution or bias, no Picard plot, and whether any reflectances \
             explain it is not asked",
        );
        let mut strips = Strips {
            model: &model,
            phi,
            errors,
            certainty: self.certainty,
            pixels,
        };
        strips.recover(self.methods, &self.options)
    }

    /// Of a foreign Φcam nothing is known but what is given.
    fn errors(&self) -> Errors<PathBuf> {
        match (&self.args.stderr, self.args.noise) {
            (_, Some(noise)) => Errors::Relative(noise),
            (Some(file), None) => Errors::File(file.clone()),
            (None, None) if is_own(self.args.phi.as_deref(), self.dir, PHI) => {
                let file = self.dir.join(STDERR);
                let is_run = self.dir.join(Record::FILE).exists();
                if (self.is_imported || !is_run) && !file.exists() {
                    return Errors::Unknown;
                }
                Errors::File(file)
            }
            (None, None) => Errors::Unknown,
        }
    }

    /// Refuses photographs of `phicam expose` whose values mean nothing in places.
    fn refuse_clipped(&self) -> Result<(), Failure> {
        let asked = self.args.keep_clipped || self.args.left_out.is_some();
        if self.args.phi.is_none() || asked {
            return Ok(());
        }
        let cure = " of the joint methods; --keep-clipped takes them as they are";
        refuse_clipped(&self.phi, self.scene, cure)
    }
}
