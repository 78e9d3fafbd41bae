//! The spectrum of noise and field along the cosines, and the likeliest one.

use crate::num::search::largest;
use crate::recovery::ErrorField;

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
pub(super) fn spectrum(frame: [usize; 2], range: f64) -> Vec<f64> {
    let shape: Vec<f64> = squared_wavenumbers(frame)
        .map(|k2| weight(k2, range))
        .collect();
    let mean = shape.iter().sum::<f64>() / shape.len() as f64;
    shape.into_iter().map(|w| w / mean).collect()
}

/// Cosines of nearly the same |k|.
#[derive(Clone, Copy, Default)]
struct Ring {
    count: f64,
    /// Sums of |k|² and of q/n.
    k2: f64,
    squares: f64,
}

/// The field of the likeliest v for q_k/n: of v = s (1 + g w), s is the mean of q/n(1 + g w).
pub(super) fn fitted(squares: &[f64], frame: [usize; 2]) -> ErrorField {
    let count = squares.len() as f64;
    let longer = frame[0].max(frame[1]) as f64;
    let mut rings = vec![Ring::default(); (libm::log(2.0 * longer) / RING) as usize + 2];
    for (k2, q) in squared_wavenumbers(frame).zip(squares) {
        // From |k| = π/longer on; 0 has a ring of its own.
        let outward =
            0.5 * libm::log(k2.max(f64::MIN_POSITIVE)) - libm::log(std::f64::consts::PI / longer);
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
    ErrorField {
        pixel,
        shared,
        range,
    }
}
