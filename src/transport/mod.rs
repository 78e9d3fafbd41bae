//! Floor 4: the tracer. Light transport from laser to camera by Monte Carlo, in absolute watts,
//! without knowing any model of it.
//!
//! Φcam[p, l] is the flux that pixel p receives when the laser lights spot l:
//!
//! ```text
//! Φ = Σ_n ∫ E(x₁) · [ Π_{k=1}^{n−2} f_r(x_k) G(x_k, x_{k+1}) ] · f_r(x_{n−1}) G(x_{n−1}, s) · Φlaser f_r(s) dx₁ … dx_{n−1} dP(s)
//! ```
//!
//! x₁ what the camera sees, s the point where the beam lands (dP its share of the power), G =
//! V·cosθ·cosθ′/d² with the visibility V, f_r = ρ/π, E the étendue per unit of footprint area, and
//! n the number of surfaces met. Paths start at the camera; at each vertex the spot is connected
//! explicitly (it is far too small to be hit), and the path goes on by sampling the hidden
//! surfaces' area or the material's lobe, weighted against each other by the density of their
//! mixture (the balance heuristic).
//!
//! A hidden surface that shines takes the place of the spots: s is a point of it, drawn by its
//! brightness, and M·x(s)/π·f(ω) ds stands for Φlaser f_r(s) dP(s), f its fall-off with direction.
//! Paths do not go on from it, for it reflects nothing.
//!
//! One file an estimator, each with its equation: `independent` (every entry from paths of its
//! own), `shared` (the paths of a pixel serve all spots), `factored` (points between the walls
//! serve all pixels and all spots, which makes Φcam a product of two matrices). `points` takes the
//! place of paths in the first two where a pixel is simple enough. They share `camera` (first
//! vertex), `path` (next vertex), `beam` and `spots` (connection with every lit point),
//! `light_path` and `light_points` (points drawn from a lit point where surfaces come close to
//! it), `vertex` (geometry term, BRDF), `visibility`, `area` and `strata` (points by area),
//! `parts` (what that is divided into), `steps` (distributions over them), `guide` (which parts
//! matter to a pixel and a spot), and what is computed of them once, in `context`.
//! `tally` adds up blocks, `spread` and `tails` judge their standard error, `reach` says which
//! entries may be lit, `render` traces them.
//!
//! No ray is cast where nothing can stand in the way; what can is computed once per pair of
//! regions, conservatively ([`Region`](crate::geometry::Region)).
//!
//! This floor never sees `model`: agreement between the two is evidence.

mod area;
mod beam;
mod camera;
mod context;
mod direct_light;
mod factored;
mod glossy;
mod guide;
mod independent;
mod light_path;
mod light_points;
mod parts;
mod path;
mod plan;
mod points;
mod reach;
mod render;
mod shared;
mod spots;
mod spread;
mod steps;
mod strata;
pub mod tails;
mod tally;
mod vertex;
mod visibility;

pub use crate::num::control::{Control, Stopped};
pub use crate::num::stream::Sampling;
pub use plan::{Budget, Estimator, Plan, RenderError, SamplesError, Traced};
pub use render::{NUMERICS, block_size, render, trace, unsupported_surface};
pub use tally::{Moments, Tally, TallyError};
