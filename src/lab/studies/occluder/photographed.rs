//! Traced photographs through a sensor.

use serde::{Deserialize, Serialize};

use crate::lab::ensemble::Photographs;
use crate::lab::error::LabError;
use crate::lab::studies::subject::{Recovery, Subject, recovered};
use crate::model::MatrixModel;
use crate::num::stream::Sampling;
use crate::scene::{Scene, SensorModel};
use crate::sensor::{Exposure, Light, Sensor, Stated};
use crate::transport::{Budget, Control, Estimator, Plan, render};

/// How the photographs are taken.
#[derive(Clone, Copy, Debug)]
pub(super) struct Camera {
    pub sensor: SensorModel,
    /// Longest exposure of a frame, s.
    pub exposure: f64,
    /// Most frames of each spot that are averaged.
    pub frames: u32,
    /// Points of the traced light; 0 where none is traced.
    pub samples: u64,
    pub seed: u64,
}

/// What such photographs show of a picture.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Photographed {
    pub subject: Subject,
    /// Exposure of a frame, s.
    pub exposure: f64,
    /// Fewest frames of a spot, of 1, 2, 4, …, with which it is resolved, else the most tried.
    pub frames: u32,
    pub recovery: Recovery,
}

impl Camera {
    /// Traces the scene, whose hidden surfaces show `subject`, photographs it, and recovers it with
    /// ever more frames until it is resolved. Frames are exposed for at most half of what saturates
    /// the brightest pixel; the sensor subtracts as many dark frames.
    ///
    /// # Errors
    /// [`LabError`].
    pub(super) fn photograph(
        &self,
        scene: &Scene,
        model: &MatrixModel,
        subject: Subject,
        control: Control<'_>,
    ) -> Result<Photographed, LabError> {
        let plan = Plan {
            estimator: Estimator::Factored,
            sampling: Sampling::Sobol,
            seed: self.seed,
            budget: Budget::new(self.samples, Sampling::Sobol)?,
        };
        let traced = render(scene, &plan, 0..scene.laser.spots.len(), control)?;
        let sensor = Sensor::builtin(self.sensor);
        let wavelength = scene.laser.wavelength;
        let light = Light::new(&traced.flux, wavelength)?;
        let light = light.with_render_error(&traced.stderr, plan.budget.blocks)?;
        let most = sensor.longest_exposure(traced.flux.max(), wavelength);
        let exposure = self.exposure.min(most);
        let truth = subject.albedo(scene, model);
        let mut frames = 1;
        loop {
            let shot = Exposure::new(&[exposure], frames, frames)?;
            let taken = sensor.expose(&light, &shot, Stated::Oracle, self.seed)?;
            let photographs = Photographs::told(taken.flux, taken.stderr);
            let recovery = recovered(model, subject, &truth, &photographs, control)?;
            if recovery.is_resolved() || 2 * frames > self.frames {
                return Ok(Photographed {
                    subject,
                    exposure,
                    frames,
                    recovery,
                });
            }
            frames *= 2;
        }
    }
}
