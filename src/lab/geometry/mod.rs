//! The geometry found from the photographs, with its errors.

pub(super) mod calibrate;
pub(super) mod common;
pub(super) mod light_left_out;
pub(super) mod located;
pub(super) mod normal;
pub(super) mod resized;
