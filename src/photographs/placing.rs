//! Where the scene's view is in the photographs of a set.

use super::error::{PhotographError, refused};
use super::footprints::{Evenness, Footprints};
use super::mapping::{Fitted, Mapping, Mark};
use super::set::Set;
use crate::geometry::DVec3;
use crate::scene::Camera;

/// Part of a view's diagonal that a mark, or a spot's position, may lie off the wall.
pub(super) const OFF_PLANE: f64 = 0.01;

/// The place of the scene's pixels in the photographs.
pub(super) struct Placing {
    /// The marks, if there are any,
    pub marks: Vec<Mark>,
    /// and what they say.
    pub fitted: Option<Fitted>,
    pub mapping: Mapping,
    pub evenness: Evenness,
    pub footprints: Footprints,
}

impl Placing {
    /// By the set's marks, its crop, or the whole photograph of `size`.
    pub(super) fn new(
        set: &Set,
        camera: &Camera,
        size: [usize; 2],
    ) -> Result<Self, PhotographError> {
        let marks = marks(set, camera)?;
        let fitted = match &marks[..] {
            [] => None,
            marks => Some(Mapping::from_marks(marks, set.camera)?),
        };
        let mapping = match (&fitted, set.crop) {
            (Some(fitted), _) => fitted.mapping,
            (None, Some(c)) => Mapping::upright([c.x, c.y], [c.width, c.height]),
            (None, None) => Mapping::upright([0.0; 2], size.map(|n| n as f64)),
        };
        if set.watts.is_some() && mapping.pose().is_some_and(|pose| pose.cosine <= 0.0) {
            return Err(refused(
                "the camera's axis never meets the wall, so that no opening parallel to the wall collects what its lens does, \
                 and `watts` has no meaning",
                "check `camera` and the marks, or leave `watts` out and recover with --free-scale",
            ));
        }
        let evenness = match (&fitted, set.camera, &set.flat) {
            (None, _, None) => Evenness::Same,
            (Some(_), Some(_), None) => Evenness::ByLens,
            _ => Evenness::Even,
        };
        Ok(Self {
            footprints: Footprints::new(camera, &mapping, size, evenness)?,
            marks,
            fitted,
            mapping,
            evenness,
        })
    }
}

/// The set's marks in view coordinates.
fn marks(set: &Set, camera: &Camera) -> Result<Vec<Mark>, PhotographError> {
    let view = &camera.view;
    let normal = view.normal();
    let diagonal = (view.u() + view.v()).length();
    let mut marks = Vec::with_capacity(set.marks.len());
    for (k, mark) in set.marks.iter().enumerate() {
        let odd = || {
            refused(
                format!(
                    "the {}. of the marks, at {:?}, is no point of the wall",
                    k + 1,
                    mark.wall
                ),
                "give x and y, or x, y and z, of a point in the plane of the scene's view",
            )
        };
        if !mark.wall.iter().chain(&mark.pixel).all(|x| x.is_finite()) {
            return Err(odd());
        }
        let (x, y) = match mark.wall[..] {
            [x, y] | [x, y, _] => (x, y),
            _ => return Err(odd()),
        };
        // On the view's plane, straight above or below.
        let corner = view.corner();
        let z = corner.z - (normal.x * (x - corner.x) + normal.y * (y - corner.y)) / normal.z;
        if mark
            .wall
            .get(2)
            .is_some_and(|own| (own - z).abs() * normal.z.abs() > OFF_PLANE * diagonal)
        {
            return Err(odd());
        }
        marks.push(Mark {
            pixel: mark.pixel,
            wall: view.coordinates(DVec3::new(x, y, z)),
        });
    }
    Ok(marks)
}
