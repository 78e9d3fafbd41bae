//! Floor 3: frames, what the camera stores, one a laser spot.
//!
//! * [`frame`]: the [`Frame`], its channels and what it knows of its origin.
//! * [`exr`]: the frame as an OpenEXR file.
//! * [`mod@stack`]: the frames of a run back into the matrix Φcam.

pub mod exr;
pub mod frame;
pub mod stack;

pub use frame::{Channel, Frame, FrameMeta, RunMeta, frame_name};
pub use stack::{Stack, StackError, stack, stack_within};
