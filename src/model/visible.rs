//! What share of each entry of Φcam the scene's surfaces leave visible.

use rayon::prelude::*;

use super::cells::HiddenCell;
use super::cut::Cut;
use super::error::ModelError;
use super::extent::Extent;
use super::kernel::Kernel;
use super::obstacles::obstacles;
use super::occlusion::{Both, Obstructed};
use crate::matrix::Matrix;
use crate::scene::Scene;

/// Occlusion of the three-bounce integral, entry by entry.
#[derive(Clone, Debug)]
pub struct Visible {
    /// Φcam with occlusion over Φcam without, 0 to 1, pixels × spots.
    pub share: Matrix,
    /// How far off that may be: the larger of what the last halving of the cells changed and half
    /// of what the one before changed. An estimate: edges of shadows make the integrand bend, and
    /// what is smaller than the last cells may be missed where it is asked ray by ray.
    pub bound: Matrix,
    /// Cells of the hidden surfaces, in the last step.
    pub points: usize,
}

/// Relative change of Φcam below which no finer cells are tried.
const TARGET: f64 = 3e-4;
/// What is asked ray by ray scatters: a single entry's change may be small by luck, and its bound
/// is at least so many times what the entries change on average (in 1e5 normal deviates one exceeds
/// 4.4).
const SCATTER: f64 = 4.5;
/// Level of the rule on spots.
const LEVEL: usize = 1;
/// Entries of each side that are held at once.
const HELD: usize = 1 << 22;

/// Φcam past everything that stands in the way over Φcam with nothing in the way, both by the same
/// cells of the hidden surfaces, so that what both leave out cancels; the cells are cut in four
/// until Φcam changes by less than 3e-4, or there are 1e8 pairs of them with pixels and spots (8e6
/// where they are asked ray by ray). `None` where nothing can stand in the way.
///
/// # Errors
/// [`ModelError::NothingHidden`].
pub fn visible(scene: &Scene, kernel: Kernel) -> Result<Option<Visible>, ModelError> {
    if scene.hidden().next().is_none() {
        return Err(ModelError::NothingHidden);
    }
    let obstacles = obstacles(scene);
    if obstacles.is_empty() {
        return Ok(None);
    }
    let cut = Cut::new(scene, Extent::UNOBSTRUCTED);
    let lit = cut.lit(scene, LEVEL);
    let walls = scene.camera.pixels() + lit.iter().map(Vec::len).sum::<usize>();
    let occlusion = Obstructed::new(scene, kernel, &obstacles, lit);
    let mut parts = cut.hidden;
    let mut cells = parts.cells();
    let mut now = photographs(&occlusion, &cells);
    let mut before: Option<Matrix> = None;
    loop {
        parts = parts.quartered();
        cells = parts.cells();
        cells.retain(|cell| cell.albedo > 0.0);
        let next = photographs(&occlusion, &cells);
        let (share, old) = (share(&next), share(&now));
        let change = (&share - old).abs();
        let moved = change.component_mul(&next[0]).norm() / next[1].norm().max(f64::MIN_POSITIVE);
        let exhausted = 4.0 * (cells.len() * walls) as f64 > occlusion.most_pairs();
        if before.is_some() && (exhausted || moved < TARGET) {
            let least = if occlusion.by_rays() {
                SCATTER * scatter(&change)
            } else {
                0.0
            };
            let bound = match before {
                None => change,
                Some(before) => change.zip_map(&before, |now, then| match now.max(0.5 * then) {
                    0.0 => 0.0,
                    bound => bound.max(least),
                }),
            };
            return Ok(Some(Visible {
                share,
                bound,
                points: cells.len(),
            }));
        }
        (now, before) = (next, Some(change));
    }
}

/// Root mean square of the changes that are not 0.
fn scatter(change: &Matrix) -> f64 {
    let moved = change.iter().filter(|x| **x > 0.0).count();
    change.norm() / (moved.max(1) as f64).sqrt()
}

/// Φ with occlusion over Φ without; 1 where there is none.
fn share([all, left]: &[Matrix; 2]) -> Matrix {
    left.zip_map(all, |left, all| if all > 0.0 { left / all } else { 1.0 })
}

/// Φ without and with occlusion.
fn photographs(occlusion: &Obstructed<'_>, cells: &[HiddenCell]) -> [Matrix; 2] {
    let (pixels, spots) = (occlusion.pixels(), occlusion.spots());
    let mut all = [0; 2].map(|_| Matrix::zeros(pixels, spots));
    for chunk in cells.chunks((HELD / (pixels + spots)).max(1)) {
        let camera: Vec<Vec<Both>> = chunk
            .par_iter()
            .map(|cell| occlusion.camera(cell))
            .collect();
        let laser: Vec<Vec<Both>> = (0..spots)
            .into_par_iter()
            .map(|l| occlusion.laser(l, chunk))
            .collect();
        for (which, phi) in all.iter_mut().enumerate() {
            let c = Matrix::from_fn(pixels, chunk.len(), |p, q| camera[q][p][which]);
            let d = Matrix::from_fn(chunk.len(), spots, |q, l| {
                laser[l][q][which] * chunk[q].albedo
            });
            phi.gemm(1.0, &c, &d, 1.0);
        }
    }
    all
}
