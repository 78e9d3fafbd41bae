//! How finely spots and footprints are divided where something stands in the way.
//!
//! The rim of a shadow crosses them, where no rule of high order converges, so that each division
//! has twice as many nodes along every axis, and what that changes is the measure of what is left.

use super::kernel::Kernel;
use super::occlusion::Obstructed;
use crate::geometry::ShapeId;
use crate::scene::Scene;

/// Divisions after the first, and parts of footprints and spots, at most.
const MOST_DIVISIONS: u32 = 4;
const MOST_WALLS: usize = 1 << 17;
/// Nodes of the first from a spot's middle to its rim.
const NODES: usize = 4;

/// What depends on the division, as fine as is needed.
pub(super) struct Divided<T> {
    pub used: T,
    /// The same by the next division, if that changes it by little; else by the one before, where
    /// no finer one can be had. None where there is but one.
    pub other: Option<T>,
    /// Whether `other` is the finer.
    pub is_settled: bool,
}

/// The scene past these obstacles by a division: 0 and finer ones.
pub(super) fn past<'a>(
    scene: &'a Scene,
    kernel: Kernel,
    obstacles: &[ShapeId],
    division: u32,
) -> Obstructed<'a> {
    Obstructed::new(scene, kernel, obstacles, (NODES << division, 1 << division))
}

/// Whether so many cells can be looked at by the next division, in a `share` of the pairs that are
/// worth looking at.
pub(super) fn can_be_finer(occlusion: &Obstructed<'_>, cells: usize, share: f64) -> bool {
    let next = 4 * occlusion.walls;
    next <= MOST_WALLS && (next * cells) as f64 <= share * occlusion.most_pairs()
}

/// `at` a division, until the next one changes it by less than `target`.
pub(super) fn settled<T, E>(
    at: impl Fn(u32) -> Result<T, E>,
    can_be_finer: impl Fn(&T) -> bool,
    moved: impl Fn(&T, &T) -> f64,
    target: f64,
) -> Result<Divided<T>, E> {
    let (mut used, mut other) = (at(0)?, None);
    for division in 1..=MOST_DIVISIONS {
        if !can_be_finer(&used) {
            break;
        }
        let next = at(division)?;
        if moved(&used, &next) < target {
            return Ok(Divided {
                used,
                other: Some(next),
                is_settled: true,
            });
        }
        other = Some(std::mem::replace(&mut used, next));
    }
    Ok(Divided {
        used,
        other,
        is_settled: false,
    })
}
