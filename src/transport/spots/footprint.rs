//! The part of a surface that a spot is expected to light.

use crate::geometry::{Blockers, Parallelogram, Region, Shape, ShapeId};
use crate::scene::Scene;
use crate::transport::beam::{Beams, Reach};
use crate::transport::vertex::Vertex;

/// The part of a flat shape that a spot is expected to light.
#[derive(Clone, Debug)]
pub(super) struct SpotFootprint {
    shape: ShapeId,
    /// The square around a wide spot; a spot without width has none.
    square: Option<Parallelogram>,
}

impl SpotFootprint {
    /// The target of a spot, where that is a flat shape on which the beam lands unhindered.
    pub(super) fn new(scene: &Scene, beams: &Beams<'_>, spot: usize) -> Option<Self> {
        let (target, shape) = {
            let spot = &scene.laser.spots[spot];
            (&spot.target, spot.surface)
        };
        let flat = &scene.surfaces[shape as usize].shape;
        if !matches!(flat, Shape::Parallelogram(_)) {
            return None;
        }
        let square = if beams.has_width() {
            Some(beams.square(spot, Reach::Expected)?)
        } else {
            let lit = beams.point(spot, [0.0; 2])?;
            let there = lit.shape == shape && lit.position == target.position;
            there.then_some(None)?
        };
        Some(Self { shape, square })
    }

    pub(super) fn holds(&self, lit: &Vertex) -> bool {
        let inside = |s: &Parallelogram| {
            let place = s.coordinates(lit.position);
            place.iter().all(|c| (0.0..=1.0).contains(c))
        };
        lit.shape == self.shape && self.square.as_ref().is_none_or(inside)
    }

    /// By shape: what can stand between the footprint and it.
    pub(super) fn blockers(&self, scene: &Scene, spot: usize, shapes: &[Region]) -> Vec<Blockers> {
        let from = match &self.square {
            Some(square) => Region::patch(square),
            None => Region::point(scene.laser.spots[spot].target.position),
        };
        let to = shapes.iter().zip(0..);
        to.map(|(region, id)| {
            let ends = [Some(self.shape), Some(id)];
            scene.bvh().blockers(&from, region, ends)
        })
        .collect()
    }
}
