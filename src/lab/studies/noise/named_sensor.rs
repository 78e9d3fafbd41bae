//! A sensor of a study, with its name.

use crate::scene::{Scene, SensorModel};
use crate::sensor::{Sensor, SensorError};

/// A sensor with its name, and how many frames it takes.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedSensor {
    /// Its name.
    pub name: String,
    /// The sensor.
    pub sensor: Sensor,
    /// Frames that are averaged.
    pub frames: u32,
    /// Frames without laser that are averaged and subtracted.
    pub dark_frames: u32,
}

impl NamedSensor {
    /// A built-in sensor that takes one frame, and one dark frame.
    pub(crate) fn builtin(model: SensorModel) -> Self {
        Self {
            name: model.name().to_owned(),
            sensor: Sensor::builtin(model),
            frames: 1,
            dark_frames: 1,
        }
    }

    /// The built-in sensor of this kind, or else that of the scene with its frames, or else the
    /// CCD.
    ///
    /// # Errors
    /// [`SensorError`], where the scene's has no meaning.
    pub fn studied(model: Option<SensorModel>, scene: &Scene) -> Result<Self, SensorError> {
        if let (None, Some(own)) = (model, &scene.sensor) {
            let (frames, dark_frames) = (own.frames.unwrap_or(1), own.dark_frames.unwrap_or(0));
            return Ok(Self {
                name: match (frames, dark_frames) {
                    (1, 1) => format!("of {}", scene.name),
                    _ => format!(
                        "of {}, frames {frames}, dark frames {dark_frames}",
                        scene.name
                    ),
                },
                sensor: Sensor::from_settings(own)?,
                frames,
                dark_frames,
            });
        }
        Ok(Self::builtin(model.unwrap_or(SensorModel::Ccd)))
    }
}
