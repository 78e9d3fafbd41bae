//! Exact light made into noisy photographs.

use super::axis::{BESIDE_SCALE, NoiseAxis, RANGE};
use crate::lab::LabError;
use crate::lab::ensemble::Photographs;
use crate::matrix::Matrix;
use crate::num::stream::{Key, Sampling, Stream};
use crate::num::units::photon_energy;
use crate::scene::{Glare, Scene};
use crate::sensor::{
    Exposure, Figures, Light, Range, Sensor, SensorError, ShotNoise, Stated, glare, glare_to_signal,
};

/// An object's light, ready to be photographed.
#[derive(Debug)]
pub(super) struct Stage {
    pub(super) axis: NoiseAxis,
    /// Φcam, pixels × spots, W.
    pub(super) exact: Matrix,
    wavelength: f64,
    /// Glare of as much light as the signal, W.
    glare: Option<Matrix>,
}

/// What takes the photographs of a level.
struct Shot {
    sensor: Sensor,
    exposure: Exposure,
    glare: Option<Matrix>,
}

impl Stage {
    pub(super) fn new(axis: &NoiseAxis, scene: &Scene, exact: Matrix) -> Result<Self, LabError> {
        if exact.max() <= 0.0 {
            return Err(LabError::DARK_OBJECT);
        }
        let glare = match axis {
            NoiseAxis::Glare(_, spread) => {
                let all = Glare {
                    fraction: 1.0,
                    spread: *spread,
                };
                let pattern = glare(scene, all);
                let ratio = glare_to_signal(&pattern, &exact);
                if ratio <= 0.0 {
                    return Err(LabError::NO_GLARE);
                }
                Some(pattern / ratio)
            }
            _ => None,
        };
        Ok(Self {
            axis: axis.clone(),
            exact,
            wavelength: scene.laser.wavelength,
            glare,
        })
    }

    /// The photographs of one draw.
    ///
    /// # Errors
    /// In words: what the sensor cannot take, that entries are saturated, which no recovery is told
    /// of, or that a draw of the scale leaves no light.
    pub(super) fn photograph(&self, level: f64, seed: u64) -> Result<Photographs, String> {
        if self.axis == NoiseAxis::Relative {
            return Ok(Photographs::relative(&self.exact, level, seed));
        }
        if let Some(error) = self.axis.scale_error(level) {
            let scale = 1.0 + error * stream(seed).normal();
            if scale <= 0.0 {
                return Err(format!(
                    "the scale that was drawn, {scale:.2}, leaves no light"
                ));
            }
            let taken = Photographs::relative(&(&self.exact * scale), BESIDE_SCALE, seed);
            return Ok(taken.of_scale(error));
        }
        let take = || {
            let shot = self.shot(level, offset(seed))?;
            shot.sensor
                .expose(&self.light(&shot)?, &shot.exposure, Stated::Oracle, seed)
        };
        let taken = take().map_err(|e| e.to_string())?;
        match taken.count(Range::Saturated) {
            0 => Ok(Photographs::told(taken.flux, taken.stderr)),
            n => Err(format!("{n} entries are saturated; expose for less")),
        }
    }

    /// The standard error of every entry at `level`, W, without what all entries share.
    pub(super) fn stderr(&self, level: f64) -> Result<Matrix, SensorError> {
        if self.axis == NoiseAxis::Relative {
            return Ok(self.exact.map(|x| level * x.abs()));
        }
        if self.axis == NoiseAxis::Scale {
            return Ok(self.exact.map(|x| BESIDE_SCALE * x.abs()));
        }
        let shot = self.shot(level, 0.0)?;
        let expected = shot.sensor.expected(&self.light(&shot)?, &shot.exposure);
        Ok(expected.stderr)
    }

    fn light<'s>(&'s self, shot: &'s Shot) -> Result<Light<'s>, SensorError> {
        let light = Light::new(&self.exact, self.wavelength)?;
        match &shot.glare {
            Some(glare) => light.with_glare(glare),
            None => Ok(light),
        }
    }

    /// Sensor and exposure of `level`; `offset`, in counts, is that of the converter on the axis of
    /// bits.
    fn shot(&self, level: f64, offset: f64) -> Result<Shot, SensorError> {
        let energy = photon_energy(self.wavelength);
        let (sensor, time, glare) = match &self.axis {
            NoiseAxis::Relative | NoiseAxis::Scale => (Sensor::new(Figures::IDEAL)?, 1.0, None),
            NoiseAxis::Photons => {
                let figures = Figures {
                    shot_noise: ShotNoise::Poisson,
                    ..Figures::IDEAL
                };
                let time = level * energy / self.exact.mean();
                (Sensor::new(figures)?, time, None)
            }
            NoiseAxis::Bits => {
                let ideal = Figures {
                    bits: Some(level as u32),
                    offset,
                    ..Figures::IDEAL
                };
                // An electron for every photon of a second: their number only sets the unit of the
                // gain.
                let gain = self.exact.max() / energy / (RANGE * ideal.top());
                (Sensor::new(Figures { gain, ..ideal })?, 1.0, None)
            }
            NoiseAxis::Exposure(camera) => (camera.sensor, level, None),
            NoiseAxis::Glare(camera, _) => {
                let glare = self.glare.as_ref().map(|g| g * level);
                let all = glare.as_ref().map(|g| &self.exact + g);
                let brightest = all.as_ref().unwrap_or(&self.exact).max();
                let time = camera.sensor.longest_exposure(brightest, self.wavelength);
                (camera.sensor, time, glare)
            }
        };
        let [frames, dark] = self.axis.frames();
        let exposure = Exposure::new(&[time], frames, dark)?;
        Ok(Shot {
            sensor,
            exposure,
            glare,
        })
    }
}

/// A part of a count, in [0, 1).
fn offset(seed: u64) -> f64 {
    stream(seed).uniform()
}

/// A block of random numbers that is of no entry.
fn stream(seed: u64) -> Stream {
    let key = Key {
        seed,
        spot: Key::ALL_SPOTS,
        pixel: u32::MAX,
        block: u32::MAX,
    };
    Stream::new(Sampling::Pcg, key)
}

#[cfg(test)]
mod tests;
