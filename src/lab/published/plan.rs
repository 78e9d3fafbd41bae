//! What is free in the items, and why an item is not computed.

use super::item::Item;
use crate::lab::ValidationError;
use crate::model::ModelError;
use crate::num::linalg::LinalgError;
use crate::num::multiprecision::TooFewDigits;
use crate::recovery::RecoveryError;
use crate::scene::SceneError;
use crate::transport::{RenderError, Stopped};

/// What is free in the items.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ReproducePlan {
    /// Items with more elements a side than this leave those curves out.
    pub most_elements: usize,
    /// Draws of the noise in Figs 22 to 24; of the moving view a quarter of them.
    pub seeds: u64,
    /// Seed of the first.
    pub first_seed: u64,
}

impl ReproducePlan {
    /// What results have to share to belong together, in words.
    pub fn settings(&self, item: Item) -> String {
        format!(
            "phicam {} reproduce {item}, up to {} elements a side, {} draws of noise from seed {}",
            env!("CARGO_PKG_VERSION"),
            self.most_elements,
            self.seeds,
            self.first_seed
        )
    }
}

/// Why an item was not computed.
#[derive(Debug, thiserror::Error)]
pub enum ReproduceError {
    /// A decomposition failed.
    #[error(transparent)]
    Linalg(#[from] LinalgError),
    /// A recovery failed.
    #[error(transparent)]
    Recovery(#[from] RecoveryError),
    /// The digits of multiple precision do not suffice.
    #[error(transparent)]
    Digits(#[from] TooFewDigits),
    /// A scene does not allow what the item needs.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A scene has no model.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// Traced photographs do not fit their model.
    #[error(transparent)]
    Validation(#[from] ValidationError),
    /// The light was not traced.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// It was stopped.
    #[error("{0}")]
    Stopped(#[from] Stopped),
}
