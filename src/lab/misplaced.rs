//! Scenes in which one thing is not where it is thought to be.

use glam::{DAffine3, DQuat};

use crate::geometry::{DVec3, Shape};
use crate::num::stream::{Key, Sampling, Stream};
use crate::num::warp;
use crate::scene::Scene;

/// What a size is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Size {
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
    pub(super) fn unit(self, scene: &Scene) -> &'static str {
        match self {
            Self::Length | Self::Random | Self::Positive => scene.unit.symbol(),
            Self::Angle => "deg",
            Self::Percent => "%",
        }
    }
}

/// Something that is assumed wrongly.
#[derive(Debug)]
pub(super) struct Misplaced {
    pub(super) name: &'static str,
    /// What its sizes are.
    pub(super) size: Size,
    /// Its name for one spot, where every spot has its own.
    pub(super) each_spot: Option<&'static str>,
    /// The scene with this misplaced by a size; `None` where the scene does not allow it.
    pub(super) apply: fn(&Scene, f64) -> Option<Scene>,
}

const fn sized(
    name: &'static str,
    size: Size,
    apply: fn(&Scene, f64) -> Option<Scene>,
) -> Misplaced {
    Misplaced {
        name,
        size,
        each_spot: None,
        apply,
    }
}

const fn length(name: &'static str, apply: fn(&Scene, f64) -> Option<Scene>) -> Misplaced {
    sized(name, Size::Length, apply)
}

/// Everything that is tried.
pub(super) const ALL: [Misplaced; 15] = [
    sized("hinge angle", Size::Angle, turned),
    sized("yaw of S2", Size::Angle, yawed),
    length("S2 along its normal", |scene, size| {
        moved(scene, first_hidden(scene)?.at([0.5; 2]).normal * size)
    }),
    length("S2 along u", |scene, size| {
        moved(scene, side(scene, [[0.0, 0.5], [1.0, 0.5]])? * size)
    }),
    length("S2 along v", |scene, size| {
        moved(scene, side(scene, [[0.5, 0.0], [0.5, 1.0]])? * size)
    }),
    Misplaced {
        each_spot: Some("one spot alone, x"),
        ..length("all spots, x", |scene, size| {
            scene.with_shifted_spots([size, 0.0]).ok()
        })
    },
    Misplaced {
        each_spot: Some("one spot alone, y"),
        ..length("all spots, y", |scene, size| {
            scene.with_shifted_spots([0.0, size]).ok()
        })
    },
    sized("each spot, random (rms)", Size::Random, scattered),
    length("view, x", |scene, size| {
        Some(scene.with_shifted_view([size, 0.0]))
    }),
    length("view, y", |scene, size| {
        Some(scene.with_shifted_view([0.0, size]))
    }),
    length("camera and laser, off the wall", |scene, size| {
        let by = scene.camera.view.normal() * size;
        let mut moved = scene.with_moved_camera(by);
        moved.laser.position += by;
        Some(moved)
    }),
    length("camera, along its sight", |scene, size| {
        Some(scene.with_moved_camera(sight(scene) * size))
    }),
    length("camera, across its sight", |scene, size| {
        let across = sight(scene).cross(scene.camera.view.normal());
        Some(scene.with_moved_camera(across.normalize_or_zero() * size))
    }),
    sized("wall bent (sagitta)", Size::Positive, bent),
    sized("scale of the view", Size::Percent, |scene, size| {
        Some(scene.with_scaled_view(1.0 + 0.01 * size))
    }),
];

fn first_hidden(scene: &Scene) -> Option<&Shape> {
    scene.hidden().next().map(|(_, surface)| &surface.shape)
}

/// The scene with its hidden surfaces moved.
fn moved(scene: &Scene, by: DVec3) -> Option<Scene> {
    let motion = DAffine3::from_translation(by);
    scene.with_moved_hidden(&motion).ok()
}

/// The scene with its hidden surfaces turned around the hinge, by degrees.
fn turned(scene: &Scene, size: f64) -> Option<Scene> {
    let (point, axis) = scene.hinge()?;
    rotated(scene, point, axis, size)
}

/// The scene with its hidden surfaces turned, by degrees, around the axis through the middle of the
/// first that lies in its plane at right angles to the hinge (to u, where there is no hinge).
fn yawed(scene: &Scene, size: f64) -> Option<Scene> {
    let middle = first_hidden(scene)?.at([0.5; 2]);
    let along = match scene.hinge() {
        Some((_, axis)) => axis,
        None => side(scene, [[0.0, 0.5], [1.0, 0.5]])?,
    };
    let axis = middle.normal.cross(along).try_normalize()?;
    rotated(scene, middle.position, axis, size)
}

fn rotated(scene: &Scene, point: DVec3, axis: DVec3, degrees: f64) -> Option<Scene> {
    let motion = DAffine3::from_translation(point)
        * DAffine3::from_quat(DQuat::from_axis_angle(axis, degrees.to_radians()))
        * DAffine3::from_translation(-point);
    scene.with_moved_hidden(&motion).ok()
}

/// The direction from one point of the first hidden surface to another.
fn side(scene: &Scene, [from, to]: [[f64; 2]; 2]) -> Option<DVec3> {
    let shape = first_hidden(scene)?;
    Some((shape.at(to).position - shape.at(from).position).normalize_or_zero())
}

/// The direction from the camera to the first corner of its view.
fn sight(scene: &Scene) -> DVec3 {
    (scene.camera.view.corners()[0] - scene.camera.position).normalize_or_zero()
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
pub(super) fn normal(seed: u64) -> impl FnMut() -> [f64; 2] {
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
