//! Albedo over a surface.

mod bilinear;
mod checked;
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
pub(super) const LEAST_ALBEDO: f64 = 1e-30;
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
}

impl Cells {
    fn at(&self, [u, v]: [f64; 2]) -> f64 {
        let [nu, nv] = self.count;
        let index = |x: f64, n: usize| ((x * n as f64) as usize).min(n - 1);
        self.albedo[index(u, nu) + index(v, nv) * nu]
    }
}

fn albedo(rho: f64) -> Result<f64, Fault> {
    if rho == 0.0 || (LEAST_ALBEDO..=1.0).contains(&rho) {
        return Ok(rho);
    }
    if rho > 0.0 && rho < LEAST_ALBEDO {
        let cause = format!("albedo {rho:e} is less than {LEAST_ALBEDO:e}, and not 0");
        return Err(Fault::new(keys![], cause, "use 0 for black"));
    }
    Err(Fault::new(
        keys![],
        format!("albedo {rho:?} is outside [0, 1]: a surface cannot reflect more than it receives"),
        "give a number from 0 to 1",
    ))
}

#[cfg(test)]
mod tests;
