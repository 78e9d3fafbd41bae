//! What is varied: the axes of noise.

use std::cmp::Ordering;

use serde::Serialize;

use crate::scene::Spread as GlareSpread;
use crate::sensor::Sensor;

/// A sensor with the name by which it is told of.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedSensor {
    /// Its name.
    pub name: String,
    /// The sensor.
    pub sensor: Sensor,
}

/// What makes photographs noisy, and by how much it is varied. The recovery is always told the standard error that the law of the noise gives to the exact entry.
#[derive(Clone, Debug, PartialEq)]
pub enum NoiseAxis {
    /// σ: each entry of Φcam times 1 + σ·N(0, 1), independently. The recovery is told σ·|Φ|.
    Relative,
    /// Mean photons that the signal sends to a pixel in the one frame: shot noise alone, of an electron for every photon, without read noise and converter.
    Photons,
    /// Seconds that a sensor's frame takes; one frame for each spot and one dark frame, which is subtracted. It serves all spots, so that the errors of a
    /// row are correlated; the recovery takes them as independent.
    Exposure(NamedSensor),
    /// Glare over signal, ΣΦ_glare/ΣΦ: light of the laser that the lens scatters, spread as said, photographed by a sensor in one frame (and one dark frame) that
    /// fills the brightest pixel to half. Nothing takes the glare away and the recovery is not told of it: a bias, beside the sensor's noise.
    Glare(NamedSensor, GlareSpread),
    /// Bits of a converter whose gain K puts the brightest entry at 80 % of its range; nothing else is noisy. The recovery is told K/√12. Rounding is no
    /// random number, so what a draw varies is the offset, by a part of a count that is common to all entries.
    Bits,
}

/// How the levels of an axis are spaced.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Spacing {
    /// By ratios.
    Logarithmic,
    /// By differences.
    Linear,
}

impl Spacing {
    /// How far x lies on the way from a to b, 0 to 1.
    pub(super) fn fraction(self, [a, b]: [f64; 2], x: f64) -> f64 {
        match self {
            Self::Logarithmic => libm::log(x / a) / libm::log(b / a),
            Self::Linear => (x - a) / (b - a),
        }
    }

    /// What lies at `t` of the way from a to b.
    pub(super) fn at(self, [a, b]: [f64; 2], t: f64) -> f64 {
        match self {
            Self::Logarithmic => libm::exp(libm::log(a) + t * libm::log(b / a)),
            Self::Linear => a + t * (b - a),
        }
    }
}

/// Share of the converter's range that the brightest entry takes on the axis of bits.
pub(super) const RANGE: f64 = 0.8;
/// Converters of that axis, bits: with fewer the brightest entry and an offset of a count reach the top.
const BITS: std::ops::RangeInclusive<u32> = 4..=24;

impl NoiseAxis {
    /// The name used on the command line and in the files of a study.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Relative => "relative",
            Self::Photons => "photons",
            Self::Exposure(_) => "exposure",
            Self::Glare(..) => "glare",
            Self::Bits => "bits",
        }
    }

    /// What a level is, with its unit, for tables and figures.
    pub fn title(&self) -> &'static str {
        match self {
            Self::Relative => "relative noise of each entry of Φcam",
            Self::Photons => "photons per pixel and frame, mean",
            Self::Exposure(_) => "exposure of a frame / s",
            Self::Glare(_, GlareSpread::Uniform) => "glare over signal, even",
            Self::Glare(_, GlareSpread::Falloff(_)) => "glare over signal, falling off",
            Self::Bits => "bits of the converter",
        }
    }

    /// The sensor that is studied, if it is one by name.
    pub fn sensor(&self) -> Option<&str> {
        match self {
            Self::Relative | Self::Photons | Self::Bits => None,
            Self::Exposure(camera) | Self::Glare(camera, _) => Some(&camera.name),
        }
    }

    /// The header of a level in comma-separated values.
    pub fn column(&self) -> &'static str {
        match self {
            Self::Relative => "relative_noise",
            Self::Photons => "photons_per_pixel",
            Self::Exposure(_) => "exposure_s",
            Self::Glare(..) => "glare_over_signal",
            Self::Bits => "bits",
        }
    }

    /// What trials on this axis have to share, in words.
    pub(super) fn identity(&self) -> String {
        let spread = match self {
            Self::Glare(_, GlareSpread::Uniform) => ", even".to_owned(),
            Self::Glare(_, GlareSpread::Falloff(d0)) => format!(", falling off over {d0:e}"),
            _ => String::new(),
        };
        let sensor = self.sensor().map_or(String::new(), |name| {
            format!(", sensor {}", name.replace(['\n', '\r'], " "))
        });
        format!("{} axis{spread}{sensor}", self.name())
    }

    /// What was done to the photographs, and what the recovery was told, in words.
    pub fn words(&self) -> &'static str {
        match self {
            Self::Relative => {
                "Each entry of Φcam is multiplied by 1 + σ·N(0, 1); the recovery is told σ·|Φ|."
            }
            Self::Photons => {
                "Shot noise alone, one frame; the mean is over pixels and spots. The recovery is told the standard error of each entry."
            }
            Self::Exposure(_) => {
                "One frame for each spot, one dark frame subtracted, no glare. The recovery is told the sensor's standard errors."
            }
            Self::Glare(..) => {
                "One frame and one dark frame that fill the brightest pixel to half. The glare is left in and the recovery is told the sensor's standard \
                 errors alone: the glare is a bias, and the Cramér–Rao bound is of the sensor's noise."
            }
            Self::Bits => {
                "Rounding alone, no shot or read noise; the brightest entry takes 80 % of the range. The recovery is told count/√12. Draws differ in the \
                 offset, a part of a count."
            }
        }
    }

    /// How levels are spaced.
    pub fn spacing(&self) -> Spacing {
        match self {
            Self::Bits => Spacing::Linear,
            _ => Spacing::Logarithmic,
        }
    }

    /// Orders levels from quiet to loud: more photons, seconds or bits are quieter.
    pub fn quiet_first(&self, a: f64, b: f64) -> Ordering {
        match self {
            Self::Relative | Self::Glare(..) => a.total_cmp(&b),
            Self::Photons | Self::Exposure(_) | Self::Bits => b.total_cmp(&a),
        }
    }

    /// The levels of a study that asks for none, from quiet to loud; those of exposures end at `longest`, s.
    pub(super) fn levels(&self, longest: f64) -> Vec<f64> {
        let halves = |from: i32, to: i32| {
            let level = |d: i32| libm::exp10(0.5 * f64::from(d));
            (from..=to).map(level).collect::<Vec<f64>>()
        };
        let mut levels: Vec<f64> = match self {
            Self::Relative => (-12..=0).map(|d| libm::exp10(f64::from(d))).collect(),
            Self::Photons => (0..=20).map(|d| libm::exp10(f64::from(d))).collect(),
            Self::Exposure(_) => {
                let last = (2.0 * libm::log10(longest) + 1e-9).floor() as i32;
                halves(last - 12, last)
            }
            Self::Glare(..) => halves(-8, 4),
            Self::Bits => BITS.step_by(2).map(f64::from).collect(),
        };
        levels.sort_by(|a, b| self.quiet_first(*a, *b));
        levels
    }

    /// Levels that have a meaning, in words, if `level` has none.
    pub fn refuses(&self, level: f64) -> Option<&'static str> {
        let positive = level > 0.0 && level.is_finite();
        let (fine, cure) = match self {
            Self::Relative => (
                level > 0.0 && level <= 1.0,
                "a relative noise is a number above 0 and not above 1, e.g. 0.01",
            ),
            Self::Photons => (
                positive && level <= 1e30,
                "photons per pixel are a number above 0, up to 1e30",
            ),
            Self::Exposure(_) => (
                positive,
                "an exposure is a number of seconds above 0, e.g. 0.1",
            ),
            Self::Glare(..) => (
                positive && level <= 1e6,
                "glare over signal is a number above 0, up to 1e6",
            ),
            Self::Bits => (
                BITS.map(f64::from).any(|b| b == level),
                "bits are a whole number from 4 to 24",
            ),
        };
        (!fine).then_some(cure)
    }

    /// What the standard error of every entry is proportional to along the axis; `None` where levels change more than its size.
    pub(super) fn size(&self, level: f64) -> Option<f64> {
        match self {
            Self::Relative => Some(level),
            Self::Photons => Some(1.0 / level.sqrt()),
            Self::Bits => Some(1.0 / (libm::exp2(level) - 1.0)),
            Self::Exposure(_) | Self::Glare(..) => None,
        }
    }

    /// The level at which an entry of mean flux has this relative noise; `None` on axes where that is not the whole of the noise.
    pub fn of_relative(&self, noise: f64) -> Option<f64> {
        match self {
            Self::Relative => Some(noise),
            Self::Photons => Some(1.0 / (noise * noise)),
            Self::Exposure(_) | Self::Glare(..) | Self::Bits => None,
        }
    }
}
