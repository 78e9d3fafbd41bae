//! Built-in sensors. Where their figures come from stands in `builtin.md`, which is part of this
//! floor's documentation.

use super::figures::{Figures, Sensor, ShotNoise};
use crate::scene::SensorModel;

/// Counts of a dark pixel in the sensors that have noise.
const OFFSET: f64 = 100.0;

impl Sensor {
    /// A built-in sensor.
    pub fn builtin(model: SensorModel) -> Self {
        Self(figures(model))
    }
}

/// What a built-in sensor is, in a few words.
pub fn summary(model: SensorModel) -> &'static str {
    match model {
        SensorModel::Ideal => "no noise, no limit, an electron for every photon",
        SensorModel::Ccd => "cooled scientific CCD: Kodak KAF-3200ME at 0 °C",
        SensorModel::Dslr => "ordinary DSLR: Nikon D3 at ISO 200, red pixels",
        SensorModel::MachineVision => "machine-vision CMOS: Sony IMX183, monochrome",
    }
}

fn figures(model: SensorModel) -> Figures {
    let real = Figures {
        offset: OFFSET,
        shot_noise: ShotNoise::Poisson,
        ..Figures::IDEAL
    };
    match model {
        SensorModel::Ideal => Figures::IDEAL,
        SensorModel::Ccd => Figures {
            quantum_efficiency: 0.79,
            dark_current: 0.080,
            full_well: 70_000.0,
            read_noise: 12.6,
            gain: 1.413,
            bits: Some(16),
            ..real
        },
        SensorModel::Dslr => Figures {
            quantum_efficiency: 0.3,
            dark_current: 0.5,
            full_well: 65_600.0,
            read_noise: 4.3 * 4.1,
            gain: 4.1,
            bits: Some(14),
            ..real
        },
        SensorModel::MachineVision => Figures {
            quantum_efficiency: 0.72,
            dark_current: 1.0,
            full_well: 14_837.0,
            read_noise: 3.1,
            gain: 4.17,
            bits: Some(12),
            ..real
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_built_in_sensor_makes_sense() {
        for model in SensorModel::ALL {
            let sensor = Sensor::builtin(model);
            assert_eq!(Sensor::new(*sensor.figures()), Ok(sensor), "{model:?}");
            // The full well, not the converter, is what ends the range of the real ones.
            let figures = sensor.figures();
            assert!(figures.full_well / figures.gain + figures.offset <= figures.top());
        }
    }
}
