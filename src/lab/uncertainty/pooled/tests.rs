use super::*;
use crate::lab::comparison::misplaced::normal;
use crate::lab::{Agreement, Evidence, Noise, Residuals, Test, agree, recover_objects};
use crate::model::{Kernel, MatrixModel};
use crate::num::control::Control;
use crate::num::statistics::{binomial_interval, student_threshold};
use crate::recovery::{Method, Nuisance, Options};
use crate::scene::Scene;

/// Mean and standard error of `count` photographs of `exact` with noise `sigma` each.
pub(in crate::lab) fn repeated(
    exact: &Matrix,
    sigma: &Matrix,
    count: u32,
    seed: u64,
) -> [Matrix; 2] {
    let n = f64::from(count);
    let mut normal = normal(seed);
    let all: Vec<Matrix> = (0..count)
        .map(|_| exact.zip_map(sigma, |x, s| x + s * normal()[0]))
        .collect();
    let mean = all.iter().sum::<Matrix>() / n;
    let squares = all.iter().map(|x| (x - &mean).map(|d| d * d));
    let stderr = squares.sum::<Matrix>().map(|s| (s / (n - 1.0) / n).sqrt());
    [mean, stderr]
}

/// The verdict on a model at 5 %.
pub(in crate::lab) fn judged(
    phi: &Matrix,
    stderr: &Matrix,
    model: &Matrix,
    known: Certainty,
) -> Agreement {
    let evidence = Evidence {
        traced: phi,
        stderr,
        model,
        bound: None,
        left_out: None,
        eliminated: None,
    };
    let test = Test {
        significance: 0.05,
        known,
    };
    agree(evidence, test, None).0
}

fn from(replicates: u32) -> Certainty {
    Certainty {
        replicates: Some(replicates),
        ..Certainty::STATED
    }
}

/// Noise that is a product is found to the error of the product: of its variance 2/ν (1/p + 1/l)
/// of itself, of which six standard deviations at most; entries without an error keep none, and
/// those that are left out tell nothing.
#[test]
fn a_product_is_known_as_well_as_its_entries_let_it() {
    let (pixels, spots, count) = (200, 150, 3);
    let sigma = Matrix::from_fn(pixels, spots, |p, l| {
        (1.0 + p as f64 / 50.0) * (1.0 + (l % 7) as f64)
    });
    let zero = Matrix::zeros(pixels, spots);
    let [_, mut stderr] = repeated(&zero, &sigma, count, 1);
    stderr[(3, 4)] = 0.0;
    let mut left_out = zero.clone();
    for l in 0..spots / 2 {
        left_out[(5, l)] = 1.0;
        stderr[(5, l)] = 1e6;
    }
    let pooled = Pooled::of(&stderr, from(count), Some(&left_out)).unwrap();
    assert_eq!(pooled.stderr[(3, 4)], 0.0);
    assert_eq!(pooled.stderr[(5, 3)], 1e6);
    let of_product = 2.0 / f64::from(count - 1) * (1.0 / 75.0 + 1.0 / pixels as f64);
    // A standard deviation is known to half of it; and that of the entry itself counts a little.
    let known = pooled.certainty.replicates.unwrap();
    assert!((ENOUGH_REPLICATES..200).contains(&known), "{known}");
    let own = 2.0 / f64::from(known);
    let most = 6.0 * 0.5 * (of_product + 2.0 * own * own).sqrt() + own * 4.0;
    for at in (0..sigma.len()).filter(|at| left_out[*at] == 0.0 && stderr[*at] > 0.0) {
        let truth = sigma[at] / f64::from(count).sqrt();
        let off = pooled.stderr[at] / truth - 1.0;
        assert!(off.abs() < most, "{at}: {off} {most}");
    }
}

/// Variances d a b/χ²\[d\], the law for which the estimate is made (Smyth 2004, section 3): the
/// degrees of freedom d are found, and deviates over the pooled errors are those of Student's t of
/// d + ν: the binomial interval of 30 000 at 5 % and at 0.1 %. As estimated they are not.
#[test]
fn deviates_over_pooled_errors_follow_students_law() {
    let (pixels, spots, d, count) = (200, 150, 6, 4);
    let mut normal = normal(2);
    let sigma = Matrix::from_fn(pixels, spots, |p, l| {
        let chi2: f64 = (0..d).map(|_| normal()[0].powi(2)).sum();
        let product = (1.0 + p as f64 / 50.0) * (1.0 + (l % 7) as f64);
        (product * f64::from(d) / chi2).sqrt()
    });
    let zero = Matrix::zeros(pixels, spots);
    let [mean, stderr] = repeated(&zero, &sigma, count, 3);
    let pooled = Pooled::of(&stderr, from(count), None).unwrap();
    let known = pooled.certainty.replicates.unwrap();
    assert!((9..=10).contains(&known), "{known}");
    let beyond = |stderr: &Matrix, z: f64| {
        let most = student_threshold(z, freedom(known));
        let t = mean.zip_map(stderr, |x, s| (x / s).abs());
        t.iter().filter(|t| **t > most).count() as u64
    };
    for (z, tail) in [(1.959_964, 0.05), (3.290_527, 0.001)] {
        let [low, high] = binomial_interval(30_000, tail, 0.999);
        let found = beyond(&pooled.stderr, z);
        // The mean variance, d/(d − 2) a b, takes the place of a b: errors are a little too large
        // rather than too small.
        assert!(
            found <= high && found as f64 > 0.3 * low as f64,
            "{z}: {found} {low} {high}"
        );
        assert!(beyond(&stderr, z) > high, "{z}");
    }
}

/// Errors that are known, that entries share, that come from enough, that do not scatter as
/// estimates do, and of too few entries are left as they are.
#[test]
fn other_errors_are_left_alone() {
    let sigma = Matrix::from_element(40, 30, 1.0);
    let [_, stderr] = repeated(&Matrix::zeros(40, 30), &sigma, 3, 5);
    let pooled = |stderr: &Matrix, certainty| Pooled::of(stderr, certainty, None);
    assert!(pooled(&stderr, from(3)).is_some());
    assert!(pooled(&stderr, Certainty::STATED).is_none());
    assert!(pooled(&stderr, from(ENOUGH_REPLICATES)).is_none());
    for errors in [Errors::WithinRows, Errors::Everywhere] {
        assert!(pooled(&stderr, Certainty { errors, ..from(3) }).is_none());
    }
    assert!(pooled(&sigma, from(3)).is_none());
    assert!(pooled(&Matrix::zeros(40, 30), from(3)).is_none());
    let few = stderr.view((0, 0), (2, 3)).into_owned();
    assert!(pooled(&few, from(3)).is_none());
}

/// Bands of 95 % from three photographs of each spot: 100 draws hold the truth as often as they
/// say, within the binomial 99.9 % of independent elements.
#[test]
fn bands_from_three_replicates_hold_what_they_say() {
    let mut scene = Scene::load("bench").unwrap();
    [scene.camera.columns, scene.camera.rows] = [12; 2];
    let model = MatrixModel::new(&scene, Kernel::Physical, Some([2, 2])).unwrap();
    let exact = model.phi();
    let sigma = exact.map(|x| 0.03 * x);
    let options = Options {
        bands: Some(0.95),
        ..Options::default()
    };
    let methods = [Method::Joint, Method::JointUnbounded, Method::JointGp];
    let mut held = [0u64; 3];
    for seed in 0..100 {
        let [phi, stderr] = repeated(&exact, &sigma, 3, 100 + seed);
        let noise = Noise::StandardError(&stderr, from(3));
        let nuisance = Nuisance::default();
        let found = recover_objects(
            &model,
            &phi,
            noise,
            nuisance,
            &methods,
            &options,
            Control::none(),
        );
        for (held, attempt) in held.iter_mut().zip(found) {
            let object = attempt.outcome.unwrap().remove(0);
            let (bands, fit) = (object.bands.unwrap(), object.fit.unwrap());
            assert!(fit.pooled.is_some());
            *held += (0..4)
                .filter(|j| {
                    let truth = model.albedo[*j];
                    bands.lower[*j] <= truth && truth <= bands.upper[*j]
                })
                .count() as u64;
        }
    }
    let [least, _] = binomial_interval(400, 0.95, 0.999);
    for (held, method) in held.iter().zip(methods) {
        assert!(*held >= least, "{method}: {held} of 400");
    }
}

/// Right light, errors from 2 or 3 photographs, the noise a product or scattering by 0.3 about one:
/// of 300 draws so many are improbable at 5 % as that says, within the binomial 99.9 %, and χ² is
/// what is expected of it to a hundredth. As squares of Student's t of the degrees of
/// freedom as from which errors are known, that are the fewest that are sure, none was of 3, and of
/// 2 one in seven at 0.1 %.
#[test]
fn right_light_is_as_improbable_as_is_said() {
    let (pixels, spots, draws) = (100, 24, 300);
    let exact = Matrix::from_element(pixels, spots, 5.0);
    for (count, scatter) in [(2, 0.0), (3, 0.0), (3, 0.3)] {
        let mut random = normal(7);
        let (mut few, mut ratio) = (0, 0.0);
        for seed in 0..draws {
            let sigma = Matrix::from_fn(pixels, spots, |p, l| {
                let own = libm::exp(scatter * random()[0]);
                own * (1.0 + p as f64 / 10.0) * (1.0 + (l % 7) as f64)
            });
            let [phi, stderr] = repeated(&exact, &sigma, count, 3000 + seed);
            let pooled = Pooled::of(&stderr, from(count), None).unwrap();
            let left = (&phi - &exact).component_div(&pooled.stderr);
            let (chi2, dof) = (left.norm_squared(), left.len() as f64);
            few += u64::from(pooled.certainty.by_noise(chi2, dof) < 0.05);
            let [square, _] = pooled.certainty.pooled_from.unwrap().squares;
            ratio += chi2 / dof / square / draws as f64;
        }
        let [least, most] = binomial_interval(draws, 0.05, 0.999);
        assert!((least..=most).contains(&few), "{count} {scatter}: {few}");
        assert!((ratio - 1.0).abs() < 0.01, "{count} {scatter}: {ratio}");
    }
}

/// The fit of the truth to even noise, errors from 2 photographs of 80 pixels and 25 spots: of 200
/// draws χ²/dof is 1 on average, to five of its errors of √(2/2000)·1.5/√200, and so many P are
/// below 5 % as that says, within the binomial 99.9 %. By Student's t of the fewest degrees of
/// freedom that are sure, χ²/dof was 0.87 and no P below a half.
#[test]
fn a_right_picture_fits_as_improbably_as_is_said() {
    let exact = Matrix::from_element(80, 25, 5.0);
    let sigma = Matrix::from_element(80, 25, 0.01);
    let draws = 200;
    let (mut mean, mut few) = (0.0, 0);
    for seed in 0..draws {
        let [phi, stderr] = repeated(&exact, &sigma, 2, 500 + seed);
        let pooled = Pooled::of(&stderr, from(2), None).unwrap();
        let mut residuals = Residuals::default();
        residuals.add(&phi, &exact, &pooled.stderr, pooled.certainty);
        let fit = residuals.fit(0.0, pooled.certainty).unwrap();
        mean += fit.chi2_per_dof / draws as f64;
        few += u64::from(fit.p < 0.05);
    }
    assert!((mean - 1.0).abs() < 0.017, "{mean}");
    let [least, most] = binomial_interval(draws, 0.05, 0.999);
    assert!((least..=most).contains(&few), "{few}");
}

/// What is fitted with pooled weights w, as if these were known, has the variance Σ w²σ² over (Σ
/// w)² and states 1/Σ w: how many times too small that error is is said, without σ, to 1 % in the
/// mean of 300 draws. σ² is a product, and scatters about it by a factor of 3; from 2, 3 and 8
/// photographs.
#[test]
fn errors_of_a_fit_by_pooled_weights_are_as_much_too_small_as_is_said() {
    let (pixels, spots, draws) = (60, 40, 300);
    let zero = Matrix::zeros(pixels, spots);
    let product = Matrix::from_fn(pixels, spots, |p, l| {
        (1.0 + p as f64 / 60.0) * (1.0 + (l % 7) as f64 / 7.0)
    });
    for (count, scatter) in [(2, 0.0), (2, 0.5), (3, 0.5), (8, 0.5)] {
        let mut random = normal(11);
        let (mut variance, mut said) = (0.0, 0.0);
        for seed in 0..draws {
            let sigma = product.map(|s| s * libm::exp(scatter * random()[0]));
            let [_, stderr] = repeated(&zero, &sigma, count, 9000 + seed);
            let pooled = Pooled::of(&stderr, from(count), None).unwrap();
            let weights = pooled.stderr.map(|s| 1.0 / (s * s));
            let squares = weights.component_mul(&sigma).norm_squared() / f64::from(count);
            variance += squares / weights.sum();
            said += pooled.certainty.pooled_from.unwrap().variance;
        }
        let off = (variance / said).sqrt() - 1.0;
        assert!(off.abs() < 0.01, "{count} {scatter}: {off}");
    }
    // Not pooled, by Student's law: of 10 replicates ν/(ν − 4) = 9/5, of 5 no variance at all, of
    // 32 hardly more than 1.
    let times = |n| from(n).too_small();
    assert!((times(10).unwrap() - 1.8f64.sqrt()).abs() < 1e-15);
    assert_eq!((times(5), times(32)), (Some(f64::INFINITY), None));
    assert_eq!(Certainty::STATED.too_small(), None);
}

/// Right light of noise that is a product, its errors from 3 photographs: the verdict, and χ² of a
/// recovery, reject no oftener than they say, within the binomial 99.9 % of 500 draws (the less
/// often, for how far σ² is a product is learnt from these photographs too). Light 1.2 σ off in
/// every entry is rejected always.
#[test]
fn right_light_is_rejected_no_oftener_than_is_said() {
    let (pixels, spots, count, draws) = (60, 40, 3, 500);
    let exact = Matrix::from_fn(pixels, spots, |p, l| 5.0 + ((3 * p + l) % 7) as f64);
    let sigma = Matrix::from_fn(pixels, spots, |p, l| {
        (1.0 + p as f64 / 10.0) * (1.0 + (l % 7) as f64)
    });
    let mut alarms = [0u64; 3];
    for seed in 0..draws {
        let [phi, stderr] = repeated(&exact, &sigma, count, 1000 + seed);
        let pooled = Pooled::of(&stderr, from(count), None).unwrap();
        let judged =
            |model: &Matrix, stderr: &Matrix, known: Certainty| judged(&phi, stderr, model, known);
        let mut residuals = Residuals::default();
        residuals.add(&phi, &exact, &pooled.stderr, pooled.certainty);
        let p = residuals.fit(0.0, pooled.certainty).unwrap().p;
        let right = judged(&exact, &pooled.stderr, pooled.certainty);
        let found = [!right.agrees, p < 0.05, p < 0.01];
        for (alarms, found) in alarms.iter_mut().zip(found) {
            *alarms += u64::from(found);
        }
        if seed < 10 {
            let off = 1.2 / f64::from(count).sqrt();
            let off = exact.zip_map(&sigma, |x, s| x + off * s);
            assert!(!judged(&off, &pooled.stderr, pooled.certainty).agrees);
        }
    }
    for (found, level) in alarms.into_iter().zip([0.05, 0.05, 0.01]) {
        let [_, high] = binomial_interval(draws, level, 0.999);
        assert!(found <= high, "{level}: {alarms:?} {high}");
    }
}
