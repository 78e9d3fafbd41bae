//! The tree for a few dozen primitives and more: obvhs' 8-wide compressed BVH.

use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::cwbvh::{CwBvh, builder::build_cwbvh};
use obvhs::ray::{Ray as TreeRay, RayHit};

use super::space::{PADDING, Space};
use crate::geometry::{DVec3, Ray};

/// A tree over boxes, asked by one ray at a time.
#[derive(Clone)]
pub(in crate::geometry) struct CompressedTree {
    cwbvh: CwBvh,
    space: Space,
}

impl CompressedTree {
    /// The tree over boxes (lower and upper corners, finite).
    pub(in crate::geometry) fn new(boxes: &[(DVec3, DVec3)]) -> Self {
        let space = Space::around(boxes.iter().copied());
        let boxes: Vec<Aabb> = boxes.iter().map(|b| space.padded(*b)).collect();
        let mut time = std::time::Duration::ZERO;
        let cwbvh = build_cwbvh(&boxes, BvhBuildParams::medium_build(), &mut time);
        Self { cwbvh, space }
    }

    /// The ray in the tree's space, and how far its start was moved.
    fn ray(&self, ray: &Ray) -> (TreeRay, f64) {
        let (start, advance) = self.space.start(ray);
        let length = (self.space.length(ray.length) - advance).max(0.0) + f64::from(PADDING);
        let direction = ray.direction.as_vec3a();
        let ray = TreeRay::new(start, direction, 0.0, length.min(1e30) as f32);
        (ray, advance)
    }

    /// Visits the boxes that the ray meets; `test` keeps the nearest hit in f64 and returns its
    /// distance.
    pub(in crate::geometry) fn closest(&self, ray: &Ray, mut test: impl FnMut(usize) -> f64) {
        let (tree_ray, advance) = self.ray(ray);
        let mut hit = RayHit::none();
        self.cwbvh.ray_traverse(tree_ray, &mut hit, |_, primitive| {
            let t = test(self.cwbvh.primitive_indices[primitive] as usize);
            // Prune only what lies behind the padded box of the nearest hit so far.
            self.space.limit(t, advance)
        });
    }

    /// Whether `blocks` says yes to a box that the ray meets.
    pub(in crate::geometry) fn any(&self, ray: &Ray, blocks: impl Fn(usize) -> bool) -> bool {
        !self
            .cwbvh
            .ray_traverse_miss(self.ray(ray).0, |_, primitive| {
                let id = self.cwbvh.primitive_indices[primitive] as usize;
                if blocks(id) { 0.0 } else { f32::INFINITY }
            })
    }
}
