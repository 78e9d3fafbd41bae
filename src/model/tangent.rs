//! How the points of the model move, and G between them, per unit of a geometric parameter.
//!
//! > x = o + t (τ − o) on the wall's surface:  ẋ = ȯ + t (τ̇ − ȯ) + ṫ (τ − o),  n·(ẋ − v(x)) = 0
//! > G = a b/R⁴, a = r·n₁, b = −r·n₂, r = x₂ − x₁:  Ġ = (ȧ b + a ḃ)/R⁴ − 4 G r·ṙ/R²
//!
//! v(x) is the velocity of the surface, which gives ṫ; where a spot grows, τ moves away from its
//! middle, and as much light is aimed at it. Where f_r or the fall-off of a surface that
//! shines varies with direction, its rate is a central difference along these velocities, of
//! relative error 1e-10, and so is that by numbers of a wall's material. An albedo that varies over
//! the wall moves with the point.

mod view;

use std::f64::consts::PI;

use super::kernel::{HiddenPoint, Kernel};
use super::wall_point::{Reflection, WallPoint};
use crate::geometry::{DVec3, Facing, Shape};
use crate::scene::material::FallOff;
use crate::scene::{MaterialRate, Scene, Twist, Velocity};

pub(super) use view::ViewRate;

/// Step of a central difference, relative to distances and in radians.
const STEP: f64 = 1e-5;

/// Velocities of a wall point.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct WallRate<'a> {
    pub position: DVec3,
    normal: DVec3,
    /// Of the unit vector to the device.
    device: DVec3,
    /// Relative, of its weight.
    weight: f64,
    /// Of how its surface reflects.
    material: Option<&'a MaterialRate>,
}

/// Velocities of a hidden point, and ω of its surface.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct HiddenRate {
    pub position: DVec3,
    pub normal: DVec3,
    pub angular: DVec3,
}

impl HiddenRate {
    /// Of a point of a surface that moves by `twist`.
    pub(super) fn new(point: &HiddenPoint, twist: &Twist) -> Self {
        Self {
            position: twist.at(point.position),
            normal: twist.angular.cross(point.normal),
            angular: twist.angular,
        }
    }
}

/// ṅ at a point of a surface that moves by `twist` and on which the point moves by `rate`.
fn normal_rate(shape: &Shape, twist: &Twist, normal: DVec3, rate: DVec3) -> DVec3 {
    match shape {
        Shape::Sphere(s) => {
            let sign = match s.facing {
                Facing::Outside => 1.0,
                Facing::Inside => -1.0,
            };
            (rate - twist.at(s.centre)) * (sign / s.radius)
        }
        _ => twist.angular.cross(normal),
    }
}

/// The plane in which a device aims: its point `at`, and how both move.
#[derive(Clone, Copy, Debug)]
struct Aim {
    at: DVec3,
    at_rate: DVec3,
    normal: DVec3,
    normal_rate: DVec3,
}

impl Aim {
    /// Of a point of surface `id` that stays on it while its (x, y) move.
    fn new(
        scene: &Scene,
        velocity: &Velocity,
        id: usize,
        at: DVec3,
        normal: DVec3,
        [dx, dy]: [f64; 2],
    ) -> Self {
        let twist = &velocity.surfaces[id];
        let dz = (normal.dot(twist.at(at)) - normal.x * dx - normal.y * dy) / normal.z;
        let at_rate = DVec3::new(dx, dy, dz);
        Self {
            at,
            at_rate,
            normal,
            normal_rate: normal_rate(&scene.surfaces[id].shape, twist, normal, at_rate),
        }
    }

    /// Where the line from `device` to `x` meets the plane.
    fn target(&self, device: DVec3, x: DVec3) -> DVec3 {
        let along = self.normal.dot(self.at - device) / self.normal.dot(x - device);
        device + (x - device) * along
    }
}

/// How a wall point moves on its surface that is met from `device`, which moves by `device_rate`,
/// towards `target`, which moves by `target_rate`.
fn met<'a>(
    scene: &Scene,
    velocity: &'a Velocity,
    point: &WallPoint,
    [device, device_rate]: [DVec3; 2],
    [target, target_rate]: [DVec3; 2],
) -> WallRate<'a> {
    let Some(id) = point.surface.map(|id| id as usize) else {
        return WallRate::default();
    };
    let twist = &velocity.surfaces[id];
    let line = target - device;
    let t = (point.position - device).dot(line) / line.length_squared();
    let carried = device_rate + (target_rate - device_rate) * t;
    let slip = point.normal.dot(twist.at(point.position) - carried) / point.normal.dot(line);
    let position = carried + line * slip;
    let to_device = device - point.position;
    let length = to_device.length();
    let unit = to_device / length;
    let rate = device_rate - position;
    WallRate {
        position,
        normal: normal_rate(&scene.surfaces[id].shape, twist, point.normal, position),
        device: (rate - unit * unit.dot(rate)) / length,
        weight: 0.0,
        material: material_of(velocity, point),
    }
}

/// How the surface of a point reflects in another way.
fn material_of<'a>(velocity: &'a Velocity, point: &WallPoint) -> Option<&'a MaterialRate> {
    let own = |m: &&MaterialRate| Some(m.surface) == point.surface.map(|id| id as usize);
    velocity.materials.iter().find(own)
}

/// Of a point that spot `spot` lights. Where its profile turns with the wall, it turns as little as
/// it can, which is all that matters of a profile that is round.
pub(super) fn lit<'a>(
    scene: &Scene,
    velocity: &'a Velocity,
    spot: usize,
    point: &WallPoint,
) -> WallRate<'a> {
    let laser = &scene.laser;
    let own = &laser.spots[spot];
    let (at, normal) = (own.target.position, own.target.normal);
    let id = own.surface as usize;
    let aim = Aim::new(scene, velocity, id, at, normal, velocity.spots[spot]);
    let target = aim.target(laser.position, point.position);
    let turn = aim.normal.cross(aim.normal_rate);
    let away = target - aim.at;
    let target_rate = aim.at_rate + turn.cross(away) + away * velocity.spot_growth;
    let device = [laser.position, velocity.laser];
    met(scene, velocity, point, device, [target, target_rate])
}

/// The velocity of a point that spot `spot` lights against the wall that it lies on, as the laser
/// sees it on the plane of the spot: that of q at x = o + s (q − o), s = n·(x − o)/n·(q − o).
pub(super) fn against_wall(
    scene: &Scene,
    velocity: &Velocity,
    spot: usize,
    point: &WallPoint,
) -> DVec3 {
    let own = &scene.laser.spots[spot];
    let wall = &velocity.surfaces[point.surface.unwrap_or(own.surface) as usize];
    let moves = lit(scene, velocity, spot, point).position - wall.at(point.position);
    let [line, to] = [point.position, own.target.position].map(|p| p - scene.laser.position);
    let normal = own.target.normal;
    let away = normal.dot(line);
    (moves - line * (normal.dot(moves) / away)) * (normal.dot(to) / away)
}

impl WallPoint {
    /// d/dθ of [`WallPoint::towards`] a hidden point that moves, with the physical kernel.
    pub(super) fn towards_rate(
        &self,
        scene: &Scene,
        rate: &WallRate<'_>,
        (hidden, moves): (&HiddenPoint, &HiddenRate),
    ) -> f64 {
        let r = hidden.position - self.position;
        let (a, b) = (r.dot(self.normal), -r.dot(hidden.normal));
        if a <= 0.0 || b <= 0.0 {
            return 0.0;
        }
        let r_rate = moves.position - rate.position;
        let a_rate = r_rate.dot(self.normal) + r.dot(rate.normal);
        let b_rate = -r_rate.dot(hidden.normal) - r.dot(moves.normal);
        let (over, ab) = (1.0 / r.length_squared(), a * b);
        let cosines = a_rate * b + a * b_rate - 4.0 * ab * over * r.dot(r_rate);
        let moved = (cosines + ab * rate.weight) * over * over;
        let by_material = || {
            let (albedo, device) = match self.reflection {
                Reflection::Constant(f) => (f * PI, self.normal),
                Reflection::Directed { albedo, device, .. } => (albedo, device),
            };
            let own = |m: &MaterialRate| m.of(albedo, self.normal, device, r.normalize_or_zero());
            self.weight * rate.material.map_or(0.0, own)
        };
        if let (None, Reflection::Constant(f)) = (&hidden.fall_off, &self.reflection) {
            return self.weight * f * moved + by_material() * ab * over * over;
        }
        let g = Kernel::Physical.between(self.position, self.normal, hidden);
        if g == 0.0 {
            return 0.0;
        }
        // Not needed where a material alone changes.
        let f = match hidden.fall_off {
            None if moved == 0.0 => 0.0,
            _ => self.reflected(scene, hidden.position),
        };
        let fall = hidden
            .fall_off
            .as_ref()
            .map_or(1.0, |own| own.towards(hidden.normal, -r));
        let speed = r_rate.length() * over.sqrt()
            + rate.normal.length()
            + rate.device.length()
            + moves.angular.length();
        let step = STEP / speed;
        let difference = |of: &dyn Fn(f64) -> f64| {
            if speed == 0.0 {
                0.0
            } else {
                (of(step) - of(-step)) / (2.0 * step)
            }
        };
        let f_rate = match self.reflection {
            Reflection::Constant(_) => 0.0,
            Reflection::Directed {
                surface,
                albedo,
                device,
            } => {
                let surface = &scene.surfaces[surface];
                let at = |h: f64| {
                    let normal = (self.normal + rate.normal * h).normalize_or_zero();
                    let device = (device + rate.device * h).normalize_or_zero();
                    let to = (r + r_rate * h).normalize_or_zero();
                    surface.brdf(albedo, normal, device, to)
                };
                self.weight * difference(&at)
            }
        };
        let fall_rate = hidden.fall_off.map_or(0.0, |fall_off| {
            let at = |h: f64| {
                let turned = |v: DVec3| v + moves.angular.cross(v) * h;
                let moved = FallOff {
                    axes: fall_off.axes.map(turned),
                    ..fall_off
                };
                moved.towards(turned(hidden.normal), -(r + r_rate * h))
            };
            difference(&at) / fall
        });
        f * (moved * fall + g * fall_rate) + (f_rate + by_material()) * g
    }
}
