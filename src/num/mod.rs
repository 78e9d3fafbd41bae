//! Floor 0: numbers. Random and low-discrepancy streams, warps, quadrature, statistics, linear algebra.

pub mod linalg;
pub mod quadratic;
pub mod quadrature;
pub mod statistics;
pub mod stream;
pub mod summation;
pub mod warp;
