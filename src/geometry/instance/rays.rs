//! Where rays meet an instance, and whether it stands in their way.

use super::Instance;
use crate::geometry::{DVec3, Interaction, Intersection, Ray};

impl Instance {
    /// The ray in the mesh's space; lengths are those of the scene over the scale.
    fn local(&self, ray: &Ray) -> Ray {
        Ray {
            origin: self.to_mesh.transform_point3(ray.origin),
            direction: self.to_mesh.transform_vector3(ray.direction) * self.scale,
            length: ray.length / self.scale,
        }
    }

    /// What coordinates in the scene measure in the mesh's space, at most: their rounding is that
    /// of the points that are computed from them.
    fn reach(&self) -> f64 {
        let (low, high) = self.bounds;
        low.abs().max(high.abs()).max_element() / self.scale
    }

    /// First triangle met, from either side, at 0 < t < length; a ray that starts in a triangle's
    /// plane does not meet that.
    pub fn intersect(&self, ray: &Ray) -> Option<Intersection> {
        let Intersection { t, triangle } =
            self.mesh.closest_beyond(&self.local(ray), self.reach())?;
        let t = t * self.scale;
        (t < ray.length).then_some(Intersection { t, triangle })
    }

    /// Whether a triangle stands between the two ends of the segment.
    pub fn blocks(&self, segment: &Ray) -> bool {
        self.is_near(segment) && self.mesh.blocks_beyond(&self.local(segment), self.reach())
    }

    /// [`Instance::blocks`] for many segments.
    pub fn blocks_many(&self, segments: &[Ray]) -> Vec<bool> {
        let mut blocked = vec![false; segments.len()];
        let near = |i: &usize| self.is_near(&segments[*i]);
        let near: Vec<usize> = (0..segments.len()).filter(near).collect();
        let local: Vec<Ray> = near.iter().map(|i| self.local(&segments[*i])).collect();
        let found = self.mesh.blocks_many_beyond(&local, self.reach());
        near.iter().zip(found).for_each(|(i, b)| blocked[*i] = b);
        blocked
    }

    /// Whether a segment meets the box around the body, widened by more than rounding moves either:
    /// what misses it meets no triangle, and costs neither a transform nor a walk down the tree.
    fn is_near(&self, segment: &Ray) -> bool {
        const ROUNDING: f64 = 1e-9;
        let (low, high) = self.bounds;
        let origin = segment.origin;
        let size = low.abs().max(high.abs()).max(origin.abs()).max_element();
        let by = ROUNDING * (size + segment.length);
        let (mut enter, mut leave) = (0.0_f64, segment.length);
        for axis in 0..3 {
            let (o, d) = (origin[axis], segment.direction[axis]);
            let (first, last) = (low[axis] - by - o, high[axis] + by - o);
            if d.abs() < f64::MIN_POSITIVE {
                if first > 0.0 || last < 0.0 {
                    return false;
                }
                continue;
            }
            let inverse = 1.0 / d;
            let (a, b) = (first * inverse, last * inverse);
            (enter, leave) = (enter.max(a.min(b)), leave.min(a.max(b)));
        }
        enter <= leave
    }

    /// The points straight above or below (x, y) along z, by growing z.
    pub fn at_xy(&self, x: f64, y: f64) -> Vec<Interaction> {
        let (low, high) = self.bounds;
        let below = low.z - 0.5 * (high.z - low.z) - 1.0;
        let mut ray = Ray::new(DVec3::new(x, y, below), DVec3::Z);
        let mut found = Vec::new();
        while let Some(Intersection { t, triangle }) = self.intersect(&ray) {
            let at = ray.origin + ray.direction * t;
            found.push(self.on_triangle(triangle, at));
            ray.origin = at;
        }
        found
    }
}
