//! Which shape does a ray meet, and is a segment free?
//!
//! Up to [`FLAT`] shapes are tested one by one; more stand behind a tree.

use super::tree::CompressedTree;
use super::{Interaction, Intersection, Ray, Shape, ShapeId};

/// Largest number of shapes tested one by one: from there on the tree is faster
/// (`benches/rays.rs`).
const FLAT: usize = 8;
/// Hits are at one place if their distances differ by no more than this, relative to the lengths
/// involved.
pub(super) const TIE: f64 = 1e-12;
/// Coordinates beyond this (in scene units) are refused.
const LARGEST: f64 = 1e12;

/// Why no acceleration structure can be built.
#[derive(Debug, thiserror::Error, PartialEq)]
pub enum GeometryError {
    /// A shape is not finite or far outside any bench.
    #[error(
        "surface {index} reaches to {reach:e}: coordinates must be finite and below 1e12 (choose a larger unit)"
    )]
    Unbounded {
        /// Position of the shape in the list.
        index: usize,
        /// Largest coordinate.
        reach: f64,
    },
}

/// A ray's first intersection.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Which shape.
    pub shape: ShapeId,
    /// Distance along the ray.
    pub t: f64,
    /// The triangle of a mesh; 0 for every other shape.
    pub triangle: u32,
}

/// All shapes of a scene, ready for ray queries.
#[derive(Clone)]
pub struct Bvh {
    shapes: Vec<Shape>,
    tree: Option<CompressedTree>,
}

impl std::fmt::Debug for Bvh {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Bvh({} shapes)", self.shapes.len())
    }
}

impl Bvh {
    /// Builds the structure; shape ids are the positions in `shapes`.
    ///
    /// # Errors
    /// [`GeometryError::Unbounded`] for coordinates that are not finite or beyond 1e12.
    pub fn new(shapes: Vec<Shape>) -> Result<Self, GeometryError> {
        for (index, shape) in shapes.iter().enumerate() {
            let (lower, upper) = shape.bounds();
            let reach = lower.abs().max(upper.abs()).max_element();
            let finite = lower.is_finite() && upper.is_finite();
            if !finite || reach > LARGEST {
                return Err(GeometryError::Unbounded { index, reach });
            }
        }
        let boxes: Vec<_> = shapes.iter().map(Shape::bounds).collect();
        let tree = (shapes.len() > FLAT).then(|| CompressedTree::new(&boxes));
        Ok(Self { shapes, tree })
    }

    /// The shapes, by id.
    pub fn shapes(&self) -> &[Shape] {
        &self.shapes
    }

    /// First shape met by `ray`, from either side; `from` is the shape that the ray starts on.
    /// Where two shapes are met at one place (a panel of two faces back to back), the one that
    /// shows its front wins, then the one with the lower id, whatever the order of the search.
    pub fn closest(&self, ray: &Ray, from: Option<ShapeId>) -> Option<Hit> {
        let mut best: Option<Hit> = None;
        let slack = |t: f64| TIE * (t + ray.origin.abs().max_element());
        let mut meet = |id: usize| -> f64 {
            let shape = id as ShapeId;
            let limit = best.map_or(ray.length, |b| (b.t + slack(b.t)).min(ray.length));
            let rest = Ray {
                length: limit,
                ..*ray
            };
            if let Some(Intersection { t, triangle }) =
                self.shapes[id].intersect(&rest, from == Some(shape))
            {
                let hit = Hit { shape, t, triangle };
                if best.is_none_or(|b| self.before(ray, hit, b, slack(t))) {
                    best = Some(hit);
                }
            }
            best.map_or(ray.length, |b| b.t)
        };
        match &self.tree {
            None => (0..self.shapes.len()).for_each(|id| {
                meet(id);
            }),
            Some(tree) => tree.closest(ray, meet),
        }
        best
    }

    /// The point that the ray hits, exactly on its shape.
    pub fn point(&self, ray: &Ray, hit: Hit) -> Interaction {
        let Hit { shape, t, triangle } = hit;
        self.shapes[shape as usize].at_intersection(ray, Intersection { t, triangle })
    }

    /// Whether hit `a` comes before hit `b`.
    fn before(&self, ray: &Ray, a: Hit, b: Hit, slack: f64) -> bool {
        if (a.t - b.t).abs() > slack {
            return a.t < b.t;
        }
        let front = |hit: Hit| self.point(ray, hit).normal.dot(ray.direction) < 0.0;
        match (front(a), front(b)) {
            (true, false) => true,
            (false, true) => false,
            _ => a.shape < b.shape,
        }
    }

    /// Whether anything blocks the open segment `ray`, whose start and end lie on the shapes in
    /// `ends` (if on any).
    pub fn blocked(&self, ray: &Ray, ends: [Option<ShapeId>; 2]) -> bool {
        let blocks = |id: usize| {
            let shape = Some(id as ShapeId);
            self.shapes[id].blocks(ray, ends[0] == shape, ends[1] == shape)
        };
        match &self.tree {
            None => (0..self.shapes.len()).any(blocks),
            Some(tree) => tree.any(ray, blocks),
        }
    }
}

#[cfg(test)]
mod tests;
