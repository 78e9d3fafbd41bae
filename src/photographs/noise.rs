//! The noise of one photograph, given or found from repeats.
//!
//! > var = g·(s − d) + σ² + LSB²/12
//!
//! in counts²: the photon transfer line (Janesick, *Photon Transfer*, 2007; EMVA 1288) with the
//! gain g (counts per electron), what is above the dark frames of the shortest exposure time s − d,
//! the read noise σ with that of their dark current, and the rounding to integers. Without dark
//! frames the line is over s, and its value at 0 is σ² − g·o with the unknown offset o. The mean of
//! n channels has the n-th part of the variance. Averaging F frames divides all but what rounding
//! leaves where other noise is too small to move values from one integer to the next: with the
//! variance v before rounding that is LSB²·B(v/LSB²), by the Fourier series of a rounding error
//! (Widrow and Kollár, *Quantization Noise*, 2008)
//!
//! > B(x) = Σ_n exp(−4π²n²x)/(2π²n²),   B(0) = 1/12

use std::f64::consts::PI;

use serde::Serialize;

use super::error::{PhotographError, refused};
use crate::num::statistics::chi_square_sf;

/// Gain and read noise of one channel of a camera.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct CameraNoise {
    /// g: variance per count of light, counts; 0 or more.
    pub gain: f64,
    /// σ², counts²; 0 or more. With `has_offset` σ² − g·o instead, of any sign: the variance is
    /// then g·s + σ² − g·o over the stored light s with the camera's offset o.
    pub read_variance: f64,
    /// Whether the line is over light with the camera's offset in it, for want of dark frames.
    pub has_offset: bool,
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
            has_offset: false,
        })
    }

    /// Variance of the mean of `frames` photographs of the light `stored`, `dark` of which is that
    /// of dark frames. Each is the mean of 1/`share` channels, and its rounding has the variance
    /// `rounding` (LSB²/12 of one channel, over their number), counts².
    pub fn of_mean(
        &self,
        [stored, dark]: [f64; 2],
        [rounding, share]: [f64; 2],
        frames: usize,
    ) -> f64 {
        let (moving, left) = self.of_one([stored, dark], [rounding, share]);
        (moving + rounding - left) / frames.max(1) as f64 + left
    }

    /// The variance of one before rounding, and what averaging any number leaves of that of the
    /// rounding.
    pub(super) fn of_one(
        &self,
        [stored, dark]: [f64; 2],
        [rounding, share]: [f64; 2],
    ) -> (f64, f64) {
        let light = if self.has_offset {
            stored
        } else {
            stored - dark
        };
        let one = self.gain * light.max(0.0) + self.read_variance;
        let moving = share * one.max(0.0);
        (moving, left_by_rounding(moving, rounding))
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
    /// Covariance of both, counts³.
    pub covariance: f64,
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

/// Part of the mean variance of the groups below which the line is not taken to fall: their weights
/// stay finite where there is no light, no read noise and no rounding.
const LEAST: f64 = 1e-6;

/// Probability of the photon transfer line below which it is said not to fit.
pub(super) const FITS: f64 = 1e-3;

/// Part of the stated variance, and standard errors, by which repeats contradict it.
const FAR: f64 = 0.1;
const SURELY: f64 = 5.0;

/// By how many times the stated variance the repeats scatter, in the mean over groups of like
/// light, where that is neither 1 nor chance: the means of s²/due, each known to √(2/freedom).
pub(super) fn contradicted(repeats: &[Repeated], stated: CameraNoise) -> Option<f64> {
    let mut sorted = repeats.to_vec();
    sorted.sort_by(|a, b| a.beside.total_cmp(&b.beside));
    let groups = sorted.chunks(FEWEST).map(group);
    let (mut sum, mut freedom) = (0.0, 0.0);
    for own in groups {
        let due = due(&own, stated, 0.0);
        // Where rounding is half of it the line does not hold.
        if due > 2.0 * own.rounding || own.variance > 3.0 * own.rounding {
            sum += own.freedom * own.variance / due;
            freedom += own.freedom;
        }
    }
    let ratio = sum / freedom;
    let off = (ratio - 1.0).abs();
    (off > FAR && off > SURELY * (2.0 / freedom).sqrt()).then_some(ratio)
}

/// Fits the line to the variances of `repeats`, in groups of like light; each group's variance is
/// known to the fraction √(2/freedom). Pixels whose variance is below twice that of rounding alone
/// say nothing of other noise; groups of such are left out. `has_offset` says that the camera's
/// offset is in their light: σ² − g·o may then be negative, and is not held at 0.
///
/// # Errors
/// [`PhotographError::Refused`] if fewer than three groups are left, or no line fits them.
pub fn photon_transfer(
    mut repeats: Vec<Repeated>,
    has_offset: bool,
) -> Result<PhotonTransferFit, PhotographError> {
    repeats.sort_by(|a, b| a.beside.total_cmp(&b.beside));
    let size = repeats.len().div_ceil(GROUPS).max(FEWEST);
    let groups: Vec<Repeated> = repeats
        .chunks(size)
        .filter(|c| c.len() >= FEWEST)
        .map(group)
        .filter(|g| g.variance > 2.0 * g.rounding)
        .collect();
    let cure = "give `noise = { gain, read_noise }`, save 16 bits, or raise the exposure";
    if groups.len() < 3 {
        return Err(refused(
            "the repeated photographs do not differ by more than rounding in enough pixels: gain and read noise cannot be found",
            cure,
        ));
    }
    let mean = groups.iter().map(|g| g.variance).sum::<f64>() / groups.len() as f64;
    let mut noise = CameraNoise {
        gain: 0.0,
        read_variance: mean,
        has_offset,
    };
    // Variances of gain and σ², and their covariance.
    let mut errors = [0.0; 3];
    for _ in 0..ROUNDS {
        (noise, errors) = line(&groups, noise, LEAST * mean);
    }
    let deviations = groups.iter().map(|g| {
        let due = due(g, noise, LEAST * mean);
        [
            (g.variance - due) / (due * (2.0 / g.freedom).sqrt()),
            g.variance / due - 1.0,
        ]
    });
    let deviations: Vec<[f64; 2]> = deviations.collect();
    let chi2: f64 = deviations.iter().map(|d| d[0] * d[0]).sum();
    let dof = (groups.len() - 2) as f64;
    let p = chi_square_sf(chi2, dof);
    // Off a line by more than chance, groups tell its errors by their scatter.
    if p < FITS {
        errors = errors.map(|error| error * (chi2 / dof));
    }
    let found = [noise.gain, noise.read_variance];
    if found == [0.0; 2] || found.iter().any(|x| !x.is_finite()) || !chi2.is_finite() {
        return Err(refused(
            "no line fits the variance of the repeated photographs over their light: gain and read noise cannot be found",
            cure,
        ));
    }
    Ok(PhotonTransferFit {
        noise,
        gain_error: errors[0].sqrt(),
        read_variance_error: errors[1].sqrt(),
        covariance: errors[2],
        groups: groups.len(),
        chi2,
        p,
        largest_deviation: deviations.iter().map(|d| d[1].abs()).fold(0.0, f64::max),
    })
}

impl PhotonTransferFit {
    /// How well the line knows the variance of one photograph of this light, counts: the variance
    /// of that over its square, (s² var g + 2 s cov + var σ²)/(g s + σ² + LSB²/12)². Infinite where
    /// the line has none, or no gain is known.
    pub(super) fn unknown(&self, light: f64, rounding: f64) -> f64 {
        let CameraNoise {
            gain,
            read_variance,
            ..
        } = self.noise;
        let due = gain * light + read_variance + rounding;
        let [g, r] = [self.gain_error, self.read_variance_error];
        let off = g * g * light * light + 2.0 * light * self.covariance + r * r;
        if due > 0.0 && off.is_finite() {
            off.max(0.0) / (due * due)
        } else {
            f64::INFINITY
        }
    }
}

/// The variance of a group by the line, at least `least`, counts².
fn due(group: &Repeated, noise: CameraNoise, least: f64) -> f64 {
    (noise.gain * group.signal + noise.read_variance + group.rounding).max(least)
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
/// negative gain or read noise becomes 0, but for an offset's. Returns it with the variances of
/// both and their covariance.
fn line(groups: &[Repeated], before: CameraNoise, least: f64) -> (CameraNoise, [f64; 3]) {
    let [mut w, mut x, mut y, mut xx, mut xy] = [0.0; 5];
    for g in groups {
        let due = due(g, before, least);
        let weight = g.freedom / (2.0 * due * due);
        let above = g.variance - g.rounding;
        w += weight;
        x += weight * g.signal;
        y += weight * above;
        xx += weight * g.signal * g.signal;
        xy += weight * g.signal * above;
    }
    let determinant = w * xx - x * x;
    let level = |read_variance| CameraNoise {
        gain: 0.0,
        read_variance,
        ..before
    };
    // Groups of one light say nothing of the gain.
    if determinant <= 1e-12 * w * xx {
        return (level(y / w), [f64::INFINITY, 1.0 / w, 0.0]);
    }
    let (gain, read) = (
        (w * xy - x * y) / determinant,
        (xx * y - x * xy) / determinant,
    );
    let noise = match (gain >= 0.0, read >= 0.0 || before.has_offset) {
        (true, true) => CameraNoise {
            gain,
            read_variance: read,
            ..before
        },
        (false, _) => level((y / w).max(0.0)),
        (_, false) => CameraNoise {
            gain: xy / xx,
            read_variance: 0.0,
            ..before
        },
    };
    (noise, [w, xx, -x].map(|own| own / determinant))
}

#[cfg(test)]
mod tests;
