//! The light of elements past what stands in the way, and how it changes as flat figures move.

use rayon::prelude::*;

use super::cells::HiddenCell;
use super::effort::Effort;
use super::error::ModelError;
use super::factors::{Past, settled};
use super::kernel::Kernel;
use super::matrix_model::element_grids;
use super::obstacles::obstacles;
use super::occlusion::Both;
use super::sweep::{Rates, Sweep, moves_figures_alone};
use super::terms::{Terms, compressed};
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
    /// ∂A_j by each parameter, as products too; none where it moves more than flat figures that
    /// stand in the way, or a wall, an obstacle or a hidden surface is not flat.
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
        let settled = settled(scene, Kernel::Physical, &obstacles, &grids, effort)?;
        let (factors, _) = settled.joined();
        let mut rates: Vec<Option<Terms>> = velocities.iter().map(|_| None).collect();
        let past = &settled.past;
        let mut cells = settled.cells.iter().flatten();
        if past.occlusion.is_flat() && cells.all(|cell| cell.corners.is_some()) {
            let all = (0..velocities.len()).filter(|k| moves_figures_alone(scene, &velocities[*k]));
            for lanes in all.collect::<Vec<_>>().chunks(AT_ONCE) {
                let moving: Vec<&Velocity> = lanes.iter().map(|k| &velocities[*k]).collect();
                let sweep = Sweep::new(&past.occlusion, &moving);
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
    let ratio = past.by_rule(cells);
    let laser: Vec<Vec<Both>> = (0..spots).map(|l| occlusion.laser(l, cells)).collect();
    // What shines is what it is wherever the figures are.
    let still: Vec<Vec<Both>> = if occlusion.scene.laser.is_shining() {
        Vec::new()
    } else {
        cells.iter().map(|cell| occlusion.camera(cell)).collect()
    };
    let camera: Vec<Vec<Rates>> = cells.iter().map(|cell| sweep.camera(cell)).collect();
    let laser_rates: Vec<Vec<Rates>> = (0..spots).map(|l| sweep.laser(l, cells)).collect();
    let n = cells.len();
    let of = |lane: usize| {
        let c = Matrix::from_fn(pixels, n + still.len(), |p, q| {
            ratio[p]
                * if q < n {
                    camera[q][p][lane]
                } else {
                    still[q - n][p][1]
                }
        });
        let d = Matrix::from_fn(n + still.len(), spots, |q, l| {
            if q < n {
                laser[l][q][1]
            } else {
                laser_rates[l][q - n][lane]
            }
        });
        compressed(&c, &d)
    };
    (0..lanes).map(of).collect()
}

#[cfg(test)]
mod tests;
