//! Materials as written in a scene file, and what they mean.

mod changed;
mod kind;

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::merl::Channel;
use super::shining::MOST_FALLOFF;
use super::variants::{LEAST_ALPHA, MOST_ALPHA, MOST_INDEX, MOST_SIGMA};
use super::{Coated, Conductor, Material, Measured, OrenNayar, Part, SecondFacet, Shining, Shown};
use crate::scene::error::{Fault, keys};
use crate::scene::exactly;
use crate::scene::texture::{AlbedoTable, Texture};
use kind::{kind, refuse_foreign_keys};

/// The keys of every material; which of them a material takes is checked. Keys that are absent are
/// not serialised, so that the hash of a scene does not depend on materials it does not have.
#[derive(Clone, Debug, Default, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct MaterialTable {
    /// Albedo in [0, 1]: a number, or a table that says how it varies over the surface.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lambertian: Option<AlbedoTable>,
    /// Albedo of a rough matt surface.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub oren_nayar: Option<AlbedoTable>,
    /// Albedo of the ground below a clear coat that loses no light.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub paint: Option<AlbedoTable>,
    /// Albedo of the ground below a clear coat in which what meets a second facet is lost.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub coated: Option<AlbedoTable>,
    /// Refractive index of a metal.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub conductor: Option<IndexTable>,
    /// File with a measured BRDF.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub measured: Option<String>,
    /// Materials to be added.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mixture: Option<Vec<PartTable>>,
    /// Standard deviation of the slope angle, radians (oren_nayar), or α (paint, coated,
    /// conductor).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub roughness: Option<f64>,
    /// Refractive index of the coat (paint, coated); default 1.5.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ior: Option<f64>,
    /// What the metal's reflection is multiplied by (conductor); default 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reflectance: Option<AlbedoTable>,
    /// Colour of a MERL table (measured).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub channel: Option<Channel>,
    /// What the table is multiplied by (measured); default 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scale: Option<AlbedoTable>,
    /// The picture with which a surface shines, in [0, 1].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shining: Option<AlbedoTable>,
    /// M, W/unit²: exitance of a Lambertian white point (shining); default 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub exitance: Option<f64>,
    /// Exponents of the fall-off along u and v (shining); default [0, 0], Lambertian.
    #[serde(
        default,
        deserialize_with = "exactly::maybe",
        skip_serializing_if = "Option::is_none"
    )]
    pub falloff: Option<[f64; 2]>,
    /// Wavelength of its light, m (shining); default 550e-9.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub wavelength: Option<f64>,
    /// What is photographed: picture (default) or elements (shining).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub light: Option<Shown>,
}

/// Complex refractive index η + ik.
#[derive(Clone, Copy, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct IndexTable {
    /// Real part.
    pub eta: f64,
    /// Imaginary part.
    pub k: f64,
}

/// A part of a mixture.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct PartTable {
    /// What the part is multiplied by.
    pub weight: f64,
    /// The part.
    pub material: MaterialTable,
}

/// Reads a file that the scene names, by the path written there; an error says why not.
pub(in crate::scene) type Files<'a> = &'a mut dyn FnMut(&str) -> Result<Vec<u8>, String>;

/// Index of refraction where the coat's is not stated: acrylic and polyurethane paint.
const COAT: f64 = 1.5;
/// Parts of a mixture.
const MOST_PARTS: usize = 16;
/// Rounding of weights that add up to 1.
const ROUNDING: f64 = 1e-12;

impl Material {
    /// What a table means: the material, and the texture whose value `brdf` takes as its albedo.
    pub(in crate::scene) fn from_table(
        table: &MaterialTable,
        wavelength: f64,
        files: Files<'_>,
    ) -> Result<(Self, Texture), Fault> {
        let kind = kind(table)?;
        refuse_foreign_keys(table, kind)?;
        let mut albedo = |key: &'static str, given: &AlbedoTable| {
            Texture::from_table(given, wavelength, files).map_err(|f| f.within(keys![key]))
        };
        let mut factor = |key: &'static str, given: &Option<AlbedoTable>| {
            given
                .as_ref()
                .map_or(Ok(Texture::Constant(1.0)), |t| albedo(key, t))
        };
        if let Some(given) = &table.lambertian {
            return Ok((Self::Lambertian, albedo("lambertian", given)?));
        }
        if let Some(given) = &table.shining {
            return Ok((Self::Shining(shining(table)?), albedo("shining", given)?));
        }
        if let Some(given) = &table.oren_nayar {
            let sigma = roughness(table, 0.0, MOST_SIGMA, "radians")?;
            let material = Self::OrenNayar(OrenNayar::new(sigma));
            return Ok((material, albedo("oren_nayar", given)?));
        }
        let coats = [
            ("paint", &table.paint, SecondFacet::Passes),
            ("coated", &table.coated, SecondFacet::Absorbs),
        ];
        for (key, given, second) in coats {
            let Some(given) = given else { continue };
            let alpha = roughness(table, LEAST_ALPHA, MOST_ALPHA, "α")?;
            let ior = table.ior.unwrap_or(COAT);
            if !(ior > 1.0 && ior <= MOST_INDEX) {
                let cause = format!("a coat of refractive index {ior}");
                let cure = "use a number above 1, up to 4; paint and varnish have 1.4 to 1.6";
                return Err(Fault::new(keys!["ior"], cause, cure));
            }
            let coated = Coated::new(alpha, ior, second);
            return Ok((Self::Coated(Arc::new(coated)), albedo(key, given)?));
        }
        if let Some(index) = &table.conductor {
            let alpha = roughness(table, LEAST_ALPHA, MOST_ALPHA, "α")?;
            for (key, value, least) in [("eta", index.eta, 1e-3), ("k", index.k, 0.0)] {
                if !(least..=100.0).contains(&value) {
                    let cause = format!("a metal whose `{key}` is {value}");
                    let cure = format!("use {least} to 100, from a table of optical constants");
                    return Err(Fault::new(keys!["conductor", key], cause, cure));
                }
            }
            let material = Self::Conductor(Conductor::new(alpha, index.eta, index.k));
            return Ok((material, factor("reflectance", &table.reflectance)?));
        }
        if let Some(path) = &table.measured {
            let texture = factor("scale", &table.scale)?;
            let material = measured(table, path, texture.largest(), files)?;
            return Ok((Self::Measured(Arc::new(material)), texture));
        }
        let parts = table.mixture.as_deref().unwrap_or_default();
        Ok((mixture(parts, wavelength, files)?, Texture::Constant(1.0)))
    }
}

fn roughness(table: &MaterialTable, least: f64, most: f64, what: &str) -> Result<f64, Fault> {
    let range = format!("{least} to {most:.4} ({what})");
    let Some(value) = table.roughness else {
        let cause = "the material does not say how rough it is";
        return Err(Fault::new(
            keys![],
            cause,
            format!("add `roughness = …`: {range}"),
        ));
    };
    if (least..=most).contains(&value) {
        return Ok(value);
    }
    let cause = format!("a roughness of {value}");
    Err(Fault::new(
        keys!["roughness"],
        cause,
        format!("use {range}"),
    ))
}

fn shining(table: &MaterialTable) -> Result<Shining, Fault> {
    let shining = Shining {
        exitance: table.exitance.unwrap_or(1.0),
        falloff: table.falloff.unwrap_or_default(),
    };
    if !(shining.exitance > 0.0 && shining.exitance.is_finite()) {
        let cause = format!("an exitance of {}", shining.exitance);
        let cure = "give a positive exitance in W/unit²: that of a Lambertian white point";
        return Err(Fault::new(keys!["exitance"], cause, cure));
    }
    if let Some(n) = shining
        .falloff
        .into_iter()
        .find(|n| !(0.0..=MOST_FALLOFF).contains(n))
    {
        let cause = format!("a fall-off by the cosine to the power of {n}");
        let cure = format!("use exponents from 0 (Lambertian) to {MOST_FALLOFF}, along u and v");
        return Err(Fault::new(keys!["falloff"], cause, cure));
    }
    Ok(shining)
}

fn measured(
    table: &MaterialTable,
    path: &str,
    largest: f64,
    files: Files<'_>,
) -> Result<Measured, Fault> {
    let text = path.to_ascii_lowercase().ends_with(".csv");
    let channel = match (text, table.channel) {
        (true, None) => None,
        (true, Some(_)) => {
            let cause = "a table of angle triples has no colours";
            return Err(Fault::new(keys!["channel"], cause, "remove `channel`"));
        }
        (false, Some(channel)) => Some(channel),
        (false, None) => {
            let cause = "a MERL table has three colours, and the scene one wavelength";
            let cure = "add `channel = \"red\"`, \"green\" or \"blue\"";
            return Err(Fault::new(keys!["measured"], cause, cure));
        }
    };
    let bytes = files(path).map_err(|cause| {
        let cure = "give the path of a MERL table or of a .csv table, from the scene's folder";
        Fault::new(keys!["measured"], cause, cure)
    })?;
    let read = match channel {
        Some(channel) => Measured::merl(&bytes, channel, largest),
        None => Measured::grid(&bytes, largest),
    };
    read.map_err(|mut fault| {
        fault.cause = format!("{path}: {}", fault.cause);
        fault.within(keys!["measured"])
    })
}

fn mixture(tables: &[PartTable], wavelength: f64, files: Files<'_>) -> Result<Material, Fault> {
    if tables.is_empty() || tables.len() > MOST_PARTS {
        let cause = format!("a mixture of {} parts", tables.len());
        let cure = format!("use 1 to {MOST_PARTS}");
        return Err(Fault::new(keys!["mixture"], cause, cure));
    }
    let mut parts = Vec::with_capacity(tables.len());
    for (i, table) in tables.iter().enumerate() {
        if !(0.0..=1.0).contains(&table.weight) {
            let cause = format!("a weight of {}", table.weight);
            let at = keys!["mixture", i, "weight"];
            return Err(Fault::new(at, cause, "use 0 to 1"));
        }
        if table.material.mixture.is_some() {
            let at = keys!["mixture", i, "material"];
            let cure = "list its parts in the outer one, their weights multiplied by its own";
            return Err(Fault::new(at, "a mixture inside a mixture", cure));
        }
        if table.material.shining.is_some() {
            let at = keys!["mixture", i, "material"];
            let cure = "let the whole surface shine: `material = { shining = … }`";
            return Err(Fault::new(at, "a part of a mixture that shines", cure));
        }
        let (material, texture) = Material::from_table(&table.material, wavelength, &mut *files)
            .map_err(|f| f.within(keys!["mixture", i, "material"]))?;
        let Texture::Constant(albedo) = texture else {
            let at = keys!["mixture", i, "material"];
            let cause = "a part of a mixture whose albedo varies over the surface";
            return Err(Fault::new(at, cause, "give it a number"));
        };
        parts.push(Part {
            weight: table.weight,
            albedo,
            material,
            share: 0.0,
        });
    }
    let weights: f64 = parts.iter().map(|p| p.weight).sum();
    if weights > 1.0 + ROUNDING {
        let cause = format!("the weights of the mixture add up to {weights}");
        return Err(Fault::new(
            keys!["mixture"],
            cause,
            "let them add up to 1 at most",
        ));
    }
    Ok(Material::mixture(parts))
}
