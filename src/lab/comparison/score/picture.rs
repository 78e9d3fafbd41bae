//! The picture as the cause of a difference: the reflectances of all elements fitted together.
//!
//! > min_δ Σ w (r − Σ_j δ_j A_j)²,   0 ≤ ρ_j + δ_j ≤ 1,
//!
//! r = traced − model, A_j the light of element j at reflectance 1, ρ the scene's picture. With the
//! change b that the likeliest single parameter makes as one more column, orthogonal reduction
//! leaves a problem of as many rows as there are elements. Of errors that entries share a picture
//! explains more than chance: they are not asked.

use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

use crate::lab::comparison::residual::Residual;
use crate::matrix::Matrix;
use crate::model::{Effort, ElementGrid, Factors, Kernel, MatrixModel, Occlusion, element_grids};
use crate::num::linalg::{Tolerance, Triangle, least_squares, triangle};
use crate::num::quadratic::{Bounds, BoxSolution, box_least_squares};
use crate::num::statistics::chi_square_sf;
use crate::scene::Scene;

/// Level at which one cause is told to miss what another explains.
pub(super) const TOLD_APART: f64 = 0.01;

/// Entries times squared elements, beyond which a verdict would wait for seconds.
const MOST: f64 = 1e10;

/// Light of the elements of the hidden surfaces.
#[derive(Clone, Debug)]
pub struct ElementLight {
    /// Of each at reflectance 1, (pixels · spots) × elements, pixels first, W.
    pub light: Matrix,
    /// Their reflectances in the scene.
    pub rho: Vec<f64>,
}

/// The picture as it fits a difference best.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PictureFit {
    /// Reflectances that were fitted.
    pub elements: usize,
    /// Those of them that no bound holds.
    pub free: usize,
    /// χ²/dof that remains, the free ones counted.
    pub chi2_per_dof: f64,
    /// z of the likeliest single parameter after the picture; 0 where there is none.
    pub misses: f64,
    /// Whether the picture explains more than chance of what that parameter leaves; true where
    /// there is none.
    pub is_missed: bool,
}

impl ElementLight {
    /// That of all elements of `scene`, by the physical kernel integrated over each; none of fewer
    /// than two, and of too many to be fitted in passing.
    pub(in crate::lab) fn of(scene: &Scene, kernel: Kernel, occlusion: Occlusion) -> Option<Self> {
        let grids = element_grids(scene, None).ok()?;
        let elements = grids.iter().map(ElementGrid::len).sum();
        let (pixels, spots) = (scene.camera.pixels(), scene.laser.spots.len());
        let work = (pixels * spots) as f64 * (elements * elements) as f64;
        if elements < 2 || work > MOST {
            return None;
        }
        let model = match kernel {
            Kernel::Physical => {
                MatrixModel::over_areas(scene, kernel, None, occlusion, Effort::FINEST)
            }
            Kernel::Published => MatrixModel::with(scene, kernel, None, occlusion),
        };
        let model = model.ok()?;
        let each: Vec<usize> = (0..elements).collect();
        let (camera, laser, element) = match &model.factors {
            Some(Factors { terms, .. }) => (&terms.camera, &terms.laser, &terms.element),
            None => (&model.camera_side, &model.laser_side, &each),
        };
        let mut light = Matrix::zeros(pixels * spots, elements);
        for (s, j) in element.iter().enumerate() {
            let mut own = light.column_mut(*j);
            for l in 0..spots {
                let mut frame = own.rows_mut(l * pixels, pixels);
                frame.axpy(laser[(s, l)], &camera.column(s), 1.0);
            }
        }
        Some(Self {
            light,
            rho: model.albedo,
        })
    }

    /// Fits `residual`, of which the likeliest parameter changes `best`; `remaining` is χ²/dof of a
    /// change of `dof` entries. None where no solver ends at the minimum.
    pub(super) fn fit(
        &self,
        residual: &Residual<'_>,
        best: Option<&Matrix>,
        (remaining, dof): (&dyn Fn(&Matrix) -> f64, f64),
    ) -> Option<PictureFit> {
        let roots = residual.roots();
        let evidence = residual.evidence;
        let weighted = |m: &Matrix| DVector::from_column_slice(m.component_mul(&roots).as_slice());
        let (rows, elements) = self.light.shape();
        let mut columns = DMatrix::zeros(rows, elements + 1);
        for (j, own) in self.light.column_iter().enumerate() {
            let own = Matrix::from_column_slice(roots.nrows(), roots.ncols(), own.as_slice());
            if let Some(left) = evidence.left_of(own) {
                columns.set_column(j, &weighted(&left));
            }
        }
        if let Some(best) = best {
            columns.set_column(elements, &weighted(best));
        }
        let off = weighted(&(evidence.traced - evidence.model));
        let Triangle { r, d, .. } = triangle(&columns, &off).ok()?;
        let (light, b) = (r.columns(0, elements).into_owned(), r.column(elements));
        let rho = DVector::from_column_slice(&self.rho);
        let bounds = Bounds {
            lower: -&rho,
            upper: rho.map(|rho| (1.0 - rho).max(0.0)),
        };
        let solve = |d: &DVector<f64>| box_least_squares(&light, d, &bounds).ok();
        let BoxSolution { solution, .. } = solve(&d)?;
        let is_free = |j: &usize| {
            solution[*j] > bounds.lower[*j]
                && solution[*j] < bounds.upper[*j]
                && light.column(*j).amax() > 0.0
        };
        let free: Vec<usize> = (0..elements).filter(is_free).collect();
        let change = columns.columns(0, elements) * &solution;
        let change = Matrix::from_fn(roots.nrows(), roots.ncols(), |p, l| match roots[(p, l)] {
            0.0 => 0.0,
            root => change[p + l * roots.nrows()] / root,
        });
        let left = &d - &light * &solution;
        let (misses, is_missed) = match best {
            Some(_) => {
                let apart = b - &light * &solution;
                let of_best = &d - b;
                let after = &of_best - &light * solve(&of_best)?.solution;
                let more = of_best.norm_squared() - after.norm_squared();
                (
                    missed(&light.select_columns(&free), &apart, &left)?,
                    chi_square_sf(more, elements as f64) < TOLD_APART,
                )
            }
            None => (0.0, true),
        };
        let own = (dof - free.len() as f64).max(1.0);
        Some(PictureFit {
            elements,
            free: free.len(),
            chi2_per_dof: remaining(&change) * dof / own,
            misses,
            is_missed,
        })
    }
}

/// z of d's part beside the columns, in the noise's unit, of what is left.
fn missed(columns: &DMatrix<f64>, d: &DVector<f64>, left: &DVector<f64>) -> Option<f64> {
    let own = if columns.is_empty() {
        d.clone()
    } else {
        d - columns * least_squares(columns, d, Tolerance::Auto).ok()?.solution
    };
    // Below a millionth of it is rounding, and what derivatives are off by.
    if own.norm_squared() < 1e-6 * d.norm_squared() || d.amax() == 0.0 {
        return Some(0.0);
    }
    Some(own.dot(left) / own.norm())
}
