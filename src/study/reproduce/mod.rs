//! The published study, item by item: computed again, and compared by stated criteria.
//!
//! The published simulation is [`Published`](crate::model::Published): its grids, spots, kernel and measurement as its code computes them, not as its text tells.
//! Its inversion is the Moore–Penrose inverse cut by MATLAB's rule, [`Tolerance::Spacing`](crate::num::linalg::Tolerance::Spacing). Every item says in its caption
//! which kernel, layout, pixels, tolerance and normalisation it uses; its verdict is a function of its [`Check`]s alone ([`Verdict::of`]).
#![doc = include_str!("ledger.md")]

mod contour;
mod distance;
mod dual;
mod exact;
mod exact_geometry;
mod figure;
mod indicators;
mod inversion;
mod item;
#[cfg(test)]
mod ledger;
mod moving_view;
mod noise;
mod photographs;
mod precision;
mod spots;
mod substitution;
mod table1;
mod tables;
mod tasks;
mod traced;
mod verdict;

use std::sync::atomic::{AtomicBool, Ordering};

use crate::model::ModelError;
use crate::num::linalg::LinalgError;
use crate::num::multiprecision::TooFewDigits;
use crate::recovery::RecoveryError;
use crate::scene::SceneError;
use crate::study::ValidationError;
use crate::study::task::whole;
use crate::transport::Control;

pub use figure::{
    Cell, Course, FigureAxis, FigureCurve, Gallery, Picture, Plot, Reproduction, Shades, Source,
};
pub use item::{Item, UnknownItem};
pub use tasks::ReproduceTasks;
pub use verdict::{Check, Verdict, Weight};

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
    /// What results have to share to be one another's, in words.
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
    /// It was stopped.
    #[error("stopped before the item was finished; run the same command again to go on")]
    Stopped,
}

/// Looks at a flag between two steps.
#[derive(Clone, Copy)]
struct Watch<'a>(&'a AtomicBool);

impl<'a> Watch<'a> {
    fn new(stop: &'a AtomicBool) -> Self {
        Self(stop)
    }

    fn go_on(self) -> Result<(), ReproduceError> {
        match self.0.load(Ordering::Relaxed) {
            true => Err(ReproduceError::Stopped),
            false => Ok(()),
        }
    }
}

/// Computes one item.
///
/// # Errors
/// [`ReproduceError`].
pub fn reproduce(
    item: Item,
    plan: &ReproducePlan,
    stop: &AtomicBool,
) -> Result<Reproduction, ReproduceError> {
    let control = Control {
        progress: &|_| (),
        stop,
    };
    let found = whole(&ReproduceTasks::new(*plan, vec![item]), control, &|_, _| ())?;
    let found = found.and_then(|items| items.into_iter().next());
    found.ok_or(ReproduceError::Stopped)
}

/// An item that is one task.
fn whole_item(
    item: Item,
    plan: &ReproducePlan,
    watch: Watch<'_>,
) -> Result<Reproduction, ReproduceError> {
    match item {
        Item::Table3 => Ok(tables::table(item, &tables::PRINTED[1])),
        Item::Table4 => Ok(tables::table(item, &tables::PRINTED[2])),
        Item::Fig15 => indicators::indicators(watch),
        Item::Fig22 => noise::figure(plan, watch),
        Item::Dual => dual::figure(plan, watch),
        _ => Ok(tables::table(item, &tables::PRINTED[0])),
    }
}
