//! Against sums over all patterns, chains and expansions.

use super::*;
use crate::recovery::Sum;

fn gained(grids: &[[usize; 2]], weights: &HashMap<Vec<bool>, f64>) -> Option<f64> {
    Reweighed::new(AlikePrior::new(grids).as_ref(), weights).gained()
}

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

/// Pattern and levels on 3 × 3 elements by the sum over all patterns and couplings, Z by the
/// same sum.
#[test]
fn levels_are_those_of_all_patterns_where_neighbours_may_be_alike() {
    let of = |at: usize| -> Vec<bool> { (0..9).map(|j| at >> j & 1 == 1).collect() };
    let count = |light: &[bool]| light.iter().filter(|x| **x).count() as f64;
    let weight = |at: usize| 1.0 + libm::sin(0.7 * at as f64);
    let levels = |light: &[bool]| {
        let [dark, bright] = [0.01 * count(light), 0.5 + 0.05 * count(light)];
        let spread = 1e-4 * count(light);
        [[dark, dark * dark], [bright, bright * bright + spread]]
    };
    let weights: HashMap<Vec<bool>, f64> = (0..512).map(|at| (of(at), weight(at))).collect();
    let (prior, recovered) = (AlikePrior::new(&[[3, 3]]), of(0b111));
    let found = Reweighed::new(prior.as_ref(), &weights).sum(|light| Some(levels(light)));
    let found = found.unwrap();
    let found = found
        .moments
        .finish(found.share(&recovered), 0.0, Sum::Exhaustive);
    let (mut whole, mut own, mut sums) = (0.0, 0.0, [[0.0; 2]; 2]);
    for k in 0..11 {
        let beta = 0.1 * f64::from(k);
        let one = |at: usize| libm::exp(beta * alike(&pairs(&[[3, 3]]), &of(at)) as f64);
        let z: f64 = (1..511).map(one).sum();
        for at in 1..511 {
            let share = weight(at) * one(at) / z;
            whole += share;
            own += if at == 0b111 { share } else { 0.0 };
            for (sum, level) in sums.iter_mut().zip(levels(&of(at))) {
                sum[0] += share * level[0];
                sum[1] += share * level[1];
            }
        }
    }
    assert!((found.pattern - own / whole).abs() < 1e-9, "{found:?}");
    for (k, [first, second]) in sums.into_iter().enumerate() {
        let [mean, square] = [first / whole, second / whole];
        assert!((found.levels[k] - mean).abs() < 1e-9, "{found:?}");
        let error = (square - mean * mean).sqrt();
        assert!((found.level_errors[k] - error).abs() < 1e-8, "{found:?}");
    }
    // Levels of nothing that has the weight.
    let few = |light: &[bool]| (count(light) < 5.0).then(|| levels(light));
    for prior in [prior.as_ref(), None] {
        assert!(Reweighed::new(prior, &weights).sum(few).is_none());
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
    assert_eq!(gained(&[[21, 21]], &HashMap::new()), Some(0.0));
}
