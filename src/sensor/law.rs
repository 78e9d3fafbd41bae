//! Means and variances without a single random number.

use std::f64::consts::PI;

use super::exposure::{Exposure, Light};
use super::figures::{Figures, Sensor};
use crate::matrix::Matrix;

/// What a sensor makes of light on average.
#[derive(Clone, Debug, PartialEq)]
pub struct Expected {
    /// Mean of the linearised flux, W.
    pub flux: Matrix,
    /// Its standard deviation, W.
    pub stderr: Matrix,
    /// Electrons of one frame of the longest exposure, on average.
    pub electrons: Matrix,
    /// Which exposure time counts, 0 the longest; `None` where even the shortest comes too near the
    /// end.
    pub bracket: Vec<Option<usize>>,
}

impl Sensor {
    /// Mean and standard deviation of every entry (pixels × spots) if each is taken from the
    /// longest exposure whose mean stays below the end with the margin of metering; where none
    /// does, the shortest as if it did. Of the sensor alone, without the render's own error. Entry
    /// (pixel, spot) of `bracket` stands at pixel + spot·pixels.
    pub fn expected(&self, light: &Light<'_>, exposure: &Exposure) -> Expected {
        let laws = Law::of(self.figures(), light, exposure);
        let (pixels, spots) = light.shape();
        let chosen = |pixel, spot| {
            let fits = laws
                .iter()
                .position(|law| law.figures.fits(law.electrons(light.of_laser(pixel, spot))));
            (fits, &laws[fits.unwrap_or(laws.len() - 1)])
        };
        let mut bracket = Vec::with_capacity(pixels * spots);
        for spot in 0..spots {
            bracket.extend((0..pixels).map(|pixel| chosen(pixel, spot).0));
        }
        let matrix = |f: &dyn Fn(&Law, f64) -> f64| {
            Matrix::from_fn(pixels, spots, |pixel, spot| {
                f(chosen(pixel, spot).1, light.of_laser(pixel, spot))
            })
        };
        Expected {
            flux: matrix(&Law::mean),
            stderr: matrix(&|law, flux| law.variance(flux).sqrt()),
            electrons: matrix(&|_, flux| laws[0].electrons(flux)),
            bracket,
        }
    }
}

/// One exposure time.
#[derive(Clone, Copy, Debug)]
pub(super) struct Law {
    pub figures: Figures,
    pub frames: u32,
    pub dark_frames: u32,
    /// ηtλ/hc: electrons per W.
    pub response: f64,
    /// Electrons of a frame without laser.
    pub dark: f64,
}

impl Law {
    /// The laws of all exposure times, the longest first.
    pub(super) fn of(figures: &Figures, light: &Light<'_>, exposure: &Exposure) -> Vec<Self> {
        let times = exposure.times().iter();
        times
            .map(|time| {
                let response = figures.quantum_efficiency * time * light.photons_per_joule();
                Self {
                    figures: *figures,
                    frames: exposure.frames(),
                    dark_frames: exposure.dark_frames(),
                    response,
                    dark: figures.dark_current * time + response * light.ambient(),
                }
            })
            .collect()
    }

    /// Mean electrons of a frame under the laser's `flux`, W.
    pub(super) fn electrons(&self, flux: f64) -> f64 {
        self.response * flux + self.dark
    }

    /// Mean of the linearised flux, W.
    fn mean(&self, flux: f64) -> f64 {
        if self.dark_frames > 0 {
            flux
        } else {
            flux + self.dark / self.response
        }
    }

    /// What stays in the linearised flux without light of the laser, W.
    pub(super) fn pedestal(&self) -> f64 {
        self.mean(0.0)
    }

    /// The variance that the dark frames bring in, W²: one error for all spots of a pixel.
    pub(super) fn common(&self) -> f64 {
        self.averaged_dark() / (self.response * self.response)
    }

    /// Variance of the linearised flux, W².
    pub(super) fn variance(&self, flux: f64) -> f64 {
        let electrons = self.averaged(self.electrons(flux), self.frames) + self.averaged_dark();
        let variance = electrons / (self.response * self.response);
        let relative = self.figures.relative_noise * self.figures.relative_noise;
        let mean = self.mean(flux);
        variance * (1.0 + relative) + relative * mean * mean
    }

    /// Variance of the mean of the dark frames, electrons²; 0 without any.
    fn averaged_dark(&self) -> f64 {
        match self.dark_frames {
            0 => 0.0,
            frames => self.averaged(self.dark, frames),
        }
    }

    /// Variance of the mean over `frames` frames of `mean` electrons, electrons².
    fn averaged(&self, mean: f64, frames: u32) -> f64 {
        self.averaged_noise(self.figures.variance(mean), frames)
    }

    /// The same, in counts², of frames with the variance `frame`, counts², rounding included.
    pub(super) fn averaged_counts(&self, frame: f64, frames: u32) -> f64 {
        let Figures { gain, bits, .. } = self.figures;
        let rounding = bits.map_or(0.0, |_| 1.0 / 12.0);
        let noise = (frame - rounding).max(0.0) * gain * gain;
        self.averaged_noise(noise, frames) / (gain * gain)
    }

    /// Variance of the mean over `frames` frames with `noise` (electrons²) before the converter.
    fn averaged_noise(&self, noise: f64, frames: u32) -> f64 {
        let gain = self.figures.gain;
        let frames = f64::from(frames);
        if self.figures.bits.is_none() {
            return noise / frames;
        }
        let step = gain * gain;
        let common = step * common_rounding(noise / step);
        common + (noise + step / 12.0 - common) / frames
    }
}

/// Of the rounding of numbers with the variance `v` (in steps²) the part that is the same in every
/// repetition: the variance, over the places that the mean can take between two steps, of the mean
/// of the rounded numbers. For normal numbers
///
/// > B = (1/2π²) Σ_{k≥1} e^{−4π²k²v}/k²,
///
/// which is 1/12 without noise and 4e-4/12 where its standard deviation is half a step.
fn common_rounding(v: f64) -> f64 {
    let a = 4.0 * PI * PI * v;
    let sum = if a < 0.5 {
        // By the theta function's transformation; what is left out is below e^(−π²/a) = 3e-9.
        PI * PI / 6.0 - (PI * a).sqrt() + 0.5 * a
    } else if a > 700.0 {
        0.0
    } else {
        (1..8)
            .map(f64::from)
            .map(|k| libm::exp(-a * k * k) / (k * k))
            .sum()
    };
    sum / (2.0 * PI * PI)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against brute force: the mean of ⌊x + m⌉ − m, x normal, squared and averaged over m in [0,
    /// 1).
    #[test]
    fn rounding_has_a_part_that_averaging_does_not_remove() {
        let phi = |z: f64| 0.5 * libm::erfc(-z / std::f64::consts::SQRT_2);
        for deviation in [0.02, 0.1, 0.11, 0.2, 0.5, 0.8] {
            let steps = 4000;
            let bias = |m: f64| {
                let mean: f64 = (-12..=12)
                    .map(|n| {
                        let [low, high] = [-0.5, 0.5].map(|h| (f64::from(n) + h - m) / deviation);
                        f64::from(n) * (phi(high) - phi(low))
                    })
                    .sum();
                mean - m
            };
            let square = |i: i32| bias((f64::from(i) + 0.5) / f64::from(steps)).powi(2);
            let exact = (0..steps).map(square).sum::<f64>() / f64::from(steps);
            let b = common_rounding(deviation * deviation);
            assert!(
                (b - exact).abs() < 1e-6 * exact + 1e-12,
                "{deviation}: {b} {exact}"
            );
        }
        assert!((common_rounding(0.0) - 1.0 / 12.0).abs() < 1e-15);
        assert_eq!(common_rounding(1e6), 0.0);
    }
}
