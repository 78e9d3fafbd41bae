//! Errors that neighbouring pixels share, as a field over the photograph.
//!
//! The error of a frame is noise of single pixels and a Matérn field of smoothness ½ with
//! reflecting borders (Lindgren, Rue and Lindström 2011, 2.3), which the cosines T of a photograph
//! of columns × rows pixels diagonalise:
//!
//! > e ~ N(0, T diag(v) Tᵀ),   v_k = σ² + τ² w_k/w̄,
//! > w_k = (1 + ℓ²|k|²)^(−3/2),   k = π (i/columns, j/rows)
//!
//! |k|⁻³ is the spectrum of pictures with edges, and of shadows'.

use nalgebra::DMatrix;
use serde::Serialize;

use crate::num::search::largest;

/// Step of ln ℓ; ℓ goes from a pixel to this many times the longer side.
const STEP: f64 = 0.35;
const LONGEST: f64 = 4.0;
/// τ²/σ², least and most.
const SHARES: [f64; 2] = [1e-4, 1e8];
/// Cosines of one |k| to this, ln, are taken together where the field is fitted.
const RING: f64 = 0.005;

/// |k|² of each cosine, column + row·columns.
fn squared_wavenumbers([columns, rows]: [usize; 2]) -> impl Iterator<Item = f64> {
    let step = |n: usize| std::f64::consts::PI / n as f64;
    (0..columns * rows).map(move |at| {
        let (i, j) = ((at % columns) as f64, (at / columns) as f64);
        (i * step(columns)).powi(2) + (j * step(rows)).powi(2)
    })
}

/// w of one |k|².
fn weight(k2: f64, range: f64) -> f64 {
    let inner = 1.0 + range * range * k2;
    1.0 / (inner * inner.sqrt())
}

/// w_k/w̄, column + row·columns.
fn spectrum(frame: [usize; 2], range: f64) -> Vec<f64> {
    let shape: Vec<f64> = squared_wavenumbers(frame)
        .map(|k2| weight(k2, range))
        .collect();
    let mean = shape.iter().sum::<f64>() / shape.len() as f64;
    shape.into_iter().map(|w| w / mean).collect()
}

/// Errors of a photograph of which a part is shared by neighbouring pixels, as what is left over
/// tells them.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ErrorField {
    /// σ, of each pixel alone, W.
    pub pixel: f64,
    /// τ, of the field that neighbours share, W: its root mean square over the photograph.
    pub shared: f64,
    /// ℓ, over which the field varies, pixels.
    pub range: f64,
}

/// Errors of less than this share of the photographs are rounding.
const ROUNDING: f64 = 1e-5;
/// A change of the ln v that makes no difference, and how often they are looked for.
const SETTLED: f64 = 0.02;
const MOST_STEPS: usize = 40;

/// Cosines of nearly the same |k|.
#[derive(Clone, Copy, Default)]
struct Ring {
    count: f64,
    /// Sums of |k|² and of q/n.
    k2: f64,
    squares: f64,
}

impl ErrorField {
    /// v, one for each cosine, column + row·columns.
    pub(crate) fn variances(&self, frame: [usize; 2]) -> Vec<f64> {
        let shape = spectrum(frame, self.range);
        let of = |w: f64| self.pixel * self.pixel + self.shared * self.shared * w;
        shape.into_iter().map(of).collect()
    }

    /// √v in each of `frames` columns.
    pub(crate) fn stderr(&self, frame: [usize; 2], frames: usize) -> DMatrix<f64> {
        let v = self.variances(frame);
        DMatrix::from_fn(v.len(), frames, |k, _| v[k].sqrt())
    }

    /// From `start` to the likeliest by expectation and maximisation (Dempster, Laird and Rubin
    /// 1977) of Σ_k n ln v_k + q_k/v_k. `squares` gives q_k/n, the expected squares of what is
    /// left over, for errors of these v; none where rounding ends the search. None too where the
    /// errors are no more than rounding of photographs whose mean square is `square`.
    pub(crate) fn maximised<E>(
        start: Self,
        frame: [usize; 2],
        square: f64,
        mut squares: impl FnMut(&Self, &[f64]) -> Result<Option<Vec<f64>>, E>,
    ) -> Result<Option<Self>, E> {
        let mut field = start;
        let mut v = field.variances(frame);
        for _ in 0..MOST_STEPS {
            let Some(squares) = squares(&field, &v)? else {
                return Ok(None);
            };
            field = Self::likeliest(&squares, frame);
            let next = field.variances(frame);
            let moved = v.iter().zip(&next).map(|(a, b)| libm::log(b / a).abs());
            let moved = moved.fold(0.0, f64::max);
            v = next;
            let mean = v.iter().sum::<f64>() / v.len() as f64;
            if mean < ROUNDING * ROUNDING * square {
                return Ok(None);
            }
            if moved < SETTLED {
                break;
            }
        }
        Ok(Some(field))
    }

    /// The field of the likeliest v for q_k/n: of v = s (1 + g w), s is the mean of q/n(1 + g w).
    fn likeliest(squares: &[f64], frame: [usize; 2]) -> Self {
        let count = squares.len() as f64;
        let longer = frame[0].max(frame[1]) as f64;
        let mut rings = vec![Ring::default(); (libm::log(2.0 * longer) / RING) as usize + 2];
        for (k2, q) in squared_wavenumbers(frame).zip(squares) {
            // From |k| = π/longer on; 0 has a ring of its own.
            let outward = 0.5 * libm::log(k2.max(f64::MIN_POSITIVE))
                - libm::log(std::f64::consts::PI / longer);
            let ring = &mut rings[if k2 > 0.0 {
                (outward / RING) as usize + 1
            } else {
                0
            }];
            ring.count += 1.0;
            ring.k2 += k2;
            ring.squares += q;
        }
        rings.retain(|ring| ring.count > 0.0);
        let steps = (libm::log(LONGEST * longer) / STEP).ceil() as usize;
        let mut best = (f64::NEG_INFINITY, [0.0; 3]);
        for range in (0..=steps).map(|k| libm::exp(k as f64 * STEP)) {
            let of = |ring: &Ring| weight(ring.k2 / ring.count, range);
            let mean = rings.iter().map(|ring| ring.count * of(ring)).sum::<f64>() / count;
            let shape: Vec<f64> = rings.iter().map(|ring| of(ring) / mean).collect();
            let size = |g: f64| {
                let of = rings.iter().zip(&shape);
                of.map(|(ring, w)| ring.squares / (1.0 + g * w))
                    .sum::<f64>()
                    / count
            };
            let (g, likelihood) = largest(SHARES[0], SHARES[1], |g| {
                let of = rings.iter().zip(&shape);
                let logs: f64 = of.map(|(ring, w)| ring.count * libm::log1p(g * w)).sum();
                -(logs + count * libm::log(size(g)))
            });
            if likelihood > best.0 {
                best = (likelihood, [size(g).sqrt(), (g * size(g)).sqrt(), range]);
            }
        }
        let [pixel, shared, range] = best.1;
        Self {
            pixel,
            shared,
            range,
        }
    }
}

#[cfg(test)]
mod tests;
