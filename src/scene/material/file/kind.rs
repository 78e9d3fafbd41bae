//! The one kind of material that a table gives.

use super::MaterialTable;
use crate::scene::error::{Fault, keys};

const KINDS: &str = "`lambertian`, `oren_nayar`, `paint`, `coated`, `conductor`, `measured`, `mixture` and `shining`";

/// The one kind of material that is given.
pub(super) fn kind(table: &MaterialTable) -> Result<&'static str, Fault> {
    let kinds = [
        ("lambertian", table.lambertian.is_some()),
        ("oren_nayar", table.oren_nayar.is_some()),
        ("paint", table.paint.is_some()),
        ("coated", table.coated.is_some()),
        ("conductor", table.conductor.is_some()),
        ("measured", table.measured.is_some()),
        ("mixture", table.mixture.is_some()),
        ("shining", table.shining.is_some()),
    ];
    let mut given = kinds
        .into_iter()
        .filter_map(|(name, is)| is.then_some(name));
    match (given.next(), given.next()) {
        (Some(name), None) => Ok(name),
        (Some(a), Some(b)) => {
            let cause = format!("a material that is both `{a}` and `{b}`");
            let cure = "keep one; a sum of materials is a `mixture`";
            Err(Fault::new(keys![b], cause, cure))
        }
        (None, _) => {
            let cause = format!("a material needs exactly one of {KINDS}");
            Err(Fault::new(keys![], cause, "add e.g. `lambertian = 0.8`"))
        }
    }
}

pub(super) fn refuse_foreign_keys(table: &MaterialTable, kind: &'static str) -> Result<(), Fault> {
    let keys: [(&'static str, bool, &[&str]); 9] = [
        (
            "roughness",
            table.roughness.is_some(),
            &["oren_nayar", "paint", "coated", "conductor"],
        ),
        ("ior", table.ior.is_some(), &["paint", "coated"]),
        ("reflectance", table.reflectance.is_some(), &["conductor"]),
        ("channel", table.channel.is_some(), &["measured"]),
        ("scale", table.scale.is_some(), &["measured"]),
        ("exitance", table.exitance.is_some(), &["shining"]),
        ("falloff", table.falloff.is_some(), &["shining"]),
        ("wavelength", table.wavelength.is_some(), &["shining"]),
        ("light", table.light.is_some(), &["shining"]),
    ];
    for (key, given, owners) in keys {
        if given && !owners.contains(&kind) {
            let cause = format!("`{key}` does not belong to `{kind}`");
            return Err(Fault::new(keys![key], cause, format!("remove `{key}`")));
        }
    }
    Ok(())
}
