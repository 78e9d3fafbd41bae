//! The probabilities of all patterns of few elements, one by one.

use std::collections::HashMap;

use nalgebra::DVector;

use super::ground::{Ground, Moments, Summed};
use super::levels::{LevelFit, rule};
use crate::recovery::Sum;

/// Most elements whose patterns are all summed, with given levels and without.
const MOST: [usize; 2] = [18, 16];
/// A pattern whose weight is below the best's by e to this adds nothing.
const NEGLIGIBLE: f64 = 40.0;

/// Whether all patterns of so many elements are summed.
pub(super) fn can(ground: &Ground<'_>) -> bool {
    ground.r.ncols() <= MOST[usize::from(ground.given.is_none())]
}

/// The sum over all 2ⁿ patterns; the best is the likeliest: of given levels that of the least χ², of
/// others that of the largest weight over all levels.
pub(super) fn sum(ground: &Ground<'_>) -> Summed {
    let n = ground.r.ncols();
    // ln weights by pattern number, pattern after pattern by one element (Gray).
    let mut lit = DVector::zeros(ground.d.len());
    let mut at = 0usize;
    let quadrature = rule();
    let mut weights: Vec<(usize, f64, [[f64; 2]; 2])> = Vec::new();
    let mut top = f64::NEG_INFINITY;
    for step in 0..1usize << n {
        if step > 0 {
            let j = step.trailing_zeros() as usize;
            at ^= 1 << j;
            let sign = if at >> j & 1 == 1 { 1.0 } else { -1.0 };
            lit.axpy(sign, &ground.r.column(j), 1.0);
            if step % 256 == 0 {
                let light: Vec<bool> = (0..n).map(|j| at >> j & 1 == 1).collect();
                lit = ground.lit(&light);
            }
        }
        let found = match ground.given {
            Some([dark, light]) => {
                let left = ground.d - &ground.all * dark - &lit * (light - dark);
                let moments = [dark, light].map(|x| [x, x * x]);
                Some((-0.5 * left.norm_squared(), moments))
            }
            None => {
                let dark = &ground.all - &lit;
                let count = at.count_ones() as usize;
                if count == 0 || count == n {
                    one_level(ground, count == n)
                } else {
                    LevelFit::new(ground.d, &dark, &lit)
                        .filter(|fit| -0.5 * fit.chi2 > top - NEGLIGIBLE)
                        .and_then(|fit| fit.weight(&quadrature))
                        .map(|weight| (weight.log, weight.moments))
                }
            }
        };
        if let Some((log, moments)) = found {
            top = top.max(log);
            weights.push((at, log, moments));
        }
    }
    weights.retain(|w| w.1 > top - NEGLIGIBLE);
    let pattern = |at: usize| -> Vec<bool> { (0..n).map(|j| at >> j & 1 == 1).collect() };
    let mut moments = Moments::new(n);
    let mut shares = HashMap::new();
    let mut best = (0, f64::NEG_INFINITY);
    for (at, log, levels) in weights {
        let (light, weight) = (pattern(at), libm::exp(log - top));
        moments.add(&light, weight, levels);
        shares.insert(light, weight);
        if log > best.1 {
            best = (at, log);
        }
    }
    let all = n as f64 * std::f64::consts::LN_2;
    Summed {
        log_evidence: top + libm::log(moments.weight) - all,
        moments,
        weights: shares,
        sum: Sum::Exhaustive,
        best: pattern(best.0),
        drawn: Vec::new(),
    }
}

/// The weight of a pattern without light elements or without dark ones: of the one level x that is
/// seen, with what remains for the other, 2 (1 − x) or 2 x, by quadrature.
fn one_level(ground: &Ground<'_>, light: bool) -> Option<(f64, [[f64; 2]; 2])> {
    let (own, along) = (ground.all.norm_squared(), ground.all.dot(ground.d));
    let (best, sd) = (along / own, own.sqrt().recip());
    let middle = best.clamp(0.0, 1.0);
    let (low, high) = ((middle - 9.0 * sd).max(0.0), (middle + 9.0 * sd).min(1.0));
    let log = |x: f64| -0.5 * (ground.d - &ground.all * x).norm_squared();
    let top = log(middle);
    let (mut sum, mut moments) = (0.0, [[0.0; 2]; 2]);
    for (x, weight) in rule().on(low, high) {
        let room = if light { x } else { 1.0 - x };
        let own = weight * 2.0 * room * libm::exp(log(x) - top);
        sum += own;
        // The level that is not seen lies evenly in [0, x] or [x, 1].
        let (from, to) = if light { (0.0, x) } else { (x, 1.0) };
        let unseen = [(from + to) / 2.0, (from * from + from * to + to * to) / 3.0];
        let levels = if light {
            [unseen, [x, x * x]]
        } else {
            [[x, x * x], unseen]
        };
        for (moment, level) in moments.iter_mut().zip(levels) {
            moment[0] += own * level[0];
            moment[1] += own * level[1];
        }
    }
    (sum > 0.0).then(|| (top + libm::log(sum), moments.map(|m| m.map(|x| x / sum))))
}
