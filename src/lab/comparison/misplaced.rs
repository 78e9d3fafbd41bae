//! Scenes in which one thing is not where it is thought to be, or spreads light in another way.

use glam::{DAffine3, DQuat};

use crate::geometry::{DVec3, Shape};
use crate::num::stream::{Key, Sampling, Stream};
use crate::num::warp;
use crate::scene::{Parameter, Scene, Twist, Velocity};

/// Sine of the angle below which a shift stays within a plane.
const WITHIN: f64 = 1e-9;
/// Sine of the angle below which a camera stands straight before the middle of its view.
const STRAIGHT: f64 = 1e-6;

/// What a size is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::lab) enum Size {
    /// A length in the scene's unit.
    Length,
    /// The root mean square of lengths by chance.
    Random,
    /// A length that cannot be negative, 0 being a limit that is not reached.
    Positive,
    /// An angle, degrees.
    Angle,
    /// Percent.
    Percent,
}

impl Size {
    /// Its unit.
    pub(in crate::lab) fn unit(self, scene: &Scene) -> &'static str {
        match self {
            Self::Length | Self::Random | Self::Positive => scene.unit.symbol(),
            Self::Angle => "deg",
            Self::Percent => "%",
        }
    }
}

/// How something is misplaced by a size: lengths along unit vectors, degrees, percent.
#[derive(Clone, Copy, Debug)]
enum Motion {
    /// The hidden surfaces turn around an axis: a point of it and its direction.
    Turn(fn(&Scene) -> Option<[DVec3; 2]>),
    /// The hidden surfaces move along this.
    Shift(fn(&Scene) -> Option<DVec3>),
    /// All spots move along x and y by so much of the size.
    Spots([f64; 2]),
    /// Every spot by itself, by the size in the root mean square.
    EachSpot,
    /// The view moves along x and y by so much of the size.
    View([f64; 2]),
    /// The view grows about its middle.
    ViewScale,
    /// The camera moves along this,
    Camera(fn(&Scene) -> DVec3),
    /// and the laser with it.
    Devices(fn(&Scene) -> DVec3),
    /// The walls, flat and looking upwards, bend.
    Bend,
    /// The [`Parameter`] of this name, of scenes that have it.
    Number(&'static str),
}

/// Something that is assumed wrongly.
#[derive(Debug)]
pub(in crate::lab) struct Misplaced {
    pub(in crate::lab) name: &'static str,
    /// What its sizes are.
    pub(in crate::lab) size: Size,
    /// Its name for one spot, where every spot has its own.
    pub(super) each_spot: Option<&'static str>,
    motion: Motion,
}

const fn sized(name: &'static str, size: Size, motion: Motion) -> Misplaced {
    Misplaced {
        name,
        size,
        each_spot: None,
        motion,
    }
}

const fn length(name: &'static str, motion: Motion) -> Misplaced {
    sized(name, Size::Length, motion)
}

/// Everything that is tried.
pub(in crate::lab) const ALL: [Misplaced; 18] = [
    sized("hinge angle", Size::Angle, Motion::Turn(hinge)),
    sized("yaw of S2", Size::Angle, Motion::Number("hidden.yaw")),
    length(
        "S2 along its normal",
        Motion::Shift(|scene| Some(first_hidden(scene)?.at([0.5; 2]).normal)),
    ),
    length("S2 along u", Motion::Shift(along_u)),
    length(
        "S2 along v",
        Motion::Shift(|scene| side(scene, [[0.5, 0.0], [0.5, 1.0]])),
    ),
    Misplaced {
        each_spot: Some("one spot alone, x"),
        ..length("all spots, x", Motion::Spots([1.0, 0.0]))
    },
    Misplaced {
        each_spot: Some("one spot alone, y"),
        ..length("all spots, y", Motion::Spots([0.0, 1.0]))
    },
    sized("each spot, random (rms)", Size::Random, Motion::EachSpot),
    length("view, x", Motion::View([1.0, 0.0])),
    length("view, y", Motion::View([0.0, 1.0])),
    length(
        "camera and laser, off the wall",
        Motion::Devices(|scene| scene.camera.view.normal()),
    ),
    length("camera, along its sight", Motion::Camera(sight)),
    length("camera, across its sight", Motion::Camera(across)),
    sized("wall bent (sagitta)", Size::Positive, Motion::Bend),
    sized("scale of the view", Size::Percent, Motion::ViewScale),
    number("diameter of the spots", "laser.spot_diameter"),
    number("roughness of the wall", "wall.roughness"),
    number("n − 1 of the wall's coat", "wall.ior"),
];

const fn number(name: &'static str, of: &'static str) -> Misplaced {
    sized(name, Size::Percent, Motion::Number(of))
}

impl Misplaced {
    /// The scene with this misplaced by a size; `None` where the scene does not allow it.
    pub(in crate::lab) fn apply(&self, scene: &Scene, size: f64) -> Option<Scene> {
        let moved = |motion: DAffine3| scene.with_moved_hidden(&motion).ok();
        match self.motion {
            Motion::Turn(about) => {
                let [point, axis] = about(scene)?;
                let turn = DQuat::from_axis_angle(axis, size.to_radians());
                moved(
                    DAffine3::from_translation(point)
                        * DAffine3::from_quat(turn)
                        * DAffine3::from_translation(-point),
                )
            }
            Motion::Shift(along) => moved(DAffine3::from_translation(along(scene)? * size)),
            Motion::Spots(by) => scene.with_shifted_spots(by.map(|x| x * size)).ok(),
            Motion::EachSpot => scattered(scene, size),
            Motion::View(by) => Some(scene.with_shifted_view(by.map(|x| x * size))),
            Motion::ViewScale => Some(scene.with_scaled_view(1.0 + 0.01 * size)),
            Motion::Camera(along) => Some(scene.with_moved_camera(along(scene) * size)),
            Motion::Devices(along) => {
                let by = along(scene) * size;
                let mut moved = scene.with_moved_camera(by);
                moved.laser.position += by;
                Some(moved)
            }
            Motion::Bend => bent(scene, size),
            Motion::Number(name) => {
                let own = Parameter::named(scene, name).ok()?;
                scene.displaced(&own, &[size]).ok()
            }
        }
    }

    /// Whether the scene has such a thing at all.
    pub(in crate::lab) fn is_in(&self, scene: &Scene) -> bool {
        match self.motion {
            Motion::Number(name) => Parameter::named(scene, name).is_ok(),
            _ => true,
        }
    }

    /// Whether this only moves flat hidden surfaces within their own planes: then it is where on
    /// them the picture lies.
    pub(in crate::lab) fn is_of_the_picture(&self, scene: &Scene) -> bool {
        let Motion::Shift(along) = self.motion else {
            return false;
        };
        along(scene).is_some_and(|along| {
            let mut hidden = scene.hidden().map(|(_, s)| &s.shape);
            hidden.all(|s| s.is_flat() && s.at([0.5; 2]).normal.dot(along).abs() < WITHIN)
        })
    }

    /// How everything moves per unit of its size; none where the scene does not allow it, and of
    /// what bends or is by chance.
    pub(in crate::lab) fn velocity(&self, scene: &Scene) -> Option<Velocity> {
        let mut found = Velocity::still(scene);
        match self.motion {
            Motion::Turn(about) => {
                let [point, axis] = about(scene)?;
                carry_hidden(&mut found, scene, Twist::about(point, axis));
            }
            Motion::Shift(along) => carry_hidden(&mut found, scene, Twist::along(along(scene)?)),
            Motion::Spots(by) => found.spots.fill(by),
            Motion::View(by) => found.view = by,
            Motion::ViewScale => found.view_growth = 0.01,
            Motion::Camera(along) => found.camera = along(scene),
            Motion::Devices(along) => {
                found.camera = along(scene);
                found.laser = found.camera;
            }
            Motion::Number(name) => {
                let own = Parameter::named(scene, name).ok()?;
                return Some(scene.velocity(&own, &[0.0], 0));
            }
            Motion::EachSpot | Motion::Bend => return None,
        }
        Some(found)
    }
}

fn carry_hidden(velocity: &mut Velocity, scene: &Scene, twist: Twist) {
    for (id, _) in scene.hidden() {
        velocity.surfaces[id] = twist;
    }
}

fn first_hidden(scene: &Scene) -> Option<&Shape> {
    scene.hidden().next().map(|(_, surface)| &surface.shape)
}

fn hinge(scene: &Scene) -> Option<[DVec3; 2]> {
    scene.hinge().map(|(point, axis)| [point, axis])
}

fn along_u(scene: &Scene) -> Option<DVec3> {
    side(scene, [[0.0, 0.5], [1.0, 0.5]])
}

/// The direction from one point of the first hidden surface to another.
fn side(scene: &Scene, [from, to]: [[f64; 2]; 2]) -> Option<DVec3> {
    let shape = first_hidden(scene)?;
    Some((shape.at(to).position - shape.at(from).position).normalize_or_zero())
}

/// The direction from the camera to the middle of its view.
fn sight(scene: &Scene) -> DVec3 {
    let middle = scene.camera.view.at([0.5; 2]).position;
    (middle - scene.camera.position).normalize_or_zero()
}

/// Across that, along the wall; of a camera straight before the middle along the view's columns.
fn across(scene: &Scene) -> DVec3 {
    let view = &scene.camera.view;
    let across = sight(scene).cross(view.normal());
    if across.length() > STRAIGHT {
        across.normalize()
    } else {
        let [from, to] = [0.0, 1.0].map(|u| view.at([u, 0.5]).position);
        (to - from).normalize_or_zero()
    }
}

/// The scene with every spot moved by itself, by `size` in the root mean square.
fn scattered(scene: &Scene, size: f64) -> Option<Scene> {
    let mut normal = normal(7);
    let spots = scene.laser.spots.iter().map(|s| {
        let [a, b] = normal();
        let r = size * std::f64::consts::FRAC_1_SQRT_2;
        [s.target.position.x + r * a, s.target.position.y + r * b]
    });
    scene.with_spots_at(&spots.collect::<Vec<_>>()).ok()
}

/// The scene with its walls bent, which must be flat and look upwards.
fn bent(scene: &Scene, size: f64) -> Option<Scene> {
    let upward = |shape: &Shape| matches!(shape, Shape::Parallelogram(p) if p.normal().z > 0.0);
    scene
        .relays()
        .all(|(_, wall)| upward(&wall.shape))
        .then(|| scene.with_bent_relay(size).ok())?
}

/// Pairs of independent standard normal numbers.
pub(in crate::lab) fn normal(seed: u64) -> impl FnMut() -> [f64; 2] {
    let key = Key {
        seed,
        spot: Key::ALL_SPOTS,
        pixel: u32::MAX,
        block: 1,
    };
    let mut stream = Stream::new(Sampling::Pcg, key);
    // The Gaussian beam's 1/e² radius is two standard deviations.
    move || {
        let [a, b, ..] = stream.next_four();
        warp::gaussian_spot([a, b]).map(|x| 2.0 * x)
    }
}
