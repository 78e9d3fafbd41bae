//! Where the Φcam of a run folder comes from.

use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize};

use crate::photographs::SourceFile;
use crate::transport::Plan;

/// Rendered or imported. A record holds the keys of a plan, or the key `imported`.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Origin {
    /// Traced by this plan.
    Rendered(Plan),
    /// Photographs.
    Imported {
        /// What they are.
        imported: Photographs,
    },
}

/// The photographs of a real camera.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub struct Photographs {
    /// SHA-256 of all settings as JSON, hex.
    pub settings: String,
    /// The unit of Φcam: W, counts/s or counts.
    pub flux_unit: String,
    /// Whether all spots of a pixel share an error that matters: that of their dark frames.
    #[serde(default)]
    pub shares_by_pixel: bool,
    /// Variance of the entries' variances over their squares, which all share: how well repeats
    /// tell the noise; 0 where it was given.
    #[serde(default)]
    pub noise_unknown: f64,
    /// Largest relative error of a frame's gain, which all its pixels share; absent where all are
    /// exact.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub frame_gain: Option<f64>,
    /// The files that they were read from.
    pub sources: Vec<SourceFile>,
}

impl Origin {
    /// The plan of a render.
    pub fn plan(&self) -> Option<&Plan> {
        match self {
            Self::Rendered(plan) => Some(plan),
            Self::Imported { .. } => None,
        }
    }

    /// Whether all spots of a pixel share an error of photographs.
    pub fn shares_by_pixel(&self) -> bool {
        matches!(self, Self::Imported { imported } if imported.shares_by_pixel)
    }

    /// Variance of the variances of photographs over their squares, which all share.
    pub fn noise_unknown(&self) -> f64 {
        match self {
            Self::Imported { imported } => imported.noise_unknown,
            Self::Rendered(_) => 0.0,
        }
    }

    /// How well the gains of photographs are known; none where they are exact.
    pub fn frame_gain(&self) -> Option<f64> {
        match self {
            Self::Imported { imported } => imported.frame_gain,
            Self::Rendered(_) => None,
        }
    }

    /// The unit of photographs whose size is not that of light, so that it says nothing of
    /// reflectances; `None` of those in W.
    pub fn unscaled(&self) -> Option<&str> {
        match self {
            Self::Imported { imported } if imported.flux_unit != "W" => Some(&imported.flux_unit),
            _ => None,
        }
    }
}

impl From<&Plan> for Origin {
    fn from(plan: &Plan) -> Self {
        Self::Rendered(*plan)
    }
}

impl std::fmt::Display for Origin {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Rendered(plan) => plan.fmt(f),
            Self::Imported { .. } => f.write_str("imported photographs"),
        }
    }
}

impl<'de> Deserialize<'de> for Origin {
    /// By the key `imported`, so that what is wrong with a plan is told in its own words.
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let mut keys = serde_json::Value::deserialize(deserializer)?;
        let read = match keys.get_mut("imported") {
            Some(own) => {
                serde_json::from_value(own.take()).map(|imported| Self::Imported { imported })
            }
            None => serde_json::from_value(keys).map(Self::Rendered),
        };
        read.map_err(D::Error::custom)
    }
}
