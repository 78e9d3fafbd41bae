//! Where laser and camera stand.

use super::FARTHEST;
use super::error::{Fault, keys};
use super::file::Triple;
use crate::geometry::{DAffine3, DVec3};

/// The position that the table of a device, `laser` or `camera`, gives it, along the scene's axes.
pub(super) fn position(device: &'static str, at: Triple, axes: &DAffine3) -> Result<DVec3, Fault> {
    if at.iter().all(|x| (-FARTHEST..=FARTHEST).contains(x)) {
        return Ok(axes.transform_point3(DVec3::from_array(at)));
    }
    let cause = format!("the {device}'s position is not finite, or farther than {FARTHEST:e}");
    let cure = "use finite numbers, or another unit of length";
    Err(Fault::new(keys![device, "position"], cause, cure))
}
