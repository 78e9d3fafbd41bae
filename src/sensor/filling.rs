//! How long a sensor may be exposed.

use super::figures::Sensor;
use crate::num::units::photon_energy;

/// A photograph of the longest bearable exposure fills the fullest pixel to this share of what it
/// holds.
const FILLED: f64 = 0.5;
/// Exposure of a sensor without limits, s.
const UNLIMITED: f64 = 1.0;

impl Sensor {
    /// The exposure, s, after which the mean signal of a pixel of flux `brightest` (W, light of
    /// `wavelength` in m) is what well or converter hold: min(full well, (top −
    /// offset)·K)/(ηΦλ/hc + D). Infinite without limits, or without light and dark current.
    pub fn saturating_exposure(&self, brightest: f64, wavelength: f64) -> f64 {
        let figures = self.figures();
        let photons = brightest / photon_energy(wavelength);
        figures.most_electrons() / (figures.quantum_efficiency * photons + figures.dark_current)
    }

    /// Half of [`Sensor::saturating_exposure`], so that noise saturates no pixel; 1 s where that is
    /// infinite.
    pub fn longest_exposure(&self, brightest: f64, wavelength: f64) -> f64 {
        match self.saturating_exposure(brightest, wavelength) {
            most if most.is_finite() => FILLED * most,
            _ => UNLIMITED,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::matrix::Matrix;
    use crate::scene::SensorModel;
    use crate::sensor::{Exposure, Light};

    /// Of every built-in sensor with limits: the electrons that the law of an exposure expects are
    /// half of what well or converter hold.
    #[test]
    fn the_longest_exposure_fills_the_brightest_pixel_half() {
        let flux = Matrix::from_row_slice(1, 2, &[3e-15, 7e-15]);
        let light = Light::new(&flux, 632.8e-9).unwrap();
        for model in SensorModel::ALL {
            let sensor = Sensor::builtin(model);
            let time = sensor.longest_exposure(flux.max(), 632.8e-9);
            let electrons = sensor
                .expected(&light, &Exposure::new(&[time], 1, 1).unwrap())
                .electrons;
            let figures = sensor.figures();
            let most = figures
                .full_well
                .min((figures.top() - figures.offset) * figures.gain);
            if most.is_finite() {
                assert!((electrons.max() / most - 0.5).abs() < 1e-12, "{model:?}");
            } else {
                assert_eq!(time, 1.0, "{model:?}");
            }
        }
    }
}
