//! What the table of an albedo means, checked.

use super::{AlbedoTable, Cells, Files, MOST_CELLS, Texture, VariedTable, albedo, picture};
use crate::scene::error::{Fault, keys};

impl Texture {
    /// Checks a table; `wavelength` (m) is the laser's, for pictures whose channels it weights, and
    /// `files` reads pictures.
    pub(in crate::scene) fn from_table(
        table: &AlbedoTable,
        wavelength: f64,
        files: &mut Files,
    ) -> Result<Self, Fault> {
        match table {
            AlbedoTable::Constant(rho) => albedo(*rho).map(Self::Constant),
            AlbedoTable::Varied(varied) => Self::varied(varied, wavelength, files),
            AlbedoTable::Unknown(_) => Err(Fault::new(
                keys![],
                "an albedo that is unknown where it has to be known",
                "give a number in [0, 1]; only `lambertian` of a hidden surface can be \"unknown\"",
            )),
        }
    }

    fn varied(table: &VariedTable, wavelength: f64, files: &mut Files) -> Result<Self, Fault> {
        let is_picture = table.image.is_some() || table.target.is_some();
        let kinds = [
            table.checkerboard.is_some(),
            table.cells.is_some(),
            table.ramp.is_some(),
            table.image.is_some(),
            table.target.is_some(),
        ];
        if kinds.iter().filter(|k| **k).count() != 1 {
            return Err(Fault::new(
                keys![],
                "an albedo table needs exactly one of `checkerboard`, `cells`, `ramp`, `image` and `target`",
                "keep one of them, or write a plain number",
            ));
        }
        const LEVELS: &str = "`checkerboard`, `image` or `target`";
        const PICTURE: &str = "`image` or `target`";
        let levels = table.checkerboard.is_some() || is_picture;
        let (is_image, is_target) = (table.image.is_some(), table.target.is_some());
        refuse_foreign_keys(&[
            ("dark", table.dark.is_some(), levels, LEVELS),
            ("light", table.light.is_some(), levels, LEVELS),
            ("size", table.size.is_some(), is_target, "`target`"),
            ("transfer", table.transfer.is_some(), is_image, "`image`"),
            ("channel", table.channel.is_some(), is_image, "`image`"),
            ("filter", table.filter.is_some(), is_picture, PICTURE),
            ("wrap", table.wrap.is_some(), is_picture, PICTURE),
        ])?;
        if let Some(name) = &table.image {
            return picture::from_image(name, table, wavelength, files);
        }
        if let Some(name) = &table.target {
            return picture::from_target(name, table);
        }
        if let Some([a, b]) = table.ramp {
            let at = |f: Fault| f.within(keys!["ramp"]);
            return Ok(Self::Ramp([albedo(a).map_err(at)?, albedo(b).map_err(at)?]));
        }
        if let Some(rows) = &table.cells {
            return cells(rows);
        }
        let [nu, nv] = table.checkerboard.unwrap_or([0, 0]);
        if !(1..=MOST_CELLS).contains(&nu) || !(1..=MOST_CELLS).contains(&nv) {
            let cause = format!("a checkerboard of {nu} × {nv} checks");
            let cure = format!("use 1 to {MOST_CELLS} checks a side");
            return Err(Fault::new(keys!["checkerboard"], cause, cure));
        }
        let value = |key: &'static str, given: Option<f64>| {
            let rho = given.ok_or_else(|| {
                Fault::new(
                    keys![],
                    format!("a checkerboard needs `{key}`"),
                    format!("add `{key} = …`"),
                )
            })?;
            albedo(rho).map_err(|f| f.within(keys![key]))
        };
        let [dark, light] = [value("dark", table.dark)?, value("light", table.light)?];
        let [nu, nv] = [nu as usize, nv as usize];
        let check = |i: usize| {
            if (i % nu + i / nu).is_multiple_of(2) {
                dark
            } else {
                light
            }
        };
        let albedo = (0..nu * nv).map(check).collect();
        Ok(Self::Cells(Cells {
            count: [nu, nv],
            albedo,
        }))
    }
}

/// Refuses keys (name, given, allowed, whose they are) that the table's kind does not take.
fn refuse_foreign_keys(keys: &[(&'static str, bool, bool, &str)]) -> Result<(), Fault> {
    match keys
        .iter()
        .find(|(_, given, allowed, _)| *given && !allowed)
    {
        None => Ok(()),
        Some((key, _, _, owner)) => {
            let cause = format!("`{key}` belongs to {owner}");
            Err(Fault::new(keys![*key], cause, format!("remove `{key}`")))
        }
    }
}

fn cells(rows: &[Vec<f64>]) -> Result<Texture, Fault> {
    let width = rows.first().map_or(0, Vec::len);
    let most = MOST_CELLS as usize;
    if width == 0 || width > most || rows.len() > most || rows.iter().any(|r| r.len() != width) {
        return Err(Fault::new(
            keys!["cells"],
            "`cells` is not a full grid",
            format!("give rows of equal length, 1 to {most} each"),
        ));
    }
    for (j, row) in rows.iter().enumerate() {
        for (i, rho) in row.iter().enumerate() {
            albedo(*rho).map_err(|f| f.within(keys!["cells", j, i]))?;
        }
    }
    Ok(Texture::Cells(Cells {
        count: [width, rows.len()],
        albedo: rows.concat(),
    }))
}
