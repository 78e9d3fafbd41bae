//! What an axis is called.

use serde::{Serialize, Serializer};

use super::NoiseAxis;
use crate::scene::Spread as GlareSpread;

/// What an axis is called, as the files of a study have it.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct AxisLabel<'a> {
    /// Its name on the command line and in the files of a study.
    #[serde(rename = "axis")]
    pub name: &'static str,
    /// What a level is, with its unit.
    #[serde(rename = "axis_title")]
    pub title: &'static str,
    /// The header of a level in comma-separated values.
    #[serde(rename = "axis_column")]
    pub column: &'static str,
    /// How levels are spaced: `linear` by differences, `logarithmic` by ratios.
    #[serde(rename = "axis_spacing")]
    pub spacing: &'static str,
    /// What was done to the photographs, and what the recovery was told.
    #[serde(rename = "axis_words")]
    pub procedure: &'static str,
    /// The sensor, if the axis has one.
    pub sensor: Option<&'a str>,
}

/// As its label.
impl Serialize for NoiseAxis {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.label().serialize(serializer)
    }
}

impl NoiseAxis {
    /// What it is called.
    pub fn label(&self) -> AxisLabel<'_> {
        let (name, title, column, procedure) = match self {
            Self::Relative => (
                "relative",
                "relative noise of each entry of Φcam",
                "relative_noise",
                "Each entry of Φcam is multiplied by 1 + σ·N(0, 1); the recovery is told σ·|Φ|.",
            ),
            Self::Photons => (
                "photons",
                "photons per pixel and frame, mean",
                "photons_per_pixel",
                "Shot noise alone, one frame; the mean is over pixels and spots. The recovery is told the standard \
                 error of each entry.",
            ),
            Self::Exposure(_) => (
                "exposure",
                "exposure of a frame / s",
                "exposure_s",
                "The sensor's frames for each spot are averaged, its dark frames subtracted (one and one where the sensor \
                 is a built-in one), no glare. The recovery is told the sensor's standard errors.",
            ),
            Self::Glare(_, spread) => (
                "glare",
                match spread {
                    GlareSpread::Uniform => "glare over signal, even",
                    GlareSpread::Falloff(_) => "glare over signal, falling off",
                },
                "glare_over_signal",
                "The sensor's frames and dark frames (one and one where it is a built-in one) fill the brightest pixel \
                 to half. The glare is left in and the \
                 recovery is told the sensor's standard errors alone: the glare is a bias, and the Cramér–Rao bound \
                 is of the sensor's noise.",
            ),
            Self::Bits => (
                "bits",
                "bits of the converter",
                "bits",
                "Rounding alone, no shot or read noise; the brightest entry takes 80 % of the range. The recovery is \
                 told count/√12. Draws differ in the offset, a part of a count.",
            ),
            Self::Scale => (
                "scale",
                "relative error of the absolute scale",
                "scale_error",
                "All photographs of a draw are multiplied by 1 + s·N(0, 1), one number, and each entry by \
                 1 + 0.001·N(0, 1). The recovery is told the standard error of each entry, joint methods s as well; to the \
                 others the error of the scale is a bias. The Cramér–Rao bound is of both.",
            ),
        };
        AxisLabel {
            name,
            title,
            column,
            spacing: if self.is_linear() {
                "linear"
            } else {
                "logarithmic"
            },
            procedure,
            sensor: match self {
                Self::Relative | Self::Photons | Self::Bits | Self::Scale => None,
                Self::Exposure(camera) | Self::Glare(camera, _) => Some(&camera.name),
            },
        }
    }
}
