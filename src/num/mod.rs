//! Floor 0: numbers. Constants, random and low-discrepancy streams, warps, quadrature, statistics,
//! linear algebra, arithmetic beyond double precision, wide arithmetic.

pub mod control;
pub(crate) mod cosines;
#[doc(hidden)]
pub mod decimal;
#[doc(hidden)]
pub mod digits;
#[doc(hidden)]
pub mod lanes;
#[doc(hidden)]
pub mod lattice;
pub mod linalg;
#[doc(hidden)]
pub mod multiprecision;
pub mod named;
#[doc(hidden)]
pub mod poisson;
#[doc(hidden)]
pub mod quadratic;
pub mod quadrature;
pub(crate) mod repetition;
#[doc(hidden)]
pub mod search;
pub mod separable;
pub mod statistics;
pub mod stream;
#[doc(hidden)]
pub mod summation;
#[doc(hidden)]
pub mod tree;
pub mod units;
#[doc(hidden)]
pub mod warp;
