//! Distributions on [0, 1) that are constant on steps, by the sums of their weights.

use std::hint::select_unpredictable;

/// The edges of `count` equal cells.
pub(super) fn even(count: usize) -> Vec<f64> {
    (0..=count).map(|i| i as f64 / count as f64).collect()
}

/// Which of count\[0\] × count\[1\] cells the parameters `uv` lie in.
pub(super) fn cell_at(count: [usize; 2], uv: [f64; 2]) -> [usize; 2] {
    let cell = |d: usize| ((uv[d] * count[d] as f64) as usize).min(count[d] - 1);
    [cell(0), cell(1)]
}

/// The step, and the place in [0, 1) within it, at which a distribution function of `steps` equal
/// steps is x ∈ [0, 1) of the whole; `before(i)` is it before step i, unnormalised. Steps without
/// weight are never chosen.
#[inline(always)]
pub(super) fn invert(steps: usize, before: impl Fn(usize) -> f64, x: f64) -> (usize, f64) {
    let (low, high) = (before(0), before(steps));
    let at = low + x * (high - low);
    // The last step before which there is no more than that; rounding may reach the end.
    let reached = |s: f64| s <= at && s < high;
    let (mut i, mut left) = (0, steps);
    while left > 1 {
        // Without a branch: which half it is cannot be predicted.
        let half = left / 2;
        i += select_unpredictable(reached(before(i + half)), half, 0);
        left -= half;
    }
    let rest = (at - before(i)) / (before(i + 1) - before(i));
    (i, rest.clamp(0.0, 1.0 - f64::EPSILON))
}

/// Smallest m for which every edge of a step is a multiple of 2⁻ᵐ of the whole, if there is one up
/// to `most`.
pub(super) fn digits(before: &[f64], most: u32) -> Option<u32> {
    let whole = |m: u32| {
        let scale = f64::from(1u32 << m) / before[before.len() - 1];
        let edges = before.iter().map(|s| s * scale);
        edges.fold(0.0, |far: f64, s| far.max((s.round() - s).abs())) < 1e-9
    };
    (0..=most.min(30)).find(|m| whole(*m))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cumulative(weights: &[f64]) -> Vec<f64> {
        let sums = (0..=weights.len()).map(|n| weights[..n].iter().sum());
        sums.collect()
    }

    /// The map is continuous and onto: equal steps in x give places whose step never falls, and the
    /// ends of the unit interval stay inside.
    #[test]
    fn distribution_functions_invert() {
        let sums = cumulative(&[0.0, 2.0, 0.0, 1.0, 0.0]);
        let place = |x: f64| invert(5, |i| sums[i], x);
        let mut last = 0.0;
        for k in 0..1000 {
            let (i, rest) = place(f64::from(k) / 1000.0);
            assert!(i == 1 || i == 3, "an empty step was chosen");
            let whole = i as f64 + rest;
            assert!(whole >= last && rest < 1.0);
            last = whole;
        }
        let (i, rest) = place(1.0 - f64::EPSILON);
        assert!(i == 3 && rest > 0.99);
        // Two thirds of the weight lie in step 1: x = 1/3 is its middle.
        let (i, rest) = place(1.0 / 3.0);
        assert!(i == 1 && (rest - 0.5).abs() < 1e-12);
    }

    #[test]
    fn edges_on_dyadic_lines_are_told_from_others() {
        let digits = |w: &[f64]| digits(&cumulative(w), 16);
        assert_eq!(digits(&[1.0]), Some(0));
        assert_eq!(digits(&[0.0, 1.0, 0.0, 1.0, 0.0, 1.0, 0.0, 1.0]), Some(2));
        assert_eq!(digits(&[3.0, 5.0]), Some(3));
        assert_eq!(digits(&[1.0, 1.0, 1.0]), None);
    }
}
