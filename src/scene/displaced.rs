//! Scenes whose geometry differs from that of a given one by some [`Parameter`]s, and how
//! everything moves with each of them.
//!
//! Surfaces that several parameters move go through all motions, the last one first: x → M₁M₂…x. So
//! per unit of θ_k they move by the twist of M_k, carried along by M₁…M_{k−1}: ẋ = v + ω × x. Spots
//! turn and grow about their mean, then they shift. Spots and view stay at their (x, y) where the
//! wall moves, as in a scene file.

mod reflection;
mod velocity;
mod written;

use glam::DAffine3;

use super::body::rotation;
use super::error::{Fault, keys};
use super::parameter::{Kind, Motion, Parameter};
use super::surface::bvh;
use super::{Role, Scene, SceneError, laser, parse};
use crate::geometry::DVec3;
pub use velocity::{MaterialRate, Twist, Velocity};

/// What parameters do to a scene.
struct Displacement {
    surfaces: Vec<DAffine3>,
    spots: Vec<[f64; 2]>,
    /// x and y of the view, lower and upper ends.
    view: [[f64; 2]; 2],
    camera: DVec3,
    laser: DVec3,
}

const PERCENT: f64 = 0.01;

/// Angle and growth of the spots' layout.
struct Layouts {
    mean: [f64; 2],
    angle: f64,
    scale: f64,
}

impl Layouts {
    fn new(scene: &Scene, parameters: &[Parameter], values: &[f64]) -> Self {
        let sum = |kind: &Kind| {
            let each = parameters.iter().zip(values);
            each.filter(|(p, _)| p.kind == *kind)
                .map(|(_, x)| x)
                .sum::<f64>()
        };
        let spots = &scene.laser.spots;
        let mean = |of: fn(DVec3) -> f64| {
            spots.iter().map(|s| of(s.target.position)).sum::<f64>() / spots.len() as f64
        };
        Self {
            mean: [mean(|p| p.x), mean(|p| p.y)],
            angle: sum(&Kind::SpotsAngle).to_radians(),
            scale: 1.0 + 0.01 * sum(&Kind::SpotsScale),
        }
    }

    /// Where the spot from (x, y) is, less the mean.
    fn turned(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let (sin, cos) = libm::sincos(self.angle);
        let [x, y] = [x - self.mean[0], y - self.mean[1]];
        [cos * x - sin * y, sin * x + cos * y].map(|c| c * self.scale)
    }
}

/// exp of `value` times a motion.
fn motion(of: &Motion, value: f64) -> DAffine3 {
    match of {
        Motion::Along(axis) => DAffine3::from_translation(*axis * value),
        Motion::About { point, axis } => {
            DAffine3::from_translation(*point)
                * DAffine3::from_quat(rotation(*axis, value))
                * DAffine3::from_translation(-*point)
        }
    }
}

/// The velocity of a motion, carried along by `before`.
fn twist(of: &Motion, before: &DAffine3) -> Twist {
    match of {
        Motion::Along(axis) => Twist::along(before.transform_vector3(*axis)),
        Motion::About { point, axis } => Twist::about(
            before.transform_point3(*point),
            before.transform_vector3(*axis),
        ),
    }
}

impl Scene {
    /// A point and the direction of the line in which the planes of the first hidden surface and of
    /// the wall meet; none where they are parallel.
    pub(crate) fn hinge(&self) -> Option<(DVec3, DVec3)> {
        let (_, hidden) = self.hidden().next()?;
        let (_, wall) = self.relays().next()?;
        let (a, b) = (hidden.shape.at([0.5, 0.5]), wall.shape.at([0.5, 0.5]));
        let axis = a.normal.cross(b.normal);
        let square = axis.length_squared();
        if square < 1e-12 {
            return None;
        }
        let (da, db) = (a.normal.dot(a.position), b.normal.dot(b.position));
        let point = (b.normal.cross(axis) * da + axis.cross(a.normal) * db) / square;
        Some((point, axis.normalize()))
    }

    /// The same scene with these parameters at `values`, in the order of [`Parameter::unit`]'s
    /// units; text and hash stay the original's.
    ///
    /// # Errors
    /// [`SceneError`] where a surface has no proper shape then, or a material none of its numbers
    /// within their range, spots have no size, or a spot or the view leaves the wall.
    pub fn displaced(&self, parameters: &[Parameter], values: &[f64]) -> Result<Self, SceneError> {
        let to = self.displacement(parameters, values);
        let moved = || -> Result<Self, Fault> {
            let mut scene = self.clone();
            let concerns = |role| {
                let each = scene.surfaces.iter().zip(&to.surfaces);
                each.into_iter()
                    .any(|(s, m)| s.role == role && *m != DAffine3::IDENTITY)
            };
            let wall_moves = concerns(Role::Relay);
            if to.surfaces.iter().any(|m| *m != DAffine3::IDENTITY) {
                for (surface, motion) in scene.surfaces.iter_mut().zip(&to.surfaces) {
                    surface.shape = surface.shape.moved(motion).ok_or_else(no_shape)?;
                }
                scene.bvh = bvh(&scene.surfaces)?;
                scene.laser.follow(&scene.surfaces);
            }
            self.reflect(&mut scene, parameters, values)?;
            if !scene.laser.is_shining() {
                let size = size_of_spots(parameters, values);
                scene.laser.profile = scene.laser.profile.grown(size).ok_or_else(no_size)?;
                scene.laser.position = to.laser;
                scene.laser.spots = laser::place(&to.spots, to.laser, &scene.surfaces)?;
            }
            scene.camera.position = to.camera;
            if wall_moves || to.view != ends(self) {
                let camera = scene.camera.with_view(to.view, &scene.surfaces)?;
                scene.camera = camera;
            }
            Ok(scene)
        };
        moved().map_err(|fault| parse::locate(&self.name, &self.text, fault))
    }

    /// How everything moves per unit of parameter `k`, where the parameters have these values.
    pub fn velocity(&self, parameters: &[Parameter], values: &[f64], k: usize) -> Velocity {
        let spots = &self.laser.spots;
        let mut found = Velocity::still(self);
        let unit = |axis: usize| [0, 1].map(|k| if k == axis { 1.0 } else { 0.0 });
        let layout = Layouts::new(self, parameters, values);
        let turned = || spots.iter().map(|s| layout.turned(xy(s.target.position)));
        match &parameters[k].kind {
            Kind::Surfaces(ids, own) => {
                for id in ids {
                    let before = self.motion_of(*id, &parameters[..k], values);
                    found.surfaces[*id] = twist(own, &before);
                }
            }
            Kind::SpotsShift(axis) => found.spots.fill(unit(*axis)),
            Kind::SpotsAngle => {
                let rate = |[x, y]: [f64; 2]| [-y, x].map(|c: f64| c.to_radians());
                found.spots = turned().map(rate).collect();
            }
            Kind::SpotsScale => {
                let rate = |at: [f64; 2]| at.map(|c| 0.01 * c / layout.scale);
                found.spots = turned().map(rate).collect();
            }
            Kind::Spot(l, axis) => found.spots[*l] = unit(*axis),
            Kind::ViewShift(axis) => found.view = unit(*axis),
            Kind::ViewScale => {
                let grown = |(p, x): (&Parameter, &f64)| match p.kind {
                    Kind::ViewScale => 0.01 * x,
                    _ => 0.0,
                };
                let scale = 1.0 + parameters.iter().zip(values).map(grown).sum::<f64>();
                found.view_growth = 0.01 / scale;
            }
            Kind::Camera(axis) => found.camera = *axis,
            Kind::Laser(axis) => found.laser = *axis,
            Kind::SpotDiameter => {
                found.spot_growth = PERCENT / size_of_spots(parameters, values);
            }
            Kind::Roughness(_) | Kind::Contrast(_) | Kind::Albedo(_) | Kind::Weight(..) => {
                found.materials = self.material_rates(parameters, values, k);
            }
        }
        found
    }

    /// All motions of surface `id`, one after the other.
    fn motion_of(&self, id: usize, parameters: &[Parameter], values: &[f64]) -> DAffine3 {
        let each = parameters.iter().zip(values);
        each.fold(DAffine3::IDENTITY, |all, (p, value)| match &p.kind {
            Kind::Surfaces(ids, own) if ids.contains(&id) && *value != 0.0 => {
                all * motion(own, *value)
            }
            _ => all,
        })
    }

    fn displacement(&self, parameters: &[Parameter], values: &[f64]) -> Displacement {
        let surfaces = 0..self.surfaces.len();
        let layout = Layouts::new(self, parameters, values);
        let is_turned = layout.angle != 0.0 || layout.scale != 1.0;
        let place = |s: &laser::Spot| {
            let own = xy(s.target.position);
            if is_turned {
                let [x, y] = layout.turned(own);
                [x + layout.mean[0], y + layout.mean[1]]
            } else {
                own
            }
        };
        let mut to = Displacement {
            surfaces: surfaces
                .map(|id| self.motion_of(id, parameters, values))
                .collect(),
            spots: self.laser.spots.iter().map(place).collect(),
            view: ends(self),
            camera: self.camera.position,
            laser: self.laser.position,
        };
        for (p, value) in parameters.iter().zip(values) {
            match &p.kind {
                Kind::SpotsShift(axis) => to.spots.iter_mut().for_each(|s| s[*axis] += value),
                Kind::Spot(l, axis) => to.spots[*l][*axis] += value,
                Kind::ViewShift(axis) => to.view[*axis].iter_mut().for_each(|x| *x += value),
                Kind::ViewScale => {
                    for [low, high] in &mut to.view {
                        let grown = 0.5 * (*high - *low) * 0.01 * value;
                        (*low, *high) = (*low - grown, *high + grown);
                    }
                }
                Kind::Camera(axis) => to.camera += *axis * *value,
                Kind::Laser(axis) => to.laser += *axis * *value,
                Kind::Surfaces(..) | Kind::SpotsAngle | Kind::SpotsScale => {}
                Kind::SpotDiameter
                | Kind::Roughness(_)
                | Kind::Contrast(_)
                | Kind::Albedo(_)
                | Kind::Weight(..) => {}
            }
        }
        to
    }
}

impl Kind {
    fn is_of_spots(&self) -> bool {
        matches!(
            self,
            Self::SpotsShift(_) | Self::SpotsAngle | Self::SpotsScale | Self::Spot(..)
        )
    }
}

fn xy(p: DVec3) -> [f64; 2] {
    [p.x, p.y]
}

/// The ends of the view in x and y, as a scene file gives them.
fn ends(scene: &Scene) -> [[f64; 2]; 2] {
    let corners = scene.camera.view.corners();
    [[corners[0].x, corners[2].x], [corners[0].y, corners[2].y]]
}

/// How many times as wide the spots are.
fn size_of_spots(parameters: &[Parameter], values: &[f64]) -> f64 {
    let own = parameters.iter().zip(values);
    let own = own.filter(|(p, _)| p.is_spot_size());
    1.0 + PERCENT * own.map(|(_, x)| x).sum::<f64>()
}

fn no_size() -> Fault {
    Fault::new(
        keys!["laser", "spot_diameter"],
        "spots have no size there",
        "let them shrink by less than 100 %",
    )
}

fn no_shape() -> Fault {
    Fault::new(
        keys!["surface"],
        "a surface has no proper shape there",
        "move it by less",
    )
}
