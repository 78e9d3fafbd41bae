//! The wall as laser and camera meet it.

use std::f64::consts::FRAC_1_PI;

use super::kernel::{HiddenPoint, Kernel};
use crate::geometry::{DVec3, Ray, SurfacePoint};
use crate::scene::{Role, Scene, Surface};

/// A point of the wall that a line of sight ends on, or that the laser lights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct WallPoint {
    pub position: DVec3,
    pub normal: DVec3,
    /// What the point contributes besides G: E_p·ρ3/π (length² sr · sr⁻¹) on the camera's side, Φlaser·ρ1/π (W sr⁻¹) on the
    /// laser's.
    pub weight: f64,
}

impl WallPoint {
    /// Weight times G.
    pub(super) fn towards(&self, kernel: Kernel, hidden: &HiddenPoint) -> f64 {
        self.weight * kernel.between(self.position, self.normal, hidden)
    }
}

/// The wall point of pixel `pixel` behind (a, b) of its footprint, with the étendue of `share` of the footprint:
/// A_lens·cosθ_cam·cosθ_view/d² · share · A_footprint. Its weight is 0 where the line of sight misses the wall.
pub(super) fn seen(scene: &Scene, pixel: usize, ab: [f64; 2], share: f64) -> WallPoint {
    let camera = &scene.camera;
    let footprint = camera.footprint(pixel);
    let target = footprint.at(ab);
    let line = target - camera.position;
    let d2 = line.length_squared();
    let direction = line / d2.sqrt();
    let cos = camera.view.normal().dot(direction);
    let etendue = camera.aperture_area * cos * cos / d2 * share * footprint.area;
    let relays = scene.surfaces.iter().filter(|s| s.role == Role::Relay);
    let ray = Ray::new(camera.position, direction);
    let nearest = relays
        .filter_map(|s| s.shape.intersect(&ray, false).map(|t| (t, s)))
        .min_by(|a, b| a.0.total_cmp(&b.0));
    match nearest {
        None => WallPoint {
            position: target,
            normal: camera.view.normal(),
            weight: 0.0,
        },
        Some((t, surface)) => {
            let point = surface.shape.at_position(camera.position + direction * t);
            lambertian(surface, &point, direction, etendue)
        }
    }
}

/// The wall where the beam that is aimed at `offset` from the target of spot `spot` meets it, lit by `share` of the laser's
/// power. Its weight is 0 where the beam misses the wall.
pub(super) fn lit(scene: &Scene, spot: usize, offset: DVec3, share: f64) -> WallPoint {
    let laser = &scene.laser;
    let target = &laser.spots[spot].target;
    let surface = &scene.surfaces[laser.spots[spot].surface as usize];
    let aim = target.position + offset;
    let direction = (aim - laser.position).normalize_or_zero();
    if offset == DVec3::ZERO {
        return lambertian(surface, target, direction, share * laser.power);
    }
    match surface
        .shape
        .intersect(&Ray::new(laser.position, direction), false)
    {
        None => WallPoint {
            position: aim,
            normal: target.normal,
            weight: 0.0,
        },
        Some(t) => {
            let point = surface.shape.at_position(laser.position + direction * t);
            lambertian(surface, &point, direction, share * laser.power)
        }
    }
}

/// A Lambertian wall point met along `direction`: its weight is `received`·ρ/π, and 0 on the back.
fn lambertian(
    surface: &Surface,
    point: &SurfacePoint,
    direction: DVec3,
    received: f64,
) -> WallPoint {
    let front = point.normal.dot(direction) < 0.0;
    let albedo = if front {
        surface.albedo.albedo(point.uv)
    } else {
        0.0
    };
    WallPoint {
        position: point.position,
        normal: point.normal,
        weight: received * albedo * FRAC_1_PI,
    }
}
