//! How likely a pattern of two levels is beforehand, where neighbours may be alike.
//!
//! Of the patterns s_j = ±1 on a grid of elements the Ising model says
//!
//! > P(s | β) = exp(β Σ_⟨ij⟩ s_i s_j)/Z(β),
//!
//! the sum over neighbours along u and v, of the patterns in which both levels are seen. β = 0 is a fair coin for each element, 2⁻ⁿ for each
//! pattern; the larger β, the larger the patches (above 0.44 they fill the grid, Onsager 1944). β is
//! not known: each of eleven values from 0 to 1 is as likely.

use std::collections::HashMap;

/// Values of β, every tenth from 0 to 1.
const COUPLINGS: u32 = 11;
/// Elements across a grid, at most, whose Z is found.
const MOST_ACROSS: usize = 12;

/// ln of Σ_s w_s P(s)/2⁻ⁿ over Σ_s w_s: with `weights` those of the patterns where every one is as
/// likely beforehand, what their evidence gains where neighbours may be alike. 0 where there is no
/// grid, or one too wide to tell; `None` where no pattern has both levels: one reflectance throughout is no pattern.
pub(super) fn gained(grids: &[[usize; 2]], weights: &HashMap<Vec<bool>, f64>) -> Option<f64> {
    if grids.is_empty() || grids.iter().any(|[nu, nv]| *nu.min(nv) > MOST_ACROSS) {
        return Some(0.0);
    }
    let couplings = (0..COUPLINGS).map(|k| f64::from(k) / f64::from(COUPLINGS - 1));
    let n: usize = grids.iter().map(|[nu, nv]| nu * nv).sum();
    let fair = n as f64 * std::f64::consts::LN_2;
    let sums: Vec<(f64, f64)> = couplings
        .map(|beta| {
            let z: f64 = grids.iter().map(|grid| log_sum(*grid, beta)).sum();
            let one = beta * alike(grids, &vec![true; n]) as f64 + std::f64::consts::LN_2;
            (beta, fair - z - libm::log1p(-libm::exp(one - z)))
        })
        .collect();
    // In an order of their own, so that the sum has the same bits.
    let mut patterns: Vec<(&Vec<bool>, f64)> = weights.iter().map(|(s, w)| (s, *w)).collect();
    patterns.sort_unstable_by(|a, b| a.0.cmp(b.0));
    let total: f64 = patterns.iter().map(|p| p.1).sum();
    let mut logs = Vec::with_capacity(patterns.len() * sums.len());
    let both = |light: &[bool]| light.contains(&true) && light.contains(&false);
    for (pattern, weight) in patterns.iter().filter(|p| p.1 > 0.0 && both(p.0)) {
        let alike = alike(grids, pattern) as f64;
        let share = libm::log(weight / total / f64::from(COUPLINGS));
        logs.extend(sums.iter().map(|(beta, rest)| share + beta * alike + rest));
    }
    let top = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    top.is_finite()
        .then(|| top + libm::log(logs.iter().map(|log| libm::exp(log - top)).sum::<f64>()))
}

/// Σ_⟨ij⟩ s_i s_j.
fn alike(grids: &[[usize; 2]], light: &[bool]) -> i64 {
    let mut sum = 0;
    let mut first = 0;
    for &[nu, nv] in grids {
        let own = &light[first..first + nu * nv];
        let pair = |a: usize, b: usize| if own[a] == own[b] { 1 } else { -1 };
        for j in 0..nu * nv {
            if (j + 1) % nu != 0 {
                sum += pair(j, j + 1);
            }
            if j + nu < nu * nv {
                sum += pair(j, j + nu);
            }
        }
        first += nu * nv;
    }
    sum
}

/// ln Z(β) of a grid, element by element: of each state of the last row's width of elements the sum
/// over all before them.
fn log_sum([nu, nv]: [usize; 2], beta: f64) -> f64 {
    let (across, along) = (nu.min(nv), nu.max(nv));
    let weigh = |same: bool| libm::exp(if same { beta } else { -beta });
    let mut sums = vec![0.0; 1 << across];
    sums[0] = 1.0;
    let mut log = 0.0;
    for j in 0..across * along {
        let column = j % across;
        let mut next = vec![0.0; 1 << across];
        for (state, sum) in sums.iter().enumerate().filter(|(_, sum)| **sum > 0.0) {
            for own in 0..2 {
                let above = state >> column & 1;
                let left = if column > 0 {
                    state >> (column - 1) & 1
                } else {
                    own
                };
                let mut weight = if j >= across {
                    weigh(above == own)
                } else {
                    1.0
                };
                if column > 0 {
                    weight *= weigh(left == own);
                }
                next[state & !(1 << column) | own << column] += sum * weight;
            }
        }
        let top = next.iter().copied().fold(0.0, f64::max);
        next.iter_mut().for_each(|sum| *sum /= top);
        log += libm::log(top);
        sums = next;
    }
    log + libm::log(sums.iter().sum())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Z of a chain is 2 (2 cosh β)^(n−1); of a 3 × 3 grid, and of two surfaces, by all patterns.
    #[test]
    fn sums_over_all_patterns() {
        for beta in [0.0, 0.3, 1.0] {
            let chain = libm::log(2.0) + 6.0 * libm::log(2.0 * libm::cosh(beta));
            assert!((log_sum([7, 1], beta) - chain).abs() < 1e-12);
            assert!((log_sum([1, 7], beta) - chain).abs() < 1e-12);
            for grid in [[3, 3], [4, 2], [2, 5]] {
                let n = grid[0] * grid[1];
                let all = (0..1usize << n).map(|at| {
                    let light: Vec<bool> = (0..n).map(|j| at >> j & 1 == 1).collect();
                    libm::exp(beta * alike(&[grid], &light) as f64)
                });
                let brute = libm::log(all.sum());
                assert!(
                    (log_sum(grid, beta) - brute).abs() < 1e-12,
                    "{grid:?} {beta}"
                );
            }
        }
    }

    /// Over all patterns alike nothing is gained; one patch gains, one of chance loses at most the
    /// share of the fair coin.
    #[test]
    fn patches_gain_and_chance_loses_little() {
        let grids = [[3, 2], [2, 2]];
        let pattern = |at: usize| -> Vec<bool> { (0..10).map(|j| at >> j & 1 == 1).collect() };
        let all = (0..1 << 10).map(|at| (pattern(at), 0.7)).collect();
        assert!(gained(&grids, &all).unwrap().abs() < 1e-12);
        let known = |light: Vec<bool>| gained(&[[8, 8]], &HashMap::from([(light, 1.0)]));
        assert_eq!(known(vec![true; 64]), None);
        let one = |light: Vec<bool>| known(light).unwrap();
        let board = |of: usize| -> Vec<bool> {
            (0..64)
                .map(|j| (j % 8 / of + j / 8 / of).is_multiple_of(2))
                .collect()
        };
        assert!(one(board(4)) > 20.0);
        assert!(one(board(1)) > -libm::log(f64::from(COUPLINGS)) - 1e-12);
        assert!(one(board(1)) < -2.0);
        assert_eq!(gained(&[[13, 13]], &HashMap::new()), Some(0.0));
    }
}
