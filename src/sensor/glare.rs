//! Veiling glare: light of the spot that the lens scatters over the whole image.

use crate::geometry::{DVec3, Ray, ShapeId};
use crate::matrix::Matrix;
use crate::scene::{Glare, Scene, Spread};

/// A lit point: place, front normal, albedo, surface.
type LitPoint = (DVec3, DVec3, f64, ShapeId);

/// Flux that enters the lens straight from each spot, W, whether the camera has the spot in view or
/// not:
///
/// > Φ_lens\[l\] = Φlaser · (ρ1/π) · cosθ_spot · cosθ_lens · A_lens / R²
///
/// R between the spot and the pinhole, θ_lens against the view's normal. A wide spot is taken at
/// its centre. 0 where a hidden surface shines, which the lens does not see, where something stands
/// between, where the beam meets a back, or where the lens
/// looks away.
pub fn entering_lens(scene: &Scene) -> Vec<f64> {
    (0..scene.laser.spots.len())
        .map(|spot| lit_point(scene, spot).map_or(0.0, |lit| enters(scene, &lit)))
        .collect()
}

/// Scattered flux into every pixel for every spot, W (pixels × spots): a column sums to fraction ·
/// Φ_lens\[l\] ([`entering_lens`]), shared out
///
/// > evenly, or as w = 1/(1 + (d/d0)²),
///
/// d the distance, on the view's plane, between the pixel's centre and the image of the spot: where
/// the line from the pinhole through the spot meets that plane. Only the spot's own light is
/// scattered, not the glow of the wall.
pub fn glare(scene: &Scene, glare: Glare) -> Matrix {
    let pixels = scene.camera.pixels();
    let mut scattered = Matrix::zeros(pixels, scene.laser.spots.len());
    for (spot, mut column) in scattered.column_iter_mut().enumerate() {
        let Some(lit) = lit_point(scene, spot) else {
            continue;
        };
        let all = glare.fraction * enters(scene, &lit);
        if all <= 0.0 {
            continue;
        }
        let weights = weights(scene, lit.0, glare.spread);
        let total: f64 = weights.iter().sum();
        for (pixel, weight) in weights.iter().enumerate() {
            column[pixel] = all * weight / total;
        }
    }
    scattered
}

/// Glare as a multiple of the signal: ΣΦ_glare/ΣΦ over all pixels and spots. Proportional to the
/// fraction that is scattered.
pub fn glare_to_signal(glare: &Matrix, signal: &Matrix) -> f64 {
    glare.sum() / signal.sum()
}

fn weights(scene: &Scene, spot: DVec3, spread: Spread) -> Vec<f64> {
    let camera = &scene.camera;
    let d0 = match spread {
        Spread::Uniform => return vec![1.0; camera.pixels()],
        Spread::Falloff(d0) => d0,
    };
    let normal = camera.view.normal();
    let line = spot - camera.position;
    let reach = normal.dot(camera.view.corner() - camera.position) / normal.dot(line);
    let image = camera.position + line * reach;
    (0..camera.pixels())
        .map(|pixel| {
            let d = (camera.footprint(pixel).at([0.5, 0.5]) - image).length() / d0;
            1.0 / (1.0 + d * d)
        })
        .collect()
}

/// Where the beam of a spot lands: on its target, or on what stands in its way.
fn lit_point(scene: &Scene, spot: usize) -> Option<LitPoint> {
    let laser = &scene.laser;
    if laser.is_shining() {
        return None;
    }
    let target = &laser.spots[spot].target;
    let ray = Ray::between(laser.position, target.position)?;
    let own = laser.spots[spot].surface;
    let (id, point) = if scene.bvh().blocked(&ray, [None, Some(own)]) {
        let hit = scene.bvh().closest(&ray, None)?;
        (hit.shape, scene.bvh().point(&ray, hit))
    } else {
        (own, *target)
    };
    let albedo = scene.surfaces[id as usize].albedo.albedo(point.uv);
    (point.normal.dot(ray.direction) < 0.0).then_some((point.position, point.normal, albedo, id))
}

fn enters(scene: &Scene, (position, normal, albedo, surface): &LitPoint) -> f64 {
    let camera = &scene.camera;
    let Some(ray) = Ray::between(*position, camera.position) else {
        return 0.0;
    };
    let cos_spot = normal.dot(ray.direction);
    let cos_lens = camera.view.normal().dot(ray.direction);
    let dark = cos_spot <= 0.0 || cos_lens <= 0.0;
    if dark || scene.bvh().blocked(&ray, [Some(*surface), None]) {
        return 0.0;
    }
    let aperture = camera.aperture_area * cos_lens / (ray.length * ray.length);
    let surface = &scene.surfaces[*surface as usize];
    let laser = (scene.laser.position - *position).normalize_or_zero();
    let reflected = surface.brdf(*albedo, *normal, laser, ray.direction);
    scene.laser.power * reflected * cos_spot * aperture
}
