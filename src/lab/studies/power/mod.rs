//! How small a model error does `validate` detect, and how often does it cry wolf?

mod describe;
mod results;
mod tasks;
mod verdicts;

pub use results::{Detection, Power, PowerPlan, PowerRow};
pub use tasks::PowerTasks;
pub(in crate::lab) use tasks::STUDY;
