//! What can stand between two regions, judged before any ray is cast.
//!
//! Every segment from region a to region b lies in the convex hull of both, the *shaft* (Haines and
//! Wallace, *Shaft culling for efficient ray-traced radiosity*, 1991). A shape that some plane
//! separates from that hull (a mesh: its box) cannot block any of them. The test tries a finite set
//! of planes and so errs to one side only: what it calls free is free; what it cannot separate has
//! to be asked ray by ray.

use super::{Bvh, DVec3, Parallelogram, Ray, Shape, ShapeId};

/// A convex set given by points whose hull contains it.
#[derive(Clone, Debug, PartialEq)]
pub struct Region {
    points: Vec<DVec3>,
    /// Directions of its edges: they span the planes that are tried.
    edges: Vec<DVec3>,
}

impl Region {
    /// A single point.
    pub fn point(p: DVec3) -> Self {
        Self {
            points: vec![p],
            edges: Vec::new(),
        }
    }

    /// A flat patch.
    pub fn patch(patch: &Parallelogram) -> Self {
        Self {
            points: patch.corners().to_vec(),
            edges: vec![patch.u(), patch.v()],
        }
    }

    /// The flat convex figure with these corners, in order around it.
    pub fn flat(corners: Vec<DVec3>) -> Self {
        let next = corners.iter().cycle().skip(1);
        let edges = corners.iter().zip(next).map(|(a, b)| *b - *a).collect();
        Self {
            points: corners,
            edges,
        }
    }

    /// A whole shape; a curved one by its axis-aligned box.
    pub fn around(shape: &Shape) -> Self {
        if let Shape::Parallelogram(patch) = shape {
            return Self::patch(patch);
        }
        Self {
            points: shape.box_corners().to_vec(),
            edges: DVec3::AXES.to_vec(),
        }
    }

    /// Whether any point of it lies in front of the plane through `point` with normal `normal`, by
    /// more than `slack`.
    pub fn reaches_above(&self, point: DVec3, normal: DVec3, slack: f64) -> bool {
        let above = |p: &DVec3| (*p - point).dot(normal) > slack;
        self.points.iter().any(above)
    }

    fn range(&self, axis: DVec3) -> [f64; 2] {
        let along = self.points.iter().map(|p| p.dot(axis));
        along.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| {
            [low.min(x), high.max(x)]
        })
    }
}

/// The shapes that may stand between two regions.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Blockers {
    /// At most these; empty: every segment is free.
    Among(Vec<ShapeId>),
    /// Not known: any.
    Any,
}

impl Blockers {
    /// Whether every segment between the two regions is free.
    pub fn none(&self) -> bool {
        matches!(self, Self::Among(ids) if ids.is_empty())
    }
}

/// With more shapes than this nothing is worked out pair by pair.
const MOST_SHAPES: usize = 64;

impl Bvh {
    /// The shapes that may block segments from `a` to `b`, whose ends lie on the shapes in `ends`
    /// (if on any): a flat shape never blocks what starts or ends on it.
    pub fn blockers(&self, a: &Region, b: &Region, ends: [Option<ShapeId>; 2]) -> Blockers {
        if self.shapes().len() > MOST_SHAPES {
            return Blockers::Any;
        }
        let ids = (0..self.shapes().len()).filter(|id| !self.is_beside(*id, a, b, ends));
        Blockers::Among(ids.map(|id| id as ShapeId).collect())
    }

    /// Whether nothing can block a segment from `a` to `b`, however many shapes there are.
    pub fn surely_free(&self, a: &Region, b: &Region, ends: [Option<ShapeId>; 2]) -> bool {
        (0..self.shapes().len()).all(|id| self.is_beside(id, a, b, ends))
    }

    /// Whether shape `id` may stand between the two.
    pub fn may_block(
        &self,
        id: ShapeId,
        a: &Region,
        b: &Region,
        ends: [Option<ShapeId>; 2],
    ) -> bool {
        !self.is_beside(id as usize, a, b, ends)
    }

    /// Whether shape `id` cannot stand in the way.
    fn is_beside(&self, id: usize, a: &Region, b: &Region, ends: [Option<ShapeId>; 2]) -> bool {
        let shape = &self.shapes()[id];
        shape.is_flat() && ends.contains(&Some(id as ShapeId)) || separated(shape, a, b)
    }

    /// [`Bvh::blocked`] where only `blockers` can stand in the way.
    pub fn blocked_by(&self, blockers: &Blockers, ray: &Ray, ends: [Option<ShapeId>; 2]) -> bool {
        match blockers {
            Blockers::Any => self.blocked(ray, ends),
            Blockers::Among(ids) => ids.iter().any(|id| {
                let end = |k: usize| ends[k] == Some(*id);
                self.shapes()[*id as usize].blocks(ray, end(0), end(1))
            }),
        }
    }
}

/// Whether a plane is found with `shape` on one side and both regions on the other. Contact within
/// rounding (1e-12 of the coordinates) counts as separate, as it does in [`Shape::blocks`]: what
/// lies in the plane of a patch is not cut by it.
fn separated(shape: &Shape, a: &Region, b: &Region) -> bool {
    const ROUNDING: f64 = 1e-12;
    let apart = |axis: DVec3| {
        let Some(axis) = axis.try_normalize() else {
            return false;
        };
        let [c, d] = extent(shape, axis);
        let ([a0, a1], [b0, b1]) = (a.range(axis), b.range(axis));
        let (low, high) = (a0.min(b0), a1.max(b1));
        let reach = [low, high, c, d]
            .map(f64::abs)
            .into_iter()
            .fold(0.0, f64::max);
        (c - high).max(low - d) >= -ROUNDING * reach
    };
    let normal = |edges: &[DVec3]| match edges {
        [u, v, ..] => u.cross(*v),
        _ => DVec3::ZERO,
    };
    let (own, centre) = match shape {
        Shape::Parallelogram(p) => (vec![p.u(), p.v()], p.at([0.5, 0.5]).position),
        Shape::Sphere(s) => (Vec::new(), s.centre),
        Shape::Disc(d) => (Vec::new(), d.centre()),
        Shape::Instance(_) => (DVec3::AXES.to_vec(), shape.circumsphere().0),
    };
    let face = match shape {
        Shape::Disc(d) => d.normal(),
        _ => normal(&own),
    };
    let first = [face, normal(&a.edges), normal(&b.edges)];
    if first.into_iter().chain(DVec3::AXES).any(apart) {
        return true;
    }
    let lines = || {
        let to = |p: &DVec3| b.points.iter().map(|q| *q - *p).collect::<Vec<_>>();
        a.points.iter().flat_map(to)
    };
    // A curved shape is separated best along its distance from the line.
    let curved = own.is_empty();
    if curved
        && lines()
            .zip(a.points.iter().flat_map(|p| vec![*p; b.points.len()]))
            .any(|(line, p)| {
                let direction = line.normalize_or_zero();
                let offset = centre - p;
                apart(offset - direction * offset.dot(direction))
            })
    {
        return true;
    }
    let edges = || own.iter().chain(&a.edges).chain(&b.edges);
    lines().any(|line| edges().any(|e| apart(line.cross(*e))))
        || edges().any(|e| edges().any(|f| apart(e.cross(*f))))
}

/// Where the shape lies along a unit vector.
fn extent(shape: &Shape, axis: DVec3) -> [f64; 2] {
    match shape {
        Shape::Parallelogram(p) => Region::patch(p).range(axis),
        Shape::Sphere(s) => {
            let middle = s.centre.dot(axis);
            [middle - s.radius, middle + s.radius]
        }
        Shape::Disc(d) => {
            // Its extent along a unit vector is r·√(1 − (n·axis)²).
            let (middle, along) = (d.centre().dot(axis), d.normal().dot(axis));
            let half = d.radius() * (1.0 - along * along).max(0.0).sqrt();
            [middle - half, middle + half]
        }
        Shape::Instance(_) => Region::around(shape).range(axis),
    }
}

#[cfg(test)]
mod tests;
