//! Gain and read noise of a sensor, from frames that it took.

use rayon::prelude::*;
use serde::Serialize;

use super::figures::Sensor;
use crate::num::stream::{Key, Sampling, Stream};

/// What a laboratory measures of a sensor before the experiment, all in counts. Pairs of frames of
/// equal, even light differ by noise alone, so that half the mean square of their difference is the
/// variance of a frame; over the mean it rises by 1/K (Janesick, *Photon Transfer*, 2007; EMVA
/// 1288).
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PhotonTransfer {
    /// Mean of frames of no light and no time.
    pub offset: f64,
    /// Their variance, counts²: read noise and rounding.
    pub bias_variance: f64,
    /// What a count of signal adds to the variance, counts: 1/K where electrons come at random.
    pub slope: f64,
}

/// Pixels whose pairs are compared: a variance is then known to √(2/65536) = 0.6 %, and the slope,
/// from all levels together, to 0.2 %.
const PIXELS: u32 = 65_536;
/// Levels of light, in equal steps up to half of what a pixel holds.
const LEVELS: u32 = 8;
/// Half of that in a sensor that holds any number of electrons, beyond a hundred times its read
/// noise.
const BRIGHT: f64 = 1e4;
/// Electrons beyond which no level goes.
const BRIGHTEST: f64 = 1e15;
/// Parts these random numbers from those of the tracer and of the photographs under the same seed.
const OWN: u64 = 0x7074_6361_6c69;

impl Sensor {
    /// Takes the pairs: without light, and at eight levels of light. The same seed gives the same
    /// bits.
    pub fn photon_transfer(&self, seed: u64) -> PhotonTransfer {
        let figures = self.figures();
        let brightest = match figures.most_electrons() {
            most if most.is_finite() => 0.5 * most,
            _ => BRIGHT + 100.0 * figures.read_noise * figures.read_noise,
        }
        .min(BRIGHTEST);
        let levels: Vec<(f64, f64)> = (0..=LEVELS)
            .into_par_iter()
            .map(|level| {
                let mean = brightest * f64::from(level) / f64::from(LEVELS);
                self.pairs(mean, level, seed ^ OWN)
            })
            .collect();
        let (offset, bias_variance) = levels[0];
        let beyond = |f: &dyn Fn(&(f64, f64)) -> f64| levels[1..].iter().map(f).sum::<f64>();
        PhotonTransfer {
            offset,
            bias_variance,
            slope: beyond(&|l| l.1 - bias_variance) / beyond(&|l| l.0 - offset),
        }
    }

    /// Mean and variance of a frame of `mean` electrons, from a pair of each pixel.
    fn pairs(&self, mean: f64, level: u32, seed: u64) -> (f64, f64) {
        let (mut sum, mut squares) = (0.0, 0.0);
        for pixel in 0..PIXELS {
            let key = Key {
                seed,
                spot: Key::ALL_SPOTS,
                pixel,
                block: level,
            };
            let mut stream = Stream::new(Sampling::Pcg, key);
            let [a, b] = [(); 2].map(|()| self.figures().frame(mean, &mut stream).0);
            sum += 0.5 * (a + b);
            squares += 0.5 * (a - b) * (a - b);
        }
        let n = f64::from(PIXELS);
        (sum / n, squares / n)
    }
}

impl PhotonTransfer {
    /// Variance of a frame of `counts`, counts². A frame cannot have less noise than one without
    /// light, but holding it there would be wrong on average by 16 % in the dark (machine-vision):
    /// it is held at half, which read noise alone reaches in a frame of twenty there, and never in
    /// the others.
    pub(super) fn variance(&self, counts: f64) -> f64 {
        let variance = self.bias_variance + self.slope * (counts - self.offset);
        variance.max(0.5 * self.bias_variance)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::SensorModel;

    /// Gain and read noise come out as the figures have them, within four standard errors.
    #[test]
    fn pairs_of_frames_tell_gain_and_read_noise() {
        for model in SensorModel::ALL {
            let sensor = Sensor::builtin(model);
            let figures = sensor.figures();
            let found = sensor.photon_transfer(1);
            if model == SensorModel::Ideal {
                assert_eq!(
                    (found.offset, found.bias_variance, found.slope),
                    (0.0, 0.0, 0.0)
                );
                continue;
            }
            let read = figures.read_noise / figures.gain;
            let bias = read * read + 1.0 / 12.0;
            let error = (2.0 / f64::from(PIXELS)).sqrt();
            assert!(
                (found.bias_variance / bias - 1.0).abs() < 4.0 * error,
                "{model:?}"
            );
            // Weights ∝ level, of eight levels: √Σk²/Σk = 0.4.
            assert!(
                (found.slope * figures.gain - 1.0).abs() < 4.0 * 0.4 * error,
                "{model:?}"
            );
            assert!((found.offset - 100.0).abs() < 4.0 * (bias / f64::from(2 * PIXELS)).sqrt());
        }
    }
}
