//! Why an entry of Φ is left out: the codes of `left_out.npy`, which add up.

use serde::Serialize;

use crate::geometry::DVec3;
use crate::matrix::Matrix;
use crate::scene::Camera;

/// A photograph's pixel in the footprint was saturated.
pub const SATURATED: u8 = 1;
/// One of them is dead, or the flat field has no light there.
pub const DEAD: u8 = 2;
/// The footprint lies within the halo of the spot.
pub const HALO: u8 = 4;
/// The footprint is not wholly in the photograph.
pub const OUTSIDE: u8 = 8;
/// There is no photograph of the spot.
pub const MISSING: u8 = 16;

/// How many entries are left out, and why; an entry may have several reasons.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct LeftOut {
    /// Pixels × spots.
    pub entries: usize,
    /// Entries with any reason.
    pub left_out: usize,
    /// Entries with [`SATURATED`].
    pub saturated: usize,
    /// Entries with [`DEAD`].
    pub dead: usize,
    /// Entries with [`HALO`].
    pub halo: usize,
    /// Entries with [`OUTSIDE`].
    pub outside: usize,
    /// Entries with [`MISSING`].
    pub missing: usize,
}

impl LeftOut {
    /// Reasons with the entries that have them.
    pub fn reasons(&self) -> [(&'static str, usize); 5] {
        [
            ("saturated", self.saturated),
            ("dead", self.dead),
            ("halo", self.halo),
            ("outside", self.outside),
            ("no photograph", self.missing),
        ]
    }

    /// Of a matrix of codes.
    pub(super) fn of(codes: &Matrix) -> Self {
        let with = |code: u8| codes.iter().filter(|c| **c as u8 & code != 0).count();
        Self {
            entries: codes.len(),
            left_out: codes.iter().filter(|c| **c != 0.0).count(),
            saturated: with(SATURATED),
            dead: with(DEAD),
            halo: with(HALO),
            outside: with(OUTSIDE),
            missing: with(MISSING),
        }
    }
}

/// Whether a part of the footprint of `pixel` is nearer to `spot` than `radius`.
pub(super) fn in_halo(camera: &Camera, pixel: usize, spot: DVec3, radius: f64) -> bool {
    let footprint = camera.footprint(pixel);
    let to = spot - footprint.corner;
    let along = |edge: DVec3| (to.dot(edge) / edge.length_squared()).clamp(0.0, 1.0);
    let nearest = footprint.at([along(footprint.u), along(footprint.v)]);
    (spot - nearest).length() < radius
}
