//! Where rays meet a mesh, and whether it stands in their way.

use super::Mesh;
use super::query::{Any, Closest};
use crate::geometry::{Intersection, Ray};
use crate::num::lanes::widest;

impl Mesh {
    /// First triangle met by the ray at 0 < t < length, from either side. A ray that starts in the
    /// plane of a triangle (to rounding) does not meet it. Where two are met at one distance, the
    /// first of the list counts.
    pub fn closest(&self, ray: &Ray) -> Option<Intersection> {
        self.closest_many(std::slice::from_ref(ray))[0]
    }

    /// [`Mesh::closest`] for many rays: much faster than one by one where the mesh is large.
    pub fn closest_many(&self, rays: &[Ray]) -> Vec<Option<Intersection>> {
        self.closest_of(rays, 0.0)
    }

    /// [`Mesh::closest`] for a ray whose start was computed from numbers as large as `reach`, and
    /// has their rounding.
    pub(in crate::geometry) fn closest_beyond(
        &self,
        ray: &Ray,
        reach: f64,
    ) -> Option<Intersection> {
        self.closest_of(std::slice::from_ref(ray), reach)[0]
    }

    fn closest_of(&self, rays: &[Ray], reach: f64) -> Vec<Option<Intersection>> {
        let mut found = vec![None; rays.len()];
        widest(
            #[inline(always)]
            || {
                self.tree
                    .traverse(rays, &Closest(self, reach), |i, (_, hit)| found[i] = hit);
            },
        );
        found
    }

    /// Whether a triangle stands between the two ends of the segment. A segment that starts or ends
    /// in the plane of a triangle (to rounding) is not cut by it.
    pub fn blocks(&self, segment: &Ray) -> bool {
        self.blocks_beyond(segment, 0.0)
    }

    /// [`Mesh::blocks`] for many segments: much faster than one by one where the mesh is large.
    pub fn blocks_many(&self, segments: &[Ray]) -> Vec<bool> {
        self.blocks_many_beyond(segments, 0.0)
    }

    /// [`Mesh::blocks_many`] for segments whose ends were computed from numbers as large as
    /// `reach`, and have their rounding.
    pub(in crate::geometry) fn blocks_many_beyond(
        &self,
        segments: &[Ray],
        reach: f64,
    ) -> Vec<bool> {
        let mut found = vec![false; segments.len()];
        self.ask(segments, reach, |i, hit| found[i] = hit);
        found
    }

    /// The same for one segment, without a list.
    pub(in crate::geometry) fn blocks_beyond(&self, segment: &Ray, reach: f64) -> bool {
        let mut found = false;
        self.ask(std::slice::from_ref(segment), reach, |_, hit| found = hit);
        found
    }

    /// Tells of each segment whether a triangle stands in it.
    fn ask(&self, segments: &[Ray], reach: f64, mut tell: impl FnMut(usize, bool)) {
        widest(
            #[inline(always)]
            || {
                self.tree
                    .traverse(segments, &Any(self, reach), |i, (_, hit)| tell(i, hit));
            },
        );
    }
}
