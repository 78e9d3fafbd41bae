//! Photographs against the model: what counts as evidence, what is left of it, the verdict and the
//! parameters that would explain a misfit.

pub(super) mod agreement;
pub(super) mod derivatives;
pub(super) mod eliminated;
pub(super) mod evidence;
pub(super) mod gains;
pub(super) mod grounds;
pub(super) mod measured;
pub(super) mod misplaced;
mod other_light;
pub(super) mod over_view;
pub(super) mod residual;
pub(super) mod score;
pub(super) mod seldom;
mod shaded;
pub(super) mod unmodelled;
pub(super) mod validation;
