//! How wrong may the assumed geometry be?
//!
//! The bench stands as the scene says; the model that inverts its photographs is of a bench that is
//! slightly off. Photographs are the converged three-bounce integral with relative normal noise;
//! the method is `joint`.

mod describe;
mod results;
mod tasks;

pub use results::{Misplacement, Sensitivity, Tolerance};
pub(in crate::lab) use tasks::STUDY;
pub use tasks::ToleranceTasks;
