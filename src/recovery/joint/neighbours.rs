//! How likely a pattern of two levels is beforehand, where neighbours may be alike.
//!
//! Of the patterns s_j = ±1 on a grid of elements the Ising model says
//!
//! > P(s | β) = exp(β Σ_⟨ij⟩ s_i s_j)/Z(β),
//!
//! the sum over neighbours along u and v, of the patterns in which both levels are seen. β = 0 is a
//! fair coin for each element, 2⁻ⁿ for each pattern; the larger β, the larger the patches (above
//! 0.44 they fill the grid, Onsager 1944). β is not known: each of eleven values from 0 to 1 is as
//! likely.

use std::collections::HashMap;

use rayon::prelude::*;

/// Values of β, every tenth from 0 to 1.
const COUPLINGS: u32 = 11;
/// Elements across a grid, at most, whose Z is found: 2 to this numbers are held for each β.
const MOST_ACROSS: usize = 20;

/// ln of Σ_s w_s P(s)/2⁻ⁿ over Σ_s w_s: with `weights` those of the patterns where every one is as
/// likely beforehand, what their evidence gains where neighbours may be alike. 0 where there is no
/// grid, or one too wide to tell; `None` where no pattern has both levels: one reflectance
/// throughout is no pattern.
pub(super) fn gained(grids: &[[usize; 2]], weights: &HashMap<Vec<bool>, f64>) -> Option<f64> {
    if grids.is_empty() || grids.iter().any(|[nu, nv]| *nu.min(nv) > MOST_ACROSS) {
        return Some(0.0);
    }
    let n: usize = grids.iter().map(|[nu, nv]| nu * nv).sum();
    let neighbours = pairs(grids);
    let fair = n as f64 * std::f64::consts::LN_2;
    let sums: Vec<(f64, f64)> = (0..COUPLINGS)
        .into_par_iter()
        .map(|k| {
            let beta = f64::from(k) / f64::from(COUPLINGS - 1);
            let z: f64 = grids.iter().map(|grid| log_sum(*grid, beta)).sum();
            let one = beta * neighbours.len() as f64 + std::f64::consts::LN_2;
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
        let alike = alike(&neighbours, pattern) as f64;
        let share = libm::log(weight / total / f64::from(COUPLINGS));
        logs.extend(sums.iter().map(|(beta, rest)| share + beta * alike + rest));
    }
    let top = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    top.is_finite()
        .then(|| top + libm::log(logs.iter().map(|log| libm::exp(log - top)).sum::<f64>()))
}

/// Σ_⟨ij⟩ s_i s_j over the neighbours.
pub(super) fn alike(pairs: &[[usize; 2]], light: &[bool]) -> i64 {
    let of = |[a, b]: &[usize; 2]| if light[*a] == light[*b] { 1 } else { -1 };
    pairs.iter().map(of).sum()
}

/// The neighbours along u and v on each grid.
pub(super) fn pairs(grids: &[[usize; 2]]) -> Vec<[usize; 2]> {
    let mut pairs = Vec::new();
    let mut first = 0;
    for &[nu, nv] in grids {
        for j in 0..nu * nv {
            if (j + 1) % nu != 0 {
                pairs.push([first + j, first + j + 1]);
            }
            if j + nu < nu * nv {
                pairs.push([first + j, first + j + nu]);
            }
        }
        first += nu * nv;
    }
    pairs
}

/// ln Z(β) of a grid, element by element: of each state of the last `across` elements the sum over
/// all before them. Bit i of a state is the last element of column i. An element at column i takes
/// the place of the one above it, so states that differ in bit i alone pass into one another.
fn log_sum([nu, nv]: [usize; 2], beta: f64) -> f64 {
    let (across, along) = (nu.min(nv), nu.max(nv));
    let [same, other] = [beta, -beta].map(libm::exp);
    let mut sums = vec![0.0; 1 << across];
    sums[0] = 1.0;
    let mut log = 0.0;
    for row in 0..along {
        // Above the first row is nothing: bits not yet set are 0, and count once.
        let [up, cross] = if row > 0 { [same, other] } else { [1.0; 2] };
        for column in 0..across {
            let half = 1 << column;
            for block in sums.chunks_exact_mut(2 * half) {
                let (dark, light) = block.split_at_mut(half);
                // By the bit to the left, which the first column has not.
                let left = if column > 0 { half / 2 } else { 0 };
                let turn = |states: (&mut [f64], &mut [f64]), [to_dark, to_light]: [f64; 2]| {
                    for (dark, light) in states.0.iter_mut().zip(states.1) {
                        let (d, l) = (*dark, *light);
                        *dark = to_dark * (up * d + cross * l);
                        *light = to_light * (cross * d + up * l);
                    }
                };
                let (dark_left, dark) = dark.split_at_mut(left);
                let (light_left, light) = light.split_at_mut(left);
                turn((dark_left, light_left), [same, other]);
                let right = if column > 0 { [other, same] } else { [1.0; 2] };
                turn((dark, light), right);
            }
        }
        let top = sums.iter().copied().fold(0.0, f64::max);
        sums.iter_mut().for_each(|sum| *sum /= top);
        log += libm::log(top);
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
            for grid in [[3, 3], [4, 2], [2, 5], [4, 4]] {
                let n = grid[0] * grid[1];
                let all = (0..1usize << n).map(|at| {
                    let light: Vec<bool> = (0..n).map(|j| at >> j & 1 == 1).collect();
                    libm::exp(beta * alike(&pairs(&[grid]), &light) as f64)
                });
                let brute = libm::log(all.sum());
                assert!(
                    (log_sum(grid, beta) - brute).abs() < 1e-12,
                    "{grid:?} {beta}"
                );
            }
        }
    }

    /// Of a wide grid by the expansion in v = tanh β with a free edge, per plaquette v⁴ and per
    /// pair of neighbouring plaquettes v⁶ (v⁸ counts 4½ times per element at most):
    ///
    /// > ln Z = n ln 2 + bonds ln cosh β + plaquettes v⁴ + pairs v⁶ + …
    #[test]
    fn wide_grids_follow_the_expansion_of_high_temperatures() {
        for [nu, nv] in [[16usize, 16], [14, 18]] {
            let [n, bonds, plaquettes, pairs] = [
                nu * nv,
                (nu - 1) * nv + nu * (nv - 1),
                (nu - 1) * (nv - 1),
                (nu - 2) * (nv - 1) + (nu - 1) * (nv - 2),
            ]
            .map(|count| count as f64);
            let v: f64 = libm::tanh(0.1);
            let ordered = n * libm::log(2.0) + bonds * libm::log(libm::cosh(0.1));
            let expected = ordered + plaquettes * v.powi(4) + pairs * v.powi(6);
            let left = log_sum([nu, nv], 0.1) - expected;
            assert!((0.0..4.5 * n * v.powi(8)).contains(&left), "{left:e}");
        }
    }

    /// A wide grid dark on one side and light on the other, 14 of 364 pairs unlike. At β = 1 nearly
    /// all of Z is that of elements all alike, so a share 1/11 of ½ e^(−28) is the least. At each β
    /// the patterns with both levels have at least the weight of those with one element unlike, and
    /// Z at least 2ⁿ cosh β to the number of pairs, the first term of a sum of positive ones.
    #[test]
    fn a_wide_grid_gains_as_well() {
        let half: Vec<bool> = (0..196).map(|j| j % 14 < 7).collect();
        let found = gained(&[[14, 14]], &HashMap::from([(half, 1.0)])).unwrap();
        let coins = 196.0 * libm::log(2.0);
        // One element unlike: so many in corners, at edges and inside, with 2, 3 and 4 neighbours.
        let flips = |beta: f64| -> f64 {
            let of = |(n, neighbours): (f64, f64)| n * libm::exp(-2.0 * neighbours * beta);
            [(4.0, 2.0), (48.0, 3.0), (144.0, 4.0)].map(of).iter().sum()
        };
        let least = coins - 28.0 - libm::log(22.0) - 1.5 * flips(1.0);
        let most = (0..11).map(|k| 0.1 * f64::from(k)).map(|beta| {
            let one = libm::exp(-28.0 * beta) / (2.0 * flips(beta));
            let pairs = 364.0 * (libm::log(libm::cosh(beta)) - beta) + coins;
            let all = libm::exp(pairs) - 2.0;
            let other = libm::exp(-28.0 * beta) / all;
            if all > 0.0 { one.min(other) } else { one }
        });
        let most = coins + libm::log(most.sum::<f64>() / 11.0);
        assert!((least..most).contains(&found), "{found} {least} {most}");
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
        assert_eq!(gained(&[[21, 21]], &HashMap::new()), Some(0.0));
    }
}
