//! The light of elements past what stands in the way, and how it changes with the geometry.

use rayon::prelude::*;

use super::cells::HiddenCell;
use super::effort::Effort;
use super::error::ModelError;
use super::factors::{Past, settled, unobstructed};
use super::kernel::Kernel;
use super::matrix_model::element_grids;
use super::obstacles::obstacles;
use super::occlusion::Both;
use super::sweep::{Rates, Sweep};
use super::terms::{NEGLIGIBLE, Terms, compressed};
use crate::geometry::AT_ONCE;
use crate::matrix::Matrix;
use crate::scene::{Scene, Velocity};

/// A_j past what stands in the way, integrated over elements, footprints and spots.
#[derive(Clone, Debug)]
pub struct Swept {
    /// A_j.
    pub terms: Terms,
    /// Number of elements.
    pub elements: usize,
    /// ∂A_j by each parameter, as products too; none where a wall, an obstacle or a hidden surface
    /// is not flat, or no wall lies below the middle of the view.
    pub rates: Vec<Option<Terms>>,
}

impl Swept {
    /// Of `scene`; `elements` replaces the elements a side that it gives, `velocities` are those by
    /// the parameters. None where nothing stands in the way.
    ///
    /// # Errors
    /// [`ModelError`].
    pub fn new(
        scene: &Scene,
        elements: Option<[usize; 2]>,
        velocities: &[Velocity],
        effort: Effort,
    ) -> Result<Option<Self>, ModelError> {
        let grids = element_grids(scene, elements)?;
        let obstacles = obstacles(scene);
        if obstacles.is_empty() {
            return Ok(None);
        }
        let settled = settled(scene, Kernel::Physical, &obstacles, &grids, effort, true)?;
        let (factors, _) = settled.joined();
        let mut rates: Vec<Option<Terms>> = velocities.iter().map(|_| None).collect();
        let past = &settled.past;
        let mut cells = settled.cells.iter().flatten();
        if past.occlusion.is_flat() && cells.all(|cell| cell.corners.is_some()) {
            let all: Vec<usize> = (0..velocities.len()).collect();
            for lanes in all.chunks(AT_ONCE) {
                let moving: Vec<&Velocity> = lanes.iter().map(|k| &velocities[*k]).collect();
                let Some(sweep) = Sweep::new(&past.occlusion, &moving) else {
                    continue;
                };
                let own = settled.cells.par_iter();
                let own = own.map(|cells| own_rates(past, cells, &sweep, lanes.len()));
                let own: Vec<Vec<(Matrix, Matrix)>> = own.collect::<Result<_, _>>()?;
                for (lane, k) in lanes.iter().enumerate() {
                    let each: Vec<_> = own.iter().map(|o| (&o[lane].0, &o[lane].1)).collect();
                    let sides = (past.occlusion.pixels(), past.occlusion.spots());
                    rates[*k] = Some(Terms::stacked(&each, sides));
                }
            }
        }
        Ok(Some(Self {
            terms: factors.terms,
            elements: settled.cells.len(),
            rates,
        }))
    }
}

/// ∂A of the element that these cells make up, by `lanes` parameters: ∂A = Σ_q ċ_q d_q + c_q ḋ_q.
fn own_rates(
    past: &Past<'_>,
    cells: &[HiddenCell],
    sweep: &Sweep<'_>,
    lanes: usize,
) -> Result<Vec<(Matrix, Matrix)>, ModelError> {
    let occlusion = &past.occlusion;
    let (pixels, spots) = (occlusion.pixels(), occlusion.spots());
    let n = cells.len();
    let laser: Vec<Vec<Both>> = (0..spots).map(|l| occlusion.laser(l, cells)).collect();
    // What shines is what it is wherever all else is.
    let terms = if occlusion.scene.laser.is_shining() {
        n
    } else {
        2 * n
    };
    let light: Vec<Vec<Both>> = if terms > n || !sweep.is_still {
        occlusion.camera(cells)
    } else {
        Vec::new()
    };
    let by_middles = if light.is_empty() {
        occlusion.unobstructed(cells)
    } else {
        unobstructed(&light, pixels)
    };
    let ratio = past.by_rule(cells, &by_middles);
    let still = |p: usize, q: usize| light.get(q).map_or(0.0, |own| own[p][1]);
    // How the ratio changes differs over an element by much less than the ratio: by its middle.
    let middle = n / 2;
    let of_middle = |m: &Matrix| m.row(middle).iter().copied().collect::<Vec<f64>>();
    let of_ratio = match cells.get(middle) {
        Some(cell) => sweep.by_rule(
            cell,
            &past.footprints,
            (&of_middle(&by_middles), &of_middle(&ratio)),
        ),
        None => Vec::new(),
    };
    let camera: Vec<Vec<Rates>> = cells.iter().map(|cell| sweep.camera(cell)).collect();
    let laser_rates: Vec<Vec<Rates>> = (0..spots).map(|l| sweep.laser(l, cells)).collect();
    let of = |lane: usize| {
        let c = Matrix::from_fn(pixels, terms, |p, q| {
            if q < n {
                ratio[(q, p)] * camera[q][p][lane] + of_ratio[p][lane] * still(p, q)
            } else {
                ratio[(q - n, p)] * still(p, q - n)
            }
        });
        let d = Matrix::from_fn(terms, spots, |q, l| {
            if q < n {
                laser[l][q][1]
            } else {
                laser_rates[l][q - n][lane]
            }
        });
        compressed((&c, &d), NEGLIGIBLE)
    };
    (0..lanes).map(of).collect()
}

#[cfg(test)]
mod tests;
