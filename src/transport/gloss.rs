//! Reflection that depends on direction, for points in packets.
//!
//! The weight of a point in a packet holds ρ/π where its surface is Lambertian and 1 where it is not; f_r, which then differs from one
//! partner to the next, is multiplied in here.

use std::f64::consts::FRAC_1_PI;

use super::beam::LitPoint;
use super::packet::Packet;
use super::walk::Vertex;
use crate::geometry::{DVec3, ShapeId};
use crate::scene::{Scene, Texture};

/// ρ/π on a Lambertian surface, 1 on any other.
pub(super) fn weight(scene: &Scene, shape: ShapeId, albedo: f64) -> f64 {
    match scene.surfaces[shape as usize].is_lambertian() {
        true => albedo * FRAC_1_PI,
        false => 1.0,
    }
}

/// Whether any surface of the scene is not Lambertian.
pub(super) fn in_scene(scene: &Scene) -> bool {
    scene.surfaces.iter().any(|s| !s.is_lambertian())
}

/// f_r at point k of x, between the direction to the pinhole and that to `to`, where x lies on a surface that is not Lambertian.
pub(super) fn of_view(scene: &Scene, x: &Packet, k: usize, to: DVec3) -> Option<f64> {
    let surface = &scene.surfaces[x.shape[k] as usize];
    if surface.is_lambertian() {
        return None;
    }
    let (position, normal) = x.point(k);
    let albedo = match &surface.albedo {
        Texture::Constant(rho) => *rho,
        varied => varied.albedo(surface.shape.at_position(position).uv),
    };
    let [eye, other] = [scene.camera.position, to].map(|p| (p - position).normalize_or_zero());
    Some(surface.brdf(albedo, normal, other, eye))
}

/// Multiplies the entries between point k of x and point k of y by f_r at x.
pub(super) fn of_views(scene: &Scene, x: &Packet, y: &Packet, entries: &mut [f64]) {
    for (k, entry) in entries.iter_mut().enumerate().filter(|(_, e)| **e != 0.0) {
        if let Some(f) = of_view(scene, x, k, y.position(k)) {
            *entry *= f;
        }
    }
}

/// Multiplies a row over lit points by f_r at each of them, towards `to`.
pub(super) fn of_lit(scene: &Scene, points: &[Option<LitPoint>], to: DVec3, row: &mut [f64]) {
    for (entry, point) in row.iter_mut().zip(points) {
        if let Some(lit) = point
            && !scene.surfaces[lit.shape as usize].is_lambertian()
        {
            *entry *= lit.brdf(scene, to);
        }
    }
}

/// Multiplies a row over lit points by f_r at a vertex, between each of them and the path so far.
pub(super) fn of_vertex(scene: &Scene, x: &Vertex, points: &[Option<LitPoint>], row: &mut [f64]) {
    if scene.surfaces[x.shape as usize].is_lambertian() {
        return;
    }
    for (entry, point) in row.iter_mut().zip(points) {
        if let Some(lit) = point {
            let from = (lit.position - x.position).normalize_or_zero();
            *entry *= x.brdf(scene, from);
        }
    }
}
