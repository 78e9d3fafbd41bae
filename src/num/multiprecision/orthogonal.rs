//! The Moore–Penrose inverse of a matrix of full rank, by modified Gram–Schmidt.

use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;

use super::{Digits, Real, dot};

/// The digits do not suffice for the matrix.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "{digits} digits do not tell the columns of the matrix apart (smallest over largest diagonal entry of R is {ratio:.1e}); use more digits"
)]
pub struct TooFewDigits {
    /// The digits used.
    pub digits: u32,
    /// min |R_kk| / max |R_kk|.
    pub ratio: f64,
}

/// A⁺ of an m × n matrix A of full rank, as the factors of A = QR (m ≥ n) or Aᵀ = QR (m < n).
pub struct Inverse {
    /// Columns of Q.
    q: Vec<Vec<Real>>,
    /// Columns of R, the k-th of length k + 1.
    r: Vec<Vec<Real>>,
    shape: Shape,
    zero: Real,
    /// min |R_kk| / max |R_kk|: 10^−this digits are lost at most.
    pub ratio: f64,
}

#[derive(Clone, Copy, PartialEq)]
enum Shape {
    Tall,
    Wide,
}

/// Decomposes the matrix with the given rows.
///
/// Gram–Schmidt leaves QᵀQ = I up to 10^−digits/ratio, so the digits are enough where ratio is
/// above 10^(−digits/2): half of them are then left. `stop` is looked at before each column;
/// `Ok(None)` if it was set.
///
/// # Errors
/// [`TooFewDigits`].
pub fn inverse(
    digits: Digits,
    rows: &[Vec<Real>],
    stop: &AtomicBool,
) -> Result<Option<Inverse>, TooFewDigits> {
    let (m, n) = (rows.len(), rows.first().map_or(0, Vec::len));
    let (shape, mut q): (Shape, Vec<Vec<Real>>) = if m >= n {
        let column = |k: usize| rows.iter().map(|r| r[k].clone()).collect();
        (Shape::Tall, (0..n).map(column).collect())
    } else {
        (Shape::Wide, rows.to_vec())
    };
    let zero = digits.whole(0);
    let mut r: Vec<Vec<Real>> = vec![Vec::new(); q.len()];
    let least = libm::exp10(-0.5 * f64::from(digits.0));
    let (mut shortest, mut longest) = (f64::INFINITY, 0.0f64);
    for k in 0..q.len() {
        if stop.load(Ordering::Relaxed) {
            return Ok(None);
        }
        let (done, open) = q.split_at_mut(k + 1);
        let own = &mut done[k];
        let length = dot(&zero, &*own, &*own).sqrt();
        let size = length.to_f64();
        (shortest, longest) = (shortest.min(size), longest.max(size));
        if shortest <= least * longest {
            return Err(TooFewDigits {
                digits: digits.0,
                ratio: shortest / longest,
            });
        }
        for x in own.iter_mut() {
            *x = &*x / &length;
        }
        r[k].push(length);
        let (own, r) = (&*own, &mut r[k + 1..]);
        open.par_iter_mut().zip(r).for_each(|(other, r)| {
            let along = dot(&zero, own, &*other);
            for (x, q) in other.iter_mut().zip(own) {
                *x = &*x - &(&along * q);
            }
            r.push(along);
        });
    }
    Ok(Some(Inverse {
        q,
        r,
        shape,
        zero,
        ratio: shortest / longest,
    }))
}

impl Inverse {
    /// b·A⁺ for a row b of length n.
    pub fn left(&self, b: &[Real]) -> Vec<Real> {
        match self.shape {
            // A⁺ = R⁻¹Qᵀ: z R = b from the first column on, then z Qᵀ.
            Shape::Tall => {
                let mut z: Vec<Real> = Vec::with_capacity(b.len());
                for (b, column) in b.iter().zip(&self.r) {
                    let known = dot(&self.zero, &z, column);
                    z.push(&(b - &known) / &column[column.len() - 1]);
                }
                let rows = self.q.first().map_or(0, Vec::len);
                let entry = |j: usize| dot(&self.zero, &z, self.q.iter().map(|q| &q[j]));
                (0..rows).map(entry).collect()
            }
            // A⁺ = Q R⁻ᵀ: y = b Q, then R xᵀ = yᵀ from the last row up.
            Shape::Wide => {
                let mut x: Vec<Real> = self.q.iter().map(|q| dot(&self.zero, b, q)).collect();
                for k in (0..x.len()).rev() {
                    x[k] = &x[k] / &self.r[k][k];
                    let (above, own) = x.split_at_mut(k);
                    for (y, r) in above.iter_mut().zip(&self.r[k]) {
                        *y = &*y - &(&own[0] * r);
                    }
                }
                x
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Hilbert's matrix of 30 columns, condition about 1e44, tall and wide: b·A·A⁺ is b where A has
    /// full row rank, and b·A⁺·A is b where it has full column rank.
    #[test]
    fn hilberts_matrix_is_inverted() {
        let d = Digits(120);
        for (m, n) in [(30, 34), (34, 30), (30, 30)] {
            let rows: Vec<Vec<Real>> = (0..m)
                .map(|i| (0..n).map(|j| d.ratio(1, i + j + 1)).collect())
                .collect();
            let found = inverse(d, &rows, &AtomicBool::new(false)).unwrap().unwrap();
            let times = |b: &[Real]| -> Vec<Real> {
                let entry = |j: usize| dot(&d.whole(0), b, rows.iter().map(|r| &r[j]));
                (0..n as usize).map(entry).collect()
            };
            let b: Vec<Real> = (0..m.min(n)).map(|i| d.whole(i * i - 7)).collect();
            let back = if m <= n {
                found.left(&times(&b))
            } else {
                times(&found.left(&b))
            };
            for (a, b) in back.iter().zip(&b) {
                assert!((a - b).to_f64().abs() < 1e-20, "{m} × {n}");
            }
        }
    }

    #[test]
    fn too_few_digits_are_told() {
        let hilbert = |d: Digits| -> Vec<Vec<Real>> {
            (0..30)
                .map(|i| (0..30).map(|j| d.ratio(1, i + j + 1)).collect())
                .collect()
        };
        let stop = AtomicBool::new(false);
        assert!(inverse(Digits(40), &hilbert(Digits(40)), &stop).is_err());
        assert!(inverse(Digits(120), &hilbert(Digits(120)), &stop).is_ok());
    }

    /// 200 columns of 200 numbers take tens of seconds with 2000 digits: with the flag set none of
    /// them is worked on.
    #[test]
    fn it_stops_when_it_is_told() {
        let d = Digits(2000);
        let rows: Vec<Vec<Real>> = (0..200)
            .map(|i| (0..200).map(|j| d.ratio(1, i + j + 1)).collect())
            .collect();
        let stop = AtomicBool::new(true);
        assert!(matches!(inverse(d, &rows, &stop), Ok(None)));
    }
}
