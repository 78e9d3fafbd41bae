//! The failed laboratory experiment, re-enacted: traced light, glare of the lens, a real sensor,
//! and every way of reading the photographs.
//!
//! The photographs of a scene are Φ\[p,l\] = Φ_object\[p,l\] + Φ_glare\[p,l\], exposed by a sensor.
//! Φ_object is traced, so no analysis is helped by a model that made its data. The glare is the
//! light that enters the lens straight from the laser spot, scattered over the image
//! ([`crate::sensor::glare`]); its strength is given as glare over signal, Σ Φ_glare/Σ Φ_object.

mod analysis;
mod describe;
mod limits;
mod results;
mod series;
mod tasks;

pub use results::{Experiment, ExperimentPlan, Reading, Setting, Threshold};
pub use tasks::ExperimentTasks;
pub(in crate::lab) use tasks::STUDY;
