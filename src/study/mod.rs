//! Floor 6: studies. Experiments that compose the floors below and return plain results.

mod results;

pub use results::{Agreement, Entry, RecoveredObject, RunResults, Settings};
