//! Floor 0: numbers. Constants, random and low-discrepancy streams, warps, quadrature, statistics, linear algebra,
//! arithmetic beyond double precision, wide arithmetic.

pub mod lanes;
pub mod linalg;
pub mod multiprecision;
pub mod poisson;
pub mod quadratic;
pub mod quadrature;
pub mod statistics;
pub mod stream;
pub mod summation;
pub mod tree;
pub mod units;
pub mod warp;
