//! What predicts how well the published inversion works?
//!
//! Its noiseless result is exactly (C diag ρ)·P ⊘ C averaged over the pixels, P = G12·G12⁺: the
//! object projected on what the spots can tell apart. So the share ‖P c‖²/‖c‖² of the object's
//! zero-mean pattern c that the projector keeps should predict the raw MTF. The published study
//! looked at the condition number and at the smallest eigenvalue of G12·G12ᵀ; here all of them
//! stand beside each other over one sweep.
//!
//! Under noise a linear method with its parameter held keeps a signal and adds a variance, both
//! known without a single draw: mean and covariance of the recovered values give mean and spread of
//! the MTF (see [`Comparison`]), which draws are then compared with.

mod configuration;
mod describe;
mod noisy;
mod plan;
mod projection;
mod ratio;
mod study;
mod summary;
mod sweep;
mod tasks;

pub use configuration::Configuration;
pub use noisy::{Comparison, NoisyOutcome, NoisyPoint};
pub use plan::IndicatorPlan;
pub use study::Indicator;
pub use summary::{Coefficients, NoisySummary};
pub use sweep::Layout;
pub use tasks::IndicatorTasks;
pub(in crate::lab) use tasks::STUDY;

#[cfg(test)]
mod tests;
