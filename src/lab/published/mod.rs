//! The published study, item by item: computed again, and compared by stated criteria.
//!
//! The published simulation is [`Published`](crate::model::Published): its grids, spots, kernel and
//! measurement as its code computes them, not as its text tells. Its inversion is the Moore–Penrose
//! inverse cut by MATLAB's rule, [`Tolerance::Spacing`](crate::num::linalg::Tolerance::Spacing).
//! Every item says in its caption which kernel, layout, pixels, tolerance and normalisation it
//! uses; its verdict is a function of its [`Check`]s alone ([`Verdict::of`]).
#![doc = include_str!("ledger.md")]

mod case;
mod distance;
mod dual;
mod exact;
mod exact_geometry;
mod indicators;
mod inversion;
mod item;
#[cfg(test)]
mod ledger_tests;
mod moving_view;
mod noise;
mod outcome;
mod plan;
mod precision;
mod sheet;
mod spots;
mod substitution;
mod summary;
mod table1;
mod tables;
mod tasks;
mod traced;

pub use crate::lab::check::{Check, Verdict, Weight};
pub use item::{Item, UnknownItem};
pub use plan::ReproducePlan;
pub use summary::{ItemSummary, overview};
pub use tasks::{ReproduceTasks, reproduce};
