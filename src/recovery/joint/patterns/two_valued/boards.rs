//! Boards of unknown levels: is what is found as good as what made the photographs?

use nalgebra::DVector;

use super::tests::noisy;
use super::*;
use crate::recovery::bench::{Bench, normal_stream};
use crate::recovery::joint::patterns::levels::{self, ALL};
use crate::recovery::joint::patterns::neighbours;
use crate::recovery::recover;

/// Draws of the noise for each board and noise. Of 40, one may miss.
const DRAWS: u64 = 1;

/// What is counted of one board at one noise.
#[derive(Debug, Default)]
struct Count {
    /// Draws whose χ² is at most that of the picture that made the photographs.
    reached: u64,
    /// Draws whose pattern is that one.
    same: u64,
    /// Draws with stated probabilities, those of them with both levels within three of their
    /// standard errors, and the same where neighbours may be alike, as far as that is known.
    stated: u64,
    levels: u64,
    alike: u64,
    levels_if_alike: u64,
}

/// Boards of 2 × 2 and 4 × 4 fields on 8 × 8 elements, levels unknown: what is found fits at least
/// as well as what made the photographs, is found as it is, and the levels where neighbours may be
/// alike are within three of their standard errors. Pictures that are settled there are within four
/// of their standard errors, and right as often as said. Where every pattern is as likely the
/// levels 0.1 and 0.6 are within three in 36 of 40 draws at a noise of 5.5e-3: it is none of
/// chance.
#[test]
#[ignore = "slow"]
fn the_search_reaches_what_made_the_photographs() {
    let bench = Bench::new(6.0, 8, 16);
    let mut short = Vec::new();
    let mut settled = [0.0; 2];
    for (k, levels) in [
        (2, [0.2, 0.8]),
        (2, [0.1, 0.6]),
        (4, [0.2, 0.8]),
        (4, [0.1, 0.6]),
    ] {
        for noise in [1e-3, 5.5e-3, 3e-2] {
            let mut count = Count::default();
            for seed in 0..DRAWS {
                let light = bench.board(k);
                let truth = light.map(|x| levels[0] + (levels[1] - levels[0]) * x);
                let [phi, stderr] = noisy(&bench, &truth, noise, seed);
                let problem = Problem::new(&phi, &bench.c, &bench.d, Some(&stderr)).unwrap();
                let problem = problem.with_grids(&[[8, 8]]).unwrap();
                let found = recover(Method::JointTwoValued, &problem, &Options::default()).unwrap();
                let chi2 = |x: &DVector<f64>| {
                    let off = (&phi - bench.phi(x)).component_div(&stderr);
                    off.norm_squared()
                };
                let [own, made] = [chi2(&found.reflectance), chi2(&truth)];
                count.reached += u64::from(own <= made + 1e-3);
                let middle = 0.5 * (found.reflectance.min() + found.reflectance.max());
                let same = found.reflectance.map(|x| f64::from(u8::from(x > middle))) == light;
                count.same += u64::from(same);
                let patterns = found.patterns.unwrap();
                let within = |found: [f64; 2], errors: [f64; 2]| {
                    let near = |k: usize| (found[k] - levels[k]).abs() <= 3.0 * errors[k];
                    u64::from(near(0) && near(1))
                };
                if patterns.settled_if_alike {
                    let error = found.standard_error.unwrap();
                    let off = (&found.reflectance - &truth).component_div(&error);
                    assert!(off.amax() < 4.0, "{k} {levels:?} {noise} {seed}: {off}");
                    let probability = patterns.assumed().pattern;
                    settled[0] += f64::from(u8::from(same)) - probability;
                    settled[1] += probability * (1.0 - probability);
                }
                if patterns.sum.converged() {
                    count.stated += 1;
                    count.levels += within(patterns.levels, patterns.level_errors);
                }
                if let Some(found) = &patterns.if_alike {
                    count.alike += 1;
                    count.levels_if_alike += within(found.levels, found.level_errors);
                }
                // Many patterns fit at this noise; few of them have fields.
                if noise < 1e-2 {
                    assert!(same, "{levels:?} {noise} {seed}: {patterns:?}");
                }
                // Where little noise sets one pattern apart, it is that of the photographs.
                if noise < 2e-3 {
                    let told = format!("{k} {levels:?} {seed}: {patterns:?}");
                    assert!((&found.reflectance - &truth).amax() < 0.01, "{told}");
                    assert!(patterns.pattern > 0.2 && patterns.sum.converged(), "{told}");
                    assert!(patterns.if_alike.unwrap().pattern > 0.9, "{told}");
                }
            }
            let most = DRAWS / 40;
            if count.reached + most < DRAWS || count.levels_if_alike + most < count.alike {
                short.push((k, levels, noise, count));
            }
        }
    }
    assert!(short.is_empty(), "{short:?}");
    let [more, variance] = settled;
    assert!(more > -4.0 * variance.sqrt() - 0.5, "{settled:?}");
}

/// Random pictures of 4 × 4 elements, levels and scale known and not: the marginals of the sampler,
/// called itself, are those of the sum over all patterns to 0.02. Where neighbours may be alike so
/// are the levels, a pattern's probability and the evidence, against the same sum weighed anew.
#[test]
#[ignore = "slow"]
fn sampled_marginals_are_those_of_all_patterns() {
    let bench = Bench::new(6.0, 4, 16);
    let mut normal = normal_stream(51);
    let (mut largest, mut alike, mut compared, mut told) = (0.0f64, 0.0f64, 0, 0);
    let prior = neighbours::AlikePrior::new(&[[4, 4]]);
    for noise in [1.0, 0.3, 0.1, 0.03, 1e-2] {
        for seed in 0..4 {
            let light: Vec<bool> = (0..16).map(|_| normal() > 0.0).collect();
            let truth = DVector::from_fn(16, |j, _| if light[j] { 0.8 } else { 0.2 });
            let [phi, stderr] = noisy(&bench, &truth, noise, seed);
            let problem = Problem::new(&phi, &bench.c, &bench.d, Some(&stderr)).unwrap();
            let options = Options::default();
            let coordinates =
                Coordinates::new(Method::JointTwoValued, &problem, &options, 1.0, 1.0).unwrap();
            let (r, d) = coordinates.whitened();
            let two = Some([0.2, 0.8]);
            for (given, scale_error) in [(None, None), (two, None), (two, Some(0.3))] {
                let likelihood = PatternLikelihood {
                    scale_error,
                    ..PatternLikelihood::new(&r, &d, given)
                };
                let exact = enumerated::sum(&likelihood);
                // A factor is linear about a pattern, which should be likely.
                let start = match scale_error {
                    Some(_) => [exact.best.clone()],
                    None => [vec![false; 16]],
                };
                let sampled = sampled::sample(&likelihood, &start, MOST as usize)
                    .unwrap()
                    .unwrap();
                let [all, own] = [&exact, &sampled].map(|sum| sum.patterns.moments.light());
                let off = (own - &all).amax();
                // Draws from a problem that is linear in the scale tell less, and say how much.
                if let (Some(_), Sum::Sampled { disagreement, .. }) = (scale_error, sampled.sum) {
                    assert!(off < 0.02 + 2.0 * disagreement, "{off} {disagreement}");
                    told += usize::from(sampled.sum.converged());
                    continue;
                }
                largest = largest.max(off);
                let drawn = sampled::sample(
                    &PatternLikelihood {
                        alike: prior.as_ref(),
                        scale_error,
                        ..PatternLikelihood::new(&r, &d, given)
                    },
                    std::slice::from_ref(&light),
                    MOST as usize,
                );
                let drawn = drawn.unwrap().unwrap();
                let anew = neighbours::Reweighed::new(prior.as_ref(), &exact.patterns.weights);
                let rule = levels::rule();
                let of = |light: &[bool]| Some(likelihood.weigh(light, &rule, ALL)?.levels);
                let gained = drawn.log_evidence - exact.log_evidence;
                alike = alike.max((gained - anew.gained().unwrap()).abs());
                let found = drawn.finish(&light);
                // Of none where too many patterns are likely.
                let Some(expected) = anew.sum(of) else {
                    continue;
                };
                let share = expected.share(&light);
                let expected = expected.moments.finish(share, 0.0, Sum::Exhaustive);
                compared += 1;
                let [x, y] = [&found, &expected].map(|of| (of.levels, of.level_errors));
                let off = (0..2).flat_map(|k| [x.0[k] - y.0[k], x.1[k] - y.1[k]]);
                let off = off.chain([found.pattern - expected.pattern]);
                alike = off.fold(alike, |most, off| most.max(off.abs()));
            }
        }
    }
    assert!(largest < 0.02 && alike < 0.02, "{largest} {alike}");
    assert!(compared > 20 && told >= 10, "{compared} {told}");
}
