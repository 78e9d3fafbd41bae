//! The camera's end of a path.

use crate::geometry::{DVec3, Ray};
use crate::scene::{Camera, Scene};

use super::beam::LitPoint;
use super::walk::Vertex;

/// What pixel `pixel` sees through the point (a, b) of its footprint, and the étendue that the sample stands for.
///
/// The flux into the pixel is Φ = ∫ L · A_lens·cosθ_cam dΩ; with the footprint's area as measure dΩ = cosθ_view dA/d², and
/// the aperture is parallel to the view: both cosines are the same. A uniform point of the footprint therefore carries
/// A_footprint · A_lens · cos²θ/d², d the distance to the footprint (not to what stands in front of it).
pub(super) fn first_vertex(scene: &Scene, pixel: usize, ab: [f64; 2]) -> Option<Vertex> {
    let camera = &scene.camera;
    let footprint = camera.footprint(pixel);
    let line = Ray::between(camera.position, footprint.at(ab))?;
    let cos = camera.view.normal().dot(line.direction).abs();
    let etendue = footprint.area * camera.aperture_area * cos * cos / (line.length * line.length);
    let ray = Ray::new(line.origin, line.direction);
    let hit = scene.bvh().closest(&ray, None)?;
    let point = scene.bvh().point(&ray, hit);
    Vertex::arrive(scene, hit.shape, &point, line.direction, etendue)
}

/// The flux of the lit point itself into whichever pixel sees it, per watt of laser power: (pixel, flux).
///
/// A point that scatters Φ has the radiant intensity Φ·f_r·cosθ; the aperture fills A_lens·cosθ_cam/d² of solid angle.
pub(super) fn direct(scene: &Scene, lit: &LitPoint) -> Option<(usize, f64)> {
    let camera: &Camera = &scene.camera;
    let pixel = camera.pixel_of(lit.position)?;
    let ray = Ray::between(lit.position, camera.position)?;
    let cos_lit = lit.normal.dot(ray.direction);
    let cos_camera = camera.view.normal().dot(ray.direction);
    if cos_lit <= 0.0 || cos_camera <= 0.0 || scene.bvh().blocked(&ray, [Some(lit.shape), None]) {
        return None;
    }
    let solid_angle = camera.aperture_area * cos_camera / (ray.length * ray.length);
    Some((
        pixel,
        lit.brdf(scene, camera.position) * cos_lit * solid_angle,
    ))
}

/// Density, per unit area at x, of what a uniform point of a pixel's footprint makes the pinhole see:
/// 1/A_footprint · (cosθ_x/d_x²)·(d_view²/cosθ_view), x seen from its front.
pub(super) fn density(scene: &Scene, x: (DVec3, DVec3)) -> f64 {
    let camera = &scene.camera;
    let Some(line) = Ray::between(camera.position, x.0) else {
        return 0.0;
    };
    let (cos_x, cos_view) = (
        -x.1.dot(line.direction),
        -camera.view.normal().dot(line.direction),
    );
    if cos_x <= 0.0 || cos_view <= 0.0 {
        return 0.0;
    }
    let to_view = camera
        .view
        .normal()
        .dot(camera.position - camera.view.corner())
        / cos_view;
    let footprint = camera.view.area() / camera.pixels() as f64;
    cos_x * to_view * to_view / (line.length * line.length * cos_view * footprint)
}
