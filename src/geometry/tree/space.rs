//! The space in which the trees work.

use glam::Vec3A;
use obvhs::aabb::Aabb;

use crate::geometry::{DVec3, Ray};

/// Extent of the scene in the tree's space.
const EXTENT: f64 = 1000.0;
/// What each box is widened by in the tree's space.
pub(super) const PADDING: f32 = 4e-3;

/// Where the scene measures [`EXTENT`] and begins at 0.
#[derive(Clone, Debug)]
pub(super) struct Space {
    origin: DVec3,
    scale: f64,
}

impl Space {
    /// The space for a scene in these boxes.
    pub(super) fn around(boxes: impl Iterator<Item = (DVec3, DVec3)>) -> Self {
        let (lower, upper) = boxes
            .reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
            .unwrap_or((DVec3::ZERO, DVec3::ONE));
        Self {
            origin: lower,
            scale: EXTENT / (upper - lower).max_element().max(f64::MIN_POSITIVE),
        }
    }

    /// A box, widened.
    pub(super) fn padded(&self, (lower, upper): (DVec3, DVec3)) -> Aabb {
        let low = self.local(lower).as_vec3a() - Vec3A::splat(PADDING);
        let high = self.local(upper).as_vec3a() + Vec3A::splat(PADDING);
        Aabb::new(low, high)
    }

    /// A point of the scene in the tree's space.
    #[inline(always)]
    pub(super) fn local(&self, p: DVec3) -> DVec3 {
        (p - self.origin) * self.scale
    }

    /// Where the ray reaches the scene's bounding sphere (so that a camera far away does not cost
    /// the f32 origin its digits), and how far that is from its own start.
    #[inline(always)]
    pub(super) fn start(&self, ray: &Ray) -> (Vec3A, f64) {
        let local = self.local(ray.origin);
        let to_centre = DVec3::splat(0.5 * EXTENT) - local;
        let advance = (to_centre.dot(ray.direction) - EXTENT).max(0.0);
        ((local + ray.direction * advance).as_vec3a(), advance)
    }

    /// Where in the tree lies what is met at distance `t` by a ray whose start was moved by
    /// `advance`, at the latest.
    #[inline(always)]
    pub(super) fn limit(&self, t: f64, advance: f64) -> f32 {
        ((t * self.scale - advance).min(1e30) as f32) + 4.0 * PADDING
    }

    /// What a distance measures in the tree's space, at the most.
    pub(super) fn beyond(&self, distance: f64) -> f32 {
        self.limit(distance, 0.0)
    }

    /// What a distance measures in the tree's space.
    pub(super) fn length(&self, distance: f64) -> f64 {
        distance * self.scale
    }
}
