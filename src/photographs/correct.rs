//! From an averaged photograph to flux: dark frames, flat field, exposure time.

use super::error::{PhotographError, refused};
use super::lens::Lens;
use super::noise::CameraNoise;
use super::plane::{Averaged, same_size};

/// What all photographs of one exposure time share.
#[derive(Clone, Copy, Debug)]
pub struct Correction<'a> {
    /// Photographs without the laser, of the same exposure time.
    pub dark: Option<&'a Averaged>,
    /// The same of the shortest exposure time: the noise of what is above them grows with it.
    pub shortest: Option<&'a Averaged>,
    /// The flat field.
    pub flat: Option<&'a Flat>,
    /// The camera's noise, where it is known.
    pub noise: Option<CameraNoise>,
    /// Exposure time, s; 1 where none is known.
    pub exposure: f64,
}

/// A photograph of even radiance: 1 on the optical axis where that is known, else on average.
#[derive(Clone, Debug, PartialEq)]
pub struct Flat {
    size: [usize; 2],
    /// F.
    pub level: Vec<f64>,
    /// Relative variance of F.
    pub variance: Vec<f64>,
    /// Pixels that see nothing in it, or too much.
    pub unusable: Vec<bool>,
}

/// Flux into the pixels of a photograph, counts per second.
#[derive(Clone, Debug, PartialEq)]
pub struct Corrected {
    /// (s − d)/(F·t).
    pub flux: Vec<f64>,
    /// Its variance, (counts/s)²; `None` where the noise is not known.
    pub variance: Option<Vec<f64>>,
    /// How the variance rises with the flux, counts/s; 0 where the noise is not known.
    pub slope: Vec<f64>,
    /// Part of the variance that is that of the dark frames, mean over the pixels: an error that
    /// all photographs have in common.
    pub common: f64,
    /// The same of the flat field: a factor of each pixel that all photographs have in common.
    pub of_flat: f64,
    /// Error of the dark frames' mean that all pixels share, counts/s: values that noise does not
    /// move from one integer to the next are all rounded alike.
    pub rounded: f64,
}

/// Part of the mean below which a pixel of a flat field counts as dead.
const DEAD: f64 = 0.05;
/// Distance from the principal point within which a flat field tells what it is on the axis, of the
/// photograph's diagonal.
const NEAR_AXIS: f64 = 0.1;

impl Flat {
    /// From averaged photographs of even radiance, less those `dark` of the same exposure time.
    /// With a `lens` F is 1 on its axis: near it F over [`Lens::etendue`] is 1 on average, or over
    /// the whole photograph where the axis is not in it.
    ///
    /// # Errors
    /// [`PhotographError::Refused`] for one without light.
    pub fn new(
        shot: &Averaged,
        dark: Option<&Averaged>,
        noise: Option<CameraNoise>,
        lens: Option<&Lens>,
    ) -> Result<Self, PhotographError> {
        let correction = Correction {
            dark,
            shortest: dark,
            flat: None,
            noise,
            exposure: 1.0,
        };
        let Corrected { flux, variance, .. } = correction.apply("the flat field", shot)?;
        let at = |k: usize| [k % shot.size[0], k / shot.size[0]].map(|x| x as f64);
        let own = |k: usize| lens.map_or(Some(1.0), |lens| lens.etendue(at(k)));
        let known = |k: usize| Some((k, own(k)?)).filter(|_| !shot.saturated[k]);
        let lit: Vec<(usize, f64)> = (0..flux.len()).filter_map(known).collect();
        let diagonal = libm::hypot(shot.size[0] as f64, shot.size[1] as f64);
        let is_near = |lens: &Lens, [u, v]: [f64; 2]| {
            libm::hypot(u - lens.cx, v - lens.cy) <= NEAR_AXIS * diagonal
        };
        let near = |(k, _): &&(usize, f64)| lens.is_some_and(|lens| is_near(lens, at(*k)));
        let mut near: Vec<(usize, f64)> = lit.iter().filter(near).copied().collect();
        if near.is_empty() {
            near = lit;
        }
        let mean = near.iter().map(|(k, _)| flux[*k]).sum::<f64>()
            / near.iter().map(|(_, own)| own).sum::<f64>();
        if mean <= 0.0 || !mean.is_finite() {
            return Err(refused(
                "the flat field has no light above its dark frames",
                "give photographs of an evenly lit white surface that are not saturated",
            ));
        }
        let level: Vec<f64> = flux.iter().map(|x| x / mean).collect();
        let unusable: Vec<bool> = (0..level.len())
            .map(|k| level[k] < DEAD || shot.saturated[k])
            .collect();
        let relative = |k: usize| match &variance {
            Some(v) if !unusable[k] => v[k] / (flux[k] * flux[k]),
            _ => 0.0,
        };
        Ok(Self {
            size: shot.size,
            variance: (0..level.len()).map(relative).collect(),
            level,
            unusable,
        })
    }
}

impl Correction<'_> {
    /// Φ = (s − d)/(F·t) of an averaged photograph, with its variance: that of its own mean, that
    /// of the dark frames' mean, and F's. `name` is for messages. Pixels that the flat field cannot
    /// serve are 0.
    ///
    /// # Errors
    /// [`PhotographError::Refused`] for dark frames or a flat field of another size.
    pub fn apply(&self, name: &str, shot: &Averaged) -> Result<Corrected, PhotographError> {
        if let Some(dark) = self.dark {
            same_size("a dark frame", dark.size, shot.size)?;
        }
        if let Some(flat) = self.flat {
            same_size("the flat field", flat.size, shot.size)?;
        }
        if !(self.exposure > 0.0 && self.exposure.is_finite()) {
            return Err(refused(
                format!("the exposure time of {name} is {} s", self.exposure),
                "give a positive number of seconds",
            ));
        }
        let pixels = shot.light.len();
        let mut flux = vec![0.0; pixels];
        let mut variance = self.noise.map(|_| vec![0.0; pixels]);
        let mut slope = vec![0.0; pixels];
        let (mut common, mut of_flat, mut known) = (0.0, 0.0, 0u32);
        for k in 0..pixels {
            let (level, level_variance) = match self.flat {
                Some(flat) if flat.unusable[k] => continue,
                Some(flat) => (flat.level[k], flat.variance[k]),
                None => (1.0, 0.0),
            };
            let signal = shot.light[k] - self.dark.map_or(0.0, |d| d.light[k]);
            let scale = 1.0 / (level * self.exposure);
            flux[k] = signal * scale;
            if let (Some(variance), Some(noise)) = (&mut variance, self.noise) {
                let of = |a: &Averaged, below: f64| {
                    noise.of_mean([a.light[k], below], [a.rounding[k], a.share], a.frames)
                };
                // Electrons of the dark current are counted like those of light.
                let below = self.shortest.map_or(0.0, |d| d.light[k]);
                let own = of(shot, below);
                let dark = self.dark.map_or(0.0, |d| of(d, below));
                let flat = level_variance * flux[k] * flux[k];
                slope[k] = noise.gain * shot.share * scale / shot.frames.max(1) as f64;
                variance[k] = (own + dark) * scale * scale + flat;
                if variance[k] > 0.0 {
                    common += dark * scale * scale / variance[k];
                    of_flat += flat / variance[k];
                    known += 1;
                }
            }
        }
        Ok(Corrected {
            flux,
            variance,
            slope,
            common: common / f64::from(known.max(1)),
            of_flat: of_flat / f64::from(known.max(1)),
            rounded: self.rounded(),
        })
    }

    /// The root mean square of what averaging the dark frames leaves of their rounding, counts/s; 0
    /// where the offsets of the pixels differ by more than rounding, which then is chance.
    fn rounded(&self) -> f64 {
        let (Some(dark), Some(noise)) = (self.dark, self.noise) else {
            return 0.0;
        };
        let n = dark.light.len() as f64;
        let mean = dark.light.iter().sum::<f64>() / n;
        let spread = dark.light.iter().map(|x| (x - mean) * (x - mean));
        if spread.sum::<f64>() > dark.rounding.iter().sum::<f64>() {
            return 0.0;
        }
        let below = self.shortest.unwrap_or(dark);
        let left = |k: usize| {
            let levels = [dark.light[k], below.light[k]];
            noise.of_one(levels, [dark.rounding[k], dark.share]).1
        };
        let left: f64 = (0..dark.light.len()).map(left).sum();
        (left / n).sqrt() / self.exposure
    }
}

#[cfg(test)]
mod tests;
