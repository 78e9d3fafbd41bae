//! Arithmetic with as many digits as are asked for, and the one decomposition that is done with it.
//! The one door to the crate `dashu-float`.
//!
//! Numbers are binary, rounded to nearest even in each operation; they carry their precision, and
//! an operation has that of its more precise operand.

mod orthogonal;

use std::ops::{Add, Div, Mul, Sub};

use dashu_float::FBig;
use dashu_float::round::mode::HalfEven;

pub use orthogonal::{Inverse, TooFewDigits, inverse};

/// A real number.
#[derive(Clone, Debug, PartialEq, PartialOrd)]
pub struct Real(FBig<HalfEven, 2>);

/// Decimal digits to compute with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Digits(pub u32);

impl Digits {
    /// Bits that hold them, log₂ 10 each.
    fn bits(self) -> usize {
        self.0 as usize * 3322 / 1000 + 1
    }

    /// A whole number.
    pub fn whole(self, n: i64) -> Real {
        Real(FBig::from(n).with_precision(self.bits()).value())
    }

    /// `n`/`d`, which a decimal fraction is; `d` not 0.
    pub fn ratio(self, n: i64, d: i64) -> Real {
        &self.whole(n) / &self.whole(d)
    }
}

impl Real {
    /// √x of x ≥ 0.
    pub fn sqrt(&self) -> Self {
        Self(self.0.sqrt())
    }

    /// The nearest f64.
    pub fn to_f64(&self) -> f64 {
        self.0.to_f64().value()
    }
}

macro_rules! operator {
    ($name:ident, $function:ident) => {
        impl $name for &Real {
            type Output = Real;

            fn $function(self, other: &Real) -> Real {
                Real((&self.0).$function(&other.0))
            }
        }
    };
}

operator!(Add, add);
operator!(Sub, sub);
operator!(Mul, mul);
operator!(Div, div);

/// Σ a_k b_k over the shorter of both; `zero` gives the precision.
pub fn dot<'a>(
    zero: &Real,
    a: impl IntoIterator<Item = &'a Real>,
    b: impl IntoIterator<Item = &'a Real>,
) -> Real {
    a.into_iter()
        .zip(b)
        .fold(zero.clone(), |sum, (a, b)| &sum + &(a * b))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// √2 · √2 − 2 is of the size of the last digit, not of a double's; and (a/b)·b is a.
    #[test]
    fn digits_are_kept() {
        for digits in [40, 100] {
            let d = Digits(digits);
            let root = d.whole(2).sqrt();
            let error = (&(&root * &root) - &d.whole(2)).to_f64().abs();
            let last = libm::pow(10.0, -f64::from(digits));
            assert!(error < 10.0 * last, "{digits}: {error:e}");
            let back = &d.ratio(586_764, 100_000) * &d.whole(100_000);
            assert!((&back - &d.whole(586_764)).to_f64().abs() < 1e7 * last);
            assert_eq!(d.ratio(1, 3).to_f64(), 1.0 / 3.0);
        }
    }
}
