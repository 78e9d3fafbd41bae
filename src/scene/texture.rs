//! Albedo over a surface.

use super::error::{Fault, keys};
use super::file::{AlbedoTable, VariedTable};

/// More cells along a side than this are taken for a mistake.
const MOST_CELLS: u32 = 4096;

/// A Lambertian albedo ρ(u, v) ∈ [0, 1] over the surface's parameters; the BRDF is ρ/π.
#[derive(Clone, Debug, PartialEq)]
pub enum Texture {
    /// The same everywhere.
    Constant(f64),
    /// Constant within each cell of a grid that divides u and v evenly.
    Cells(Cells),
    /// Linear in u: from the first to the second value.
    Ramp([f64; 2]),
}

/// Cell-wise constant albedo.
#[derive(Clone, Debug, PartialEq)]
pub struct Cells {
    /// Cells along u and v.
    pub count: [usize; 2],
    /// Albedo of cell iu + iv·count\[0\].
    pub albedo: Vec<f64>,
}

impl Texture {
    /// Albedo at (u, v). On an edge between cells the higher cell counts; u, v are held to [0, 1].
    pub fn albedo(&self, [u, v]: [f64; 2]) -> f64 {
        match self {
            Self::Constant(rho) => *rho,
            Self::Cells(cells) => {
                let [nu, nv] = cells.count;
                let index = |x: f64, n: usize| ((x * n as f64) as usize).min(n - 1);
                cells.albedo[index(u, nu) + index(v, nv) * nu]
            }
            Self::Ramp([a, b]) => a + (b - a) * u.clamp(0.0, 1.0),
        }
    }

    /// Number of cells along u and v within which the albedo is smooth.
    pub fn smooth_cells(&self) -> [usize; 2] {
        match self {
            Self::Constant(_) | Self::Ramp(_) => [1, 1],
            Self::Cells(cells) => cells.count,
        }
    }

    /// Mean albedo of smooth cell iu + iv·nu: exact.
    pub fn cell_mean(&self, cell: usize) -> f64 {
        match self {
            Self::Constant(rho) => *rho,
            Self::Cells(cells) => cells.albedo[cell],
            Self::Ramp([a, b]) => 0.5 * (a + b),
        }
    }

    /// Largest albedo.
    pub fn largest(&self) -> f64 {
        match self {
            Self::Constant(rho) => *rho,
            Self::Cells(cells) => cells.albedo.iter().copied().fold(0.0, f64::max),
            Self::Ramp([a, b]) => a.max(*b),
        }
    }

    pub(super) fn from_table(table: &AlbedoTable) -> Result<Self, Fault> {
        match table {
            AlbedoTable::Constant(rho) => albedo(*rho).map(Self::Constant),
            AlbedoTable::Varied(varied) => Self::varied(varied),
        }
    }

    fn varied(table: &VariedTable) -> Result<Self, Fault> {
        let kinds = [
            table.checkerboard.is_some(),
            table.cells.is_some(),
            table.ramp.is_some(),
        ];
        if kinds.iter().filter(|k| **k).count() != 1 {
            return Err(Fault::new(
                keys![],
                "an albedo table needs exactly one of `checkerboard`, `cells` and `ramp`",
                "keep one of them, or write a plain number",
            ));
        }
        if table.checkerboard.is_none() {
            for (key, given) in [("dark", table.dark), ("light", table.light)] {
                if given.is_some() {
                    let cause = format!("`{key}` belongs to `checkerboard`");
                    return Err(Fault::new(keys![key], cause, format!("remove `{key}`")));
                }
            }
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

fn albedo(rho: f64) -> Result<f64, Fault> {
    if (0.0..=1.0).contains(&rho) {
        return Ok(rho);
    }
    Err(Fault::new(
        keys![],
        format!("albedo {rho} is outside [0, 1]: a surface cannot reflect more than it receives"),
        "give a number from 0 to 1",
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texture(text: &str) -> Result<Texture, Fault> {
        #[derive(serde::Deserialize)]
        struct Holder {
            a: AlbedoTable,
        }
        Texture::from_table(&toml::from_str::<Holder>(&format!("a = {text}")).unwrap().a)
    }

    #[test]
    fn the_first_check_is_dark() {
        let board = texture("{ checkerboard = [2, 4], dark = 0.1, light = 0.9 }").unwrap();
        assert_eq!(board.albedo([0.1, 0.1]), 0.1);
        assert_eq!(board.albedo([0.6, 0.1]), 0.9);
        assert_eq!(board.albedo([0.1, 0.3]), 0.9);
        assert_eq!(board.albedo([0.6, 0.3]), 0.1);
        assert_eq!(board.albedo([1.0, 1.0]), board.albedo([0.99, 0.99]));
    }

    #[test]
    fn cells_run_along_u_and_ramps_are_linear() {
        let cells = texture("{ cells = [[0, 0.5, 1], [0.1, 0.2, 0.3]] }").unwrap();
        assert_eq!(cells.albedo([0.5, 0.25]), 0.5);
        assert_eq!(cells.albedo([0.9, 0.75]), 0.3);
        assert!(
            (texture("{ ramp = [0.2, 0.6] }")
                .unwrap()
                .albedo([0.25, 0.9])
                - 0.3)
                .abs()
                < 1e-15
        );
    }

    #[test]
    fn impossible_albedos_are_refused() {
        for text in [
            "1.2",
            "-0.1",
            "nan",
            "{ checkerboard = [2, 2], dark = 0, light = 2 }",
            "{ checkerboard = [0, 2], dark = 0, light = 1 }",
            "{ checkerboard = [2, 2], dark = 0 }",
            "{ cells = [[1], [1, 0]] }",
            "{ cells = [] }",
            "{ ramp = [0, 1.5] }",
            "{ dark = 0.5 }",
            "{ ramp = [0, 1], light = 1 }",
        ] {
            assert!(texture(text).is_err(), "{text}");
        }
    }
}
