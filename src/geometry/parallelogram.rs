//! Flat patches.

use glam::DAffine3;

use super::plane::Plane;
use super::{DVec3, Interaction, Ray};

/// The patch corner + a·u + b·v, a, b ∈ [0, 1]; its front normal is along u × v.
///
/// One primitive, not two triangles: there is no diagonal through which a ray could leak.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parallelogram {
    corner: DVec3,
    u: DVec3,
    v: DVec3,
    normal: DVec3,
    /// Dual vectors in the plane: (p − corner)·u* = a, (p − corner)·v* = b.
    dual: [DVec3; 2],
    area: f64,
}

impl Parallelogram {
    /// The patch spanned by `u` and `v` at `corner`; `None` if it has no area (|u × v| below
    /// 1e-12·|u||v|) or is not finite.
    pub fn new(corner: DVec3, u: DVec3, v: DVec3) -> Option<Self> {
        let cross = u.cross(v);
        let area = cross.length();
        let proper =
            corner.is_finite() && area.is_finite() && area > 1e-12 * u.length() * v.length();
        if !proper || area <= 0.0 {
            return None;
        }
        let normal = cross / area;
        let dual = [v.cross(normal) / area, normal.cross(u) / area];
        Some(Self {
            corner,
            u,
            v,
            normal,
            dual,
            area,
        })
    }

    /// The same patch with its front turned to the other side: normal along v × u.
    pub fn turned(self) -> Self {
        Self {
            normal: -self.normal,
            ..self
        }
    }

    /// The patch after an affine motion, its front kept; `None` if that leaves no area.
    pub fn moved(&self, motion: &DAffine3) -> Option<Self> {
        let v = |d| motion.transform_vector3(d);
        let moved = Self::new(motion.transform_point3(self.corner), v(self.u), v(self.v))?;
        let turned = self.u.cross(self.v).dot(self.normal) < 0.0;
        Some(if turned { moved.turned() } else { moved })
    }

    /// Corner at (a, b) = (0, 0).
    pub fn corner(&self) -> DVec3 {
        self.corner
    }

    /// First edge.
    pub fn u(&self) -> DVec3 {
        self.u
    }

    /// Second edge.
    pub fn v(&self) -> DVec3 {
        self.v
    }

    /// Unit normal of the front, along u × v.
    pub fn normal(&self) -> DVec3 {
        self.normal
    }

    /// |u × v|.
    pub fn area(&self) -> f64 {
        self.area
    }

    /// The four corners in the order (0,0), (1,0), (1,1), (0,1).
    pub fn corners(&self) -> [DVec3; 4] {
        let c = self.corner;
        [c, c + self.u, c + self.u + self.v, c + self.v]
    }

    /// The ends of its four sides, from corner to corner in their order.
    pub fn sides(&self) -> [[DVec3; 2]; 4] {
        let [a, b, c, d] = self.corners();
        [[a, b], [b, c], [c, d], [d, a]]
    }

    /// The lines that divide it into `count` equal cells along u and v, from end to end.
    pub fn lines(&self, count: [usize; 2]) -> impl Iterator<Item = [DVec3; 2]> {
        let inner = |n: usize| (1..n).map(move |i| i as f64 / n as f64);
        let at = |a: f64, b: f64| self.corner + a * self.u + b * self.v;
        let across_u = inner(count[0]).map(move |a| [at(a, 0.0), at(a, 1.0)]);
        let across_v = inner(count[1]).map(move |b| [at(0.0, b), at(1.0, b)]);
        across_u.chain(across_v)
    }

    /// Cosine of the angle between u and v; 0 for a rectangle.
    pub fn skew(&self) -> f64 {
        self.u.dot(self.v) / (self.u.length() * self.v.length())
    }

    /// (a, b) of a point of the plane.
    #[inline(always)]
    pub fn coordinates(&self, p: DVec3) -> [f64; 2] {
        let p = p - self.corner;
        [p.dot(self.dual[0]), p.dot(self.dual[1])]
    }

    /// The point with the given (a, b).
    pub fn at(&self, [a, b]: [f64; 2]) -> Interaction {
        Interaction {
            position: self.corner + self.u * a + self.v * b,
            normal: self.normal,
            uv: [a, b],
        }
    }

    /// Projects `p` onto the patch.
    pub fn at_position(&self, p: DVec3) -> Interaction {
        self.at(self.coordinates(p).map(|x| x.clamp(0.0, 1.0)))
    }

    /// Intersection with the plane inside the patch: t = n·(corner − o)/(n·d). A ray that starts in
    /// the plane (to rounding) does not meet it.
    pub fn intersect(&self, ray: &Ray) -> Option<f64> {
        let (t, met) = self.crossing(ray);
        met.then_some(t)
    }

    /// [`Parallelogram::intersect`] without branches: t, and whether the ray meets the patch there.
    #[inline(always)]
    pub(super) fn crossing(&self, ray: &Ray) -> (f64, bool) {
        let (height, off) = self.plane().height(ray.origin);
        // A slope of 0 gives an infinite t, which no length exceeds.
        let t = -height / self.normal.dot(ray.direction);
        let inside = contains(self.coordinates(ray.origin + ray.direction * t));
        (t, off & (t > 0.0) & (t < ray.length) & inside)
    }

    /// Whether the patch stands between the two ends of the segment. A segment that starts or ends
    /// in the patch's plane (to rounding) is not cut by it: a point on a seam is not hidden by the
    /// neighbour, nor by what stands edge-on at its foot.
    #[inline(always)]
    pub fn blocks(&self, segment: &Ray) -> bool {
        let (_, off) = self
            .plane()
            .height(segment.origin + segment.direction * segment.length);
        off & self.crossing(segment).1
    }

    #[inline(always)]
    fn plane(&self) -> Plane {
        Plane {
            point: self.corner,
            normal: self.normal,
        }
    }

    /// Whether the two patches lie in one plane (to a billionth of their size) and have more than
    /// an edge in common.
    pub fn overlaps(&self, other: &Self) -> bool {
        const SLACK: f64 = 1e-9;
        let size = |p: &Self| p.u.length() + p.v.length();
        let slack = SLACK * (size(self) + size(other));
        let above = |c: &DVec3| self.normal.dot(*c - self.corner).abs() > slack;
        if other.corners().iter().any(above) {
            return false;
        }
        // Two convex figures are apart if some edge of either separates them.
        let separates = |edge: DVec3| {
            let axis = edge.cross(self.normal).normalize_or_zero();
            let range = |p: &Self| {
                let along = p.corners().map(|c| c.dot(axis));
                (
                    along.into_iter().fold(f64::INFINITY, f64::min),
                    along.into_iter().fold(f64::NEG_INFINITY, f64::max),
                )
            };
            let ((a, b), (c, d)) = (range(self), range(other));
            b.min(d) - a.max(c) <= slack
        };
        ![self.u, self.v, other.u, other.v]
            .into_iter()
            .any(separates)
    }

    /// The point above (x, y) along z, if the patch has one.
    pub fn at_xy(&self, x: f64, y: f64) -> Option<Interaction> {
        let p = self.plane().at_xy(x, y)?;
        let uv = self.coordinates(p);
        contains(uv).then(|| self.at(uv.map(|c| c.clamp(0.0, 1.0))))
    }

    /// Axis-aligned bounds.
    pub fn bounds(&self) -> (DVec3, DVec3) {
        let corners = self.corners();
        let fold =
            |f: fn(DVec3, DVec3) -> DVec3| corners.into_iter().reduce(f).unwrap_or(self.corner);
        (fold(DVec3::min), fold(DVec3::max))
    }
}

/// Whether (a, b) lies in the patch. A few roundings outside still belong to it, so that no ray
/// slips through between two patches that share an edge.
#[inline(always)]
fn contains([a, b]: [f64; 2]) -> bool {
    const EDGE: f64 = 1e-12;
    let within = |c: f64| (-EDGE..=1.0 + EDGE).contains(&c);
    within(a) & within(b)
}

#[cfg(test)]
mod tests;
