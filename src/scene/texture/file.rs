//! The albedo of a surface as a scene file writes it.

use serde::de::{self, MapAccess, Visitor, value::MapAccessDeserializer};
use serde::{Deserialize, Deserializer, Serialize};

use super::bilinear::Wrap;
use crate::image::Transfer;
use crate::scene::exactly;

/// `0.8`, a table that says how the albedo varies, or `"unknown"`.
#[derive(Clone, Debug, Serialize)]
#[serde(untagged)]
pub enum AlbedoTable {
    /// The same everywhere.
    Constant(f64),
    /// As a table says.
    Varied(Box<VariedTable>),
    /// Nothing is known of it.
    Unknown(Unknown),
}

/// The word `"unknown"`.
#[derive(Clone, Copy, Debug, Serialize)]
pub enum Unknown {
    /// That it is.
    #[serde(rename = "unknown")]
    Unknown,
}

impl From<f64> for AlbedoTable {
    fn from(albedo: f64) -> Self {
        Self::Constant(albedo)
    }
}

/// How an albedo varies over a surface: exactly one of `checkerboard`, `cells`, `ramp`, `image` and
/// `target`.
#[derive(Clone, Debug, Default, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct VariedTable {
    /// Checks along u and v; cell (0, 0), at the corner, is dark.
    #[serde(
        default,
        deserialize_with = "exactly::maybe",
        skip_serializing_if = "Option::is_none"
    )]
    pub checkerboard: Option<[u32; 2]>,
    /// Albedo of the dark checks, or of a picture's value 0.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dark: Option<f64>,
    /// Albedo of the light checks, or of a picture's value 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub light: Option<f64>,
    /// Albedo cell by cell: rows along v, from the corner; each row along u.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cells: Option<Vec<Vec<f64>>>,
    /// Albedo that changes linearly along u, from the corner on: [start, end].
    #[serde(
        default,
        deserialize_with = "exactly::maybe",
        skip_serializing_if = "Option::is_none"
    )]
    pub ramp: Option<[f64; 2]>,
    /// A picture below the scene's folder: PNG, JPEG or OpenEXR. Its lower left corner is at the
    /// surface's corner.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub image: Option<String>,
    /// A picture that is built in: card, letters, siemens, edge, usaf or ramp.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub target: Option<String>,
    /// Columns and rows of the target; its own unless given.
    #[serde(
        default,
        deserialize_with = "exactly::maybe",
        skip_serializing_if = "Option::is_none"
    )]
    pub size: Option<[u32; 2]>,
    /// What the image's stored values mean: srgb or linear.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub transfer: Option<Transfer>,
    /// Which value of the image's pixels counts.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub channel: Option<PictureChannel>,
    /// Between the centres of pixels: nearest (default) or bilinear.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub filter: Option<Filter>,
    /// Outside \[0, 1\]: clamp (default) or repeat.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub wrap: Option<Wrap>,
}

/// Which value of a picture's pixels counts.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub enum PictureChannel {
    /// The only channel of a grey picture.
    Grey,
    /// Red.
    Red,
    /// Green.
    Green,
    /// Blue.
    Blue,
    /// 0.2126·R + 0.7152·G + 0.0722·B.
    Luminance,
    /// Interpolated to the laser's wavelength.
    Wavelength,
}

/// What a picture is between the centres of its pixels.
#[derive(Clone, Copy, Debug, Default, Deserialize, Serialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub enum Filter {
    /// Every pixel is a cell of one albedo.
    #[default]
    Nearest,
    /// Linear between the centres of pixels.
    Bilinear,
}

impl<'de> Deserialize<'de> for AlbedoTable {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Albedo;
        impl<'de> Visitor<'de> for Albedo {
            type Value = AlbedoTable;
            fn expecting(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
                f.write_str("an albedo: a number in [0, 1], a table with `checkerboard`, `cells`, `ramp`, `image` or `target`, or \"unknown\"")
            }
            fn visit_f64<E: de::Error>(self, x: f64) -> Result<AlbedoTable, E> {
                Ok(AlbedoTable::Constant(x))
            }
            fn visit_i64<E: de::Error>(self, x: i64) -> Result<AlbedoTable, E> {
                Ok(AlbedoTable::Constant(x as f64))
            }
            fn visit_str<E: de::Error>(self, word: &str) -> Result<AlbedoTable, E> {
                match word {
                    "unknown" => Ok(AlbedoTable::Unknown(Unknown::Unknown)),
                    other => Err(E::invalid_value(de::Unexpected::Str(other), &self)),
                }
            }
            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<AlbedoTable, A::Error> {
                let table = VariedTable::deserialize(MapAccessDeserializer::new(map))?;
                Ok(AlbedoTable::Varied(Box::new(table)))
            }
        }
        deserializer.deserialize_any(Albedo)
    }
}
