//! Vertices of light paths, one or many at once: the geometry term between two, the BRDF at one.
//!
//! At a surface `wi` points to where the light comes from and `wo` to where it goes; both are unit
//! vectors away from the surface. The BRDF is split into two factors, f_r = c · d(wi, wo): c = ρ/π
//! and d = 1 on a Lambertian surface, c = 1 and d = f_r on any other; c = x/π and d = f on one that
//! shines ([`Shining`](crate::scene::material::Shining)), for its power is M times its area. c is
//! part of the weight of a vertex, before any direction is known; d is multiplied in for every pair
//! of directions.

use std::f64::consts::FRAC_1_PI;
use std::ops::Range;

use super::visibility::Place;
use crate::geometry::{DVec3, Interaction, Ray, ShapeId};
use crate::num::lanes::widest;
use crate::scene::{Scene, Surface, Texture};

/// A position and the unit normal there.
pub(super) type Oriented = (DVec3, DVec3);

/// The factor c of the BRDF where the texture of `surface` has the value `albedo`.
pub(super) fn constant_factor(surface: &Surface, albedo: f64) -> f64 {
    if surface.is_lambertian() || surface.shining().is_some() {
        albedo * FRAC_1_PI
    } else {
        1.0
    }
}

/// A point on the front of a surface that light is reflected at.
#[derive(Clone, Copy, Debug)]
pub(super) struct Vertex {
    pub position: DVec3,
    pub normal: DVec3,
    pub shape: ShapeId,
    pub albedo: f64,
    /// Unit vector back along the path that found the vertex: `wo` where it comes from the camera,
    /// `wi` where it comes from the laser.
    pub back: DVec3,
    /// Flux into the pixel per unit of radiance leaving this vertex along the path, over the
    /// density of the path so far (length² sr).
    pub throughput: f64,
    /// Points per area, of all kinds but light paths, that were drawn where this one is; infinite
    /// for a vertex that no light path competes with.
    pub density: f64,
}

impl Vertex {
    /// The vertex at a point of `shape`.
    pub(super) fn new(
        scene: &Scene,
        shape: ShapeId,
        point: &Interaction,
        back: DVec3,
        throughput: f64,
    ) -> Self {
        Self {
            position: point.position,
            normal: point.normal,
            shape,
            albedo: scene.surfaces[shape as usize].albedo.albedo(point.uv),
            back,
            throughput,
            density: f64::INFINITY,
        }
    }

    /// The vertex where a ray along `direction` meets a point of `shape`; `None` on its back.
    pub(super) fn arrive(
        scene: &Scene,
        shape: ShapeId,
        point: &Interaction,
        direction: DVec3,
        throughput: f64,
    ) -> Option<Self> {
        let front = point.normal.dot(direction) < 0.0;
        front.then(|| Self::new(scene, shape, point, -direction, throughput))
    }

    /// Whether the surface is not black here.
    pub(super) fn reflects(&self, scene: &Scene) -> bool {
        !self.surface(scene).material.is_black(self.albedo)
    }

    fn surface<'s>(&self, scene: &'s Scene) -> &'s Surface {
        &scene.surfaces[self.shape as usize]
    }

    pub(super) fn oriented(&self) -> Oriented {
        (self.position, self.normal)
    }

    /// The factor c of the BRDF.
    pub(super) fn constant_factor(&self, scene: &Scene) -> f64 {
        constant_factor(self.surface(scene), self.albedo)
    }

    /// The factor d of the BRDF for light from the point `light`, on a path from the camera.
    pub(super) fn factor_from(&self, scene: &Scene, light: DVec3) -> f64 {
        self.directional_factor(scene, || [self.towards(light), self.back])
    }

    /// The factor d of the BRDF for light to the point `to`, where the laser's beam lands or a
    /// surface shines.
    pub(super) fn factor_to(&self, scene: &Scene, to: DVec3) -> f64 {
        self.directional_factor(scene, || [self.back, self.towards(to)])
    }

    /// f_r for light from the direction `wi`, on a path from the camera.
    pub(super) fn brdf(&self, scene: &Scene, wi: DVec3) -> f64 {
        self.constant_factor(scene) * self.directional_factor(scene, || [wi, self.back])
    }

    fn directional_factor(&self, scene: &Scene, directions: impl FnOnce() -> [DVec3; 2]) -> f64 {
        let surface = self.surface(scene);
        if surface.is_lambertian() {
            return 1.0;
        }
        let [wi, wo] = directions();
        match surface.fall_off() {
            Some(fall_off) => fall_off.towards(self.normal, wo),
            None => surface.brdf(self.albedo, self.normal, wi, wo),
        }
    }

    fn towards(&self, point: DVec3) -> DVec3 {
        (point - self.position).normalize_or_zero()
    }
}

/// G without visibility, cosθ·cosθ′/d² (length⁻²), with the segment from a to b; `None` unless both
/// see the front of the other.
pub(super) fn geometry_term(a: Oriented, b: Oriented) -> Option<(f64, Ray)> {
    let ray = Ray::between(a.0, b.0)?;
    let (cos_a, cos_b) = (a.1.dot(ray.direction), -b.1.dot(ray.direction));
    (cos_a > 0.0 && cos_b > 0.0).then(|| (cos_a * cos_b / (ray.length * ray.length), ray))
}

/// Many vertices, coordinate by coordinate for wide arithmetic, each with a weight. Those of weight
/// 0 stand for light that goes nowhere.
#[derive(Clone, Debug, Default)]
pub(super) struct Batch {
    position: [Vec<f64>; 3],
    normal: [Vec<f64>; 3],
    pub weight: Vec<f64>,
    pub shape: Vec<ShapeId>,
}

impl Batch {
    /// `n` vertices of weight 0.
    pub(super) fn zeros(n: usize) -> Self {
        let zeros = || std::array::from_fn(|_| vec![0.0; n]);
        Self {
            position: zeros(),
            normal: zeros(),
            weight: vec![0.0; n],
            shape: vec![0; n],
        }
    }

    /// Number of vertices.
    pub(super) fn len(&self) -> usize {
        self.weight.len()
    }

    /// Replaces vertex `i`.
    pub(super) fn set(
        &mut self,
        i: usize,
        (position, normal): Oriented,
        weight: f64,
        shape: ShapeId,
    ) {
        for d in 0..3 {
            self.position[d][i] = position[d];
            self.normal[d][i] = normal[d];
        }
        self.weight[i] = weight;
        self.shape[i] = shape;
    }

    /// Puts the first `n` vertices on one flat shape; returns their positions and weights, to be
    /// written.
    pub(super) fn put_on_plane(
        &mut self,
        n: usize,
        shape: ShapeId,
        normal: DVec3,
    ) -> ([&mut [f64]; 3], &mut [f64]) {
        for d in 0..3 {
            self.normal[d][..n].fill(normal[d]);
        }
        self.shape[..n].fill(shape);
        let [x, y, z] = &mut self.position;
        let position = [&mut x[..n], &mut y[..n], &mut z[..n]];
        (position, &mut self.weight[..n])
    }

    /// Position and normal of vertex `i`.
    #[inline]
    pub(super) fn oriented(&self, i: usize) -> Oriented {
        let at = |c: &[Vec<f64>; 3]| DVec3::new(c[0][i], c[1][i], c[2][i]);
        (at(&self.position), at(&self.normal))
    }

    /// Position and shape of vertex `i`.
    #[inline]
    pub(super) fn place(&self, i: usize) -> Place {
        (self.oriented(i).0, self.shape[i])
    }

    /// The factor d of the BRDF at vertex k for light from the point `light`, where the pinhole
    /// sees it.
    pub(super) fn factor_from(&self, scene: &Scene, k: usize, light: DVec3) -> f64 {
        let surface = &scene.surfaces[self.shape[k] as usize];
        if surface.is_lambertian() {
            return 1.0;
        }
        let (position, normal) = self.oriented(k);
        let albedo = match &surface.albedo {
            Texture::Constant(rho) => *rho,
            varied => varied.albedo(surface.shape.at_position(position).uv),
        };
        let [wi, wo] = [light, scene.camera.position].map(|p| (p - position).normalize_or_zero());
        surface.brdf(albedo, normal, wi, wo)
    }

    /// Vertices `range`.
    pub(super) fn part(&self, range: Range<usize>) -> Self {
        let cut = |v: &Vec<f64>| v[range.clone()].to_vec();
        Self {
            position: self.position.each_ref().map(cut),
            normal: self.normal.each_ref().map(cut),
            weight: cut(&self.weight),
            shape: self.shape[range.clone()].to_vec(),
        }
    }

    /// G between vertex `i` and another, without visibility.
    pub(super) fn geometry_term(&self, i: usize, (q, m): Oriented) -> f64 {
        let (p, n) = self.oriented(i);
        term((q - p).to_array(), n.to_array(), m.to_array())
    }

    /// factor · weight_i · G between one vertex and vertex i of the batch; visibility is not part
    /// of G.
    pub(super) fn geometry_terms_from(
        &self,
        (p, n): Oriented,
        factor: f64,
        weight: &[f64],
        out: &mut [f64],
    ) {
        let count = self.len();
        let [x, y, z] = first(count, &self.position);
        let [a, b, c] = first(count, &self.normal);
        let (weight, out) = (&weight[..count], &mut out[..count]);
        widest(
            #[inline(always)]
            || {
                for i in 0..count {
                    let d = [x[i] - p.x, y[i] - p.y, z[i] - p.z];
                    out[i] = factor * weight[i] * term(d, n.to_array(), [a[i], b[i], c[i]]);
                }
            },
        );
    }

    /// weight_i · G between vertex i of this batch and vertex i of `other`; visibility is not part
    /// of G.
    pub(super) fn geometry_terms_to(&self, other: &Self, weight: &[f64], out: &mut [f64]) {
        let count = self.len();
        let [x, y, z] = first(count, &self.position);
        let [a, b, c] = first(count, &self.normal);
        let [u, v, w] = first(count, &other.position);
        let [k, l, m] = first(count, &other.normal);
        let (weight, out) = (&weight[..count], &mut out[..count]);
        widest(
            #[inline(always)]
            || {
                for i in 0..count {
                    let d = [u[i] - x[i], v[i] - y[i], w[i] - z[i]];
                    out[i] = weight[i] * term(d, [a[i], b[i], c[i]], [k[i], l[i], m[i]]);
                }
            },
        );
    }
}

/// The first `count` of each component.
#[inline]
fn first(count: usize, [x, y, z]: &[Vec<f64>; 3]) -> [&[f64]; 3] {
    [&x[..count], &y[..count], &z[..count]]
}

/// G for the segment d from a point with normal n to one with normal m: (n·d)(−m·d)/|d|⁴ where both
/// see the front of the other, else 0.
#[inline(always)]
fn term(d: [f64; 3], n: [f64; 3], m: [f64; 3]) -> f64 {
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let (there, back, square) = (dot(n, d), -dot(m, d), dot(d, d));
    if there > 0.0 && back > 0.0 {
        there * back / (square * square)
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests;
