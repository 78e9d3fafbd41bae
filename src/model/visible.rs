//! What share of each entry of Φcam the scene's surfaces leave visible.

use rayon::prelude::*;

use super::cells::HiddenCell;
use super::cut::Cut;
use super::divided;
use super::error::ModelError;
use super::extent::Extent;
use super::kernel::Kernel;
use super::obstacles::{may_shade, obstacles};
use super::occlusion::{Both, Obstructed};
use super::parts::HiddenParts;
use crate::geometry::ShapeId;
use crate::matrix::Matrix;
use crate::scene::Scene;

/// Occlusion of the three-bounce integral, entry by entry.
#[derive(Clone, Debug)]
pub struct Visible {
    /// Φcam with occlusion over Φcam without, 0 to 1, pixels × spots.
    pub share: Matrix,
    /// How far off that may be: the larger of what the last halving of the cells changed and half
    /// of what the one before changed, and what another division of footprints and spots changes.
    /// At least two standard deviations of what viewpoints leave to chance where camera and laser
    /// both see a part of a cell; where a shadow was met from fewer than ten cells and may be
    /// there, at least 3/n of the most that a shadow takes, n cells (of what none of n saw, less
    /// than 3/n is there in 95 of 100; n pairs of cells and pixels, or spots, where no shadow was
    /// met at all); and half of what is not known to be in the camera's sight or not. An estimate:
    /// edges of shadows make the integrand bend, and what is smaller than the last cells may be
    /// missed where it is asked ray by ray.
    pub bound: Matrix,
    /// Cells of the hidden surfaces, in the last step.
    pub points: usize,
}

/// Relative change of Φcam below which no finer cells are tried.
const TARGET: f64 = 3e-4;
/// Cells that one thread asks for at once.
const TOGETHER: usize = 16;
/// What is asked ray by ray scatters: a single entry's change may be small by luck, and its bound
/// is at least so many times what the entries change on average (in 1e5 normal deviates one exceeds
/// 4.4).
const SCATTER: f64 = 4.5;
/// Standard deviations of what viewpoints leave to chance in a bound.
pub(super) const DEVIATIONS: f64 = 2.0;
/// Cells whose viewpoints meet the shadows on a pixel or of a spot, from which on what changes from
/// one division to the next tells how many are missed; and of fewer how many may be, beside twice
/// the square root of their number.
const FEW: usize = 10;
const MISSED: f64 = 3.0;
/// Things in the way that are left out one by one, at most.
const MOST_SINGLE: usize = 16;
/// Entries of each side that are held at once.
const HELD: usize = 1 << 22;

/// Φcam past everything that stands in the way over Φcam with nothing in the way, both by the same
/// cells of the hidden surfaces, so that what both leave out cancels; the cells are cut in four
/// until Φcam changes by less than 3e-4, or there are 1e8 pairs of them with pixels and spots (8e6
/// where they are asked ray by ray). Footprints and spots are divided likewise, for the cells that
/// are cut once; what another division changes for the cells before the last is added. `None` where
/// nothing can stand in the way.
///
/// # Errors
/// [`ModelError::NothingHidden`].
pub fn visible(scene: &Scene, kernel: Kernel) -> Result<Option<Visible>, ModelError> {
    if scene.hidden().next().is_none() {
        return Err(ModelError::NothingHidden);
    }
    past(scene, kernel, &obstacles(scene))
}

/// The part, 0 to 1, of each entry's light past all others that a thing in the way takes, pixels ×
/// spots, for each thing; of more than 16 what all together take. `share` is what all
/// of them leave.
///
/// # Errors
/// [`ModelError::NothingHidden`].
pub fn shadows(scene: &Scene, kernel: Kernel, share: &Matrix) -> Result<Vec<Matrix>, ModelError> {
    let all = obstacles(scene);
    // Both sides of a surface are one thing.
    let thing = |id: &ShapeId| scene.front_of(*id as usize).unwrap_or(*id as usize);
    let mut things: Vec<usize> = all.iter().map(thing).collect();
    things.sort_unstable();
    things.dedup();
    if things.len() > MOST_SINGLE {
        return Ok(vec![share.map(|left| 1.0 - left)]);
    }
    let taken = |out: &usize| {
        let others = all.iter().copied().filter(|id| thing(id) != *out);
        let others: Vec<ShapeId> = others.collect();
        let without = past(scene, kernel, &others)?;
        Ok(match without {
            None => share.map(|left| 1.0 - left),
            Some(past) => share.zip_map(&past.share, |left, most| {
                if most > left { 1.0 - left / most } else { 0.0 }
            }),
        })
    };
    things.iter().map(taken).collect()
}

/// What these obstacles leave.
fn past(
    scene: &Scene,
    kernel: Kernel,
    obstacles: &[ShapeId],
) -> Result<Option<Visible>, ModelError> {
    if obstacles.is_empty() {
        return Ok(None);
    }
    let whole = Cut::new(scene, Extent::UNOBSTRUCTED).hidden;
    let coarse = whole.cells();
    let mut parts = whole.quartered();
    let light = |parts: &HiddenParts<'_>| {
        let mut cells = parts.cells();
        cells.retain(|cell| cell.albedo > 0.0);
        cells
    };
    let mut cells = light(&parts);
    let by = |division| {
        let past = divided::past(scene, kernel, obstacles, division);
        let phi = photographs(&past, &cells);
        Ok::<_, ModelError>((past, phi))
    };
    let walls = divided::settled(
        by,
        |(past, _)| divided::can_be_finer(past, cells.len(), 1.0),
        |(_, now), (_, next)| moved(&(next.share() - now.share()), now),
        TARGET,
    )?;
    let (occlusion, mut next) = walls.used;
    let other = walls.other.map(|(past, _)| past);
    let (mut now, mut cells_now) = (photographs(&occlusion, &coarse), coarse);
    let may = occlusion
        .places()
        .map(|places| may_shade(scene, obstacles, places.into_iter()));
    let mut before: Option<Matrix> = None;
    loop {
        let (mut share, old) = (next.share(), now.share());
        let change = (&share - old).abs();
        let missed = next.missed(&may, cells.len());
        let exhausted = 4.0 * (cells.len() * occlusion.walls) as f64 > occlusion.most_pairs();
        if let Some(before) = &before
            && (exhausted || moved(&change, &next) < TARGET && moved(&missed, &next) < TARGET)
        {
            let least = if occlusion.by_rays() {
                SCATTER * scatter(&change)
            } else {
                0.0
            };
            let mut bound = change.zip_map(before, |now, then| match now.max(0.5 * then) {
                0.0 => 0.0,
                bound => bound.max(least),
            });
            bound = bound.zip_map(&next.deviation(), |bound, d| bound.max(DEVIATIONS * d));
            bound = bound.zip_map(&missed, f64::max);
            for (p, mut bound) in bound.row_iter_mut().enumerate() {
                bound.add_scalar_mut(occlusion.undecided(p));
            }
            if let Some(other) = &other {
                let (used, other) = (now.share(), photographs(other, &cells_now).share());
                bound += (&other - &used).abs();
                if walls.is_settled {
                    share = share.zip_zip_map(&used, &other, finer);
                }
            }
            return Ok(Some(Visible {
                share,
                bound,
                points: cells.len(),
            }));
        }
        parts = parts.quartered();
        cells_now = std::mem::replace(&mut cells, light(&parts));
        let finer = photographs(&occlusion, &cells);
        (now, before, next) = (next, Some(change), finer);
    }
}

/// A share by the division of which fewer cells have `used`, as another changes it to `other`.
fn finer(share: f64, used: f64, other: f64) -> f64 {
    if used > 0.0 {
        share * (other / used)
    } else {
        share + other
    }
}

/// What shares change in Φ with what stands in the way, over all of it.
fn moved(change: &Matrix, Photographs { all, left, .. }: &Photographs) -> f64 {
    change.component_mul(all).norm() / left.norm().max(f64::MIN_POSITIVE)
}

/// Root mean square of the changes that are not 0.
fn scatter(change: &Matrix) -> f64 {
    let moved = change.iter().filter(|x| **x > 0.0).count();
    change.norm() / (moved.max(1) as f64).sqrt()
}

/// Φ without and with occlusion, and the variance of the latter by the choice of viewpoints.
struct Photographs {
    all: Matrix,
    left: Matrix,
    variance: Matrix,
    /// Cells from which each pixel, and each spot, is seen in part or not at all, and the most that
    /// a shadow takes of what one of them sends to any.
    met: [(Vec<usize>, f64); 2],
}

impl Photographs {
    /// What shadows that may be there and are met from few of `cells` cells may take of each entry.
    fn missed(&self, may: &[Vec<bool>; 2], cells: usize) -> Matrix {
        let side = |side: usize| -> Vec<f64> {
            let (met, most) = &self.met[side];
            let [looks, most] = if *most > 0.0 {
                [cells as f64, *most]
            } else {
                [(cells * met.len().max(1)) as f64, 1.0]
            };
            let missed = |(met, may): (&usize, &bool)| {
                let few = (MISSED + 2.0 * (*met as f64).sqrt()) / looks;
                f64::from(u8::from(*may && *met < FEW)) * few.min(1.0) * most
            };
            met.iter().zip(&may[side]).map(missed).collect()
        };
        let [camera, laser] = [0, 1].map(side);
        Matrix::from_fn(camera.len(), laser.len(), |p, l| camera[p] + laser[l])
    }

    /// Φ with occlusion over Φ without; 1 where there is none.
    fn share(&self) -> Matrix {
        let share = |left: f64, all: f64| if all > 0.0 { left / all } else { 1.0 };
        self.left.zip_map(&self.all, share)
    }

    /// Standard deviation of that.
    fn deviation(&self) -> Matrix {
        let share = |v: f64, all: f64| if all > 0.0 { v.sqrt() / all } else { 0.0 };
        self.variance.zip_map(&self.all, share)
    }
}

/// Φ of cells. c is known at a cell's viewpoint x, d as the mean d̄ over the cell and as d′ at x.
/// Where pixel and spot see different parts of a cell, c(x)·d̄ is not the mean of c·d: were one's
/// part the other's dark, light would pass where none does, in every cell along the edge alike.
/// Both c(x)·d̄ + (c_all − c(x))·(d̄ − d′) = c_all·d̄ − (c_all − c(x))·d′ and c(x)·d̄ − c(x)·(d̄ −
/// d′) = c(x)·d′ have the right mean over x; of each entry the one that varies less, by the squares
/// of what it adds: the first where the camera sees the parts that are lit, and then nothing is
/// added.
fn photographs(occlusion: &Obstructed<'_>, cells: &[HiddenCell]) -> Photographs {
    let (pixels, spots) = (occlusion.pixels(), occlusion.spots());
    let zeros = || Matrix::zeros(pixels, spots);
    let [mut all, mut left, mut variance] = [zeros(), zeros(), zeros()];
    let mut met = [pixels, spots].map(|n| (vec![0; n], 0.0));
    let shaded = |(met, most): &mut (Vec<usize>, f64), at: usize, [all, left]: Both| {
        if left < all {
            met[at] += 1;
            *most = most.max(1.0 - left / all);
        }
    };
    // Sums and squares of what each adds.
    let mut added = [[zeros(), zeros()], [zeros(), zeros()]];
    for chunk in cells.chunks((HELD / (pixels + spots)).max(1)) {
        let camera: Vec<Vec<Both>> = chunk
            .par_chunks(TOGETHER)
            .flat_map_iter(|cells| occlusion.camera(cells))
            .collect();
        let laser: Vec<Vec<[f64; 3]>> = (0..spots)
            .into_par_iter()
            .map(|l| occlusion.laser_and_viewpoints(l, chunk))
            .collect();
        for cell in &camera {
            let each = cell.iter().enumerate();
            each.for_each(|(p, both)| shaded(&mut met[0], p, *both));
        }
        for (l, cells) in laser.iter().enumerate() {
            let each = cells.iter();
            each.for_each(|[all, left, _]| shaded(&mut met[1], l, [*all, *left]));
        }
        let c = |which: usize| Matrix::from_fn(pixels, chunk.len(), |p, q| camera[q][p][which]);
        let d = |of: fn([f64; 3]) -> f64| {
            Matrix::from_fn(chunk.len(), spots, |q, l| of(laser[l][q]) * chunk[q].albedo)
        };
        let (seen, free) = (c(0), c(1));
        all.gemm(1.0, &seen, &d(|[all, ..]| all), 1.0);
        left.gemm(1.0, &free, &d(|[_, left, _]| left), 1.0);
        let apart = d(|[_, left, at_viewpoint]| left - at_viewpoint);
        if apart.iter().all(|x| *x == 0.0) {
            continue;
        }
        let squares = |m: &Matrix| m.map(|x| x * x);
        for (side, [sum, square]) in [&free - &seen, free].iter().zip(&mut added) {
            sum.gemm(-1.0, side, &apart, 1.0);
            square.gemm(1.0, &squares(side), &squares(&apart), 1.0);
        }
    }
    let [[by_hidden, hidden], [by_free, free]] = &added;
    for k in 0..left.len() {
        let lit = left[k] + by_hidden[k] >= 0.0;
        let (more, own) = if lit && hidden[k] <= free[k] {
            (by_hidden[k], hidden[k])
        } else {
            (by_free[k], free[k])
        };
        left[k] += more;
        variance[k] = own;
    }
    Photographs {
        all,
        left,
        variance,
        met,
    }
}
