//! Albedo over a surface.

mod bilinear;
mod file;
mod picture;

use super::error::{Fault, keys};

pub use bilinear::{Bilinear, Wrap};
pub use file::{AlbedoTable, Filter, PictureChannel, VariedTable};

/// Reads a file that a scene names, by its path below the scene's folder; the error says why not,
/// without a full stop.
pub(super) type Files<'a> = dyn FnMut(&str) -> Result<Vec<u8>, String> + 'a;

/// A smaller albedo than this is taken for a mistake: products of them would leave the range of
/// f64.
const LEAST_ALBEDO: f64 = 1e-30;
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
    /// Cells that are repeated outside \[0, 1\].
    Tiles(Cells),
    /// Interpolated between the centres of texels.
    Bilinear(Bilinear),
}

/// Cell-wise constant albedo.
#[derive(Clone, Debug, PartialEq)]
pub struct Cells {
    /// Cells along u and v.
    pub count: [usize; 2],
    /// Albedo of cell iu + iv·count\[0\].
    pub albedo: Vec<f64>,
}

/// The cells of n equal ones on \[0, 1\] that an interval covers, each with its share of the
/// interval; of one within rounding (1e-9 of a cell) nothing is taken.
fn overlaps([a, b]: [f64; 2], n: usize) -> Vec<(usize, f64)> {
    const ROUNDING: f64 = 1e-9;
    let (a, b) = (a * n as f64, b * n as f64);
    let first = (a + ROUNDING).floor().max(0.0) as usize;
    let last = ((b - ROUNDING).ceil() as usize).clamp(first + 1, n.max(first + 1));
    let width = |i: usize| b.min(i as f64 + 1.0) - a.max(i as f64);
    match last - first {
        1 => vec![(first.min(n - 1), 1.0)],
        _ => (first..last).map(|i| (i, width(i) / (b - a))).collect(),
    }
}

/// The middles of the parts into which the edges of n equal cells divide an interval, each with its
/// share of it.
fn middles([a, b]: [f64; 2], n: usize) -> Vec<(f64, f64)> {
    let shares = overlaps([a, b], n).into_iter();
    let mut from = a;
    let part = |(_, share): (usize, f64)| {
        let middle = from + 0.5 * share * (b - a);
        from += share * (b - a);
        (middle, share)
    };
    shares.map(part).collect()
}

impl Texture {
    /// Albedo at (u, v). On an edge between cells the higher cell counts; u, v are held to [0, 1]
    /// unless the texture repeats.
    pub fn albedo(&self, [u, v]: [f64; 2]) -> f64 {
        match self {
            Self::Constant(rho) => *rho,
            Self::Cells(cells) => cells.at([u, v]),
            Self::Ramp([a, b]) => a + (b - a) * u.clamp(0.0, 1.0),
            Self::Tiles(cells) => cells.at([u - u.floor(), v - v.floor()]),
            Self::Bilinear(texels) => texels.at([u, v]),
        }
    }

    /// What lies outside \[0, 1\].
    pub fn wrap(&self) -> Wrap {
        match self {
            Self::Constant(_) | Self::Tiles(_) => Wrap::Repeat,
            Self::Cells(_) | Self::Ramp(_) => Wrap::Clamp,
            Self::Bilinear(texels) => texels.wrap,
        }
    }

    /// Number of cells along u and v within which the albedo is smooth.
    pub fn smooth_cells(&self) -> [usize; 2] {
        match self {
            Self::Constant(_) | Self::Ramp(_) => [1, 1],
            Self::Cells(cells) | Self::Tiles(cells) => cells.count,
            Self::Bilinear(texels) => texels.smooth_cells(),
        }
    }

    /// How many numbers it holds.
    pub(super) fn held(&self) -> usize {
        match self {
            Self::Constant(_) | Self::Ramp(_) => 0,
            Self::Cells(cells) | Self::Tiles(cells) => cells.albedo.len(),
            Self::Bilinear(texels) => texels.albedo.len(),
        }
    }

    /// Mean albedo of smooth cell iu + iv·nu: exact.
    pub fn cell_mean(&self, cell: usize) -> f64 {
        match self {
            Self::Constant(rho) => *rho,
            Self::Cells(cells) | Self::Tiles(cells) => cells.albedo[cell],
            Self::Ramp([a, b]) => 0.5 * (a + b),
            Self::Bilinear(texels) => texels.cell_mean(cell),
        }
    }

    /// Mean albedo over a rectangle of parameters within \[0, 1\]: exact.
    pub fn mean(&self, [u0, u1]: [f64; 2], [v0, v1]: [f64; 2]) -> f64 {
        match self {
            Self::Constant(rho) => *rho,
            Self::Ramp([a, b]) => a + (b - a) * 0.5 * (u0 + u1),
            Self::Cells(cells) | Self::Tiles(cells) => {
                let [nu, nv] = cells.count;
                let (across, up) = (overlaps([u0, u1], nu), overlaps([v0, v1], nv));
                let row = |j: usize| -> f64 {
                    let along = across.iter();
                    along.map(|(i, w)| w * cells.albedo[i + j * nu]).sum()
                };
                up.iter().map(|(j, w)| w * row(*j)).sum()
            }
            // Linear along u and along v within each part: the mean is the value in its middle.
            Self::Bilinear(texels) => {
                let [nu, nv] = texels.smooth_cells();
                let (across, up) = (middles([u0, u1], nu), middles([v0, v1], nv));
                let row = |v: f64| -> f64 {
                    let along = across.iter();
                    along.map(|(u, w)| w * texels.at([*u, v])).sum()
                };
                up.iter().map(|(v, w)| w * row(*v)).sum()
            }
        }
    }

    /// The texture whose numbers are `f` of this one's. Between the numbers of a ramp or of a
    /// bilinear picture it is interpolated as before, which is `f` of what was there only if `f` is
    /// linear.
    pub(super) fn map(&self, mut f: impl FnMut(f64) -> f64) -> Self {
        let mut each = |albedo: &[f64]| albedo.iter().map(|rho| f(*rho)).collect::<Vec<_>>();
        let mut cells = |c: &Cells| Cells {
            count: c.count,
            albedo: each(&c.albedo),
        };
        match self {
            Self::Cells(c) => Self::Cells(cells(c)),
            Self::Tiles(c) => Self::Tiles(cells(c)),
            Self::Constant(rho) => Self::Constant(f(*rho)),
            Self::Ramp([a, b]) => Self::Ramp([f(*a), f(*b)]),
            Self::Bilinear(texels) => Self::Bilinear(Bilinear {
                albedo: each(&texels.albedo),
                ..texels.clone()
            }),
        }
    }

    /// Largest albedo.
    pub fn largest(&self) -> f64 {
        match self {
            Self::Constant(rho) => *rho,
            Self::Cells(cells) | Self::Tiles(cells) => {
                cells.albedo.iter().copied().fold(0.0, f64::max)
            }
            Self::Bilinear(texels) => texels.albedo.iter().copied().fold(0.0, f64::max),
            Self::Ramp([a, b]) => a.max(*b),
        }
    }

    /// Checks a table; `wavelength` (m) is the laser's, for pictures whose channels it weights, and
    /// `files` reads pictures.
    pub(super) fn from_table(
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

impl Cells {
    fn at(&self, [u, v]: [f64; 2]) -> f64 {
        let [nu, nv] = self.count;
        let index = |x: f64, n: usize| ((x * n as f64) as usize).min(n - 1);
        self.albedo[index(u, nu) + index(v, nv) * nu]
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

fn albedo(rho: f64) -> Result<f64, Fault> {
    if rho == 0.0 || (LEAST_ALBEDO..=1.0).contains(&rho) {
        return Ok(rho);
    }
    if rho > 0.0 && rho < LEAST_ALBEDO {
        let cause = format!("albedo {rho} is less than {LEAST_ALBEDO:e}, and not 0");
        return Err(Fault::new(keys![], cause, "use 0 for black"));
    }
    Err(Fault::new(
        keys![],
        format!("albedo {rho} is outside [0, 1]: a surface cannot reflect more than it receives"),
        "give a number from 0 to 1",
    ))
}

#[cfg(test)]
mod tests;
