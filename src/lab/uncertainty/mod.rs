//! What is known of the standard errors of photographs: how many replicates they come from, whether
//! entries share them, whether they follow the light.

pub(super) mod certainty;
pub(super) mod counted;
pub(super) mod light_law;
pub(super) mod noise_law;
pub(super) mod pooled;
pub(super) mod refined;
pub(super) mod smooth;
pub(super) mod smooth_noise;
pub(super) mod tails;
pub(super) mod unexplained;
pub(super) mod which_errors;
pub(super) mod with_light;
