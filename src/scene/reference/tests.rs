use std::collections::BTreeSet;
use std::fmt;

use serde::de::{self, Deserialize, Deserializer, Visitor};

use super::*;
use crate::scene::file::{
    CameraTable, DiscTable, KnownTable, LaserTable, LineTable, MeshTable, OnTable, RectangleTable,
    RotationTable, SceneFile, SphereTable, SpotsTable, SurfaceTable, ViewTable,
};
use crate::scene::material::{IndexTable, MaterialTable, PartTable};
use crate::scene::{AxesTable, Glare, SensorSettings, VariedTable};

/// Asks a table for its keys, and gives it nothing.
struct Keys<'a>(&'a mut &'static [&'static str]);

#[derive(Debug)]
struct Nothing;

impl fmt::Display for Nothing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("nothing")
    }
}

impl std::error::Error for Nothing {}

impl de::Error for Nothing {
    fn custom<T: fmt::Display>(_: T) -> Self {
        Self
    }
}

impl<'de> Deserializer<'de> for Keys<'_> {
    type Error = Nothing;

    fn deserialize_any<V: Visitor<'de>>(self, _: V) -> Result<V::Value, Nothing> {
        Err(Nothing)
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        fields: &'static [&'static str],
        _: V,
    ) -> Result<V::Value, Nothing> {
        *self.0 = fields;
        Err(Nothing)
    }

    serde::forward_to_deserialize_any! {
        bool i8 i16 i32 i64 u8 u16 u32 u64 f32 f64 char str string bytes byte_buf option unit
        unit_struct newtype_struct seq tuple tuple_struct map enum identifier ignored_any
    }
}

fn keys_of<'de, T: Deserialize<'de>>() -> &'static [&'static str] {
    let mut fields: &'static [&'static str] = &[];
    assert!(T::deserialize(Keys(&mut fields)).is_err());
    assert!(!fields.is_empty(), "a table has keys");
    fields
}

/// Every table of the scene file: what its keys stand below, and the keys that its reader takes.
fn tables() -> Vec<(&'static str, &'static [&'static str])> {
    vec![
        ("", keys_of::<SceneFile>()),
        ("axes", keys_of::<AxesTable>()),
        ("laser", keys_of::<LaserTable>()),
        ("laser.spots", keys_of::<SpotsTable>()),
        ("laser.spots.lines", keys_of::<LineTable>()),
        ("camera", keys_of::<CameraTable>()),
        ("camera.view", keys_of::<ViewTable>()),
        ("surface", keys_of::<SurfaceTable>()),
        ("surface.rectangle", keys_of::<RectangleTable>()),
        ("surface.disc", keys_of::<DiscTable>()),
        ("surface.sphere", keys_of::<SphereTable>()),
        ("surface.mesh", keys_of::<MeshTable>()),
        ("surface.mesh.rotate", keys_of::<RotationTable>()),
        ("surface.mesh.on", keys_of::<OnTable>()),
        ("known", keys_of::<KnownTable>()),
        ("sensor", keys_of::<SensorSettings>()),
        ("sensor.glare", keys_of::<Glare>()),
        ("material", keys_of::<MaterialTable>()),
        ("material.conductor", keys_of::<IndexTable>()),
        ("material.mixture", keys_of::<PartTable>()),
        ("albedo", keys_of::<VariedTable>()),
    ]
}

/// Keys of what no table with fields reads: the variant of an enum, and names of the geometry.
const BESIDE: [&str; 2] = ["sensor.glare.spread.falloff", "uncertainty.NAME"];

#[test]
fn every_key_that_a_reader_takes_stands_in_the_reference_and_no_other() {
    let read: BTreeSet<String> = tables()
        .iter()
        .flat_map(|(prefix, fields)| {
            let path = move |field: &&str| format!("{prefix}.{field}");
            fields.iter().map(path)
        })
        .map(|path| path.trim_start_matches('.').to_owned())
        .chain(BESIDE.map(str::to_owned))
        .collect();
    let documented: BTreeSet<String> = keys().iter().map(|key| key.path.to_owned()).collect();
    let missing: Vec<_> = read.difference(&documented).collect();
    let unknown: Vec<_> = documented.difference(&read).collect();
    assert!(missing.is_empty(), "not in reference.md: {missing:?}");
    assert!(
        unknown.is_empty(),
        "in reference.md, but read by nothing: {unknown:?}"
    );
    assert_eq!(
        keys().len(),
        documented.len(),
        "a key stands in the reference twice"
    );
}

/// The sources of the tables: a table that the list above does not have would go unseen.
#[test]
fn every_strict_table_of_the_sources_is_looked_at() {
    let sources = [
        include_str!("../axes.rs"),
        include_str!("../file.rs"),
        include_str!("../file/mesh.rs"),
        include_str!("../file/spots.rs"),
        include_str!("../material/file.rs"),
        include_str!("../sensor.rs"),
        include_str!("../texture/file.rs"),
    ];
    let strict: usize = sources
        .iter()
        .map(|s| s.matches("deny_unknown_fields").count())
        .sum();
    assert_eq!(tables().len(), strict);
}

/// Tables have keys of their own in the reference, and only they.
#[test]
fn what_is_called_a_table_has_keys() {
    for key in keys() {
        let is_table = key.value.contains("table") || ["material", "albedo"].contains(&key.value);
        let has_keys = below(key.inside()).next().is_some();
        assert_eq!(is_table, has_keys, "{}", key.path);
    }
}

/// Every unit of the reference is one of a dimension, or one of those that numbers only count in.
#[test]
fn units_are_known() {
    let counts = [
        "electrons",
        "electrons/s",
        "electrons/count",
        "counts",
        "% or length",
    ];
    for key in keys().iter().filter(|key| key.value.contains("number")) {
        if let Some((_, unit)) = key.value.rsplit_once(", ") {
            let unit = unit.split(" (").next().unwrap();
            let known = Dimension::of_unit(unit).is_some() || counts.contains(&unit);
            assert!(known, "{}: {unit}", key.path);
        }
    }
}

#[test]
fn keys_are_found_as_files_and_definitions_name_them() {
    for (asked, shown) in [
        ("unit", "unit"),
        ("camera.view", "camera.view"),
        ("laser.spots.per_side", "laser.spots.per_side"),
        ("surface.material", "surface.material"),
        (
            "surface.wall.material.lambertian",
            "surface.material.lambertian",
        ),
        ("surface.0", "surface"),
        (
            "surface.0.material.paint.ramp",
            "surface.material.paint.ramp",
        ),
        (
            "surface.a.material.mixture.1.material.ior",
            "surface.material.mixture.material.ior",
        ),
        ("uncertainty.hinge", "uncertainty.NAME"),
    ] {
        assert_eq!(
            find(asked).map(|(path, _)| path).as_deref(),
            Some(shown),
            "{asked}"
        );
    }
    for unknown in [
        "",
        "camera.vew",
        "camera.view.z",
        "laser.0.power",
        "surface.a.b.c",
        "x.y",
    ] {
        assert_eq!(find(unknown), None, "{unknown}");
    }
}

#[test]
fn the_nearest_keys_are_named() {
    for (asked, near) in [
        ("camera.vew", "camera.view"),
        ("per_side", "laser.spots.per_side"),
        ("laser.powr", "laser.power"),
        ("lambertain", "surface.material.lambertian"),
        ("checkerbord", "surface.material.lambertian.checkerboard"),
    ] {
        assert_eq!(
            nearest(asked).first().map(String::as_str),
            Some(near),
            "{asked}"
        );
    }
    assert!(nearest("zzzzzzzzzzzz").is_empty());
    assert!(nearest(&"laser".repeat(1 << 20)).is_empty());
}
