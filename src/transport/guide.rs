//! Where light between the walls comes from: a guess by which surfaces are sampled.
//!
//! ```text
//! I(y) = G(x, y)·V · G(y, s)·V
//! ```
//!
//! for what a pixel sees, x, and a lit point s; summed over some of each where one sampler serves
//! many. It only steers where points are drawn: their density is known whatever it is, so that no
//! guess makes an estimate wrong.

use std::sync::Arc;

use rayon::prelude::*;

use super::area::AreaSampler;
use super::camera::PixelView;
use super::parts::Parts;
use super::path::{PathSampler, Points};
use super::plan::Plan;
use super::spots::LitSpots;
use super::vertex::Vertex;
use crate::geometry::ShapeId;
use crate::scene::Scene;

/// Points that are asked of each kind where one sampler serves all, at most.
const MOST: usize = 16;

/// Probability of the area strategy where some parts are near what the pixel sees.
const BESIDE_LOBE: f64 = 0.75;

/// Spots times parts up to which each spot has its own guess: 64 MiB, and as much in each thread.
const MOST_NUMBERS: usize = 1 << 23;

/// What parts of surfaces some pixels and some spots see.
#[derive(Debug)]
pub(super) struct Guide {
    parts: Arc<Parts>,
    /// By part: seen by some pixels, lit by some spots.
    seen: Vec<f64>,
    lit: Vec<f64>,
    /// By column and part, where every entry has paths of its own.
    lit_by: Vec<Vec<f64>>,
}

impl Guide {
    /// For surfaces `between` the walls.
    pub(super) fn new(
        between: &[ShapeId],
        views: &[PixelView],
        spots: &LitSpots<'_>,
        plan: &Plan,
    ) -> Self {
        let scene = spots.scene;
        let parts = Parts::divided(scene, between, side(scene, plan));
        let seen = views.iter().filter_map(|v| v.vertex(scene, [0.5; 2]));
        let lit = |spot: usize| spots.beams.point(spot, [0.5; 2]);
        // Of all spots, whichever of them are traced: the bits of some do not depend on others.
        let all: Vec<_> = (0..scene.laser.spots.len()).filter_map(lit).collect();
        let numbers = scene.laser.spots.len() * parts.weights().count();
        let columns = if plan.estimator.serves_all_spots() || numbers > MOST_NUMBERS {
            0..0
        } else {
            spots.range.clone()
        };
        let by_column = columns
            .into_par_iter()
            .map(|spot| lit(spot).map_or_else(Vec::new, |lit| parts.seen_from(scene, &lit)));
        Self {
            seen: from_some(scene, &parts, &seen.collect::<Vec<_>>()),
            lit: from_some(scene, &parts, &all),
            lit_by: by_column.collect(),
            parts: Arc::new(parts),
        }
    }

    /// Whether no surface reflects.
    pub(super) fn is_empty(&self) -> bool {
        self.parts.surfaces.is_empty()
    }

    /// Whether every entry has points of its own.
    pub(super) fn is_by_column(&self) -> bool {
        !self.lit_by.is_empty()
    }

    /// Whether any surface comes so near to a spot of radius `reach` that its parts are too large
    /// for it.
    pub(super) fn is_too_coarse_for(&self, scene: &Scene, spot: usize, reach: f64) -> bool {
        let target = scene.laser.spots[spot].target.position;
        !self.parts.are_far_from(target, reach)
    }

    /// One sampler for all pixels and spots.
    pub(super) fn for_all(&self) -> AreaSampler {
        AreaSampler::guided(&self.parts, |k| self.seen[k] * self.lit[k])
    }
}

/// Parts along a side of a surface: twice as many where a block has so many paths in each pixel, or
/// connections, that what they cost does not count.
fn side(scene: &Scene, plan: &Plan) -> usize {
    let all = plan.budget.size as usize * scene.laser.spots.len();
    if all < 1024 { 16 } else { 32 }
}

/// What some of the `ends`, evenly chosen, see.
fn from_some(scene: &Scene, parts: &Parts, ends: &[Vertex]) -> Vec<f64> {
    let count = ends.len().min(MOST);
    let places = (0..count).map(|i| (2 * i + 1) * ends.len() / (2 * count));
    let some: Vec<_> = places.map(|k| ends[k]).collect();
    let seen: Vec<_> = some
        .par_iter()
        .map(|end| parts.seen_from(scene, end))
        .collect();
    let sum = |k: usize| seen.iter().map(|s| s[k]).sum();
    (0..parts.weights().count()).map(sum).collect()
}

/// The samplers of one pixel.
#[derive(Debug)]
pub(super) struct PixelGuide<'a> {
    guide: &'a Guide,
    /// By part.
    seen: Vec<f64>,
    /// Probability of the area strategy.
    share: f64,
    /// By column, or one for all.
    samplers: Vec<Option<AreaSampler>>,
}

impl<'a> PixelGuide<'a> {
    /// `None` where the paths of the pixel do not choose.
    pub(super) fn new(
        guide: &'a Guide,
        (path, view): (&PathSampler<'_>, &PixelView),
        scene: &Scene,
    ) -> Option<Self> {
        let x = view.vertex(scene, [0.5; 2])?;
        if !path.chooses_at(x.shape) {
            return None;
        }
        let flat = scene.surfaces[x.shape as usize].is_lambertian() && view.shape().is_some();
        let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let reach = corners.map(|c| {
            let corner = view.vertex(scene, c);
            corner.map_or(f64::INFINITY, |c| (c.position - x.position).length())
        });
        let reach = reach.into_iter().fold(0.0, f64::max);
        let alone = flat && guide.parts.are_far_from(x.position, reach);
        Some(Self {
            seen: guide.parts.seen_from(scene, &x),
            share: if alone { 1.0 } else { BESIDE_LOBE },
            samplers: (0..guide.lit_by.len().max(1)).map(|_| None).collect(),
            guide,
        })
    }

    /// The points of a column, or of all.
    pub(super) fn points(&mut self, column: usize) -> Points<'_> {
        let Self {
            guide,
            seen,
            share,
            samplers,
        } = self;
        let lit_by = guide.lit_by.get(column).filter(|lit| !lit.is_empty());
        let lit = lit_by.unwrap_or(&guide.lit);
        let column = column.min(samplers.len() - 1);
        let sampler = || AreaSampler::guided(&guide.parts, |k| seen[k] * lit[k]);
        (samplers[column].get_or_insert_with(sampler), *share)
    }
}
