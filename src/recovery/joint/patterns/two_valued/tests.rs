use nalgebra::{DMatrix, DVector};

use super::*;
use crate::recovery::bench::{Bench, normal_stream};
use crate::recovery::joint::patterns::part;
use crate::recovery::{Nuisance, WeightRule, recover};

pub(super) fn noisy(
    bench: &Bench,
    truth: &DVector<f64>,
    noise: f64,
    seed: u64,
) -> [DMatrix<f64>; 2] {
    let exact = bench.phi(truth);
    let stderr = &exact * noise;
    let mut normal = normal_stream(seed);
    [exact.zip_map(&stderr, |x, s| x + s * normal()), stderr]
}

/// At this noise the bounded fit leaves a tenth of the contrast (see `bounded`); that there are two
/// values only gives all of it back.
#[test]
fn a_fine_board_is_recovered_whole() {
    let bench = Bench::new(6.0, 8, 16);
    let board = bench.board(4);
    for seed in 1000..1002 {
        let [phi, stderr] = noisy(&bench, &board, 1e-4, seed);
        let problem = Problem::new(&phi, &bench.c, &bench.d, Some(&stderr)).unwrap();
        let found = recover(Method::JointTwoValued, &problem, &Options::default()).unwrap();
        assert!((&found.reflectance - &board).amax() < 1e-3, "{seed}");
        // 64 residuals of unit variance: χ² within five deviations of 64.
        let solver = found.solver.unwrap();
        assert!(
            (2.0 * solver.objective - 64.0).abs() < 5.0 * 128f64.sqrt(),
            "{solver:?}"
        );
        assert!(solver.gap <= solver.objective);
        // No element differs from its level.
        let patterns = found.patterns.unwrap();
        let exact = patterns.assumed().exact.unwrap();
        assert!(exact > 0.9, "{exact}");
    }
}

/// With the levels given, branch and bound ends with a proof: gap zero. Grey levels are estimated
/// as well.
#[test]
fn levels_are_kept_or_estimated() {
    let bench = Bench::new(6.0, 4, 8);
    let grey = bench.board(4).map(|x| 0.3 + 0.4 * x);
    let [phi, stderr] = noisy(&bench, &grey, 1e-5, 4);
    let problem = Problem::new(&phi, &bench.c, &bench.d, Some(&stderr)).unwrap();
    let given = Options {
        levels: Some([0.3, 0.7]),
        ..Options::default()
    };
    let found = recover(Method::JointTwoValued, &problem, &given).unwrap();
    assert!((&found.reflectance - &grey).amax() < 1e-15);
    assert_eq!(
        (found.choice, found.parameter),
        (Choice::Given, Parameter::Levels([0.3, 0.7]))
    );
    assert!(found.solver.unwrap().gap < 1e-9);
    let found = recover(Method::JointTwoValued, &problem, &Options::default()).unwrap();
    assert_eq!(found.choice, Choice::Estimated);
    assert!(
        (&found.reflectance - &grey).amax() < 1e-3,
        "{}",
        found.reflectance
    );
    for levels in [
        [0.5, 0.5],
        [0.7, 0.3],
        [-0.1, 1.0],
        [0.0, 1.1],
        [f64::NAN, 1.0],
    ] {
        let options = Options {
            levels: Some(levels),
            ..Options::default()
        };
        let error = recover(Method::JointTwoValued, &problem, &options).unwrap_err();
        assert!(matches!(error, RecoveryError::BadParameter { .. }));
    }
}

/// Few elements: every pattern's likelihood summed here one by one, levels known. The marginals and
/// the evidence are those of the recovery, and sampling finds them too.
#[test]
fn probabilities_are_those_of_all_patterns() {
    let bench = Bench::new(6.0, 3, 8);
    let truth = DVector::from_fn(9, |j, _| if j % 4 == 1 { 0.7 } else { 0.3 });
    let [phi, stderr] = noisy(&bench, &truth, 3.0, 5);
    let problem = Problem::new(&phi, &bench.c, &bench.d, Some(&stderr)).unwrap();
    let options = Options {
        levels: Some([0.3, 0.7]),
        ..Options::default()
    };
    let found = recover(Method::JointTwoValued, &problem, &options).unwrap();
    let patterns = found.patterns.unwrap();
    assert_eq!(patterns.sum, Sum::Exhaustive);
    let chi2 = |set: usize| {
        let x = DVector::from_fn(9, |j, _| if set >> j & 1 == 1 { 0.7 } else { 0.3 });
        (&phi - bench.phi(&x)).component_div(&stderr).norm_squared()
    };
    let all: Vec<f64> = (0..512).map(chi2).collect();
    let least = all.iter().copied().fold(f64::INFINITY, f64::min);
    let weight = |set: usize| libm::exp(-0.5 * (all[set] - least));
    let sum: f64 = (0..512).map(weight).sum();
    let light = DVector::from_fn(9, |j, _| {
        let own = (0..512).filter(|set| set >> j & 1 == 1).map(weight);
        own.sum::<f64>() / sum
    });
    assert!((&patterns.light - &light).amax() < 1e-6, "{light}");
    assert!(light.iter().any(|p| (0.1..0.9).contains(p)), "{light}");
    // Of the likeliest patterns, 0.95 together, the picture has the most elements expected right.
    let mut order: Vec<usize> = (0..512).collect();
    order.sort_by(|a, b| all[*a].total_cmp(&all[*b]));
    let mut before = 0.0;
    let likely = order.into_iter().take_while(|set| {
        let within = before < 0.95 * sum;
        before += weight(*set);
        within
    });
    let likely: Vec<usize> = likely.collect();
    let right = |set: usize| -> f64 {
        let of = |j: usize| {
            if set >> j & 1 == 1 {
                light[j]
            } else {
                1.0 - light[j]
            }
        };
        (0..9).map(of).sum()
    };
    let lit = (0..9).filter(|j| found.reflectance[*j] > 0.5);
    let picture: usize = lit.map(|j| 1 << j).sum();
    let most = likely.iter().map(|set| right(*set)).fold(0.0, f64::max);
    assert!(likely.contains(&picture) && (right(picture) - most).abs() < 1e-6);
    assert!((patterns.pattern - weight(picture) / sum).abs() < 1e-6);
    // Evidences are over the best fit of all numbers.
    let free = recover(Method::JointUnbounded, &problem, &by_entry()).unwrap();
    let best = (&phi - bench.phi(&free.reflectance)).component_div(&stderr);
    let evidence = libm::log(sum / 512.0) - 0.5 * (least - best.norm_squared());
    assert!(
        (patterns.log_evidence - evidence).abs() < 1e-4,
        "{evidence}"
    );
    let coordinates =
        Coordinates::new(Method::JointTwoValued, &problem, &options, 1.0, 1.0).unwrap();
    let (r, d) = coordinates.whitened();
    let likelihood = PatternLikelihood::new(&r, &d, Some([0.3, 0.7]));
    let sampled = sampled::sample(&likelihood, &[vec![false; 9]], 4000)
        .unwrap()
        .unwrap()
        .finish(&[false; 9]);
    assert!(sampled.sum.converged(), "{:?}", sampled.sum);
    assert!((&sampled.light - &light).amax() < 0.02, "{}", sampled.light);
    assert!(
        (sampled.log_evidence - evidence).abs() < 0.1,
        "{}",
        sampled.log_evidence
    );
}

fn by_entry() -> Options {
    Options {
        weighting: WeightRule::Entries,
        ..Options::default()
    }
}

/// Levels unknown: sampling agrees with the sum over all patterns and levels.
#[test]
fn sampled_levels_are_those_of_the_sum() {
    let bench = Bench::new(6.0, 3, 8);
    let truth = DVector::from_fn(9, |j, _| if j % 4 == 1 { 0.8 } else { 0.2 });
    for noise in [0.3, 0.05] {
        let [phi, stderr] = noisy(&bench, &truth, noise, 6);
        let problem = Problem::new(&phi, &bench.c, &bench.d, Some(&stderr)).unwrap();
        let options = Options::default();
        let coordinates =
            Coordinates::new(Method::JointTwoValued, &problem, &options, 1.0, 1.0).unwrap();
        let (r, d) = coordinates.whitened();
        let likelihood = PatternLikelihood::new(&r, &d, None);
        let all = enumerated::sum(&likelihood);
        let best = all.best.clone();
        let [all, sampled] = [
            all,
            sampled::sample(&likelihood, std::slice::from_ref(&best), 4000)
                .unwrap()
                .unwrap(),
        ]
        .map(|s| s.finish(&best));
        assert!(sampled.sum.converged(), "{:?}", sampled.sum);
        assert!((&sampled.light - &all.light).amax() < 0.03, "{}", all.light);
        assert!((&sampled.mean - &all.mean).amax() < 0.02, "{}", all.mean);
        for k in 0..2 {
            assert!((sampled.levels[k] - all.levels[k]).abs() < 0.02);
            assert!((sampled.level_errors[k] / all.level_errors[k] - 1.0).abs() < 0.1);
        }
        assert!((sampled.log_evidence - all.log_evidence).abs() < 0.2);
    }
}

/// 4 × 4 elements at noise that leaves far more patterns likely than are listed: what is drawn
/// makes up for the others, to within what is stated.
#[test]
fn drawn_patterns_make_up_for_those_that_are_not_listed() {
    let bench = Bench::new(6.0, 4, 8);
    let truth = DVector::from_fn(16, |j, _| if j % 5 < 2 { 0.8 } else { 0.2 });
    for given in [None, Some([0.2, 0.8])] {
        let [phi, stderr] = noisy(&bench, &truth, 3.0, 7);
        let problem = Problem::new(&phi, &bench.c, &bench.d, Some(&stderr)).unwrap();
        let options = Options::default();
        let coordinates =
            Coordinates::new(Method::JointTwoValued, &problem, &options, 1.0, 1.0).unwrap();
        let (r, d) = coordinates.whitened();
        let likelihood = PatternLikelihood::new(&r, &d, given);
        let all = enumerated::sum(&likelihood);
        let known = [all.best.clone()];
        let sampled = sampled::sample(&likelihood, &known, 20_000)
            .unwrap()
            .unwrap();
        let Sum::Sampled {
            listed,
            disagreement,
            ..
        } = sampled.sum
        else {
            panic!("{:?}", sampled.sum)
        };
        assert!(listed < 0.7, "{given:?}: {listed}");
        assert!(disagreement < 0.05, "{given:?}: {disagreement}");
        let drawn = part::draw(&sampled, &likelihood);
        let mean = |j: usize| {
            let levels = drawn.iter().map(|of| of.1[usize::from(of.0[j])]);
            levels.sum::<f64>() / drawn.len() as f64
        };
        let means = DVector::from_fn(16, |j, _| mean(j));
        let [all, own] = [&all, &sampled].map(|s| s.finish(&all.best));
        let off = (&own.light - &all.light).amax();
        assert!(off < 1.5 * disagreement, "{given:?}: {off} {disagreement}");
        assert!((&own.mean - &all.mean).amax() < 0.02, "{given:?}");
        // 200 pictures, none of an element's values further than ½ from its mean.
        assert!(
            (means - &all.mean).amax() < 4.0 * 0.5 / (drawn.len() as f64).sqrt(),
            "{given:?}"
        );
        let evidences = own.log_evidence - all.log_evidence;
        assert!(evidences.abs() < 0.05, "{given:?}: {evidences}");
        for k in 0..2 {
            assert!((own.levels[k] - all.levels[k]).abs() < 0.01);
            assert!((own.level_errors[k] - all.level_errors[k]).abs() < 0.01);
        }
    }
}

/// At noise as low as the published study's the one pattern is certain, and is said to be.
#[test]
fn little_noise_leaves_one_pattern() {
    let bench = Bench::new(6.0, 8, 16);
    let truth = two_levels(&bench, [0.2, 0.8]);
    for noise in [1e-6, 1e-8, 1e-10] {
        let [phi, stderr] = noisy(&bench, &truth, noise, 3);
        let problem = Problem::new(&phi, &bench.c, &bench.d, Some(&stderr)).unwrap();
        let found = recover(Method::JointTwoValued, &problem, &Options::default()).unwrap();
        assert!(
            (&found.reflectance - &truth).amax() < 100.0 * noise,
            "{noise}"
        );
        let patterns = found.patterns.unwrap();
        assert!(patterns.sum.converged(), "{noise}: {:?}", patterns.sum);
        assert!(patterns.pattern > 0.9, "{noise}: {}", patterns.pattern);
    }
}

/// Random patterns of 4 × 4 elements, levels known: of all elements said to be light with a
/// probability of p the share p is. 1000 pictures at noise that leaves elements undecided; in each
/// tenth of p the light ones within four deviations of the binomial that the probabilities make.
#[test]
#[ignore = "slow"]
fn stated_probabilities_come_true() {
    let bench = Bench::new(6.0, 4, 8);
    let mut normal = normal_stream(31);
    let mut bins = [[0.0f64; 3]; 10];
    let options = Options {
        levels: Some([0.2, 0.8]),
        ..Options::default()
    };
    for _ in 0..1000 {
        let light: Vec<bool> = (0..16).map(|_| normal() > 0.0).collect();
        let truth = DVector::from_fn(16, |j, _| if light[j] { 0.8 } else { 0.2 });
        let exact = bench.phi(&truth);
        let stderr = &exact * 0.5;
        let phi = exact.zip_map(&stderr, |x, s| x + s * normal());
        let problem = Problem::new(&phi, &bench.c, &bench.d, Some(&stderr)).unwrap();
        let found = recover(Method::JointTwoValued, &problem, &options).unwrap();
        for (p, light) in found.patterns.unwrap().light.iter().zip(light) {
            let bin = &mut bins[((10.0 * p) as usize).min(9)];
            bin[0] += p;
            bin[1] += p * (1.0 - p);
            bin[2] += f64::from(u8::from(light));
        }
    }
    for [expected, variance, found] in bins {
        assert!(
            (found - expected).abs() < 4.0 * variance.sqrt() + 1.0,
            "{bins:?}"
        );
    }
}

/// At a noise of a tenth, levels known: the pattern of 4 × 4 elements is right in 95 of 100 or
/// more.
#[test]
fn random_patterns_are_found_at_a_tenth_of_noise() {
    let bench = Bench::new(6.0, 4, 16);
    let mut normal = normal_stream(41);
    let options = Options {
        levels: Some([0.0, 1.0]),
        ..Options::default()
    };
    let right = (0..100).filter(|seed| {
        let truth = DVector::from_fn(16, |_, _| f64::from(u8::from(normal() > 0.0)));
        let [phi, stderr] = noisy(&bench, &truth, 0.1, *seed);
        let problem = Problem::new(&phi, &bench.c, &bench.d, Some(&stderr)).unwrap();
        let found = recover(Method::JointTwoValued, &problem, &options).unwrap();
        found.reflectance == truth
    });
    let right = right.count();
    assert!(right >= 95, "{right}");
}

/// A board of levels a and b at this noise.
fn two_levels(bench: &Bench, [dark, light]: [f64; 2]) -> DVector<f64> {
    bench.board(4).map(|x| dark + (light - dark) * x)
}

/// Photographs in an unknown unit, of a surface of exactly two reflectances: the pattern, the ratio
/// of its levels and a fit within the noise, as where the scale is known. Levels that are given are
/// a ratio.
#[test]
fn a_pattern_is_found_whatever_the_unit() {
    let bench = Bench::new(6.0, 4, 8);
    for (levels, noise, seed) in [
        ([0.05, 0.9], 1e-3, 1),
        ([0.05, 0.9], 1e-4, 2),
        ([0.3, 0.7], 1e-4, 3),
        ([0.6, 0.8], 1e-5, 4),
    ] {
        let truth = two_levels(&bench, levels);
        let [phi, stderr] = noisy(&bench, &truth, noise, seed);
        let (phi, stderr) = (phi * 3.7e9, stderr * 3.7e9);
        let nuisance = Nuisance {
            free_scale: true,
            ..Nuisance::default()
        };
        let problem = Problem::new(&phi, &bench.c, &bench.d, Some(&stderr)).unwrap();
        let problem = problem.with_nuisance(nuisance).unwrap();
        for given in [None, Some(levels)] {
            let options = Options {
                levels: given,
                ..Options::default()
            };
            let found = recover(Method::JointTwoValued, &problem, &options).unwrap();
            let expected = &truth / levels[1];
            let off = (&found.reflectance - &expected).amax();
            assert!(off < 0.05, "{levels:?} {given:?}: {off}");
            // 16 residuals of unit variance.
            let solver = found.solver.unwrap();
            let chi2 = 2.0 * solver.objective;
            assert!(chi2 < 16.0 + 5.0 * 32f64.sqrt(), "{levels:?}: {chi2}");
            // All patterns of so few elements were tried.
            assert_eq!(solver.gap, 0.0, "{levels:?} {given:?}");
            assert_eq!(found.choice == Choice::Given, given.is_some());
        }
    }
}

/// Without the levels the pattern that fits best of all 2⁹, told by least squares over all entries,
/// at noise that many of them explain.
#[test]
fn of_few_elements_the_best_of_all_patterns_is_found() {
    let bench = Bench::new(3.0, 3, 6);
    for (seed, noise) in [(1, 0.01), (2, 0.03), (3, 0.1), (4, 0.3), (5, 0.3), (6, 0.3)] {
        let truth = DVector::from_fn(9, |j, _| if (j + seed) % 3 == 0 { 0.8 } else { 0.1 });
        let [phi, stderr] = noisy(&bench, &truth, noise, seed as u64);
        let over = |m: DMatrix<f64>| m.zip_map(&stderr, |x, s| x / s);
        let seen = over(phi.clone());
        let misfit = |set: usize| {
            let light = DVector::from_fn(9, |j, _| f64::from(u8::from(set >> j & 1 == 1)));
            let [u, w] = [light.map(|x| 1.0 - x), light].map(|x| over(bench.phi(&x)));
            let (uu, uw, ww) = (u.dot(&u), u.dot(&w), w.dot(&w));
            let (ud, wd) = (u.dot(&seen), w.dot(&seen));
            let off = |a: f64, b: f64| (&seen - &u * a - &w * b).norm_squared();
            let of_both = uu * ww - uw * uw;
            let [a, b] = [ww * ud - uw * wd, uu * wd - uw * ud].map(|x| x / of_both);
            if of_both > 0.0 && a >= 0.0 && b >= 0.0 {
                return off(a, b);
            }
            let alone = |square: f64, with: f64| if square > 0.0 { with / square } else { 0.0 };
            off(alone(uu, ud).max(0.0), 0.0).min(off(0.0, alone(ww, wd).max(0.0)))
        };
        let all = (0..512).map(misfit);
        let least = all.fold(f64::INFINITY, f64::min);
        let nuisance = Nuisance {
            free_scale: true,
            ..Nuisance::default()
        };
        let problem = Problem::new(&phi, &bench.c, &bench.d, Some(&stderr)).unwrap();
        let problem = problem.with_nuisance(nuisance).unwrap();
        let options = Options {
            weighting: WeightRule::Entries,
            ..Options::default()
        };
        let found = recover(Method::JointTwoValued, &problem, &options).unwrap();
        let x = &found.reflectance;
        let middle = 0.5 * (x.min() + x.max());
        let set = (0..9).map(|j| usize::from(x[j] > middle) << j).sum();
        let own = misfit(set);
        assert!(own <= least * (1.0 + 1e-9), "{seed}: {own} {least}");
    }
}

/// Photographs in W whose scale is stated to be known to `known`, and is `factor`: the pattern is
/// found however large the stated error is.
#[test]
fn a_larger_error_of_the_scale_loses_no_pattern() {
    let bench = Bench::new(6.0, 4, 8);
    let levels = [0.05, 0.9];
    let truth = two_levels(&bench, levels);
    let [phi, stderr] = noisy(&bench, &truth, 1e-4, 5);
    for (known, factor) in [(0.03, 1.0), (0.2, 1.0), (1.0, 1.0), (0.2, 1.3), (0.2, 0.8)] {
        let (phi, stderr) = (&phi * factor, &stderr * factor);
        let nuisance = Nuisance {
            scale_error: Some(known),
            ..Nuisance::default()
        };
        let problem = Problem::new(&phi, &bench.c, &bench.d, Some(&stderr)).unwrap();
        let problem = problem.with_nuisance(nuisance).unwrap();
        for given in [None, Some(levels)] {
            let options = Options {
                levels: given,
                ..Options::default()
            };
            let found = recover(Method::JointTwoValued, &problem, &options).unwrap();
            let of = found
                .nuisance
                .as_ref()
                .and_then(|n| n.gains.as_ref())
                .unwrap();
            let whole = of.whole.as_ref().unwrap().size[0];
            // With σ = 1 the prior's curvature is 1e-12 of the photographs': rounding moves ε.
            let told = format!("{known} {factor} {given:?}: ε {whole}");
            assert!(of.settled || known == 1.0, "{told}");
            let x = &found.reflectance;
            let (low, high) = (x.min(), x.max());
            let pattern = truth
                .iter()
                .zip(x)
                .all(|(t, x)| (*t > 0.5) == (*x > 0.5 * (low + high)));
            assert!(pattern, "{told} {x}");
            let ratio = low / high - levels[0] / levels[1];
            assert!(ratio.abs() < 0.02, "{told}: {ratio}");
            // Levels that are not given take what they may of the factor, up to white.
            let due = match given {
                Some(_) => factor,
                None => (factor * levels[1]).max(1.0),
            };
            // Where levels and factor are free along each other ε is known to σ and no better.
            let off = (1.0 + whole - due).abs();
            assert!(off < given.map_or(0.3 * known, |_| 0.02), "{told}");
        }
    }
}

/// Of light whose size is known to 30 %, half of that noise: the probabilities of all 512 patterns
/// by hand, from every entry, over the size by a sum of 4000 values. As many are right of those
/// that are certain as they say.
#[test]
fn given_levels_whatever_the_size_of_the_light() {
    let bench = Bench::new(6.0, 3, 6);
    let (levels, sigma) = ([0.2, 0.8], 0.3);
    let spots: Vec<usize> = (0..120).step_by(10).collect();
    let d = bench.d.select_columns(&spots);
    let light = |x: &DVector<f64>| &bench.c * DMatrix::from_diagonal(x) * &d;
    let noise = 0.5 * light(&DVector::from_element(9, 0.5)).mean();
    let patterns: Vec<DMatrix<f64>> = (0..512)
        .map(|at: usize| light(&DVector::from_fn(9, |j, _| levels[at >> j & 1])))
        .collect();
    let nuisance = Nuisance {
        scale_error: Some(sigma),
        ..Nuisance::default()
    };
    let given = Options {
        levels: Some(levels),
        ..Options::default()
    };
    for (seed, factor) in [(1, 0.45), (2, 0.6), (3, 1.0), (4, 1.5)] {
        let truth = &patterns[(37 * seed as usize + 100) % 512];
        let mut normal = normal_stream(seed);
        let phi = truth.map(|x| factor * x + noise * normal());
        let logs = patterns.iter().map(|m| {
            let [least, along, own] = [(&phi, &phi), (m, &phi), (m, m)].map(|(a, b)| a.dot(b));
            let sizes = (1..=4000).map(|k| 3e-3 * f64::from(k));
            let each = sizes.map(|s| {
                let chi2 = (least - 2.0 * s * along + s * s * own) / (noise * noise);
                -0.5 * (chi2 + ((s - 1.0) / sigma).powi(2))
            });
            crate::num::summation::log_sum_exp(&each.collect::<Vec<f64>>())
        });
        let logs: Vec<f64> = logs.collect();
        let top = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let weights: Vec<f64> = logs.iter().map(|log| libm::exp(log - top)).collect();
        let all: f64 = weights.iter().sum();
        let stderr = DMatrix::from_element(phi.nrows(), phi.ncols(), noise);
        let problem = Problem::new(&phi, &bench.c, &d, Some(&stderr)).unwrap();
        let problem = problem.with_nuisance(nuisance).unwrap();
        let found = recover(Method::JointTwoValued, &problem, &given).unwrap();
        let summed = found.patterns.unwrap();
        for j in 0..9 {
            let of = weights
                .iter()
                .enumerate()
                .filter(|(at, _)| at >> j & 1 == 1);
            let expected = of.map(|(_, weight)| weight).sum::<f64>() / all;
            let off = summed.light[j] - expected;
            assert!(off.abs() < 1e-3, "{factor} {j}: {expected} {off}");
        }
        assert!(found.reflectance.iter().all(|x| levels.contains(x)));
    }
}
