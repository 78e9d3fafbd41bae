//! The best weights that photographs could have, and how good any layout can be.

use super::design::Design;
use crate::lab::error::LabError;
use crate::transport::Control;

/// Relative distance of risk and bound at which the weights are good enough, and most steps.
const CLOSE: f64 = 1e-4;
const STEPS: usize = 2000;

/// Weights of the candidates, 0 ≤ w_s ≤ 1, Σ w_s = N.
#[derive(Clone, Debug)]
pub(super) struct Relaxed {
    pub weights: Vec<f64>,
    /// Risk with them.
    pub risk: f64,
    /// What no layout of N of the candidates, and no such weights, can be below.
    pub bound: f64,
    pub steps: usize,
}

/// Minimises the risk over the weights of N of the candidates.
///
/// Each step goes to the least of an upper bound of the risk that touches it at w°. With the
/// estimator of w° kept, other weights have the noise Σ_s (w°_s²/w_s) B A⁻¹ H_s A⁻¹ Bᵀ, so
///
/// > risk(w) ≤ c + Σ_s g_s w°_s²/w_s,   least at   w_s = min(1, w°_s √(g_s/λ)),   Σ w_s = N
///
/// (multiplicative algorithm, Yu 2010). The risk never rises. The risk is convex, so every step
/// also has a bound by duality,
///
/// > risk(v) ≥ risk(w) + Σ_s g_s w_s − (sum of the N largest g_s)   for all v,
///
/// and the steps end where the best of them is near.
///
/// # Errors
/// Those of [`Design::risk`]; that it was stopped.
pub(super) fn relaxed(
    design: &Design,
    count: usize,
    control: Control<'_>,
) -> Result<Relaxed, LabError> {
    let all = design.candidates().len();
    let weights = vec![count as f64 / all as f64; all];
    stepped(design, (weights, count), Most::One, control)
}

/// Part of the risk that exposures of their own of all candidates, 0 ≤ w_s, Σ w_s = N, can take off
/// that of alike ones, w_s = 1, by the same steps.
///
/// # Errors
/// Those of [`relaxed`].
pub(super) fn of_exposures(design: &Design, control: Control<'_>) -> Result<f64, LabError> {
    let count = design.candidates().len();
    let alike = vec![1.0; count];
    let risk = design.risk(&design.weighted(&alike))?;
    let best = stepped(design, (alike, count), Most::All, control)?;
    Ok(1.0 - best.risk / risk)
}

/// The most weight that a candidate may have.
#[derive(Clone, Copy)]
enum Most {
    One,
    /// That of all.
    All,
}

impl Most {
    /// Weights of v_s = w_s √g_s whose sum is `count`.
    fn share(self, wanted: Vec<f64>, count: usize) -> Vec<f64> {
        match self {
            Self::One => shared(wanted, count),
            Self::All => {
                let sum: f64 = wanted.iter().sum();
                let one = count as f64 / sum;
                wanted.iter().map(|v| v * one).collect()
            }
        }
    }

    /// The largest Σ g_s v_s of such weights.
    fn largest(self, gains: &[f64], count: usize) -> f64 {
        match self {
            Self::One => {
                let mut sorted = gains.to_vec();
                sorted.sort_by(|a, b| b.total_cmp(a));
                sorted.iter().take(count).sum()
            }
            Self::All => count as f64 * gains.iter().copied().fold(0.0, f64::max),
        }
    }
}

/// Steps from weights, `count` together.
fn stepped(
    design: &Design,
    (mut weights, count): (Vec<f64>, usize),
    most: Most,
    control: Control<'_>,
) -> Result<Relaxed, LabError> {
    let (mut bound, mut steps) = (0.0f64, 0);
    loop {
        control.check()?;
        let a = design.weighted(&weights);
        let (risk, gains) = (design.risk(&a)?, design.gains(&a)?);
        let spent: f64 = weights.iter().zip(&gains).map(|(w, g)| w * g).sum();
        bound = bound.max(risk + spent - most.largest(&gains, count));
        if risk - bound <= CLOSE * risk || steps == STEPS {
            return Ok(Relaxed {
                weights,
                risk,
                bound,
                steps,
            });
        }
        let wanted = weights.iter().zip(&gains);
        let wanted = wanted.map(|(w, g)| w * g.max(0.0).sqrt()).collect();
        weights = most.share(wanted, count);
        steps += 1;
    }
}

/// min(1, v_s/λ) with the λ for which they sum to `count`.
fn shared(wanted: Vec<f64>, count: usize) -> Vec<f64> {
    let mut sorted = wanted.clone();
    sorted.sort_by(|a, b| a.total_cmp(b));
    let mut rest: Vec<f64> = sorted
        .iter()
        .scan(0.0, |sum, v| {
            *sum += v;
            Some(*sum)
        })
        .collect();
    // With k of weight 1 the others share N − k.
    let mut lambda = 0.0;
    for k in 0..count {
        let (Some(sum), Some(largest)) = (rest.pop(), sorted.pop()) else {
            break;
        };
        lambda = sum / (count - k) as f64;
        if largest <= lambda {
            break;
        }
    }
    // Where nothing is wanted all have the same.
    if lambda <= 0.0 {
        return vec![count as f64 / wanted.len() as f64; wanted.len()];
    }
    wanted.into_iter().map(|v| (v / lambda).min(1.0)).collect()
}

#[cfg(test)]
mod tests {
    use super::super::design::tests::{tied, triangles};
    use super::*;

    /// All layouts of 3 of 9 candidates of two elements: none is below the bound, which is no more
    /// than 1 % below the weights' risk, which no layout is below either but for the steps' end.
    #[test]
    fn no_layout_is_below_the_bound() {
        let all = triangles(9, (1, 2), 0.3);
        let design = Design::new(&all, &tied(2)).unwrap();
        let found = relaxed(&design, 3, Control::none()).unwrap();
        let risk = |some: &[usize]| {
            let a = design.of(some.iter().map(|s| &design.candidates()[*s]));
            design.risk(&a).unwrap()
        };
        let mut least = f64::INFINITY;
        for a in 0..9 {
            for b in 0..a {
                for c in 0..b {
                    least = least.min(risk(&[a, b, c]));
                }
            }
        }
        assert!(found.bound <= least, "{found:?} {least}");
        assert!(found.risk - found.bound <= 1e-3 * found.risk, "{found:?}");
        assert!(least < 1.3 * found.bound, "{found:?} {least}");
        assert!((found.weights.iter().sum::<f64>() - 3.0).abs() < 1e-9);
        assert!(found.weights.iter().all(|w| (0.0..=1.0).contains(w)));
    }

    /// The bound holds at weights that are far from the best, too: against random layouts of a
    /// larger problem.
    #[test]
    fn every_bound_by_duality_holds() {
        let all = triangles(40, (3, 6), 0.4);
        let design = Design::new(&all, &tied(6)).unwrap();
        let count = 7;
        let weights = vec![count as f64 / 40.0; 40];
        let a = design.weighted(&weights);
        let (risk, gains) = (design.risk(&a).unwrap(), design.gains(&a).unwrap());
        let spent: f64 = weights.iter().zip(&gains).map(|(w, g)| w * g).sum();
        let first = risk + spent - Most::One.largest(&gains, count);
        let last = relaxed(&design, count, Control::none()).unwrap();
        assert!(first <= last.bound && last.bound <= last.risk && last.risk < risk);
        for start in 0..40 {
            let some = (0..count).map(|k| (start + k * (1 + start % 5)) % 40);
            let layout = design.of(some.map(|s| &design.candidates()[s]));
            assert!(last.bound <= design.risk(&layout).unwrap());
        }
    }

    /// Of three candidates the best exposures by a search of all in steps of a fiftieth: none gains
    /// more than is said, but for the steps' end, and the best nearly as much.
    #[test]
    fn exposures_gain_what_a_search_finds() {
        let all = triangles(3, (1, 2), 0.3);
        let design = Design::new(&all, &tied(2)).unwrap();
        let risk = |w: [f64; 3]| design.risk(&design.weighted(&w)).unwrap();
        let mut least = f64::INFINITY;
        for i in 0..=150 {
            for j in 0..=150 - i {
                let [a, b] = [i, j].map(|k| f64::from(k) / 50.0);
                least = least.min(risk([a, b, (3.0 - a - b).max(0.0)]));
            }
        }
        let gain = of_exposures(&design, Control::none()).unwrap();
        let found = 1.0 - least / risk([1.0; 3]);
        assert!(found > 0.01, "{found}");
        assert!(
            found - gain < 2.0 * CLOSE && gain - found < 1e-3,
            "{gain} {found}"
        );
    }

    /// Water filled by hand: of 1, 2, 5, 10 three in all; the last two are full, and 1 and 2 share
    /// the third as 1 : 2.
    #[test]
    fn shares_by_hand() {
        let found = shared(vec![1.0, 10.0, 2.0, 5.0], 3);
        for (found, want) in found.iter().zip([1.0 / 3.0, 1.0, 2.0 / 3.0, 1.0]) {
            assert!((found - want).abs() < 1e-15, "{found} {want}");
        }
        assert_eq!(shared(vec![3.0, 3.0], 1), [0.5, 0.5]);
    }
}
