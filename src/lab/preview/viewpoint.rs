//! Where the viewer stands, and the ray through each place in the picture.

use crate::geometry::{DVec3, Ray};
use crate::transport::Stopped;

/// Largest number of pixels of a preview: 4096 × 4096.
const MOST_PIXELS: usize = 1 << 24;

/// Where the viewer stands, and what is in the middle of the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Viewpoint {
    /// The viewer's eye, in the scene's unit.
    pub from: DVec3,
    /// What is in the middle.
    pub to: DVec3,
    /// What points upwards in the picture, as far as it can.
    pub up: DVec3,
    /// Angle between the left and the right edge, degrees.
    pub field: f64,
}

/// Why there is no picture.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum PreviewError {
    /// A coordinate is not finite, or the two points coincide.
    #[error("the viewer at ({0}) cannot look at ({1}): give two different, finite points")]
    NoDirection(DVec3, DVec3),
    /// Up is along the line of sight, zero, or not finite.
    #[error(
        "({0}) cannot point up for a viewer who looks along ({1}): give a direction across the \
         line of sight"
    )]
    NoUp(DVec3, DVec3),
    /// Not an angle of view.
    #[error("a field of view of {0} degrees; give more than 0 and less than 180")]
    Field(f64),
    /// No pixels, or too many.
    #[error("a picture of {0} × {1} pixels; give 1 to 4096 a side")]
    Size(usize, usize),
    /// It was stopped.
    #[error("{0}")]
    Stopped(#[from] Stopped),
}

/// A viewpoint with its picture: a pinhole with square pixels. Places in the picture are in px from
/// its upper left corner, x to the right, y downwards.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lens {
    eye: DVec3,
    right: DVec3,
    up: DVec3,
    ahead: DVec3,
    size: [usize; 2],
    /// Pixels per unit of tangent.
    scale: f64,
}

impl Lens {
    pub(super) fn new(viewpoint: &Viewpoint, size: [usize; 2]) -> Result<Self, PreviewError> {
        let Viewpoint {
            from,
            to,
            up,
            field,
        } = *viewpoint;
        let pixels = size[0].checked_mul(size[1]);
        if !pixels.is_some_and(|n| (1..=MOST_PIXELS).contains(&n)) {
            return Err(PreviewError::Size(size[0], size[1]));
        }
        if !(field > 0.0 && field < 180.0) {
            return Err(PreviewError::Field(field));
        }
        let ahead = (to - from).try_normalize();
        let ahead = ahead.ok_or(PreviewError::NoDirection(from, to))?;
        let upright = up.try_normalize().map(|up| ahead.cross(up));
        let right = upright.filter(|r| r.length() > 1e-6);
        let right = right.ok_or(PreviewError::NoUp(up, ahead))?.normalize();
        Ok(Self {
            eye: from,
            right,
            up: right.cross(ahead),
            ahead,
            size,
            scale: 0.5 * size[0] as f64 / libm::tan(0.5 * field.to_radians()),
        })
    }

    /// Columns and rows.
    pub(super) fn size(&self) -> [usize; 2] {
        self.size
    }

    /// Unit vectors to the right, upwards in the picture, and ahead.
    pub(super) fn axes(&self) -> [DVec3; 3] {
        [self.right, self.up, self.ahead]
    }

    fn middle(&self) -> [f64; 2] {
        self.size.map(|n| 0.5 * n as f64)
    }

    /// The ray through a place in the picture.
    pub(super) fn ray(&self, [x, y]: [f64; 2]) -> Ray {
        let [cx, cy] = self.middle();
        let [a, b] = [(x - cx) / self.scale, (cy - y) / self.scale];
        let direction = self.ahead + self.right * a + self.up * b;
        Ray::new(self.eye, direction.normalize())
    }

    /// How far ahead of the eye a point is, measured along the line of sight.
    pub(super) fn depth(&self, point: DVec3) -> f64 {
        (point - self.eye).dot(self.ahead)
    }

    /// The place of a point ahead of the eye.
    pub(super) fn place(&self, point: DVec3) -> [f64; 2] {
        let [cx, cy] = self.middle();
        let (way, depth) = (point - self.eye, self.depth(point));
        [
            cx + self.scale * way.dot(self.right) / depth,
            cy - self.scale * way.dot(self.up) / depth,
        ]
    }
}
