//! What a frame knows of its origin, as attributes of an OpenEXR header.
//!
//! | attribute | type | what |
//! | --- | --- | --- |
//! | `phicam.scene`, `phicam.sceneHash` | string | name and hexadecimal SHA-256 of the scene |
//! | `phicam.lengthUnit`, `phicam.fluxUnit` | string | m, cm, mm or in; W |
//! | `phicam.spotIndex`, `phicam.spotCount` | int | which spot of how many |
//! | `phicam.spotX`, `phicam.spotY`, `phicam.spotZ` | double | where the spot is, in the length unit |
//! | `phicam.seed` | string | hexadecimal after `0x`: OpenEXR has no integer of 64 bits |
//! | `phicam.samples` | string | decimal |
//! | `phicam.estimator`, `phicam.sampler`, `phicam.version` | string | how the frame was made |
//! | `software` | string | the program with its version, where other programs look for it |

use exr::meta::attribute::{AttributeValue, Text};
use exr::meta::header::LayerAttributes;

use crate::film::{FrameMeta, RunMeta};

const SCENE: &str = "phicam.scene";
const SCENE_HASH: &str = "phicam.sceneHash";
const LENGTH_UNIT: &str = "phicam.lengthUnit";
const FLUX_UNIT: &str = "phicam.fluxUnit";
const SPOT_INDEX: &str = "phicam.spotIndex";
const SPOT_COUNT: &str = "phicam.spotCount";
const SPOT_POSITION: [&str; 3] = ["phicam.spotX", "phicam.spotY", "phicam.spotZ"];
const SEED: &str = "phicam.seed";
const SAMPLES: &str = "phicam.samples";
const ESTIMATOR: &str = "phicam.estimator";
const SAMPLER: &str = "phicam.sampler";
const VERSION: &str = "phicam.version";

/// Text by its UTF-8 bytes; the crate's own conversion panics outside Latin-1.
pub(super) fn text(s: &str) -> Text {
    Text::from_slice_unchecked(s.as_bytes())
}

/// The attributes that record `meta`; the error says what a header cannot record.
pub(super) fn record(meta: &FrameMeta) -> Result<LayerAttributes, String> {
    let string = |s: &str| AttributeValue::Text(text(s));
    let int = |n: u32| {
        i32::try_from(n)
            .map(AttributeValue::I32)
            .map_err(|_| format!("{n} spots are too many for its header"))
    };
    let run = &meta.run;
    let mut attributes = LayerAttributes {
        software_name: Some(text(&format!("phicam {}", run.version))),
        ..Default::default()
    };
    let mut set = |name: &str, value| attributes.other.insert(text(name), value);
    set(SCENE, string(&run.scene_name));
    set(SCENE_HASH, string(&run.scene_hash));
    set(LENGTH_UNIT, string(&run.unit));
    set(FLUX_UNIT, string("W"));
    set(SPOT_INDEX, int(meta.spot_index)?);
    set(SPOT_COUNT, int(run.spot_count)?);
    for (name, coordinate) in SPOT_POSITION.iter().zip(meta.spot_position) {
        set(name, AttributeValue::F64(coordinate));
    }
    set(SEED, string(&format!("{:#018x}", run.seed)));
    set(SAMPLES, string(&run.samples.to_string()));
    set(ESTIMATOR, string(&run.estimator));
    set(SAMPLER, string(&run.sampler));
    set(VERSION, string(&run.version));
    Ok(attributes)
}

/// The origin that `attributes` record; the error names the attribute that is missing or malformed.
pub(super) fn recall(attributes: &LayerAttributes) -> Result<FrameMeta, String> {
    let find = |name: &str| {
        attributes
            .other
            .get(&text(name))
            .ok_or(format!("it has no attribute {name}"))
    };
    let bad = |name: &str| format!("its attribute {name} is malformed");
    let string = |name: &str| match find(name)? {
        AttributeValue::Text(t) => String::from_utf8(t.as_slice().to_vec()).map_err(|_| bad(name)),
        _ => Err(bad(name)),
    };
    let int = |name: &str| match find(name)? {
        AttributeValue::I32(n) => u32::try_from(*n).map_err(|_| bad(name)),
        _ => Err(bad(name)),
    };
    let double = |name: &str| match find(name)? {
        AttributeValue::F64(x) => Ok(*x),
        _ => Err(bad(name)),
    };
    let hash = string(SCENE_HASH)?;
    if hash.len() != 64 || !hash.bytes().all(|b| b.is_ascii_hexdigit()) {
        return Err(bad(SCENE_HASH));
    }
    if string(FLUX_UNIT)? != "W" {
        return Err(format!("its attribute {FLUX_UNIT} is not W"));
    }
    let seed = string(SEED)?;
    let seed = seed
        .strip_prefix("0x")
        .and_then(|digits| u64::from_str_radix(digits, 16).ok());
    let run = RunMeta {
        scene_name: string(SCENE)?,
        scene_hash: hash,
        unit: string(LENGTH_UNIT)?,
        spot_count: int(SPOT_COUNT)?,
        seed: seed.ok_or_else(|| bad(SEED))?,
        samples: string(SAMPLES)?.parse().map_err(|_| bad(SAMPLES))?,
        estimator: string(ESTIMATOR)?,
        sampler: string(SAMPLER)?,
        version: string(VERSION)?,
    };
    let [x, y, z] = SPOT_POSITION.map(double);
    Ok(FrameMeta {
        run,
        spot_index: int(SPOT_INDEX)?,
        spot_position: [x?, y?, z?],
    })
}
