//! Sampling of points on surfaces by area.

use std::sync::Arc;

use super::parts::{Divided, Parts};
use super::steps::{cell_at, invert};
use super::vertex::Oriented;
use crate::geometry::{Facets, Hit, Interaction, Ray, Shape, ShapeId};
use crate::scene::Scene;

/// Density proportional to the mean albedo of each smooth texture cell (of a mesh its facets
/// there), uniform in area within it. Dark cells are never sampled, which is exact; light ones are
/// stratified by their edges. Guided, each part of a surface has a density in proportion to its
/// albedo times an importance, besides a tenth of that by albedo alone.
#[derive(Clone, Debug)]
pub(super) struct AreaSampler {
    parts: Arc<Parts>,
    /// By part: the probability before it, unnormalised, and that of all.
    before: Vec<f64>,
}

/// A point of a surface: which surface, the point, and where it lies in the surface's own map.
#[derive(Clone, Copy, Debug)]
pub(super) struct SurfaceInteraction {
    pub shape: ShapeId,
    pub point: Interaction,
    /// The parameters for which the shape's equal-area map gives it.
    pub parameters: [f64; 2],
}

impl SurfaceInteraction {
    /// The point of `shape` with these parameters.
    pub(super) fn at(scene: &Scene, shape: ShapeId, parameters: [f64; 2]) -> Self {
        Self {
            shape,
            point: scene.surfaces[shape as usize].shape.at(parameters),
            parameters,
        }
    }

    /// Where the ray hits a shape.
    pub(super) fn hit(scene: &Scene, ray: &Ray, hit: Hit) -> Self {
        let point = scene.bvh().point(ray, hit);
        let parameters = match &scene.surfaces[hit.shape as usize].shape {
            Shape::Instance(body) => body.parameters(hit.triangle, point.position),
            _ => point.uv,
        };
        Self {
            shape: hit.shape,
            point,
            parameters,
        }
    }

    /// Which of the smooth cells of its surface it lies in, in rows.
    pub(super) fn cell(&self, scene: &Scene) -> usize {
        let surface = &scene.surfaces[self.shape as usize];
        if let Shape::Instance(body) = &surface.shape
            && !body.is_patch()
        {
            let edges = body.facets().map_or(&[0.0, 1.0][..], Facets::edges);
            let inner = &edges[1..edges.len() - 1];
            return inner.partition_point(|edge| *edge <= self.parameters[0]);
        }
        let count = surface.smooth_cells();
        let [i, j] = cell_at(count, self.parameters);
        i + j * count[0]
    }

    pub(super) fn oriented(&self) -> Oriented {
        (self.point.position, self.point.normal)
    }
}

/// The share of the density that no guess takes away.
const UNGUIDED: f64 = 0.1;

impl AreaSampler {
    pub(super) fn new(scene: &Scene, shapes: &[ShapeId]) -> Self {
        let parts = Arc::new(Parts::whole(scene, shapes));
        Self::of_weights(&parts, |_, weight| weight)
    }

    /// A sampler that follows the importance of each part.
    pub(super) fn guided(parts: &Arc<Parts>, importance: impl Fn(usize) -> f64) -> Self {
        let plain: f64 = parts.weights().sum();
        let guessed = parts.weights().enumerate().map(|(k, w)| w * importance(k));
        let total: f64 = guessed.sum();
        if total <= 0.0 {
            return Self::of_weights(parts, |_, weight| weight);
        }
        let (even, by_guess) = (UNGUIDED / plain, (1.0 - UNGUIDED) / total);
        Self::of_weights(parts, |k, weight| {
            weight * (even + by_guess * importance(k))
        })
    }

    fn of_weights(parts: &Arc<Parts>, weight: impl Fn(usize, f64) -> f64) -> Self {
        let mut sum = 0.0;
        let mut before = vec![sum];
        for (k, w) in parts.weights().enumerate() {
            sum += weight(k, w);
            before.push(sum);
        }
        Self {
            before,
            parts: Arc::clone(parts),
        }
    }

    /// Whether nothing is sampled because all shapes are black.
    pub(super) fn is_empty(&self) -> bool {
        self.parts.surfaces.is_empty()
    }

    /// Whether `shape` is sampled.
    pub(super) fn contains(&self, shape: ShapeId) -> bool {
        self.parts.of(shape).is_some()
    }

    /// A point for u ∈ [0, 1)², with its density per unit area: surfaces by the first number, then
    /// rows of parts by the second and parts by what is left of the first.
    pub(super) fn sample(&self, scene: &Scene, [a, b]: [f64; 2]) -> (SurfaceInteraction, f64) {
        let surfaces = &self.parts.surfaces;
        let end = |s: &Divided| self.before[s.first + s.parts()];
        let edge = |k: usize| if k == 0 { 0.0 } else { end(&surfaces[k - 1]) };
        let (k, a) = invert(surfaces.len(), edge, a);
        let s = &surfaces[k];
        let [nu, nv] = s.grid;
        let (row, b) = invert(nv, |j| self.before[s.first + j * nu], b);
        let first = s.first + row * nu;
        let (column, a) = invert(nu, |i| self.before[first + i], a);
        let (uv, light) = s.place(row * nu + column, [a, b]);
        let density = self.share(first + column) * light;
        (SurfaceInteraction::at(scene, s.shape, uv), density)
    }

    /// The probability of a part.
    fn share(&self, part: usize) -> f64 {
        (self.before[part + 1] - self.before[part]) / self.before[self.before.len() - 1]
    }

    /// Density of [`AreaSampler::sample`] at a point, per unit area.
    pub(super) fn density(&self, at: &SurfaceInteraction) -> f64 {
        self.parts.of(at.shape).map_or(0.0, |s| {
            let (part, light) = s.locate(at.parameters);
            let share = self.share(part);
            if share > 0.0 { share * light } else { 0.0 }
        })
    }

    /// Whether all cells of one surface are unions of the boxes into which a net of `points` is
    /// stratified: then the net is stratified by the cells too, and better than nets of their own.
    pub(super) fn is_dyadic(&self, points: u32) -> bool {
        match self.parts.surfaces.as_slice() {
            [s] if s.parts() == 1 => s.is_dyadic(points.max(1).ilog2()),
            _ => false,
        }
    }
}

#[cfg(test)]
mod tests;
