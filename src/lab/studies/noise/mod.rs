//! How much noise does each recovery bear?
//!
//! The object is a checkerboard of albedo 0 and 1, and the scene's own picture where that is
//! another, Φcam that of the matrix model, elements, pixels and spots at their centres or
//! integrated over them as `recover` does it, and the recovery inverts this very model: what is
//! lost is lost to noise, and to what the method does even without it. The latter includes, of
//! methods that work pixel by pixel, that the integrated model is no product C·D, which most of
//! them do not bear. Each draw of the noise is recovered by every method.
//!
//! A method that is linear and unbiased keeps its mean raw MTF however loud the noise: what grows
//! is the spread. And a ratio whose denominator W + B comes near 0 has no mean. Both are why the
//! normalized MTF, which lies between −1 and 1, and the root mean square error stand beside it; see
//! [`Lost::Unknown`].
//!
//! Beside the error stands the bound of Cramér and Rao, √(tr CRB/r): what no unbiased recovery
//! undercuts. Methods that are told more than the photographs (bounds, two values) do; what bound
//! holds for them is not known, so the ratio of the error to this one is all that is given.

mod axis;
mod best;
mod bound;
mod curve;
mod describe;
mod ledger;
mod named_sensor;
mod options;
mod picture;
mod plan;
mod render;
mod stage;
mod study;
mod tasks;
mod trial;

pub use axis::{AxisLabel, NoiseAxis};
pub use best::Best;
pub use curve::{Held, LIMITS, Lost, NoiseCurve, Point, Reach};
pub use named_sensor::NamedSensor;
pub(in crate::lab) use options::STUDY;
pub use picture::Picture;
pub use plan::NoisePlan;
pub use render::RenderNoise;
pub use study::NoiseStudy;
pub use tasks::NoiseTasks;

#[cfg(test)]
mod tests;
