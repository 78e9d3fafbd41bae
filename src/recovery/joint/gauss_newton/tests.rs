use nalgebra::{DMatrix, DVector};

use super::*;
use crate::num::linalg::{Tolerance, pinv};
use crate::recovery::bench::{Bench, normal_stream};
use crate::recovery::{Deviations, Nuisance, recover};

/// A small bench: 4 elements between 0.2 and 0.7, 16 pixels, every tenth spot, errors of 2 %.
struct Small {
    c: DMatrix<f64>,
    d: DMatrix<f64>,
    rho: DVector<f64>,
    stderr: DMatrix<f64>,
}

impl Small {
    fn new() -> Self {
        let bench = Bench::new(3.0, 2, 4);
        let rho = DVector::from_column_slice(&[0.3, 0.7, 0.6, 0.2]);
        let every: Vec<usize> = (0..12).map(|l| 10 * l).collect();
        let stderr = bench.phi(&rho).select_columns(&every) * 0.02;
        Self {
            d: bench.d.select_columns(&every),
            c: bench.c,
            rho,
            stderr,
        }
    }

    fn exact(&self) -> DMatrix<f64> {
        &self.c * DMatrix::from_diagonal(&self.rho) * &self.d
    }

    /// Photographs with noise and with factors of the frames and of all.
    fn drawn(&self, gain: f64, scale: f64, seed: u64) -> DMatrix<f64> {
        let mut normal = normal_stream(seed);
        let whole = 1.0 + scale * normal();
        let mut phi = self.exact() * whole;
        for mut frame in phi.column_iter_mut() {
            frame *= 1.0 + gain * normal();
        }
        phi.zip_map(&self.stderr, |x, s| x + s * normal())
    }

    fn problem<'a>(&'a self, phi: &'a DMatrix<f64>, nuisance: Nuisance<'a>) -> Problem<'a> {
        let problem = Problem::new(phi, &self.c, &self.d, Some(&self.stderr)).unwrap();
        let problem = problem.with_grids(&[[2, 2]]).unwrap();
        problem.with_nuisance(nuisance).unwrap()
    }

    /// The minimum of Σ z² + Σ ε_l²/σ_g² + ε²/σ_s² over x, ε and the strengths of patterns (pixels
    /// × patterns, of each frame), and the inverse of half its Hessian in Gauss and Newton's form:
    /// all rows and columns written out, from the truth, by the pseudo-inverse.
    fn brute(
        &self,
        phi: &DMatrix<f64>,
        patterns: &DMatrix<f64>,
        background: bool,
        [gain, scale]: [Option<f64>; 2],
    ) -> (DVector<f64>, DMatrix<f64>) {
        let (pixels, spots) = phi.shape();
        let n = self.rho.len();
        let (k, a) = (patterns.ncols(), if background { pixels } else { 0 });
        let [gains, whole] = [n, n + if gain.is_some() { spots } else { 0 }];
        let others = whole + usize::from(scale.is_some());
        let all = others + k * spots + a;
        let mut u = DVector::zeros(all);
        u.rows_mut(0, n).copy_from(&self.rho);
        let priors: Vec<(usize, f64)> = (gains..whole)
            .map(|i| (i, gain.unwrap()))
            .chain(scale.map(|s| (whole, s)))
            .collect();
        // Unit of the other light.
        let unit = phi.mean();
        let mut covariance = DMatrix::zeros(all, all);
        for _ in 0..40 {
            let rows = pixels * spots + priors.len();
            let mut j = DMatrix::zeros(rows, all);
            let mut left = DVector::zeros(rows);
            for row in 0..pixels * spots {
                let (p, l) = (row % pixels, row / pixels);
                let one = |e: Option<usize>| e.map_or(1.0, |i| 1.0 + u[i]);
                let own = gain.map(|_| gains + l);
                let all = scale.map(|_| whole);
                let light: f64 = (0..n).map(|i| self.c[(p, i)] * u[i] * self.d[(i, l)]).sum();
                let mut seen = one(own) * one(all) * light;
                for i in 0..n {
                    j[(row, i)] = one(own) * one(all) * self.c[(p, i)] * self.d[(i, l)];
                }
                if let Some(own) = own {
                    j[(row, own)] = one(all) * light;
                }
                if let Some(all) = all {
                    j[(row, all)] = one(own) * light;
                }
                for i in 0..k {
                    j[(row, others + l * k + i)] = unit * patterns[(p, i)];
                    seen += unit * patterns[(p, i)] * u[others + l * k + i];
                }
                if background {
                    j[(row, others + k * spots + p)] = unit;
                    seen += unit * u[others + k * spots + p];
                }
                let weight = 1.0 / self.stderr[(p, l)];
                j.row_mut(row).scale_mut(weight);
                left[row] = weight * (phi[(p, l)] - seen);
            }
            for (at, (i, known)) in priors.iter().enumerate() {
                j[(pixels * spots + at, *i)] = 1.0 / known;
                left[pixels * spots + at] = -u[*i] / known;
            }
            let inverse = pinv(&j, Tolerance::Relative(1e-9)).unwrap().matrix;
            u += &inverse * left;
            covariance = &inverse * inverse.transpose();
        }
        (u, covariance)
    }
}

fn near(found: f64, expected: f64, to: f64) -> bool {
    (found - expected).abs() <= to * expected.abs()
}

fn gains(found: &Recovered) -> &Gains {
    found.nuisance.as_ref().unwrap().gains.as_ref().unwrap()
}

/// ρ̂, its standard errors and its covariance, ε̂ and its standard errors, against the minimum and
/// the inverse Hessian of the whole problem written out; with other light too.
#[test]
fn it_is_the_minimum_over_picture_and_factors_written_out() {
    let small = Small::new();
    let none = DMatrix::zeros(16, 0);
    let constant = DMatrix::from_element(16, 1, 1.0);
    let slope = DMatrix::from_fn(16, 2, |p, k| if k == 0 { 1.0 } else { (p % 4) as f64 });
    let cases = [
        (Some(0.1), None, &none, false),
        (None, Some(0.05), &none, false),
        (Some(0.1), Some(0.05), &none, false),
        (Some(0.1), Some(0.05), &constant, false),
        (Some(0.1), None, &slope, false),
        (Some(0.1), None, &none, true),
        (Some(0.1), Some(0.05), &constant, true),
    ];
    for (frame_gain, scale_error, patterns, background) in cases {
        let drawn = [frame_gain, scale_error].map(|known| known.unwrap_or(0.0));
        let phi = small.drawn(drawn[0], drawn[1], 3);
        let nuisance = Nuisance {
            frame_gain,
            scale_error,
            frame_patterns: (patterns.ncols() > 0).then_some(patterns),
            background,
            ..Nuisance::default()
        };
        let problem = small.problem(&phi, nuisance);
        let free = recover(Method::JointUnbounded, &problem, &Options::default()).unwrap();
        let bounded = recover(Method::Joint, &problem, &Options::default()).unwrap();
        let (u, covariance) = small.brute(&phi, patterns, background, [frame_gain, scale_error]);
        let case = format!(
            "{frame_gain:?} {scale_error:?} {} {background}",
            patterns.ncols()
        );
        assert!(gains(&free).settled, "{case}: {:?}", gains(&free));
        let stderr = free.standard_error.as_ref().unwrap();
        for j in 0..4 {
            let expected = covariance[(j, j)].sqrt();
            assert!(
                (free.reflectance[j] - u[j]).abs() < 1e-3 * expected,
                "{case}"
            );
            assert!(
                (bounded.reflectance[j] - u[j]).abs() < 1e-3 * expected,
                "{case}"
            );
            assert!(
                near(stderr[j], expected, 1e-4),
                "{case}: {} {expected}",
                stderr[j]
            );
            let own = free.covariance.as_ref().unwrap()[(0, j)];
            assert!((own - covariance[(0, j)]).abs() < 1e-4 * expected * expected.max(stderr[0]));
        }
        let mut at = 4;
        for of in [&gains(&free).frames, &gains(&free).whole]
            .into_iter()
            .flatten()
        {
            for (size, error) in of.size.iter().zip(of.standard_error.iter()) {
                let expected = covariance[(at, at)].sqrt();
                assert!(
                    (size - u[at]).abs() < 1e-3 * expected,
                    "{case}: {size} {}",
                    u[at]
                );
                assert!(near(*error, expected, 1e-4), "{case}: {error} {expected}");
                assert!(*error <= of.known_to * (1.0 + 1e-9) && !of.picture_given);
                at += 1;
            }
        }
    }
}

/// An entry left out, and glare, take nothing from it: the minimum written out has the entry
/// without weight.
#[test]
fn entries_left_out_have_no_factor() {
    let mut small = Small::new();
    let mut phi = small.drawn(0.1, 0.0, 4);
    let mut flags = DMatrix::zeros(16, 12);
    for at in [(3, 2), (7, 2), (15, 11)] {
        flags[at] = 1.0;
        phi[at] *= 5.0;
    }
    let nuisance = Nuisance {
        frame_gain: Some(0.1),
        left_out: Some(&flags),
        ..Nuisance::default()
    };
    let problem = small.problem(&phi, nuisance);
    let found = recover(Method::JointUnbounded, &problem, &Options::default()).unwrap();
    let found = found.reflectance;
    small
        .stderr
        .zip_apply(&flags, |s, flag| *s *= 1.0 + 1e9 * flag);
    let (u, covariance) = small.brute(&phi, &DMatrix::zeros(16, 0), false, [Some(0.1), None]);
    for j in 0..4 {
        assert!((found[j] - u[j]).abs() < 1e-3 * covariance[(j, j)].sqrt());
    }
}

/// 200 draws of random factors and noise, 4 elements each: 95 % bars of ρ, and of ε, cover within
/// 4.5 standard deviations of the draws' number (those of one draw hang together: counted as
/// draws); without the option far less.
#[test]
fn bars_cover_with_the_option_and_not_without() {
    let small = Small::new();
    let draws = 200;
    let mut covered = [0.0; 3];
    for seed in 0..draws {
        let mut normal = normal_stream(1000 + seed);
        let mut phi = small.exact();
        let drawn: Vec<f64> = (0..12).map(|_| 0.1 * normal()).collect();
        for (mut frame, gain) in phi.column_iter_mut().zip(&drawn) {
            frame *= 1.0 + gain;
        }
        let phi = phi.zip_map(&small.stderr, |x, s| x + s * normal());
        let nuisance = Nuisance {
            frame_gain: Some(0.1),
            ..Nuisance::default()
        };
        let [with, without] = [nuisance, Nuisance::default()].map(|nuisance| {
            let problem = small.problem(&phi, nuisance);
            recover(Method::JointUnbounded, &problem, &Options::default()).unwrap()
        });
        let share = |sizes: &DVector<f64>, errors: &DVector<f64>, truth: &[f64]| {
            let of = sizes.iter().zip(errors.iter()).zip(truth);
            let within = of.filter(|((x, s), truth)| (*x - *truth).abs() < 1.959964 * *s);
            within.count() as f64 / truth.len() as f64
        };
        for (sum, found) in covered.iter_mut().zip([&with, &without]) {
            let errors = found.standard_error.as_ref().unwrap();
            *sum += share(&found.reflectance, errors, small.rho.as_slice()) / draws as f64;
        }
        let Deviations {
            size,
            standard_error,
            ..
        } = gains(&with).frames.as_ref().unwrap();
        covered[2] += share(size, standard_error, &drawn) / draws as f64;
    }
    let room = 4.5 * (0.95f64 * 0.05 / draws as f64).sqrt();
    let [with, without, of_gains] = covered;
    assert!((with - 0.95).abs() < room, "{covered:?}");
    assert!((of_gains - 0.95).abs() < room, "{covered:?}");
    assert!(without < 0.8, "{covered:?}");
}

/// A wide prior is the exact elimination of the light of each frame as a pattern of unknown
/// strength, a narrow one changes nothing.
#[test]
fn wide_priors_eliminate_and_narrow_ones_do_nothing() {
    let small = Small::new();
    let phi = small.drawn(0.05, 0.0, 5);
    let light = small.exact();
    let plain = small.problem(&phi, Nuisance::default());
    let options = Options {
        weighting: WeightRule::Entries,
        ..Options::default()
    };
    for background in [false, true] {
        let glare = Nuisance {
            glare: Some(&light),
            background,
            ..Nuisance::default()
        };
        let none = Nuisance {
            glare: None,
            ..glare
        };
        let cases = [(1e5, glare), (1e-7, none)];
        for (known_to, nuisance) in cases {
            let soft = Soft {
                frames: Some((light.clone(), known_to)),
                ..Soft::NONE
            };
            let base = plain.with_nuisance(none).unwrap();
            let own = base.about(&phi, &small.d, &soft);
            let other = plain.with_nuisance(nuisance).unwrap();
            // By rows, each of its own weight, as the other.
            let other = other.about(&phi, &small.d, &Soft::NONE);
            let [own, other] =
                [own, other].map(|p| operator(&p, &options).unwrap().directions().unwrap());
            // With one strength in each frame unknown the picture's scale is lost.
            let rank = if known_to > 1.0 { 3 } else { 4 };
            for i in 0..rank {
                assert!(near(own.0.sigma[i], other.0.sigma[i], 1e-6), "{known_to}");
                assert!((own.1[i].abs() - other.1[i].abs()).abs() < 1e-4 * other.1.amax());
            }
            if rank == 3 {
                let lost = own.0.sigma.get(3);
                assert!(lost.is_none_or(|s| *s < 1e-3 * own.0.sigma[2]));
            }
        }
    }
    let narrow = small.problem(
        &phi,
        Nuisance {
            frame_gain: Some(1e-9),
            scale_error: Some(1e-9),
            ..Nuisance::default()
        },
    );
    for method in [
        Method::JointUnbounded,
        Method::JointGp,
        Method::JointTwoValued,
    ] {
        let [a, b] = [narrow, plain].map(|p| recover(method, &p, &options).unwrap());
        assert!((a.reflectance - b.reflectance).amax() < 1e-6, "{method}");
        if let (Some(a), Some(b)) = (a.log_evidence, b.log_evidence) {
            assert!((a - b).abs() < 1e-4, "{method}: {a} {b}");
        }
    }
}

/// A surface of one reflectance, of a scale known to 5 %: its mean is known to no less, and to
/// hardly more where the noise is small; the factor itself is known to its σ.
#[test]
fn a_scale_known_to_five_percent_leaves_five_percent() {
    let small = Small::new();
    let flat = DVector::from_element(4, 0.6);
    let phi = &small.c * DMatrix::from_diagonal(&flat) * &small.d;
    let nuisance = Nuisance {
        scale_error: Some(0.05),
        ..Nuisance::default()
    };
    let stderr = &phi * 1e-3;
    let problem = Problem::new(&phi, &small.c, &small.d, Some(&stderr)).unwrap();
    let problem = problem.with_grids(&[[2, 2]]).unwrap();
    let problem = problem.with_nuisance(nuisance).unwrap();
    let of_mean = |found: &Recovered| found.covariance.as_ref().unwrap().mean().sqrt() / 0.6;
    let free = recover(Method::JointUnbounded, &problem, &Options::default()).unwrap();
    assert!(
        free.standard_error
            .as_ref()
            .unwrap()
            .iter()
            .all(|s| *s >= 0.05 * 0.6)
    );
    assert!(
        (0.05..0.0505).contains(&of_mean(&free)),
        "{}",
        of_mean(&free)
    );
    let of = gains(&free);
    assert!(of.widened.unwrap() > 1.0, "{of:?}");
    let whole = of.whole.as_ref().unwrap();
    assert!(near(whole.standard_error[0], 0.05, 1e-6) && whole.size[0].abs() < 1e-6);
    // What is known of pictures beforehand, ½ ± ½ throughout, tells a little of the scale.
    let smooth = recover(Method::JointGp, &problem, &Options::default()).unwrap();
    assert!(
        (0.048..0.0505).contains(&of_mean(&smooth)),
        "{}",
        of_mean(&smooth)
    );
    let levels = recover(Method::JointTwoValued, &problem, &Options::default()).unwrap();
    assert!(gains(&levels).settled, "{:?}", gains(&levels));
}

/// A picture of many reflectances is none of two, and gains that were found with one of two are
/// wrong: there are no standard errors then. Of a picture of two there are, and they hold it.
#[test]
fn gains_of_a_refuted_pattern_leave_no_errors() {
    let nuisance = Nuisance {
        frame_gain: Some(0.3),
        ..Nuisance::default()
    };
    for (rho, is_of_two) in [([0.1, 0.9, 0.55, 0.3], false), ([0.2, 0.8, 0.8, 0.2], true)] {
        let mut small = Small::new();
        small.rho = DVector::from_column_slice(&rho);
        let phi = small.drawn(0.3, 0.0, 5);
        let problem = small.problem(&phi, nuisance);
        let found = recover(Method::JointTwoValued, &problem, &Options::default()).unwrap();
        assert_eq!(found.rests_on_wrong_gains(), !is_of_two);
        assert_eq!(found.standard_error.is_some(), is_of_two);
        if let Some(error) = found.standard_error {
            let off = (&found.reflectance - &small.rho).component_div(&error);
            assert!(off.amax() < 4.0, "{off}");
        }
    }
}

/// The evidence of factors against the density of the data written out, N(Φ; A x, Σ + …) for a
/// picture whose levels are given: all patterns summed. It rises where there are factors, by far,
/// and falls where there are none.
#[test]
fn the_evidence_punishes_factors_that_nothing_asks_for() {
    let mut small = Small::new();
    small.rho = DVector::from_column_slice(&[0.25, 0.7, 0.7, 0.25]);
    let small = small;
    let nuisance = Nuisance {
        frame_gain: Some(0.1),
        ..Nuisance::default()
    };
    let evidence = |phi: &DMatrix<f64>, nuisance, method| {
        let problem = small.problem(phi, nuisance);
        let found = recover(method, &problem, &Options::default()).unwrap();
        found.log_evidence.unwrap()
    };
    for method in [Method::JointGp, Method::JointTwoValued] {
        let [drifting, steady] = [0.1, 0.0].map(|gain| {
            let phi = small.drawn(gain, 0.0, 8);
            evidence(&phi, nuisance, method) - evidence(&phi, Nuisance::default(), method)
        });
        assert!(
            drifting > 100.0 && steady < -10.0,
            "{method}: {drifting} {steady}"
        );
    }
    // Of joint-gp the density of the data with the factors linear about x̂, all written out: x is
    // normal with each pair of its lattice, so that a mixture of normals is the density. It is
    // compared by its gain over no factors, for one pair: a flat surface, where the pair does not
    // matter.
    let phi = small.drawn(0.1, 0.0, 9);
    let problem = small.problem(&phi, nuisance);
    let found = recover(Method::JointUnbounded, &problem, &Options::default()).unwrap();
    let base = problem.without_gains();
    let at = Estimates {
        x: found.seen(),
        frames: gains(&found).frames.as_ref().unwrap().size.clone(),
        whole: 0.0,
        noise: 1.0,
        directions: 0.0,
    };
    let linear = Linear::about(&problem, &at);
    let options = Options::default();
    let own = punished(0.0, &base, &linear.problem(&base), &options);
    let own = own.unwrap().unwrap();
    // −2 ln of the largest density over x.
    let deviance = |phi: &DMatrix<f64>, d: &DMatrix<f64>, known_to: f64| {
        let all = phi.len();
        let weight = |row: usize| 1.0 / small.stderr[(row % 16, row / 16)];
        let k = DMatrix::from_fn(all, 4, |row, j| {
            weight(row) * small.c[(row % 16, j)] * d[(j, row / 16)]
        });
        let y = DVector::from_fn(all, |row, _| weight(row) * phi[(row % 16, row / 16)]);
        let m = problem.light(&at.x);
        let covariance = DMatrix::from_fn(all, all, |a, b| {
            let own = if a / 16 == b / 16 {
                let of = |row: usize| weight(row) * m[(row % 16, row / 16)];
                known_to * known_to * of(a) * of(b)
            } else {
                0.0
            };
            own + f64::from(u8::from(a == b))
        });
        let log_det = libm::log(covariance.determinant());
        let inverse = covariance.try_inverse().unwrap();
        let normal = k.transpose() * &inverse * &k;
        let x = normal.try_inverse().unwrap() * k.transpose() * &inverse * &y;
        let left = &y - &k * x;
        log_det + left.dot(&(&inverse * &left))
    };
    let expected = 0.5 * (deviance(&phi, &small.d, 0.0) - deviance(&linear.phi, &linear.d, 0.1));
    assert!(
        (own - expected).abs() < 1e-4 * expected.abs(),
        "{own} {expected}"
    );
}

/// Numbers between 0 and 1, all as likely.
fn levels(seed: u64) -> impl FnMut() -> f64 {
    let mut normal = normal_stream(seed);
    move || 0.5 * libm::erfc(-normal() / 2f64.sqrt())
}

/// Sides of a model that tells 36 elements apart.
fn sides(level: &mut impl FnMut() -> f64, spots: usize) -> (DMatrix<f64>, DMatrix<f64>) {
    (
        DMatrix::from_fn(60, 36, |_, _| level()),
        DMatrix::from_fn(36, spots, |_, _| level()),
    )
}

/// Photographs with their errors, of 6 × 6 elements, by `joint-gp`.
fn by_process(
    (c, d): (&DMatrix<f64>, &DMatrix<f64>),
    [phi, stderr]: [&DMatrix<f64>; 2],
    nuisance: Nuisance<'_>,
) -> Recovered {
    let problem = Problem::new(phi, c, d, Some(stderr)).unwrap();
    let problem = problem.with_grids(&[[6, 6]]).unwrap();
    let problem = problem.with_nuisance(nuisance).unwrap();
    recover(Method::JointGp, &problem, &Options::default()).unwrap()
}

/// Photographs that tell each element tell nothing of a factor of all, and a picture of a prior's
/// size little: with (1 + ε) A in place of A, by Gauss's rule over ε,
///
/// > p(ε|Φ) ∝ N(ε; 0, σ²) p(Φ|ε),   p(Φ|ε) the evidence with the factor known,
///
/// the same mean and evidence, and errors that are no smaller, of elements between 0 and 1 and a
/// factor that is off. A fit of picture and factor together is off by 36 σ².
#[test]
fn a_factor_of_all_is_averaged_over_not_fitted_with_the_picture() {
    let mut level = levels(77);
    let (c, d) = sides(&mut level, 40);
    let rho = DVector::from_fn(36, |_, _| level());
    let known = 0.07;
    let clean = &c * DMatrix::from_diagonal(&rho) * &d * (1.0 - known);
    let stderr = clean.map(|_| 0.02 * clean.mean());
    let mut normal = normal_stream(78);
    let phi = clean.zip_map(&stderr, |x, s| x + s * normal());
    let recovered = |factor: f64, nuisance: Nuisance<'_>| {
        by_process((&c, &d), [&(&phi / factor), &(&stderr / factor)], nuisance)
    };
    let nodes: Vec<(f64, f64, Recovered)> = (-20..=20)
        .map(|k| {
            let z = 0.25 * f64::from(k);
            let found = recovered(1.0 + known * z, Nuisance::default());
            let density = 0.25 * libm::exp(-0.5 * z * z) / std::f64::consts::TAU.sqrt();
            (
                known * z,
                libm::log(density) + found.log_evidence.unwrap(),
                found,
            )
        })
        .collect();
    let most = nodes
        .iter()
        .fold(f64::NEG_INFINITY, |m, node| m.max(node.1));
    let all: f64 = nodes.iter().map(|node| libm::exp(node.1 - most)).sum();
    let average = |of: &dyn Fn(f64, &Recovered) -> f64| -> f64 {
        let each = nodes.iter();
        let each = each.map(|(e, log, found)| libm::exp(log - most) / all * of(*e, found));
        each.sum()
    };
    let found = recovered(
        1.0,
        Nuisance {
            scale_error: Some(known),
            ..Nuisance::default()
        },
    );
    let whole = gains(&found).whole.as_ref().unwrap();
    let errors = found.standard_error.as_ref().unwrap();
    // Of the factor, and of each element.
    let mut told = vec![[
        whole.size[0],
        whole.standard_error[0],
        average(&|e, _| e),
        0.0,
    ]];
    told[0][3] = average(&|e, _| e * e);
    for j in 0..36 {
        let own = |_: f64, f: &Recovered| f.reflectance[j];
        let square = |_: f64, f: &Recovered| {
            f.standard_error.as_ref().unwrap()[j].powi(2) + f.reflectance[j].powi(2)
        };
        told.push([own(0.0, &found), errors[j], average(&own), average(&square)]);
    }
    for (k, [own, stated, mean, square]) in told.into_iter().enumerate() {
        let error = (square - mean * mean).sqrt();
        let off = (own - mean).abs() / error;
        assert!(off < 0.2, "{k}: {own} {mean} ± {error}");
        // The linear problem knows less of the factor than there is to know: 1.35 times the error.
        let ratio = stated / error;
        assert!((0.95..1.4).contains(&ratio), "{k}: {stated} {error}");
    }
    let evidence = most + libm::log(all);
    let own = found.log_evidence.unwrap();
    assert!((own - evidence).abs() < 0.1, "{own} {evidence}");
}

/// Factors of single frames have a mean, which is a factor of all known to σ_g/√n: a fit of it with
/// the picture is off by N σ_g²/n.
#[test]
fn factors_of_frames_do_not_lessen_the_picture() {
    let mut level = levels(80);
    let (c, d) = sides(&mut level, 12);
    let (known, trials) = (0.2, 20);
    let mut mean = 0.0;
    let nuisance = Nuisance {
        frame_gain: Some(known),
        ..Nuisance::default()
    };
    for _ in 0..trials {
        let rho = DVector::from_fn(36, |_, _| level());
        let phi = &c * DMatrix::from_diagonal(&rho) * &d;
        let stderr = phi.map(|_| 0.01 * phi.mean());
        let phi = phi.zip_map(&stderr, |x, s| x + s * 12f64.sqrt() * (level() - 0.5));
        let found = by_process((&c, &d), [&phi, &stderr], nuisance);
        mean += gains(&found).frames.as_ref().unwrap().size.mean() / f64::from(trials);
    }
    // 0.12 where they are fitted with the picture.
    assert!(mean.abs() < 0.02, "{mean}");
}

/// Of a frame that does not count nothing is known but what was said.
#[test]
fn a_frame_that_is_left_out_has_the_factor_that_was_said() {
    let small = Small::new();
    let phi = small.drawn(0.1, 0.0, 4);
    let flags = DMatrix::from_fn(16, 12, |_, l| f64::from(u8::from(l == 5)));
    let nuisance = Nuisance {
        frame_gain: Some(0.1),
        left_out: Some(&flags),
        ..Nuisance::default()
    };
    let problem = small.problem(&phi, nuisance);
    for method in [Method::JointGp, Method::JointUnbounded] {
        let found = recover(method, &problem, &Options::default()).unwrap();
        let frames = gains(&found).frames.as_ref().unwrap();
        assert!(frames.size[5].abs() < 1e-12, "{method} {}", frames.size[5]);
        assert!(
            (frames.standard_error[5] / 0.1 - 1.0).abs() < 1e-9,
            "{frames:?}"
        );
        assert!(frames.size[4].abs() > 1e-4, "{method} {}", frames.size[4]);
    }
}

/// Methods with bounds, with levels, with a free scale and of unknown noise find the factors of the
/// frames: of 2 % noise in 16 pixels each is known to a hundredth, their mean where the scale is
/// free to what their prior says.
#[test]
fn every_method_finds_the_factors() {
    let mut small = Small::new();
    small.rho = DVector::from_column_slice(&[0.25, 0.7, 0.7, 0.25]);
    let mut normal = normal_stream(12);
    let drawn = DVector::from_fn(12, |_, _| 0.1 * normal());
    let mut phi = small.exact();
    for (mut frame, gain) in phi.column_iter_mut().zip(drawn.iter()) {
        frame *= 1.0 + gain;
    }
    let phi = phi.zip_map(&small.stderr, |x, s| x + s * normal());
    let methods = [
        Method::JointUnbounded,
        Method::Joint,
        Method::Nnls,
        Method::JointGp,
        Method::JointTv,
        Method::JointTwoValued,
    ];
    for method in methods {
        for (free_scale, known) in [(false, true), (true, true), (false, false), (true, false)] {
            if method == Method::JointTv && !known {
                continue;
            }
            let nuisance = Nuisance {
                frame_gain: Some(0.1),
                free_scale,
                ..Nuisance::default()
            };
            let stderr = known.then_some(&small.stderr);
            let problem = Problem::new(&phi, &small.c, &small.d, stderr).unwrap();
            let problem = problem.with_grids(&[[2, 2]]).unwrap();
            let problem = problem.with_nuisance(nuisance).unwrap();
            let found = recover(method, &problem, &Options::default()).unwrap();
            let case = format!("{method} {free_scale} {known}");
            let own = gains(&found);
            let frames = own.frames.as_ref().unwrap();
            let off = &frames.size - &drawn;
            // Their common part is the picture's: the scale of ρ is that of the factors.
            let off = off.add_scalar(-off.mean());
            assert!(own.settled, "{case}: {own:?}");
            assert!(off.amax() < 0.025, "{case}: {off}");
            assert!(
                frames.size.mean().abs() < 0.1 * 3.0 / 12f64.sqrt(),
                "{case}"
            );
            assert!(
                found.relative_residual < 0.03,
                "{case}: {}",
                found.relative_residual
            );
        }
    }
}

/// Right photographs of much larger factors than noise are never refused as understated noise: the
/// first linear problems, about factors of 1, explain none of them. Of 40 pictures of 3 × 3
/// elements at most twice the noise of 0.1 % is left.
#[test]
fn large_factors_are_not_taken_for_understated_noise() {
    let bench = Bench::new(3.0, 3, 8);
    let every: Vec<usize> = (0..20).map(|l| 6 * l).collect();
    let d = bench.d.select_columns(&every);
    let nuisance = Nuisance {
        frame_gain: Some(0.05),
        ..Nuisance::default()
    };
    for seed in 0..40 {
        let (mut level, mut normal) = (levels(seed), normal_stream(500 + seed));
        let rho = DVector::from_fn(9, |_, _| 0.05 + 0.9 * level());
        let mut phi = &bench.c * DMatrix::from_diagonal(&rho) * &d;
        for mut frame in phi.column_iter_mut() {
            frame *= 1.0 + 0.05 * normal();
        }
        let stderr = &phi * 1e-3;
        let phi = phi.zip_map(&stderr, |x, s| x + s * normal());
        let problem = Problem::new(&phi, &bench.c, &d, Some(&stderr)).unwrap();
        let problem = problem.with_grids(&[[3, 3]]).unwrap();
        let problem = problem.with_nuisance(nuisance).unwrap();
        let found = recover(Method::JointTv, &problem, &Options::default());
        let left = found
            .unwrap_or_else(|error| panic!("{seed}: {error}"))
            .relative_residual;
        assert!(left < 2e-3, "{seed}: {left}");
    }
}

#[test]
fn deviations_without_meaning_are_refused() {
    let small = Small::new();
    let phi = small.exact();
    let problem = small.problem(&phi, Nuisance::default());
    for value in [0.0, -0.1, 1.5, f64::NAN, f64::INFINITY] {
        let gain = Nuisance {
            frame_gain: Some(value),
            ..Nuisance::default()
        };
        let scale = Nuisance {
            scale_error: Some(value),
            ..Nuisance::default()
        };
        for nuisance in [gain, scale] {
            let refused = problem.with_nuisance(nuisance).unwrap_err().to_string();
            assert!(refused.contains("at most 1"), "{refused}");
        }
    }
    let twice = Nuisance {
        scale_error: Some(0.05),
        free_scale: true,
        ..Nuisance::default()
    };
    assert_eq!(
        problem.with_nuisance(twice).unwrap_err(),
        RecoveryError::ScaleTwice
    );
    let gain = Nuisance {
        frame_gain: Some(0.1),
        ..Nuisance::default()
    };
    let problem = problem.with_nuisance(gain).unwrap();
    assert!(recover(Method::Tsvd, &problem, &Options::default()).is_err());
}
