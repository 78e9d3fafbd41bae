//! Floor 4: the tracer. Light transport from laser to camera by Monte Carlo, in absolute watts, without knowing any
//! model of it.
//!
//! Φcam[p, l] is the flux that pixel p receives when the laser lights spot l:
//!
//! ```text
//! Φ = Σ_n ∫ E(x₁) · [ Π_{k=1}^{n−2} f_r(x_k) G(x_k, x_{k+1}) ] · f_r(x_{n−1}) G(x_{n−1}, s) · Φlaser f_r(s) dx₁ … dx_{n−1} dP(s)
//! ```
//!
//! x₁ what the camera sees, s the point where the beam lands (dP its share of the power), G = V·cosθ·cosθ′/d² with the visibility V, f_r = ρ/π, E the
//! étendue per unit of footprint area, and n the number of surfaces met. Paths start at the camera; at each vertex the spot
//! is connected explicitly (it is far too small to be hit), and the path goes on by sampling the hidden surfaces' area
//! or the cosine lobe, weighted against each other by the density of their mixture (the balance heuristic). Under
//! [`Estimator::Factored`] they are points that all pixels and all spots share instead, which makes Φcam a product of two matrices.
//!
//! No ray is cast where nothing can stand in the way; what can is worked out once per pair of regions, conservatively
//! ([`Region`](crate::geometry::Region)).
//!
//! This floor never sees `model`: agreement between the two is evidence.

mod beam;
mod direct;
mod eye;
mod factored;
mod form;
mod gloss;
mod hidden;
mod lamp;
mod layout;
mod lit;
mod lobe;
mod own;
mod packet;
mod pinhole;
mod pixel;
mod render;
mod setting;
mod shadow;
mod sight;
mod steps;
mod strata;
mod tally;
mod walk;

pub use render::{
    Budget, Control, Estimator, NUMERICS, Plan, Traced, block_size, obstacle, render, trace,
};
pub use tally::{Moments, Tally, TallyError};
