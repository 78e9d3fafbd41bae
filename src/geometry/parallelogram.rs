//! Flat patches.

use super::{DVec3, Ray, SurfacePoint};

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
    /// The patch spanned by `u` and `v` at `corner`; `None` if it has no area (|u × v| below 1e-12·|u||v|) or is not
    /// finite.
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

    /// Cosine of the angle between u and v; 0 for a rectangle.
    pub fn skew(&self) -> f64 {
        self.u.dot(self.v) / (self.u.length() * self.v.length())
    }

    /// (a, b) of a point of the plane.
    pub fn coordinates(&self, p: DVec3) -> [f64; 2] {
        self.dual.map(|d| (p - self.corner).dot(d))
    }

    /// The point with the given (a, b).
    pub fn at(&self, [a, b]: [f64; 2]) -> SurfacePoint {
        SurfacePoint {
            position: self.corner + self.u * a + self.v * b,
            normal: self.normal,
            uv: [a, b],
        }
    }

    /// Projects `p` onto the patch.
    pub fn at_position(&self, p: DVec3) -> SurfacePoint {
        self.at(self.coordinates(p).map(|x| x.clamp(0.0, 1.0)))
    }

    /// Intersection with the plane inside the patch: t = n·(corner − o)/(n·d). A ray that starts in the plane (to rounding)
    /// does not meet it.
    pub fn intersect(&self, ray: &Ray) -> Option<f64> {
        let slope = self.normal.dot(ray.direction);
        let height = self.height(ray.origin)?;
        let t = -height / slope;
        // A slope of 0 gives an infinite t, which no length exceeds.
        if !(t > 0.0 && t < ray.length) {
            return None;
        }
        contains(self.coordinates(ray.origin + ray.direction * t)).then_some(t)
    }

    /// Whether the patch stands between the two ends of the segment. A segment that starts or ends in the patch's plane (to
    /// rounding) is not cut by it: a point on a seam is not hidden by the neighbour, nor by what stands edge-on at its foot.
    pub fn blocks(&self, segment: &Ray) -> bool {
        let end = segment.origin + segment.direction * segment.length;
        self.height(end).is_some() && self.intersect(segment).is_some()
    }

    /// Signed distance n·(p − corner) from the plane; `None` if that is no more than rounding.
    fn height(&self, p: DVec3) -> Option<f64> {
        const ROUNDING: f64 = 1e-12;
        let height = self.normal.dot(p - self.corner);
        let reach = p.abs().max_element() + self.corner.abs().max_element();
        (height.abs() > ROUNDING * reach).then_some(height)
    }

    /// Whether the two patches lie in one plane (to a billionth of their size) and have more than an edge in common.
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
    pub fn at_xy(&self, x: f64, y: f64) -> Option<SurfacePoint> {
        let p = self.plane_at_xy(x, y)?;
        let uv = self.coordinates(p);
        contains(uv).then(|| self.at(uv.map(|c| c.clamp(0.0, 1.0))))
    }

    /// The point of the patch's plane above (x, y) along z; `None` if the plane is parallel to z.
    pub fn plane_at_xy(&self, x: f64, y: f64) -> Option<DVec3> {
        if self.normal.z.abs() < 1e-9 {
            return None;
        }
        let foot = DVec3::new(x, y, 0.0);
        let z = self.normal.dot(self.corner - foot) / self.normal.z;
        Some(DVec3::new(x, y, z))
    }

    /// Axis-aligned bounds.
    pub fn bounds(&self) -> (DVec3, DVec3) {
        let corners = self.corners();
        let fold =
            |f: fn(DVec3, DVec3) -> DVec3| corners.into_iter().reduce(f).unwrap_or(self.corner);
        (fold(DVec3::min), fold(DVec3::max))
    }
}

/// Whether (a, b) lies in the patch. A few roundings outside still belong to it, so that no ray slips through between
/// two patches that share an edge.
fn contains(uv: [f64; 2]) -> bool {
    const EDGE: f64 = 1e-12;
    uv.iter().all(|c| (-EDGE..=1.0 + EDGE).contains(c))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn patch() -> Parallelogram {
        Parallelogram::new(
            DVec3::new(3.0, 11.351, 4.149),
            DVec3::new(4.0, 0.0, 0.0),
            DVec3::new(0.0, -2.8284, 2.8284),
        )
        .unwrap()
    }

    #[test]
    fn the_bench_object_faces_down_towards_the_wall() {
        let h = 0.5f64.sqrt();
        assert!((patch().normal() - DVec3::new(0.0, -h, -h)).length() < 1e-15);
        assert!((patch().area() - 4.0 * 2.8284 * 2f64.sqrt()).abs() < 1e-12);
        assert!(patch().skew().abs() < 1e-15);
    }

    #[test]
    fn coordinates_invert_the_parametrisation() {
        for a in [0.0, 0.3, 1.0] {
            for b in [0.0, 0.7, 1.0] {
                let p = patch().at([a, b]).position + patch().normal() * 0.5;
                let [x, y] = patch().coordinates(p);
                assert!((x - a).abs() < 1e-14 && (y - b).abs() < 1e-14);
            }
        }
    }

    #[test]
    fn hits_inside_and_misses_outside_and_behind() {
        let target = patch().at([0.25, 0.5]).position;
        let from = DVec3::new(5.0, 4.0, 0.0);
        let ray = Ray::between(from, target).unwrap();
        let long = Ray {
            length: 100.0,
            ..ray
        };
        let t = patch().intersect(&long).unwrap();
        assert!((t - ray.length).abs() < 1e-13);
        assert!(
            patch()
                .intersect(&Ray {
                    direction: -ray.direction,
                    ..long
                })
                .is_none()
        );
        assert!(
            patch()
                .intersect(&Ray {
                    length: t * 0.99,
                    ..long
                })
                .is_none()
        );
        let aside = patch().at([1.2, 0.5]).position;
        assert!(
            patch()
                .intersect(&Ray {
                    length: 100.0,
                    ..Ray::between(from, aside).unwrap()
                })
                .is_none()
        );
    }

    /// A wall of two tiles: a spot exactly on the seam is free from everywhere in front, however t rounds.
    #[test]
    fn a_point_on_a_seam_is_not_blocked_by_the_neighbour() {
        let tile = |x: f64| {
            let corner = DVec3::new(x, 0.0, 0.1);
            Parallelogram::new(corner, DVec3::X * 5.0, DVec3::new(0.0, 15.5, 0.3)).unwrap()
        };
        let (left, right) = (tile(0.0), tile(5.0));
        for i in 0..2000 {
            let k = f64::from(i);
            let seam = left.at([1.0, (k * 0.618).fract()]).position;
            let from = DVec3::new(10.0 * (k * 0.31).fract(), 15.0 * (k * 0.77).fract(), 4.0);
            assert!(!right.blocks(&Ray::between(from, seam).unwrap()));
            assert!(!right.blocks(&Ray::between(seam, from).unwrap()));
            let behind = Ray::between(from, DVec3::new(7.0, 7.0, -1.0)).unwrap();
            assert!(right.blocks(&behind) || left.blocks(&behind));
        }
    }

    #[test]
    fn overlap_is_more_than_an_edge_in_one_plane() {
        let square = |x: f64, y: f64, z: f64| {
            Parallelogram::new(DVec3::new(x, y, z), DVec3::X, DVec3::new(0.2, 1.0, 0.0)).unwrap()
        };
        let base = square(0.0, 0.0, 0.0);
        assert!(base.overlaps(&base) && base.overlaps(&base.turned()));
        assert!(base.overlaps(&square(0.9, 0.0, 0.0)) && square(0.9, 0.0, 0.0).overlaps(&base));
        assert!(
            !base.overlaps(&square(1.0, 0.0, 0.0)),
            "neighbours share an edge"
        );
        assert!(!base.overlaps(&square(0.0, 0.0, 1e-6)), "lifted");
        // The bounding boxes share [1, 1.2] × [0, 0.1], where the slanted square is not: its edge is x = 1 + y/5.
        let corner = DVec3::new(1.05, 0.0, 0.0);
        let low = Parallelogram::new(corner, DVec3::X, DVec3::Y * 0.1).unwrap();
        assert!(!base.overlaps(&low) && !low.overlaps(&base));
    }

    #[test]
    fn no_area_is_no_patch() {
        let x = DVec3::X;
        assert!(Parallelogram::new(DVec3::ZERO, x, x * 2.0).is_none());
        assert!(Parallelogram::new(DVec3::ZERO, DVec3::ZERO, x).is_none());
        assert!(Parallelogram::new(DVec3::NAN, x, DVec3::Y).is_none());
        assert!(Parallelogram::new(DVec3::ZERO, x * f64::MAX, DVec3::Y * f64::MAX).is_none());
    }
}
