//! Scenes in which one thing is not where it is thought to be.

use glam::{DAffine3, DQuat};

use crate::geometry::{DVec3, Shape};
use crate::num::stream::{Key, Sampling, Stream};
use crate::num::warp;
use crate::scene::{Role, Scene, SceneError};

/// What is assumed wrongly.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Misplaced {
    HingeAngle,
    HiddenAlongNormal,
    HiddenAlongU,
    HiddenAlongV,
    SpotsX,
    SpotsY,
    SpotsRandom,
    ViewX,
    ViewY,
    CameraAlong,
    CameraAcross,
    WallBent,
}

impl Misplaced {
    pub(super) const ALL: [Self; 12] = [
        Self::HingeAngle,
        Self::HiddenAlongNormal,
        Self::HiddenAlongU,
        Self::HiddenAlongV,
        Self::SpotsX,
        Self::SpotsY,
        Self::SpotsRandom,
        Self::ViewX,
        Self::ViewY,
        Self::CameraAlong,
        Self::CameraAcross,
        Self::WallBent,
    ];

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::HingeAngle => "hinge angle",
            Self::HiddenAlongNormal => "S2 along its normal",
            Self::HiddenAlongU => "S2 along u",
            Self::HiddenAlongV => "S2 along v",
            Self::SpotsX => "all spots, x",
            Self::SpotsY => "all spots, y",
            Self::SpotsRandom => "each spot, random (rms)",
            Self::ViewX => "view, x",
            Self::ViewY => "view, y",
            Self::CameraAlong => "camera, along its sight",
            Self::CameraAcross => "camera, across its sight",
            Self::WallBent => "wall bent (sagitta)",
        }
    }

    /// The scene with this misplaced by `size` (degrees for the angle, else the scene's unit); `None` if the scene has no such
    /// thing.
    pub(super) fn apply(self, scene: &Scene, size: f64) -> Result<Option<Scene>, SceneError> {
        let Some((_, hidden)) = scene.hidden().next() else {
            return Ok(None);
        };
        let centre = hidden.shape.at([0.5, 0.5]);
        let along = |a: [f64; 2], b: [f64; 2]| {
            (hidden.shape.at(b).position - hidden.shape.at(a).position).normalize_or_zero()
        };
        let moved = |by: DVec3| {
            scene
                .with_moved_hidden(&DAffine3::from_translation(by * size))
                .map(Some)
        };
        let sight = (scene.camera.view.corners()[0] - scene.camera.position).normalize_or_zero();
        match self {
            Self::HingeAngle => match hinge(scene) {
                None => Ok(None),
                Some((point, axis)) => {
                    let turn = DQuat::from_axis_angle(axis, size.to_radians());
                    let motion = DAffine3::from_translation(point)
                        * DAffine3::from_quat(turn)
                        * DAffine3::from_translation(-point);
                    scene.with_moved_hidden(&motion).map(Some)
                }
            },
            Self::HiddenAlongNormal => moved(centre.normal),
            Self::HiddenAlongU => moved(along([0.0, 0.5], [1.0, 0.5])),
            Self::HiddenAlongV => moved(along([0.5, 0.0], [0.5, 1.0])),
            Self::SpotsX => scene.with_shifted_spots([size, 0.0]).map(Some),
            Self::SpotsY => scene.with_shifted_spots([0.0, size]).map(Some),
            Self::SpotsRandom => {
                let mut normal = normal(7);
                let places: Vec<[f64; 2]> = scene
                    .laser
                    .spots
                    .iter()
                    .map(|s| {
                        let [a, b] = normal();
                        let r = size * std::f64::consts::FRAC_1_SQRT_2;
                        [s.target.position.x + r * a, s.target.position.y + r * b]
                    })
                    .collect();
                scene.with_spots_at(&places).map(Some)
            }
            Self::ViewX => Ok(Some(scene.with_shifted_view([size, 0.0]))),
            Self::ViewY => Ok(Some(scene.with_shifted_view([0.0, size]))),
            Self::CameraAlong => Ok(Some(scene.with_moved_camera(sight * size))),
            Self::CameraAcross => {
                let across = sight.cross(scene.camera.view.normal()).normalize_or_zero();
                Ok(Some(scene.with_moved_camera(across * size)))
            }
            Self::WallBent => {
                let upward = scene.surfaces.iter().all(|s| {
                    s.role != Role::Relay
                        || matches!(&s.shape, Shape::Parallelogram(p) if p.normal().z > 0.0)
                });
                if upward {
                    scene.with_bent_relay(size).map(Some)
                } else {
                    Ok(None)
                }
            }
        }
    }
}

/// A point and the direction of the line in which the planes of the first hidden surface and of the wall meet.
pub(super) fn hinge(scene: &Scene) -> Option<(DVec3, DVec3)> {
    let (_, hidden) = scene.hidden().next()?;
    let wall = scene.surfaces.iter().find(|s| s.role == Role::Relay)?;
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
