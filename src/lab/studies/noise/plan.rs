//! What is studied.

use super::axis::NoiseAxis;
use super::picture::Picture;
use crate::lab::comparison::validation::Integration;
use crate::lab::error::LabError;
use crate::lab::problem::inverted;
use crate::model::{Effort, Kernel, MatrixModel, ModelError, Occlusion};
use crate::recovery::Method;
use crate::scene::Scene;

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
    /// How both integrate.
    pub integration: Integration,
    /// What is varied.
    pub axis: NoiseAxis,
    /// Its levels, from quiet to loud ([`NoiseAxis::quiet_first`]).
    pub levels: Vec<f64>,
    /// Draws of the noise.
    pub seeds: u64,
    /// Seed of the first.
    pub first_seed: u64,
}

impl NoisePlan {
    /// What trials have to share to belong to one study, in words: program, scene, kernel, axis and
    /// sensor.
    pub fn study(&self, scene: &Scene) -> String {
        format!(
            "phicam {} study noise of scene {} ({}), {} kernel, {}, {}",
            env!("CARGO_PKG_VERSION"),
            scene.name.replace(['\n', '\r'], " "),
            scene.hash,
            self.kernel.name(),
            self.integration.name(),
            self.axis.identity()
        )
    }

    /// The levels of a plan that names none, from quiet to loud.
    ///
    /// # Errors
    /// [`LabError`], where they depend on the brightest object.
    pub fn default_levels(&self, scene: &Scene) -> Result<Vec<f64>, LabError> {
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
    fn brightest(&self, scene: &Scene) -> Result<f64, LabError> {
        let mut brightest = 0.0f64;
        for object in self.objects(scene) {
            brightest = brightest.max(self.model(scene, object)?.phi().max());
        }
        if brightest > 0.0 {
            Ok(brightest)
        } else {
            Err(LabError::DARK_OBJECT)
        }
    }

    /// What an object's light is, and what it is recovered with.
    pub(super) fn model(
        &self,
        scene: &Scene,
        (picture, elements): (Picture, usize),
    ) -> Result<MatrixModel, ModelError> {
        inverted(
            &picture.on(scene),
            self.kernel,
            Some([elements; 2]),
            Occlusion::Considered,
            (self.integration, Effort::USUAL),
        )
    }

    /// Refuses exposures that saturate whatever the noise.
    pub(super) fn refuse_saturation(&self, scene: &Scene) -> Result<(), LabError> {
        let NoiseAxis::Exposure(camera) = &self.axis else {
            return Ok(());
        };
        let brightest = self.brightest(scene)?;
        let most = camera
            .sensor
            .saturating_exposure(brightest, scene.laser.wavelength);
        match self.levels.iter().find(|level| **level > most) {
            Some(&exposure) => Err(LabError::Saturated { exposure, most }),
            None => Ok(()),
        }
    }

    /// Of the objects the scene's own, at its own elements or else at the most; none where it is
    /// not among them.
    pub(super) fn own(scene: &Scene, objects: &[(Picture, usize)]) -> Option<(Picture, usize)> {
        let picture = Picture::of(scene)?;
        let own = objects.iter().copied().filter(|(p, _)| *p == picture);
        let elements = scene.hidden().next().map(|(_, s)| s.elements);
        own.max_by_key(|(_, e)| (elements == Some([*e; 2]), *e))
    }

    /// Boards whose checks divide none of the elements.
    pub(super) fn unplaced(&self) -> Vec<usize> {
        let divides = |checks: &usize| self.elements.iter().any(|e| e % checks == 0);
        let all = self.boards.iter().copied();
        all.filter(|checks| !divides(checks)).collect()
    }

    /// Objects with the elements that they are recovered at: the scene's own picture, where it is
    /// no board, and the boards.
    pub(super) fn objects(&self, scene: &Scene) -> Vec<(Picture, usize)> {
        let boards = self.boards.iter().map(|b| Picture::Board(*b));
        let own = Picture::of(scene).filter(|own| *own == Picture::Own);
        let pictures = own.into_iter().chain(boards);
        let at = |picture| self.elements.iter().map(move |e| (picture, *e));
        let divides = |(picture, e): &(Picture, usize)| match picture {
            Picture::Own => true,
            Picture::Board(checks) => e % checks == 0,
        };
        pictures.flat_map(at).filter(divides).collect()
    }
}
