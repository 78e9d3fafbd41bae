//! The noise of one photograph, given or found from repeats.
//!
//! > var = g·(s − d) + σ² + LSB²/12
//!
//! in counts²: the photon transfer line (Janesick, *Photon Transfer*, 2007; EMVA 1288) with the gain
//! g (counts per electron), the light above the dark frames s − d, the read noise σ with the dark
//! current's, and the rounding to integers. Averaging F frames divides all but what rounding leaves
//! where other noise is too small to move values from one integer to the next: with the variance v
//! before rounding that is LSB²·B(v/LSB²), by the Fourier series of a rounding error (Widrow and
//! Kollár, *Quantization Noise*, 2008)
//!
//! > B(x) = Σ_n exp(−4π²n²x)/(2π²n²),   B(0) = 1/12

use std::f64::consts::PI;

use serde::Serialize;

use super::error::{PhotographError, refused};
use crate::num::statistics::chi_square_sf;

/// Gain and read noise of a camera.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct CameraNoise {
    /// g: variance per count of light, counts; 0 or more.
    pub gain: f64,
    /// σ², counts²; 0 or more.
    pub read_variance: f64,
}

impl CameraNoise {
    /// Of given gain and read noise (root mean square), counts.
    ///
    /// # Errors
    /// [`PhotographError::Refused`] for negative or infinite ones.
    pub fn new(gain: f64, read_noise: f64) -> Result<Self, PhotographError> {
        let fits = |x: f64| x >= 0.0 && x.is_finite();
        if !(fits(gain) && fits(read_noise)) {
            return Err(refused(
                format!(
                    "a gain of {gain} counts per electron with {read_noise} counts of read noise has no meaning"
                ),
                "use numbers of 0 or more, both in counts",
            ));
        }
        Ok(Self {
            gain,
            read_variance: read_noise * read_noise,
        })
    }

    /// Variance of the mean of `frames` photographs of the light `signal` above dark, whose rounding
    /// has the variance `rounding` (LSB²/12), counts².
    pub fn of_mean(&self, signal: f64, rounding: f64, frames: usize) -> f64 {
        let moving = self.gain * signal.max(0.0) + self.read_variance;
        let left = left_by_rounding(moving, rounding);
        (moving + rounding - left) / frames.max(1) as f64 + left
    }
}

/// Terms of the series that are summed, and the size below which the others count for nothing.
const TERMS: u32 = 64;
const NEGLIGIBLE: f64 = 1e-7;

/// What averaging any number of frames leaves of the rounding's variance.
fn left_by_rounding(moving: f64, rounding: f64) -> f64 {
    if rounding == 0.0 {
        return 0.0;
    }
    let x = moving / (12.0 * rounding);
    let mut series = 0.0;
    for n in 1..=TERMS {
        let n2 = f64::from(n * n);
        let term = libm::exp(-4.0 * PI * PI * n2 * x) / (2.0 * PI * PI * n2);
        series += term;
        if term < NEGLIGIBLE {
            return 12.0 * rounding * series;
        }
    }
    // So little noise that rounding is all there is.
    rounding
}

/// Repeats of one pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Repeated {
    /// Light above dark, counts.
    pub signal: f64,
    /// Light of the pixels beside it, counts: groups are formed by it, for its noise is not the
    /// pixel's. Formed by `signal` itself they would have too large a range of it.
    pub beside: f64,
    /// Sample variance of one photograph, counts².
    pub variance: f64,
    /// Variance of the rounding, counts².
    pub rounding: f64,
    /// Repeats − 1.
    pub freedom: f64,
}

/// The line through the variances of repeats.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PhotonTransferFit {
    /// Gain and read noise.
    pub noise: CameraNoise,
    /// Standard error of the gain, counts.
    pub gain_error: f64,
    /// Standard error of σ², counts².
    pub read_variance_error: f64,
    /// Groups of pixels of like light that the line was fitted to.
    pub groups: usize,
    /// Sum of their squared deviations in standard errors.
    pub chi2: f64,
    /// Probability of a larger sum if the line is right.
    pub p: f64,
    /// Largest deviation of a group from the line, relative to the line.
    pub largest_deviation: f64,
}

/// Most groups of pixels, and fewest pixels of a group.
const GROUPS: usize = 32;
const FEWEST: usize = 32;
/// Rounds of weighing by the line that was found.
const ROUNDS: usize = 8;

/// Fits the line to the variances of `repeats`, in groups of like light; each group's variance is
/// known to the fraction √(2/freedom). Pixels whose variance is below twice that of rounding alone
/// say nothing of other noise; groups of such are left out.
///
/// # Errors
/// [`PhotographError::Refused`] if fewer than three groups are left.
pub fn photon_transfer(mut repeats: Vec<Repeated>) -> Result<PhotonTransferFit, PhotographError> {
    repeats.sort_by(|a, b| a.beside.total_cmp(&b.beside));
    let size = repeats.len().div_ceil(GROUPS).max(FEWEST);
    let groups: Vec<Repeated> = repeats
        .chunks(size)
        .filter(|c| c.len() >= FEWEST)
        .map(group)
        .filter(|g| g.variance > 2.0 * g.rounding)
        .collect();
    if groups.len() < 3 {
        return Err(refused(
            "the repeated photographs do not differ by more than rounding in enough pixels: gain and read noise cannot be found",
            "give `noise = { gain, read_noise }`, save 16 bits, or raise the exposure",
        ));
    }
    let mut noise = CameraNoise {
        gain: 0.0,
        read_variance: groups.iter().map(|g| g.variance).sum::<f64>() / groups.len() as f64,
    };
    let mut errors = [0.0; 2];
    for _ in 0..ROUNDS {
        (noise, errors) = line(&groups, noise);
    }
    let deviations = groups.iter().map(|g| {
        let due = noise.gain * g.signal.max(0.0) + noise.read_variance + g.rounding;
        [
            (g.variance - due) / (due * (2.0 / g.freedom).sqrt()),
            g.variance / due - 1.0,
        ]
    });
    let deviations: Vec<[f64; 2]> = deviations.collect();
    let chi2: f64 = deviations.iter().map(|d| d[0] * d[0]).sum();
    Ok(PhotonTransferFit {
        noise,
        gain_error: errors[0],
        read_variance_error: errors[1],
        groups: groups.len(),
        chi2,
        p: chi_square_sf(chi2, (groups.len() - 2) as f64),
        largest_deviation: deviations.iter().map(|d| d[1].abs()).fold(0.0, f64::max),
    })
}

/// The means over pixels of like light.
fn group(pixels: &[Repeated]) -> Repeated {
    let freedom: f64 = pixels.iter().map(|p| p.freedom).sum();
    let mean =
        |of: fn(&Repeated) -> f64| pixels.iter().map(|p| p.freedom * of(p)).sum::<f64>() / freedom;
    Repeated {
        signal: mean(|p| p.signal).max(0.0),
        beside: mean(|p| p.beside),
        variance: mean(|p| p.variance),
        rounding: mean(|p| p.rounding),
        freedom,
    }
}

/// The weighted line, with weights 1/variance of each group's variance by the line `before`; a
/// negative gain or read noise becomes 0. Returns it with the standard errors of both.
fn line(groups: &[Repeated], before: CameraNoise) -> (CameraNoise, [f64; 2]) {
    let [mut w, mut x, mut y, mut xx, mut xy] = [0.0; 5];
    for g in groups {
        let due = before.gain * g.signal + before.read_variance + g.rounding;
        let weight = g.freedom / (2.0 * due * due);
        let above = g.variance - g.rounding;
        w += weight;
        x += weight * g.signal;
        y += weight * above;
        xx += weight * g.signal * g.signal;
        xy += weight * g.signal * above;
    }
    let determinant = w * xx - x * x;
    // Groups of one light say nothing of the gain.
    if determinant <= 1e-12 * w * xx {
        let noise = CameraNoise {
            gain: 0.0,
            read_variance: y / w,
        };
        return (noise, [f64::INFINITY, (1.0 / w).sqrt()]);
    }
    let (gain, read) = (
        (w * xy - x * y) / determinant,
        (xx * y - x * xy) / determinant,
    );
    let noise = match (gain >= 0.0, read >= 0.0) {
        (true, true) => CameraNoise {
            gain,
            read_variance: read,
        },
        (false, _) => CameraNoise {
            gain: 0.0,
            read_variance: (y / w).max(0.0),
        },
        (_, false) => CameraNoise {
            gain: xy / xx,
            read_variance: 0.0,
        },
    };
    (noise, [(w / determinant).sqrt(), (xx / determinant).sqrt()])
}

#[cfg(test)]
mod tests;
