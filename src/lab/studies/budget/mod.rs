//! The error budget of the matrix model: what each idealisation costs on this bench.
//!
//! The chain from the model M₀ (elements, pixels and spots by their centres) to the light that a
//! run stores:
//!
//! ```text
//! M₀ →(elements)→ M₁ →(footprints)→ M₂ →(spots)→ M₃ →(occlusion)→ T₃ᵐ →(BRDF of S2)→ T₃ˡ →(other surfaces)→ T₃
//!    →(2, 4, 5, … bounces)→ T →(Monte Carlo)→ A →(f32)→ frames
//! ```
//!
//! The model knows the BRDF of the wall, but takes S2 for the Lambertian surface of equal white-sky
//! albedo ([`crate::scene::Surface::lambertian_equivalent`]). Where it is not Lambertian, T₃ᵐ is
//! traced with that one in its place, and what its own BRDF changes has a row.
//!
//! Each step is a matrix, computed by itself: M by quadrature, T from an ensemble of precise
//! renders (`shared`, Sobol', seeds of their own), A one render as `render` makes it
//! (`independent`). The parts add up to frames − M₀ by construction, except that T is estimated
//! twice, by A and by the ensemble, which share no random number and no estimator: whether the sum
//! closes is a test of both.

mod describe;
mod results;
mod sizes;
mod tasks;
mod terms;

pub use results::{BudgetPlan, Closure, ErrorBudget, Term};
pub use tasks::BudgetTasks;
pub(in crate::lab) use tasks::STUDY;
