//! From what a scene says to a sensor and an exposure.

use super::error::SensorError;
use super::exposure::Exposure;
use super::figures::{Figures, Sensor, ShotNoise};
use crate::scene::SensorSettings;

impl Sensor {
    /// The sensor of a scene's settings: the built-in one, with the figures that are given in place
    /// of its own. Without a model the others are those of the ideal sensor, but for shot noise,
    /// which it then has.
    ///
    /// # Errors
    /// [`SensorError::Figure`], [`SensorError::Offset`].
    pub fn from_settings(settings: &SensorSettings) -> Result<Self, SensorError> {
        let base = match settings.model {
            Some(model) => *Self::builtin(model).figures(),
            None => Figures {
                shot_noise: ShotNoise::Poisson,
                ..Figures::IDEAL
            },
        };
        let s = settings;
        Self::new(Figures {
            quantum_efficiency: s.quantum_efficiency.unwrap_or(base.quantum_efficiency),
            dark_current: s.dark_current.unwrap_or(base.dark_current),
            full_well: s.full_well.unwrap_or(base.full_well),
            read_noise: s.read_noise.unwrap_or(base.read_noise),
            gain: s.gain.unwrap_or(base.gain),
            bits: s.bits.or(base.bits),
            offset: s.offset.unwrap_or(base.offset),
            shot_noise: match s.shot_noise {
                Some(true) => ShotNoise::Poisson,
                Some(false) => ShotNoise::None,
                None => base.shot_noise,
            },
            relative_noise: s.relative_noise.unwrap_or(base.relative_noise),
        })
    }
}

impl Exposure {
    /// The exposure of a scene's settings: one frame of 1 s unless they say otherwise.
    ///
    /// # Errors
    /// [`SensorError::NoTime`], [`SensorError::Figure`].
    pub fn from_settings(settings: &SensorSettings) -> Result<Self, SensorError> {
        let single = [settings.exposure.unwrap_or(1.0)];
        Self::new(
            settings.brackets.as_deref().unwrap_or(&single),
            settings.frames.unwrap_or(1),
            settings.dark_frames.unwrap_or(0),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::SensorModel;

    #[test]
    fn figures_that_are_given_replace_those_of_the_model() {
        let ccd = SensorSettings {
            model: Some(SensorModel::Ccd),
            read_noise: Some(3.0),
            bits: Some(0),
            ..SensorSettings::default()
        };
        let found = Sensor::from_settings(&ccd).unwrap();
        let expected = Figures {
            read_noise: 3.0,
            bits: None,
            ..*Sensor::builtin(SensorModel::Ccd).figures()
        };
        assert_eq!(*found.figures(), expected);
        let bare = Sensor::from_settings(&SensorSettings::default()).unwrap();
        assert_eq!(bare.figures().shot_noise, ShotNoise::Poisson);
        let silent = SensorSettings {
            shot_noise: Some(false),
            ..SensorSettings::default()
        };
        let silent = Sensor::from_settings(&silent).unwrap();
        assert_eq!(silent, Sensor::builtin(SensorModel::Ideal));
    }

    #[test]
    fn an_offset_must_leave_room() {
        let settings = SensorSettings {
            bits: Some(8),
            offset: Some(255.0),
            ..SensorSettings::default()
        };
        let error = Sensor::from_settings(&settings).unwrap_err();
        assert_eq!(
            error,
            SensorError::Offset {
                offset: 255.0,
                top: 255.0
            }
        );
    }

    #[test]
    fn exposure_times_are_the_longest_first() {
        let settings = SensorSettings {
            brackets: Some(vec![0.1, 10.0, 1.0]),
            ..SensorSettings::default()
        };
        let exposure = Exposure::from_settings(&settings).unwrap();
        assert_eq!(exposure.times(), [10.0, 1.0, 0.1]);
        assert_eq!((exposure.frames(), exposure.dark_frames()), (1, 0));
    }
}
