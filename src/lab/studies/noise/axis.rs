//! What is varied: the axes of noise.

mod label;

use std::cmp::Ordering;

use super::named_sensor::NamedSensor;
use crate::lab::finding::Axis;
use crate::scene::Spread as GlareSpread;
pub use label::AxisLabel;

/// What makes photographs noisy, and by how much it is varied. The recovery is always told the
/// standard error that the law of the noise gives to the exact entry.
#[derive(Clone, Debug, PartialEq)]
pub enum NoiseAxis {
    /// σ: each entry of Φcam times 1 + σ·N(0, 1), independently. The recovery is told σ·|Φ|.
    Relative,
    /// Mean photons that the signal sends to a pixel in the one frame: shot noise alone, of an
    /// electron for every photon, without read noise and converter.
    Photons,
    /// Seconds that a sensor's frame takes; its frames for each spot, averaged, less the mean of
    /// its dark frames. These serve all spots, so that the errors of a row are correlated; the
    /// recovery takes them as independent.
    Exposure(NamedSensor),
    /// Glare over signal, ΣΦ_glare/ΣΦ: light of the laser that the lens scatters, photographed by a
    /// sensor in its frames (and dark frames), which fill the brightest pixel to half. Nothing
    /// takes the glare away and the recovery is not told of it: a bias, beside the sensor's noise.
    Glare(NamedSensor, GlareSpread),
    /// Bits of a converter whose gain K puts the brightest entry at 80 % of its range; nothing else
    /// is noisy. The recovery is told K/√12. Rounding is no random number, so what a draw varies is
    /// the offset, by a part of a count that is common to all entries.
    Bits,
    /// s: all of Φcam times 1 + s·N(0, 1), one number a draw, and each entry noisy by a thousandth
    /// of it. Joint methods are told s and the entries' errors, the others these alone.
    Scale,
}

/// Share of the converter's range that the brightest entry takes on the axis of bits.
pub(super) const RANGE: f64 = 0.8;
/// Converters of that axis, bits: with fewer the brightest entry and an offset of a count reach the
/// top.
const BITS: std::ops::RangeInclusive<u32> = 4..=24;

/// Relative noise of each entry on the axis of scale.
pub(super) const BESIDE_SCALE: f64 = 1e-3;

impl NoiseAxis {
    /// How many frames, and how many dark frames, are averaged.
    pub(super) fn frames(&self) -> [u32; 2] {
        match self {
            Self::Relative | Self::Photons | Self::Bits | Self::Scale => [1, 0],
            Self::Exposure(camera) | Self::Glare(camera, _) => [camera.frames, camera.dark_frames],
        }
    }

    /// The name on the command line and in the files of a study.
    pub fn name(&self) -> &'static str {
        self.label().name
    }

    /// Whether levels are spaced by differences; else by ratios.
    fn is_linear(&self) -> bool {
        *self == Self::Bits
    }

    /// How far x lies on the way from a to b, 0 to 1.
    pub(super) fn fraction(&self, [a, b]: [f64; 2], x: f64) -> f64 {
        if self.is_linear() {
            (x - a) / (b - a)
        } else {
            libm::log(x / a) / libm::log(b / a)
        }
    }

    /// Whether a and b are too far apart to interpolate between them.
    pub(super) fn is_far(&self, [a, b]: [f64; 2]) -> bool {
        if self.is_linear() {
            (a - b).abs() > 3.0
        } else {
            libm::log10(a / b).abs() > 1.0 + 1e-9
        }
    }

    /// What lies at `t` of the way from a to b.
    pub(super) fn at(&self, [a, b]: [f64; 2], t: f64) -> f64 {
        if self.is_linear() {
            a + t * (b - a)
        } else {
            libm::exp(libm::log(a) + t * libm::log(b / a))
        }
    }

    /// The axis of a plot.
    pub(super) fn of_plot(&self) -> Axis {
        let title = self.label().title;
        if self.is_linear() {
            Axis::linear(title, [*BITS.start(), *BITS.end()].map(f64::from))
        } else {
            Axis::decades(title)
        }
    }

    /// What trials on this axis have to share, in words.
    pub(super) fn identity(&self) -> String {
        let spread = match self {
            Self::Glare(_, GlareSpread::Uniform) => ", even".to_owned(),
            Self::Glare(_, GlareSpread::Falloff(d0)) => format!(", falling off over {d0:e}"),
            _ => String::new(),
        };
        let AxisLabel { name, sensor, .. } = self.label();
        let sensor = sensor.map_or(String::new(), |name| {
            format!(", sensor {}", name.replace(['\n', '\r'], " "))
        });
        format!("{name} axis{spread}{sensor}")
    }

    /// Whether levels fall as the noise grows: fewer photons, seconds or bits are louder.
    pub(super) fn falls(&self) -> bool {
        matches!(self, Self::Photons | Self::Exposure(_) | Self::Bits)
    }

    /// Orders levels from quiet to loud.
    pub fn quiet_first(&self, a: f64, b: f64) -> Ordering {
        if self.falls() {
            b.total_cmp(&a)
        } else {
            a.total_cmp(&b)
        }
    }

    /// The levels of a study that asks for none, from quiet to loud; those of exposures end at
    /// `longest`, s.
    pub(super) fn levels(&self, longest: f64) -> Vec<f64> {
        let decades = |powers: std::ops::RangeInclusive<i32>, each: f64| {
            powers.map(|d| libm::exp10(each * f64::from(d))).collect()
        };
        let mut levels: Vec<f64> = match self {
            Self::Relative => decades(-12..=0, 1.0),
            Self::Photons => decades(0..=20, 1.0),
            Self::Exposure(_) => {
                let last = (2.0 * libm::log10(longest) + 1e-9).floor() as i32;
                decades(last - 12..=last, 0.5)
            }
            Self::Glare(..) => decades(-8..=4, 0.5),
            Self::Bits => BITS.step_by(2).map(f64::from).collect(),
            Self::Scale => decades(-6..=-1, 0.5),
        };
        levels.sort_by(|a, b| self.quiet_first(*a, *b));
        levels
    }

    /// Levels that have a meaning, in words, if `level` has none.
    pub fn refuses(&self, level: f64) -> Option<&'static str> {
        let up_to = |most: f64| level > 0.0 && level <= most;
        let (fine, cure) = match self {
            Self::Relative => (
                up_to(1.0),
                "a relative noise is a number above 0 and not above 1, e.g. 0.01",
            ),
            Self::Photons => (
                up_to(1e30),
                "photons per pixel are a number above 0, up to 1e30",
            ),
            Self::Exposure(_) => (
                up_to(f64::MAX),
                "an exposure is a number of seconds above 0, e.g. 0.1",
            ),
            Self::Glare(..) => (
                up_to(1e6),
                "glare over signal is a number above 0, up to 1e6",
            ),
            Self::Bits => (
                BITS.map(f64::from).any(|b| b == level),
                "bits are a whole number from 4 to 24",
            ),
            Self::Scale => (
                up_to(1.0),
                "an error of the scale is a number above 0 and not above 1, e.g. 0.05",
            ),
        };
        (!fine).then_some(cure)
    }

    /// What the standard error of every entry is proportional to along the axis; `None` where
    /// levels change more than its size.
    pub(super) fn size(&self, level: f64) -> Option<f64> {
        match self {
            Self::Relative => Some(level),
            Self::Photons => Some(1.0 / level.sqrt()),
            Self::Bits => Some(1.0 / (libm::exp2(level) - 1.0)),
            Self::Exposure(_) | Self::Glare(..) | Self::Scale => None,
        }
    }

    /// The relative error that all entries of a draw share, and that joint methods are told.
    pub(super) fn scale_error(&self, level: f64) -> Option<f64> {
        (*self == Self::Scale).then_some(level)
    }

    /// The level at which an entry of mean flux has this relative noise; `None` on axes where that
    /// is not the whole of the noise.
    pub fn of_relative(&self, noise: f64) -> Option<f64> {
        match self {
            Self::Relative => Some(noise),
            Self::Photons => Some(1.0 / (noise * noise)),
            Self::Exposure(_) | Self::Glare(..) | Self::Bits | Self::Scale => None,
        }
    }
}
