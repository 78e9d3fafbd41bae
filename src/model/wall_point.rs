//! The wall as laser and camera meet it.

use std::f64::consts::{FRAC_1_PI, PI};

use super::kernel::{HiddenPoint, HiddenPoints, Kernel};
use crate::geometry::{DVec3, Interaction, Intersection, Ray, Shape, ShapeId};
use crate::matrix::Matrix;
use crate::scene::Scene;

/// A point of the wall that a line of sight ends on, or that the laser lights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct WallPoint {
    pub position: DVec3,
    pub normal: DVec3,
    /// What the point contributes besides G and f_r: E_p (length² sr) on the camera's side, Φlaser
    /// (W) on the laser's; 0 where the line ends on nothing, or on a back.
    pub weight: f64,
    /// How it reflects.
    pub reflection: Reflection,
    /// The wall; none where the line ends on nothing.
    pub surface: Option<ShapeId>,
}

/// f_r of a wall point between the device (laser or camera) and the hidden surface: BRDF12,
/// BRDF23cam.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Reflection {
    /// ρ/π, whatever the directions.
    Constant(f64),
    /// That of surface `surface`, whose texture has the value `albedo`, for the unit vector
    /// `device`.
    Directed {
        surface: usize,
        albedo: f64,
        device: DVec3,
    },
}

impl WallPoint {
    /// Weight times f_r, towards a point of the hidden surface.
    pub(super) fn reflected(&self, scene: &Scene, to: DVec3) -> f64 {
        self.weight
            * match self.reflection {
                Reflection::Constant(f) => f,
                Reflection::Directed {
                    surface,
                    albedo,
                    device,
                } => {
                    let to = (to - self.position).normalize_or_zero();
                    scene.surfaces[surface].brdf(albedo, self.normal, device, to)
                }
            }
    }

    /// Value of the wall's texture.
    pub(super) fn albedo(&self) -> f64 {
        match self.reflection {
            Reflection::Constant(f) => PI * f,
            Reflection::Directed { albedo, .. } => albedo,
        }
    }

    /// Weight times f_r times G.
    pub(super) fn towards(&self, scene: &Scene, kernel: Kernel, hidden: &HiddenPoint) -> f64 {
        match kernel.between(self.position, self.normal, hidden) {
            0.0 => 0.0,
            g => self.reflected(scene, hidden.position) * g,
        }
    }

    /// Adds that of each hidden point to its sum.
    pub(super) fn add_towards(
        &self,
        scene: &Scene,
        kernel: Kernel,
        hidden: &HiddenPoints<'_>,
        sums: &mut [f64],
    ) {
        match self.reflection {
            Reflection::Constant(f) if hidden.are_plain(kernel) => {
                hidden.add_geometry(self.position, self.normal, self.weight * f, sums);
            }
            _ => {
                for (sum, (point, _)) in sums.iter_mut().zip(hidden.all) {
                    *sum += self.towards(scene, kernel, point);
                }
            }
        }
    }

    /// A place that nothing is lit at or seen of.
    fn nowhere(position: DVec3, normal: DVec3) -> Self {
        Self {
            position,
            normal,
            weight: 0.0,
            reflection: Reflection::Constant(0.0),
            surface: None,
        }
    }
}

/// What each of these groups of wall points sends to each hidden point, points × groups: Σ of
/// weight times f_r times G.
pub(super) fn sides<'w, G: Iterator<Item = &'w WallPoint>>(
    (scene, kernel): (&Scene, Kernel),
    hidden: &HiddenPoints<'_>,
    groups: impl ExactSizeIterator<Item = G>,
) -> Matrix {
    let n = hidden.all.len();
    let mut sums = Matrix::zeros(n, groups.len());
    // At least one, or there are no chunks.
    for (sums, group) in sums.as_mut_slice().chunks_mut(n.max(1)).zip(groups) {
        for wall in group {
            wall.add_towards(scene, kernel, hidden, sums);
        }
    }
    sums
}

/// The wall point of pixel `pixel` behind (a, b) of its footprint, with the étendue of `share` of
/// the footprint: A_lens·cosθ_cam·cosθ_view/d² · share · A_footprint. Its weight is 0 where the
/// line of sight misses the wall.
pub(super) fn seen(scene: &Scene, pixel: usize, ab: [f64; 2], share: f64) -> WallPoint {
    let camera = &scene.camera;
    let footprint = camera.footprint(pixel);
    let target = footprint.at(ab);
    let line = target - camera.position;
    let d2 = line.length_squared();
    let direction = line / d2.sqrt();
    let cos = camera.view.normal().dot(direction);
    let etendue = camera.aperture_area * cos * cos / d2 * share * footprint.area;
    met(scene, (camera.position, direction), etendue)
        .unwrap_or_else(|| WallPoint::nowhere(target, camera.view.normal()))
}

/// The wall that a ray from the device meets first, with `received` W or length² sr; none where it
/// meets none.
fn met(scene: &Scene, (from, direction): (DVec3, DVec3), received: f64) -> Option<WallPoint> {
    let ray = Ray::new(from, direction);
    let (met, id) = scene
        .relays()
        .filter_map(|(id, s)| s.shape.intersect(&ray, false).map(|met| (met, id)))
        .min_by(|a, b| {
            // Of the two sides of one wall the one that shows its front.
            let back = |(met, id): &(Intersection, usize)| {
                let point = scene.surfaces[*id].shape.at_intersection(&ray, *met);
                point.normal.dot(direction) >= 0.0
            };
            a.0.t.total_cmp(&b.0.t).then_with(|| back(a).cmp(&back(b)))
        })?;
    let point = scene.surfaces[id].shape.at_intersection(&ray, met);
    Some(reflecting(scene, id, &point, direction, received))
}

/// A piece of `area` of the facet of the wall about `whole` that the camera sees, at its middle: dE
/// = A_lens·cosθ_cam·cosθ_facet/d² dA.
pub(super) fn seen_piece(scene: &Scene, whole: &WallPoint, middle: DVec3, area: f64) -> WallPoint {
    let camera = &scene.camera;
    let Some(id) = whole.surface else {
        return WallPoint::nowhere(middle, whole.normal);
    };
    let line = middle - camera.position;
    let d2 = line.length_squared();
    let direction = line / d2.sqrt();
    let shape = &scene.surfaces[id as usize].shape;
    let point = shape.at_position(on_wall(scene, whole, middle));
    let cosines = camera.view.normal().dot(direction) * whole.normal.dot(direction);
    let etendue = camera.aperture_area * cosines.abs() / d2 * area;
    reflecting(scene, id as usize, &point, direction, etendue)
}

/// Where the camera sees the wall behind a point of the facet about `whole`: there where the wall
/// is flat.
pub(super) fn on_wall(scene: &Scene, whole: &WallPoint, at: DVec3) -> DVec3 {
    let shape = whole.surface.map(|id| &scene.surfaces[id as usize].shape);
    let Some(shape @ Shape::Sphere(_)) = shape else {
        return at;
    };
    let camera = scene.camera.position;
    let ray = Ray::new(camera, (at - camera).normalize_or_zero());
    match shape.intersect(&ray, false) {
        Some(met) => shape.at_intersection(&ray, met).position,
        None => shape.at_position(at).position,
    }
}

/// The wall that the beam meets which is aimed at `offset` from the target of spot `spot`, lit by
/// `share` of the laser's power: not always the wall of the target. Its weight is 0 where the beam
/// misses all walls.
pub(super) fn lit(scene: &Scene, spot: usize, offset: DVec3, share: f64) -> WallPoint {
    let laser = &scene.laser;
    let target = &laser.spots[spot].target;
    let id = laser.spots[spot].surface as usize;
    let aim = target.position + offset;
    let direction = (aim - laser.position).normalize_or_zero();
    if offset == DVec3::ZERO {
        return reflecting(scene, id, target, direction, share * laser.power);
    }
    met(scene, (laser.position, direction), share * laser.power)
        .unwrap_or_else(|| WallPoint::nowhere(aim, target.normal))
}

/// A wall point of surface `id` met along `direction`, with `received` W or length² sr; nothing on
/// the back.
fn reflecting(
    scene: &Scene,
    id: usize,
    point: &Interaction,
    direction: DVec3,
    received: f64,
) -> WallPoint {
    if point.normal.dot(direction) >= 0.0 {
        return WallPoint::nowhere(point.position, point.normal);
    }
    let surface = &scene.surfaces[id];
    let albedo = surface.albedo.albedo(point.uv);
    WallPoint {
        position: point.position,
        normal: point.normal,
        weight: received,
        reflection: if surface.is_lambertian() {
            Reflection::Constant(albedo * FRAC_1_PI)
        } else {
            Reflection::Directed {
                surface: id,
                albedo,
                device: -direction,
            }
        },
        surface: Some(id as ShapeId),
    }
}
