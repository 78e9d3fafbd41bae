//! Meshes in their places.

mod rays;

use std::sync::Arc;

use glam::DAffine3;

use super::{DVec3, Facet, Facets, Interaction, Mesh, Patch};

/// A mesh, placed by a similarity (rotation, uniform scale, translation): several bodies may share
/// one mesh. Rays are taken into the mesh's own space, so that a million triangles exist, and their
/// tree is built, once.
#[derive(Clone, Debug)]
pub struct Instance {
    mesh: Arc<Mesh>,
    to_world: DAffine3,
    to_mesh: DAffine3,
    scale: f64,
    side: Side,
    bounds: (DVec3, DVec3),
    /// What the equal-area map takes in place of the triangles.
    facets: Option<Arc<Facets>>,
}

/// Which side of a mesh's triangles is the front.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// The one from which the corners run counterclockwise.
    Outer,
    /// The other.
    Inner,
}

impl PartialEq for Instance {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.mesh, &other.mesh)
            && self.to_world == other.to_world
            && self.side == other.side
    }
}

impl Instance {
    /// The mesh after `placement`; `None` unless that is a finite similarity (to 1e-9) that does
    /// not mirror.
    pub fn new(mesh: Arc<Mesh>, placement: DAffine3, side: Side) -> Option<Self> {
        let axes = placement.matrix3;
        let scale = axes.determinant().cbrt();
        let similar = axes * axes.transpose() * (scale * scale).recip();
        let off = (similar - glam::DMat3::IDENTITY).to_cols_array();
        let proper = placement.is_finite()
            && scale.is_finite()
            && scale > 0.0
            && off.iter().all(|x| x.abs() < 1e-9);
        if !proper {
            return None;
        }
        let to_mesh = if placement == DAffine3::IDENTITY {
            DAffine3::IDENTITY
        } else {
            placement.inverse()
        };
        let place = |p: &DVec3| placement.transform_point3(*p);
        let bounds = mesh
            .positions()
            .iter()
            .map(place)
            .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| {
                (low.min(p), high.max(p))
            });
        Some(Self {
            mesh,
            to_world: placement,
            to_mesh,
            scale,
            side,
            bounds,
            facets: None,
        })
    }

    /// The same body whose equal-area map takes facets of the triangles, cell after cell, in place
    /// of the triangles: they make up each triangle once, in the order of the triangles. `None`:
    /// the triangles again.
    pub fn in_facets(self, facets: Option<Vec<Facet>>) -> Self {
        Self {
            facets: facets.map(|all| Arc::new(self.mesh.cut(all))),
            ..self
        }
    }

    /// Whether it is a parallelogram in its texture coordinates, to 1e-6 of its size: these are
    /// then the parameters of its equal-area map, and the area element is its mean to 2e-6.
    pub fn is_patch(&self) -> bool {
        self.mesh.patch().is_some()
    }

    /// The same to rounding.
    pub fn is_exact_patch(&self) -> bool {
        self.mesh.patch().is_some_and(Patch::is_exact)
    }

    /// The facets of its triangles, if it is cut.
    pub fn facets(&self) -> Option<&Facets> {
        self.facets.as_deref()
    }

    /// How many facets it is cut into, or its triangles where it is not cut.
    pub fn facet_count(&self) -> usize {
        let triangles = self.mesh.triangles().len();
        self.facets().map_or(triangles, |f| f.all().len())
    }

    /// Corners of a facet in the scene.
    pub fn facet_corners(&self, facet: &Facet) -> [DVec3; 3] {
        let place = |w| self.mesh.place(facet.triangle, w);
        facet
            .corners
            .map(|w| self.to_world.transform_point3(place(w)))
    }

    /// Edges along u that divide the body into about `parts` parts, none of which has to do with
    /// two cells of its facets: the larger triangles of a mesh of few, many together of one of
    /// many.
    pub fn edges(&self, parts: usize) -> Vec<f64> {
        match &self.facets {
            Some(facets) => self.mesh.edges_in(facets, parts),
            None => self.mesh.edges(parts),
        }
    }

    /// The mesh, in its own space.
    pub fn mesh(&self) -> &Arc<Mesh> {
        &self.mesh
    }

    /// From the mesh's space to the scene.
    pub fn placement(&self) -> &DAffine3 {
        &self.to_world
    }

    /// Which side reflects.
    pub fn side(&self) -> Side {
        self.side
    }

    /// The same body with its front turned to the other side.
    pub fn turned(&self) -> Self {
        Self {
            side: match self.side {
                Side::Outer => Side::Inner,
                Side::Inner => Side::Outer,
            },
            ..self.clone()
        }
    }

    /// The body after a rigid motion.
    pub fn moved(&self, motion: &DAffine3) -> Option<Self> {
        let moved = Self::new(self.mesh.clone(), *motion * self.to_world, self.side)?;
        Some(Self {
            facets: self.facets.clone(),
            ..moved
        })
    }

    /// Smallest axis-aligned box around the vertices.
    pub fn bounds(&self) -> (DVec3, DVec3) {
        self.bounds
    }

    /// Area, length².
    pub fn area(&self) -> f64 {
        self.mesh.area() * self.scale * self.scale
    }

    /// Whether a point lies in front of the plane of some triangle with an area.
    pub fn faces(&self, q: DVec3) -> bool {
        let local = self.to_mesh.transform_point3(q);
        let in_front = |t: &u32| {
            let [a, b, c] = self.mesh.corners(*t);
            let height = (b - a).cross(c - a).dot(local - a);
            match self.side {
                Side::Outer => height > 0.0,
                Side::Inner => height < 0.0,
            }
        };
        (0..self.mesh.triangles().len() as u32).any(|t| in_front(&t))
    }

    /// Whether a vertex lies in front of the plane through `point` with normal `normal`, by more
    /// than `slack`.
    pub fn reaches_above(&self, point: DVec3, normal: DVec3, slack: f64) -> bool {
        let from = self.to_mesh.transform_point3(point);
        let height = self.to_mesh.transform_vector3(normal) * (self.scale * self.scale);
        let positions = self.mesh.positions();
        positions.iter().any(|p| height.dot(*p - from) > slack)
    }

    /// Area of a triangle, length².
    ///
    /// # Panics
    /// If there is no such triangle.
    pub fn triangle_area(&self, triangle: u32) -> f64 {
        self.mesh.triangle_area(triangle) * self.scale * self.scale
    }

    /// Corners of a triangle in the scene.
    ///
    /// # Panics
    /// If there is no such triangle.
    pub fn corners(&self, triangle: u32) -> [DVec3; 3] {
        self.mesh
            .corners(triangle)
            .map(|c| self.to_world.transform_point3(c))
    }

    /// The edges across which the plane of the mesh changes, and those along which it ends, by
    /// their ends in the scene.
    pub fn folds(&self) -> impl Iterator<Item = [DVec3; 2]> {
        let folds = self.mesh.folds().iter();
        folds.map(|ends| ends.map(|p| self.to_world.transform_point3(p)))
    }

    fn to_scene(&self, point: Interaction) -> Interaction {
        let normal = self.to_world.transform_vector3(point.normal) / self.scale;
        Interaction {
            position: self.to_world.transform_point3(point.position),
            normal: match self.side {
                Side::Outer => normal,
                Side::Inner => -normal,
            },
            uv: point.uv,
        }
    }

    /// The point of a triangle nearest to `p`.
    ///
    /// # Panics
    /// If there is no such triangle.
    pub fn on_triangle(&self, triangle: u32, p: DVec3) -> Interaction {
        let local = self.to_mesh.transform_point3(p);
        self.to_scene(self.mesh.on_triangle(triangle, local))
    }

    /// The point of the body nearest to `p`.
    pub fn at_position(&self, p: DVec3) -> Interaction {
        let (_, point) = self.mesh.at_position(self.to_mesh.transform_point3(p));
        self.to_scene(point)
    }

    /// The point that the equal-area map of the square to the mesh gives to `u`.
    pub fn at(&self, u: [f64; 2]) -> Interaction {
        self.to_scene(match (self.mesh.patch(), &self.facets) {
            (Some(patch), _) if patch.is_exact() => patch.plane.at(u),
            // On the mesh itself, from which no ray may start by a hair.
            (Some(patch), _) => self.mesh.at_position(patch.plane.at(u).position).1,
            (None, Some(facets)) => self.mesh.at_facet(facets, u),
            (None, None) => self.mesh.at(u),
        })
    }

    /// The box around what [`Instance::at`] gives between `low` and `high`: its lower and its upper
    /// corner.
    pub fn bounds_between(&self, low: [f64; 2], high: [f64; 2]) -> (DVec3, DVec3) {
        let empty = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let around = |(low, high): (DVec3, DVec3), p: DVec3| {
            let p = self.to_world.transform_point3(p);
            (low.min(p), high.max(p))
        };
        match (self.mesh.patch(), &self.facets) {
            (Some(patch), _) => {
                let rim = [low, [low[0], high[1]], high, [high[0], low[1]]];
                let rim = rim.map(|uv| patch.plane.at(uv).position);
                let (low, high) = rim.into_iter().fold(empty, around);
                let off = DVec3::splat(2.0 * patch.off * self.scale);
                (low - off, high + off)
            }
            (None, Some(facets)) => self.mesh.hull_in(facets, low, high).fold(empty, around),
            (None, None) => self.mesh.hull(low, high).fold(empty, around),
        }
    }

    /// The parameters for which [`Instance::at`] gives the point of a triangle that is nearest to
    /// `p`.
    ///
    /// # Panics
    /// If there is no such triangle.
    pub fn parameters(&self, triangle: u32, p: DVec3) -> [f64; 2] {
        let local = self.to_mesh.transform_point3(p);
        match (self.mesh.patch(), &self.facets) {
            (Some(patch), _) if patch.is_exact() => {
                patch.plane.coordinates(local).map(|x| x.clamp(0.0, 1.0))
            }
            (Some(_), _) => self.mesh.on_triangle(triangle, local).uv,
            (None, Some(facets)) => self.mesh.parameters_in(facets, triangle, local),
            (None, None) => self.mesh.parameters(triangle, local),
        }
    }
}

#[cfg(test)]
mod tests;
