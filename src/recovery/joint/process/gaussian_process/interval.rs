//! Intervals of a mixture of normal distributions.

use std::f64::consts::{FRAC_1_SQRT_2, PI};

use nalgebra::DVector;

/// Newton steps at most, and the step at which they end, over what is possible.
const MOST_STEPS: usize = 100;
const ENOUGH: f64 = 1e-13;

/// Between which values element j lies, as much of it beyond either: the x of
/// Σ w Φ((x − m)/s) = ½ (1 ∓ confidence), by Newton's method, halving where a step leaves what is
/// possible.
pub(super) fn interval(
    parts: &[(f64, DVector<f64>, DVector<f64>)],
    j: usize,
    confidence: f64,
) -> [f64; 2] {
    let each = parts.iter().map(|(w, m, v)| {
        let s = v[j].sqrt();
        (*w, m[j], s, 1.0 / s.max(f64::MIN_POSITIVE))
    });
    let each: Vec<(f64, f64, f64, f64)> = each.collect();
    // What lies below x, and how densely about it.
    let about = |x: f64| -> [f64; 2] {
        let of = |&(w, m, _, one_over_s): &(f64, f64, f64, f64)| {
            let z = (x - m) * one_over_s;
            let density = libm::exp(-0.5 * z * z) * one_over_s / (2.0 * PI).sqrt();
            [0.5 * w * libm::erfc(-z * FRAC_1_SQRT_2), w * density]
        };
        each.iter()
            .map(of)
            .fold([0.0; 2], |[a, b], [x, y]| [a + x, b + y])
    };
    let middle: f64 = each.iter().map(|(w, m, ..)| w * m).sum();
    let far = each.iter().map(|(_, m, s, _)| m.abs() + 40.0 * s);
    let far = far.fold(0.0, f64::max);
    [0.5 - 0.5 * confidence, 0.5 + 0.5 * confidence].map(|share| {
        let (mut low, mut high, mut x) = (-far, far, middle);
        for _ in 0..MOST_STEPS {
            let [below, density] = about(x);
            if below < share {
                low = x;
            } else {
                high = x;
            }
            let newton = x + (share - below) / density;
            let is_within = low < newton && newton < high;
            let next = if is_within {
                newton
            } else {
                0.5 * (low + high)
            };
            let step = (next - x).abs();
            x = next;
            if step <= ENOUGH * far {
                break;
            }
        }
        x
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of one normal distribution its ± 1.96 σ; of two that are apart, by hand: 2.5 % of all is 5 %
    /// of the first, and 97.5 % where 5 % of the second are above, at once where it has no width.
    #[test]
    fn intervals_by_hand() {
        let part = |w: f64, m: f64, s: f64| {
            (
                w,
                DVector::from_element(1, m),
                DVector::from_element(1, s * s),
            )
        };
        let near = |found: [f64; 2], want: [f64; 2]| {
            let off = found.iter().zip(want).map(|(a, b)| (a - b).abs());
            assert!(off.fold(0.0, f64::max) < 1e-9, "{found:?} {want:?}");
        };
        // Φ⁻¹(0.975) and Φ⁻¹(0.95), by tables.
        let (two_sided, one_sided) = (1.959_963_984_540_054, 1.644_853_626_951_472_7);
        let one = [part(1.0, 0.3, 0.02)];
        near(
            interval(&one, 0, 0.95),
            [0.3 - 0.02 * two_sided, 0.3 + 0.02 * two_sided],
        );
        let apart = [part(0.5, -1.0, 0.01), part(0.5, 2.0, 0.1)];
        let want = [-1.0 - 0.01 * one_sided, 2.0 + 0.1 * one_sided];
        near(interval(&apart, 0, 0.95), want);
        let sharp = [part(0.5, -1.0, 0.01), part(0.5, 2.0, 0.0)];
        near(interval(&sharp, 0, 0.95), [-1.0 - 0.01 * one_sided, 2.0]);
    }
}
