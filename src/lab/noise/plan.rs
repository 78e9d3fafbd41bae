//! What is studied, and why it cannot be.

use super::axis::NoiseAxis;
use crate::model::{Kernel, MatrixModel, ModelError};
use crate::recovery::Method;
use crate::scene::Scene;
use crate::transport::{RenderError, Stopped};

/// What is studied.
#[derive(Clone, Debug, PartialEq)]
pub struct NoisePlan {
    /// Checks a side of the objects.
    pub boards: Vec<usize>,
    /// Elements a side of the recoveries; those that a board does not divide are left out with it.
    pub elements: Vec<usize>,
    /// The methods.
    pub methods: Vec<Method>,
    /// Kernel of the data and of the inversion.
    pub kernel: Kernel,
    /// What is varied.
    pub axis: NoiseAxis,
    /// Its levels, from quiet to loud ([`NoiseAxis::quiet_first`]).
    pub levels: Vec<f64>,
    /// Draws of the noise.
    pub seeds: u64,
    /// Seed of the first.
    pub first_seed: u64,
}

/// Why there is no study.
#[derive(Debug, thiserror::Error)]
pub enum NoiseError {
    /// The scene has no model.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// No board divides any number of elements.
    #[error(
        "no number of elements is a multiple of a number of checks, so there is no object to study (use e.g. 2 checks and 8 elements)"
    )]
    NoObject,
    /// No light.
    #[error("no light from the object reaches the camera (see `phicam scene check`)")]
    Dark,
    /// No glare to be had.
    #[error(
        "no light enters the lens straight from any spot, so there is no glare to study (let the camera face the wall where the spots are)"
    )]
    NoGlare,
    /// Not a number of paths.
    #[error("{0} samples cannot be traced (use 1 to 2³²)")]
    Samples(u64),
    /// The light was not traced.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// It was stopped.
    #[error("{0}")]
    Stopped(#[from] Stopped),
    /// Nothing but saturated pixels.
    #[error(
        "an exposure of {exposure:e} s saturates the brightest pixel; use exposures below {most:.3e} s"
    )]
    Saturated {
        /// The exposure, s.
        exposure: f64,
        /// What fills the brightest pixel, s.
        most: f64,
    },
}

impl NoisePlan {
    /// What trials have to share to belong to one study, in words: program, scene, kernel, axis and
    /// sensor.
    pub fn study(&self, scene: &Scene) -> String {
        format!(
            "phicam {} study noise of scene {} ({}), {} kernel, {}",
            env!("CARGO_PKG_VERSION"),
            scene.name.replace(['\n', '\r'], " "),
            scene.hash,
            self.kernel.name(),
            self.axis.identity()
        )
    }

    /// The levels of a plan that names none, from quiet to loud.
    ///
    /// # Errors
    /// [`NoiseError`], where they depend on the brightest object.
    pub fn default_levels(&self, scene: &Scene) -> Result<Vec<f64>, NoiseError> {
        let longest = match &self.axis {
            NoiseAxis::Exposure(camera) => {
                let brightest = self.brightest(scene)?;
                camera
                    .sensor
                    .longest_exposure(brightest, scene.laser.wavelength)
            }
            _ => 1.0,
        };
        Ok(self.axis.levels(longest))
    }

    /// The brightest entry of all objects, W.
    fn brightest(&self, scene: &Scene) -> Result<f64, NoiseError> {
        let mut brightest = 0.0f64;
        for object in self.objects() {
            brightest = brightest.max(self.model(scene, object)?.phi().max());
        }
        if brightest > 0.0 {
            Ok(brightest)
        } else {
            Err(NoiseError::Dark)
        }
    }

    /// What an object's light is, and what it is recovered with.
    pub(super) fn model(
        &self,
        scene: &Scene,
        [board, elements]: [usize; 2],
    ) -> Result<MatrixModel, ModelError> {
        let scene = scene.with_checkerboard(board);
        MatrixModel::new(&scene, self.kernel, Some([elements; 2]))
    }

    /// Refuses exposures that saturate whatever the noise.
    pub(super) fn refuse_saturation(&self, scene: &Scene) -> Result<(), NoiseError> {
        let NoiseAxis::Exposure(camera) = &self.axis else {
            return Ok(());
        };
        let brightest = self.brightest(scene)?;
        let most = camera
            .sensor
            .saturating_exposure(brightest, scene.laser.wavelength);
        match self.levels.iter().find(|level| **level > most) {
            Some(&exposure) => Err(NoiseError::Saturated { exposure, most }),
            None => Ok(()),
        }
    }

    /// Objects with the elements that they are recovered at.
    pub(super) fn objects(&self) -> Vec<[usize; 2]> {
        let pairs = self
            .boards
            .iter()
            .flat_map(|b| self.elements.iter().map(|e| [*b, *e]));
        pairs.filter(|[b, e]| e % b == 0).collect()
    }

    /// Recoveries of the whole study.
    pub fn trials(&self) -> usize {
        self.objects().len() * self.levels.len() * self.seeds as usize * self.methods.len()
    }
}
