//! Shapes: what a surface is made of.

use glam::DAffine3;

use super::{DVec3, Disc, Facing, Instance, Interaction, Intersection, Parallelogram, Ray, Sphere};

/// Index of a shape in its [`Bvh`](super::Bvh).
pub type ShapeId = u32;

/// A surface's geometry. Every shape is one-sided in its optics (front: where the normal points)
/// and opaque from both sides.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// A flat patch corner + a·u + b·v.
    Parallelogram(Parallelogram),
    /// A sphere seen from outside or from inside.
    Sphere(Sphere),
    /// A flat disc.
    Disc(Disc),
    /// A mesh of triangles.
    Instance(Instance),
}

impl Shape {
    /// Smallest axis-aligned box: lower and upper corner.
    pub fn bounds(&self) -> (DVec3, DVec3) {
        match self {
            Self::Parallelogram(p) => p.bounds(),
            Self::Sphere(s) => s.bounds(),
            Self::Disc(d) => d.bounds(),
            Self::Instance(b) => b.bounds(),
        }
    }

    /// Area, length².
    pub fn area(&self) -> f64 {
        match self {
            Self::Parallelogram(p) => p.area(),
            Self::Sphere(s) => s.area(),
            Self::Disc(d) => d.area(),
            Self::Instance(b) => b.area(),
        }
    }

    /// Smallest t in (0, `ray.length`) at which the ray meets the shape from either side.
    /// `leaving`: the ray starts on this very shape, so that the start itself is no hit.
    pub fn intersect(&self, ray: &Ray, leaving: bool) -> Option<Intersection> {
        let plain = |t| Intersection { t, triangle: 0 };
        match self {
            Self::Parallelogram(p) => (!leaving).then(|| p.intersect(ray)).flatten().map(plain),
            Self::Sphere(s) => s.intersect(ray, leaving).map(plain),
            Self::Disc(d) => (!leaving).then(|| d.intersect(ray)).flatten().map(plain),
            Self::Instance(b) => b.intersect(ray),
        }
    }

    /// The point of the shape where the ray meets it: removes the rounding.
    pub fn at_intersection(&self, ray: &Ray, met: Intersection) -> Interaction {
        let at = ray.origin + ray.direction * met.t;
        match self {
            Self::Instance(b) => b.on_triangle(met.triangle, at),
            _ => self.at_position(at),
        }
    }

    /// Whether the shape blocks the open segment `ray`, of which the start (`leaves`) or the end
    /// (`arrives`) may lie on the shape itself.
    pub fn blocks(&self, ray: &Ray, leaves: bool, arrives: bool) -> bool {
        match self {
            Self::Parallelogram(p) => !leaves && !arrives && p.blocks(ray),
            Self::Sphere(s) => s.blocks(ray, leaves, arrives),
            Self::Disc(d) => !leaves && !arrives && d.blocks(ray),
            Self::Instance(b) => b.blocks(ray),
        }
    }

    /// The point of the shape nearest to `p`, which must lie on it up to rounding: removes the
    /// rounding. Of a mesh it takes a search; [`Shape::at_intersection`] does not.
    pub fn at_position(&self, p: DVec3) -> Interaction {
        match self {
            Self::Parallelogram(s) => s.at_position(p),
            Self::Sphere(s) => s.at_position(p),
            Self::Disc(d) => d.at_position(p),
            Self::Instance(b) => b.at_position(p),
        }
    }

    /// The point to which an equal-area map takes `uv` in [0, 1]². They are the point's parameters,
    /// but for a mesh, whose parameters are its texture coordinates.
    pub fn at(&self, uv: [f64; 2]) -> Interaction {
        match self {
            Self::Parallelogram(p) => p.at(uv),
            Self::Sphere(s) => s.at(uv),
            Self::Disc(d) => d.at(uv),
            Self::Instance(b) => b.at(uv),
        }
    }

    /// The points straight above or below (x, y) along z, by growing z.
    pub fn at_xy(&self, x: f64, y: f64) -> Vec<Interaction> {
        match self {
            Self::Parallelogram(p) => p.at_xy(x, y).into_iter().collect(),
            Self::Sphere(s) => s.at_xy(x, y),
            Self::Disc(d) => d.at_xy(x, y).into_iter().collect(),
            Self::Instance(b) => b.at_xy(x, y),
        }
    }

    /// Whether the whole shape lies in one plane: then no light travels between two points of it.
    pub fn is_flat(&self) -> bool {
        matches!(self, Self::Parallelogram(_) | Self::Disc(_))
    }

    /// Whether light may travel between two points of the shape's own front.
    pub fn may_see_itself(&self) -> bool {
        match self {
            Self::Parallelogram(_) | Self::Disc(_) => false,
            Self::Sphere(s) => s.facing == Facing::Inside,
            Self::Instance(_) => true,
        }
    }

    /// Whether any point of the shape lies in front of the plane through `point` with normal
    /// `normal`, by more than `slack`.
    pub fn reaches_above(&self, point: DVec3, normal: DVec3, slack: f64) -> bool {
        match self {
            Self::Parallelogram(p) => p.corners().iter().any(|c| (*c - point).dot(normal) > slack),
            Self::Sphere(s) => (s.centre - point).dot(normal) + s.radius > slack,
            Self::Disc(_) | Self::Instance(_) => {
                let corners = self.box_corners();
                corners.iter().any(|c| (*c - point).dot(normal) > slack)
            }
        }
    }

    /// The shape after a rigid motion; `None` if that leaves no proper shape.
    pub fn moved(&self, motion: &DAffine3) -> Option<Self> {
        match self {
            Self::Parallelogram(p) => p.moved(motion).map(Self::Parallelogram),
            Self::Sphere(s) => {
                let centre = motion.transform_point3(s.centre);
                Sphere::new(centre, s.radius, s.facing).map(Self::Sphere)
            }
            Self::Disc(d) => d.moved(motion).map(Self::Disc),
            Self::Instance(b) => b.moved(motion).map(Self::Instance),
        }
    }

    /// The corners of its axis-aligned box.
    pub fn box_corners(&self) -> [DVec3; 8] {
        let (low, high) = self.bounds();
        std::array::from_fn(|k| {
            let pick = |d: usize| if k >> d & 1 == 0 { low[d] } else { high[d] };
            DVec3::new(pick(0), pick(1), pick(2))
        })
    }

    /// A ball around the shape: centre and radius.
    pub fn circumsphere(&self) -> (DVec3, f64) {
        match self {
            Self::Parallelogram(p) => {
                let centre = p.at([0.5, 0.5]).position;
                let reach = |c: DVec3| (c - centre).length();
                (
                    centre,
                    p.corners().into_iter().map(reach).fold(0.0, f64::max),
                )
            }
            Self::Sphere(s) => (s.centre, s.radius),
            Self::Disc(d) => (d.centre(), d.radius()),
            Self::Instance(b) => {
                let (low, high) = b.bounds();
                (0.5 * (low + high), 0.5 * (high - low).length())
            }
        }
    }

    /// Distance from `p` to the shape: exact for rectangles and spheres; a skewed patch may be
    /// nearer than this says.
    pub fn distance_to(&self, p: DVec3) -> f64 {
        match self {
            Self::Parallelogram(s) => (s.at_position(p).position - p).length(),
            Self::Sphere(s) => ((p - s.centre).length() - s.radius).abs(),
            Self::Disc(d) => (d.at_position(p).position - p).length(),
            Self::Instance(b) => (b.at_position(p).position - p).length(),
        }
    }

    /// Points spread over the shape, its corners or extremes among them, for conservative tests of
    /// what it can see.
    pub fn outline(&self) -> Vec<Interaction> {
        match self {
            Self::Parallelogram(_) => [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]
                .map(|uv| self.at(uv))
                .to_vec(),
            Self::Sphere(_) | Self::Disc(_) | Self::Instance(_) => {
                let steps = [0.0, 0.25, 0.5, 0.75, 1.0];
                steps
                    .iter()
                    .flat_map(|&u| steps.map(|v| self.at([u, v])))
                    .collect()
            }
        }
    }
}
