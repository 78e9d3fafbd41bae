//! The camera's view moving with the laser spot, against the view that stays.
//!
//! The published work has an older configuration in which spot and view shift together over the
//! wall, and a later one, used everywhere else in this crate, with a view that stays. The text at
//! hand gives no measures of the older one. The natural layout is taken: a view of the same size at
//! a constant offset from the spot, spots where the later configuration has them, as many
//! photographs and as many pixels in each. Several offsets are computed, so that the answer does
//! not depend on one, and a fixed view that covers as much of the wall, so that motion and coverage
//! can be told apart. Every photograph has a G23 of its own, and ρ is found by least squares over
//! all rows at once; of the fixed view by the same way.

mod checks;
mod figure;
mod layout;
mod modelled;
mod system;
#[cfg(test)]
mod tests;
mod traced;

pub(super) use figure::{figure, pieces};
pub(super) use modelled::Modelled;
pub(super) use traced::Seen;
