//! phicam: a physically based Monte Carlo renderer for indirect photography and the laboratory around it.

pub mod cli;
pub mod film;
pub mod geometry;
pub mod matrix;
pub mod metrics;
pub mod model;
pub mod num;
pub mod recovery;
pub mod report;
pub mod scene;
pub mod store;
pub mod study;
pub mod transport;
