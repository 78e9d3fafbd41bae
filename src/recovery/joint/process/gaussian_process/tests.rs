use nalgebra::{DMatrix, DVector};

use crate::num::linalg::{columns_times, svd};
use crate::recovery::bench::{Bench, normal_stream, relative_noise};
use crate::recovery::{
    BandKind, Choice, Method, Nuisance, Options, Problem, Recovered, RecoveryError, WeightRule,
    recover,
};

fn gp(problem: &Problem<'_>, options: &Options) -> Recovered {
    recover(Method::JointGp, problem, options).unwrap()
}

/// One element seen n times with signal a and noise σ: ŷ = Φ̄/a with variance e = σ²/(n a²). At one
/// τ the posterior is N(½ + v z/(v + e), v e/(v + e)), v = ¼ + τ², z = ŷ − ½, and p(y | τ) ∝ N(z;
/// 0, v + e); over τ a sum of many terms, ten times as fine as the lattice, and one in fifty of τ =
/// 0.
#[test]
fn one_element_by_hand() {
    let (c, d) = (
        DMatrix::from_element(2, 1, 0.3),
        DMatrix::from_element(1, 3, 1.0),
    );
    let stderr = DMatrix::from_element(2, 3, 0.4);
    for y in [0.45, 1.2] {
        let phi = DMatrix::from_element(2, 3, 0.3 * y);
        let problem = Problem::new(&phi, &c, &d, Some(&stderr)).unwrap();
        let found = gp(&problem, &Options::default());
        let e: f64 = 0.16 / (6.0 * 0.09);
        let (mut sum, mut first, mut second) = (0.0, 0.0, 0.0);
        let steps = (-90..=90).map(|step| 0.035 * f64::from(step));
        let density = |z: f64| libm::exp(-0.5 * (z / 0.98).powi(2));
        let prior: f64 = steps.clone().map(density).sum();
        let varied = steps.map(|z| (libm::exp(-2.13 + z), 0.98 * density(z) / prior));
        let mut apart = (sum, first, second);
        for (tau, own) in varied.chain([(0.0, 0.02)]) {
            let (v, left) = (0.25 + tau * tau, y - 0.5);
            let weight = own * libm::exp(-0.5 * left * left / (v + e)) / (v + e).sqrt();
            let (mean, variance) = (0.5 + v * left / (v + e), v * e / (v + e));
            sum += weight;
            first += weight * mean;
            second += weight * (variance + mean * mean);
            if tau > 0.0 {
                apart = (sum, first, second);
            }
        }
        let mean = first / sum;
        let sd = (second / sum - mean * mean).sqrt();
        assert!((found.reflectance[0] - mean).abs() < 3e-3 * sd, "{y}");
        assert!((found.standard_error.as_ref().unwrap()[0] / sd - 1.0).abs() < 3e-3);
        assert!((found.covariance.unwrap()[(0, 0)] / (sd * sd) - 1.0).abs() < 6e-3);
        // Without neighbours the lengths are alike: the mean picture's error without the flat one.
        let Choice::Averaged { if_unalike, .. } = found.choice else {
            panic!("{:?}", found.choice)
        };
        let [one, two] = [apart.1 / apart.0, apart.2 / apart.0];
        let own = (two - 2.0 * one * mean + mean * mean).sqrt();
        assert!((if_unalike.unwrap() / (own / sd) - 1.0).abs() < 3e-3);
        let log = found.log_evidence.unwrap();
        assert!((log - libm::log(sum * e.sqrt())).abs() < 3e-3, "{log}");
    }
}

/// Two neighbours, of which three photographs tell the sum well and the difference badly: mean,
/// errors and how many times these are too small were the two not alike, by a sum over all
/// priors, of normal distributions of two variables. How far the picture is from that of neighbours
/// that are not alike makes three hundredths of it.
#[test]
fn two_elements_by_hand() {
    let d = DMatrix::from_element(2, 1, 1.0);
    let k = |length: f64, tau: f64, own: f64| {
        let alike = (1.0 - own) * libm::exp(-1.0 / length);
        DMatrix::from_fn(2, 2, |i, j| {
            0.25 + tau * tau * if i == j { 1.0 } else { alike }
        })
    };
    for (sigma, unlike, apart) in [(0.3, 0.5, 1.2), (0.1, 0.2, 0.8)] {
        let [more, less] = [1.0 + unlike, 1.0 - unlike];
        let c = DMatrix::from_column_slice(3, 2, &[1.0, less, more, 1.0, more, less]);
        let stderr = DMatrix::from_element(3, 1, sigma);
        let truth = [0.5 + 0.5 * apart, 0.5 - 0.5 * apart];
        let phi = &c * DMatrix::from_column_slice(2, 1, &truth);
        let problem = Problem::new(&phi, &c, &d, Some(&stderr)).unwrap();
        let found = gp(&problem, &Options::default());
        // Weight, mean and covariance of each prior.
        let left = &phi - &c * DMatrix::from_element(2, 1, 0.5);
        let of = |length: f64, tau: f64, own: f64, prior: f64| {
            let k = k(length, tau, own);
            let s = &c * &k * c.transpose() + DMatrix::identity(3, 3) * (sigma * sigma);
            let inverse = s.clone().try_inverse().unwrap();
            let gain = &k * c.transpose() * &inverse;
            let chi2 = (left.transpose() * &inverse * &left)[(0, 0)];
            let weight = prior * libm::exp(-0.5 * chi2) / s.determinant().sqrt();
            let mean = (&gain * &left).add_scalar(0.5);
            (weight, mean, &k - &gain * &c * &k)
        };
        let mut all = vec![of(1.0, 0.0, 0.0, 0.02)];
        // Lengths from 0.4 to 8 distances at least, in steps of ½ of the logarithm.
        for length in (0..7).map(|k| 0.4 * libm::exp(0.5 * f64::from(k))) {
            let normal = |z: f64| libm::exp(-0.5 * (z / 0.98).powi(2));
            let steps: Vec<f64> = (-90..=90).map(|step| 0.035 * f64::from(step)).collect();
            let sum: f64 = steps.iter().map(|z| normal(*z)).sum();
            for own in [0.0, 0.1, 0.3] {
                for z in &steps {
                    let prior = 0.98 * normal(*z) / (sum * 21.0);
                    all.push(of(length, libm::exp(z - 2.13), own, prior));
                }
            }
        }
        let moments = |some: &[(f64, DMatrix<f64>, DMatrix<f64>)]| {
            let weight: f64 = some.iter().map(|part| part.0).sum();
            let mean = some.iter().map(|(w, m, _)| m * (w / weight));
            let square = some
                .iter()
                .map(|(w, m, v)| (m * m.transpose() + v) * (w / weight));
            let mean = mean.fold(DMatrix::zeros(2, 1), |sum, x| sum + x);
            (mean, square.fold(DMatrix::zeros(2, 2), |sum, x| sum + x))
        };
        let (mean, square) = moments(&all);
        // After the flat one, the shortest length: three times 181.
        let (apart, apart_square) = moments(&all[1..1 + 3 * 181]);
        let mut ratio = 0.0;
        for j in 0..2 {
            let variance = square[(j, j)] - mean[j] * mean[j];
            let sd = variance.sqrt();
            assert!(
                (found.reflectance[j] - mean[j]).abs() < 3e-3 * sd,
                "{truth:?}"
            );
            assert!((found.standard_error.as_ref().unwrap()[j] / sd - 1.0).abs() < 3e-3);
            let about = apart_square[(j, j)] - 2.0 * mean[j] * apart[j] + mean[j] * mean[j];
            ratio += 0.5 * about / variance;
        }
        let Choice::Averaged { if_unalike, .. } = found.choice else {
            panic!("{:?}", found.choice)
        };
        let times = if_unalike.unwrap();
        let off = times / ratio.sqrt() - 1.0;
        assert!(off.abs() < 3e-3, "{truth:?}: {times} {off}");
    }
}

/// A picture of 5 × 5 elements as the method takes pictures to be.
fn drawn(normal: &mut impl FnMut() -> f64, tau: f64, length: f64, own: f64) -> DVector<f64> {
    let distance = |i: usize, j: usize| {
        libm::hypot(
            (i % 5) as f64 - (j % 5) as f64,
            (i / 5) as f64 - (j / 5) as f64,
        )
    };
    let k = DMatrix::from_fn(25, 25, |i, j| {
        let alike = (1.0 - own) * libm::exp(-distance(i, j) / length);
        alike + if i == j { own } else { 0.0 }
    });
    let found = svd(&k).unwrap();
    let root = columns_times(found.u, &found.sigma.map(f64::sqrt));
    let mean = 0.5 + 0.5 * normal();
    let white = DVector::from_fn(25, |_, _| normal());
    (root * white * tau).add_scalar(mean)
}

/// Pictures that are what the method takes them for, spread, length and independent share drawn as
/// it says: of all their elements 95 % bands cover 95 %, and z = (ρ̂ − ρ)/σ has the square 1 in the
/// mean; where they may be of one reflectance, which none is, the square is that of the errors that
/// are told for pictures that vary. 300 pictures; elements of one hang together, so the error is
/// taken from the scatter among pictures, five standard errors.
#[test]
fn pictures_of_the_prior_are_covered_as_promised() {
    let bench = Bench::new(6.0, 5, 8);
    let mut normal = normal_stream(21);
    let options = Options {
        bands: Some(0.95),
        ..Options::default()
    };
    for noise in [1e-3, 1e-1] {
        let mut shares = Vec::new();
        let mut squares = Vec::new();
        let mut uneven = Vec::new();
        for seed in 0..300u64 {
            let tau = libm::exp(-2.13 + 0.98 * normal());
            // Twelve lengths of the lattice, one after the other.
            let length = 0.4 * libm::exp(0.5 * (seed % 10) as f64);
            let own = [0.0, 0.1, 0.3][(seed / 10 % 3) as usize];
            let truth = drawn(&mut normal, tau, length, own);
            let exact = bench.phi(&truth);
            let stderr = bench.phi(&DVector::from_element(25, 0.5)) * noise;
            let phi = exact.zip_map(&stderr, |x, s| x + s * normal());
            let problem = Problem::new(&phi, &bench.c, &bench.d, Some(&stderr)).unwrap();
            let found = gp(&problem.with_grids(&[[5, 5]]).unwrap(), &options);
            let bands = found.bands.unwrap();
            assert_eq!(bands.kind, BandKind::Posterior);
            shares.push(bands.covered(truth.as_slice()) as f64 / 25.0);
            let z = (found.reflectance - truth).component_div(&found.standard_error.unwrap());
            let square = z.norm_squared() / 25.0;
            squares.push(square);
            if let Choice::Averaged {
                if_uneven: Some([p, times]),
                ..
            } = found.choice
            {
                assert!(p > 0.025 && p < 1.0, "{p}");
                uneven.push(square / (times * times));
            }
        }
        assert!(uneven.len() > 20 || noise < 1e-2, "{}", uneven.len());
        let of_noise = [(shares, 0.95), (squares, 1.0), (uneven, 1.0)];
        for (values, expected) in of_noise.into_iter().filter(|(all, _)| all.len() > 20) {
            let values = DVector::from_vec(values);
            let error = (values.variance() / values.len() as f64).sqrt();
            let off = (values.mean() - expected) / error;
            assert!(off.abs() < 5.0, "{noise}: {} {off}", values.mean());
        }
    }
}

/// Pictures whose elements have nearly nothing in common, of which noisy photographs do not say so:
/// stated errors, which hold over all lengths, are too small for them, and those that are so many
/// times as large hold. 200 pictures.
#[test]
fn errors_of_elements_that_are_not_alike_are_told() {
    let bench = Bench::new(6.0, 5, 8);
    let mut normal = normal_stream(23);
    let (mut stated, mut told, mut said) = (0, 0, 0);
    for seed in 0..200usize {
        let tau = libm::exp(-2.13 + 0.98 * normal());
        let truth = drawn(&mut normal, tau, 0.4, [0.0, 0.1, 0.3][seed % 3]);
        let exact = bench.phi(&truth);
        let stderr = bench.phi(&DVector::from_element(25, 0.5)) * 0.1;
        let phi = exact.zip_map(&stderr, |x, s| x + s * normal());
        let problem = Problem::new(&phi, &bench.c, &bench.d, Some(&stderr)).unwrap();
        let found = gp(&problem.with_grids(&[[5, 5]]).unwrap(), &Options::default());
        let Choice::Averaged { if_unalike, .. } = found.choice else {
            panic!("{:?}", found.choice)
        };
        said += usize::from(if_unalike.is_some_and(|times| times > 1.1));
        let z = (found.reflectance - truth).component_div(&found.standard_error.unwrap());
        let held = |times: f64| z.iter().filter(|z| z.abs() < 1.96 * times).count();
        stated += held(1.0);
        told += held(if_unalike.unwrap_or(1.0));
    }
    let share = |count: usize| count as f64 / 5000.0;
    assert!(said >= 180, "{said} of 200 pictures");
    assert!(
        share(stated) < 0.9,
        "{} by the stated errors",
        share(stated)
    );
    assert!(
        (share(told) - 0.95).abs() < 0.03,
        "{} by the larger ones",
        share(told)
    );
}

/// Where the photographs say all, the picture is theirs: the truth without noise, and with little
/// the unbounded estimate with its errors.
#[test]
fn good_photographs_have_the_last_word() {
    let bench = Bench::new(6.0, 2, 8);
    let truth = DVector::from_row_slice(&[0.9, 0.1, 0.2, 0.7]);
    let exact = bench.phi(&truth);
    let problem = Problem::new(&exact, &bench.c, &bench.d, None).unwrap();
    let found = gp(&problem, &Options::default());
    assert!((found.reflectance - &truth).amax() < 1e-9);
    let (phi, stderr) = relative_noise(&exact, 1e-5, 4);
    let problem = Problem::new(&phi, &bench.c, &bench.d, Some(&stderr)).unwrap();
    let entries = Options {
        weighting: WeightRule::Entries,
        ..Options::default()
    };
    let [own, free] = [Method::JointGp, Method::JointUnbounded]
        .map(|method| recover(method, &problem, &entries).unwrap());
    let sigma = free.standard_error.unwrap();
    let off = (own.reflectance - free.reflectance).component_div(&sigma);
    assert!(off.amax() < 1e-2, "{off}");
    let ratio = own.standard_error.unwrap().component_div(&sigma);
    assert!(ratio.add_scalar(-1.0).amax() < 1e-3, "{ratio}");
}

/// Of unknown noise the same picture as of known, nearly; of a free scale the same relative to the
/// brightest.
#[test]
fn noise_and_scale_may_be_unknown() {
    let bench = Bench::new(6.0, 4, 8);
    let truth = DVector::from_fn(16, |j, _| {
        0.3 + 0.04 * (j % 4) as f64 + 0.02 * (j / 4) as f64
    });
    let exact = bench.phi(&truth);
    let stderr = DMatrix::from_element(64, 120, 1e-3 * exact.mean());
    let mut normal = normal_stream(8);
    let phi = exact.zip_map(&stderr, |x, s| x + s * normal());
    let problem = |stderr| {
        let problem = Problem::new(&phi, &bench.c, &bench.d, stderr).unwrap();
        problem.with_grids(&[[4, 4]]).unwrap()
    };
    let known = gp(&problem(Some(&stderr)), &Options::default());
    let unknown = gp(&problem(None), &Options::default());
    let sigma = known.standard_error.clone().unwrap();
    let off = (&unknown.reflectance - &known.reflectance).component_div(&sigma);
    assert!(off.amax() < 0.1, "{off}");
    let free = Nuisance {
        free_scale: true,
        ..Nuisance::default()
    };
    let scaled = &phi * 7.0;
    let errors = &stderr * 7.0;
    let of = Problem::new(&scaled, &bench.c, &bench.d, Some(&errors)).unwrap();
    let of = of
        .with_grids(&[[4, 4]])
        .unwrap()
        .with_nuisance(free)
        .unwrap();
    let relative = gp(&of, &Options::default());
    assert_eq!(relative.reflectance.max(), 1.0);
    let expected = &known.reflectance / known.reflectance.max();
    let off = (&relative.reflectance - expected).component_div(&sigma);
    assert!(off.amax() < 0.5, "{off}");
    assert!((relative.nuisance.unwrap().scale.unwrap() / 7.0 / 0.48 - 1.0).abs() < 0.2);
}

/// Fewer entries than unknowns, and no noise known.
#[test]
fn nothing_to_tell_the_noise_from() {
    let one = |rows, columns| DMatrix::from_element(rows, columns, 1.0);
    let (phi, c, d) = (one(1, 1), one(1, 1), one(1, 1));
    let problem = Problem::new(&phi, &c, &d, None).unwrap();
    let error = recover(Method::JointGp, &problem, &Options::default()).unwrap_err();
    assert!(
        matches!(error, RecoveryError::NotForMethod { .. }),
        "{error}"
    );
}
