//! Studies: each file or folder is one; [`registry`] lists those that have a command.

pub(super) mod brdf;
pub(super) mod budget;
pub(super) mod convergence;
pub(super) mod coverage;
pub(super) mod experiment;
pub(super) mod foot_on_wall;
pub(super) mod grey;
pub(super) mod indicator;
mod layout;
pub(super) mod limit;
pub(super) mod loss;
pub(super) mod noise;
mod occluder;
pub(super) mod power;
pub(super) mod registered;
pub(super) mod registry;
pub(super) mod sensitivity;
mod spots;
pub(super) mod subject;
mod sweep;
pub(super) mod tolerance;
pub(super) mod traced;
