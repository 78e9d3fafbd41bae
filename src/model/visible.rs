//! What share of each entry of Φcam the scene's surfaces leave visible.

use super::ModelError;
use super::converged::{CHUNK, Cut, Extent};
use super::kernel::Kernel;
use super::parts::{HiddenNode, HiddenParts};
use super::wall_point::WallPoint;
use crate::geometry::{DVec3, Ray};
use crate::matrix::Matrix;
use crate::scene::Scene;

/// Occlusion of the three-bounce integral, entry by entry.
#[derive(Clone, Debug)]
pub struct Visible {
    /// Φcam with occlusion over Φcam without, 0 to 1, pixels × spots.
    pub share: Matrix,
    /// How far off that may be: the larger of what the last halving of the parts changed and half
    /// of what the one before changed. A shadow's edge makes the integrand jump, so that this is an
    /// estimate; an object smaller than the last parts may be missed.
    pub bound: Matrix,
    /// Points on the hidden surfaces, in the last step.
    pub points: usize,
}

/// Wall points of a pixel or a spot, each with whether its device sees it.
type Looked = Vec<(WallPoint, bool)>;

/// Lines that are asked for at most.
const MOST_RAYS: f64 = 1e7;
/// Level of the rules on footprints, spots and parts.
const LEVEL: usize = 1;

/// Asks, for 2 × 2 points of each pixel and the points of each spot, which of the hidden surfaces'
/// points are in free sight, laser and camera included; then again with every part of the hidden
/// surfaces in four, until there are 1e7 lines to ask for. The share of an entry is Φ with occlusion
/// over Φ without from the same points, so that what both leave out cancels.
///
/// # Errors
/// [`ModelError::NothingHidden`].
pub fn visible(scene: &Scene, kernel: Kernel) -> Result<Visible, ModelError> {
    if scene.hidden().next().is_none() {
        return Err(ModelError::NothingHidden);
    }
    let cut = Cut::new(scene, Extent::FULL);
    let looking = |device: DVec3, walls: Vec<Vec<WallPoint>>| -> Vec<Looked> {
        let free = |w: WallPoint| {
            let ray = Ray::between(device, w.position);
            let free = ray.is_some_and(|ray| !scene.bvh().blocked(&ray, [None, w.surface]));
            (w, free)
        };
        let each = walls.into_iter();
        each.map(|walls| walls.into_iter().map(free).collect())
            .collect()
    };
    let seen = looking(scene.camera.position, cut.seen(scene, LEVEL));
    let lit = looking(scene.laser.position, cut.lit(scene, LEVEL));
    let walls: usize = seen.iter().chain(&lit).map(Vec::len).sum();
    let mut parts = cut.hidden;
    let mut share = shares(scene, kernel, [&seen, &lit], &parts);
    let mut before: Option<Matrix> = None;
    loop {
        parts = parts.quartered();
        let next = shares(scene, kernel, [&seen, &lit], &parts);
        let change = (&next - &share).abs();
        let points = parts.count(0);
        if before.is_some() && 4.0 * points as f64 * walls as f64 > MOST_RAYS {
            let bound = match before {
                None => change,
                Some(before) => change.zip_map(&before, |now, then| now.max(0.5 * then)),
            };
            return Ok(Visible {
                share: next,
                bound,
                points,
            });
        }
        (share, before) = (next, Some(change));
    }
}

/// Φ with occlusion over Φ without; 1 where there is none.
fn shares(
    scene: &Scene,
    kernel: Kernel,
    [seen, lit]: [&[Looked]; 2],
    parts: &HiddenParts<'_>,
) -> Matrix {
    let mut all = [0; 2].map(|_| Matrix::zeros(seen.len(), lit.len()));
    // What arrives without and with what stands in the way.
    let side = |walls: &[(WallPoint, bool)], node: &HiddenNode| {
        walls.iter().fold([0.0; 2], |[all, left], (wall, free)| {
            let light = wall.towards(scene, kernel, &node.point);
            let arrives = *free && light != 0.0 && {
                let ray = Ray::between(wall.position, node.point.position);
                ray.is_some_and(|r| !scene.bvh().blocked(&r, [wall.surface, Some(node.surface)]))
            };
            [all + light, if arrives { left + light } else { left }]
        })
    };
    for chunk in parts.nodes(0).chunks(CHUNK) {
        let mut camera = [0; 2].map(|_| Matrix::zeros(seen.len(), chunk.len()));
        let mut laser = [0; 2].map(|_| Matrix::zeros(chunk.len(), lit.len()));
        for (q, node) in chunk.iter().enumerate() {
            for (p, walls) in seen.iter().enumerate() {
                let both = side(walls, node);
                (camera[0][(p, q)], camera[1][(p, q)]) = (both[0], both[1]);
            }
            for (l, walls) in lit.iter().enumerate() {
                let both = side(walls, node).map(|x| x * node.weight);
                (laser[0][(q, l)], laser[1][(q, l)]) = (both[0], both[1]);
            }
        }
        for ((phi, camera), laser) in all.iter_mut().zip(&camera).zip(&laser) {
            phi.gemm(1.0, camera, laser, 1.0);
        }
    }
    all[1].zip_map(
        &all[0],
        |left, all| if all > 0.0 { left / all } else { 1.0 },
    )
}
