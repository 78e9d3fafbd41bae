use super::*;
use crate::lab::comparison::misplaced::normal;
use crate::lab::uncertainty::certainty::FOLLOWS_ENTRIES;
use crate::lab::uncertainty::pooled::tests::{judged, repeated};
use crate::lab::{
    Against, Certainty, Errors, Integration, Measured, Noise, Residuals, Test, recover_objects,
    validate,
};
use crate::model::{Extent, Kernel, MatrixModel, Occlusion, converged};
use crate::num::control::Control;
use crate::num::statistics::binomial_interval;
use crate::num::stream::{Key, Sampling, Stream};
use crate::recovery::{Method, Nuisance, Options};
use crate::scene::Scene;

/// Counts of this mean.
pub(in crate::lab) fn counted(light: &Matrix, seed: u64) -> Matrix {
    let key = Key {
        seed,
        spot: 0,
        pixel: 0,
        block: 0,
    };
    let mut draw = Stream::new(Sampling::Pcg, key);
    light.map(|mu| draw.poisson(mu))
}

fn law(powers: &[f64; 3], x: f64) -> f64 {
    powers[0] + powers[1] * x + powers[2] * x * x
}

/// Errors that follow from the entries by any law are those of the light, to what its expectation
/// is known; those of the light itself, of a constant and of no law stay as they are, and of few
/// pixels it is known that nothing can be done.
#[test]
fn errors_of_noisy_entries_are_those_of_their_light() {
    let light = Matrix::from_fn(60, 40, |p, l| 100.0 + 3.0 * p as f64 + 2.0 * l as f64);
    for powers in [[0.0, 1.0, 0.0], [0.0, 0.0, 0.01], [50.0, 0.5, 1e-3]] {
        let right = light.map(|x| law(&powers, x).sqrt());
        let mut draw = normal(3);
        let phi = light.zip_map(&right, |x, s| x + s * draw()[0]);
        let own = phi.map(|x| law(&powers, x).sqrt());
        let refined = Refined::of(&phi, &own, Certainty::STATED, None);
        let off = |stderr: &Matrix| {
            let each = stderr.zip_map(&right, |a, b| (a / b - 1.0) * (a / b - 1.0));
            each.mean().sqrt()
        };
        let [before, after] = [off(&own), off(&refined.stderr)];
        assert!(after < 0.35 * before, "{powers:?}: {before} {after}");
        assert!(!refined.certainty.follows_entries);
        let kept = |phi: &Matrix, stderr: &Matrix| {
            let refined = Refined::of(phi, stderr, Certainty::STATED, None);
            refined.stderr.as_ref() == stderr && !refined.certainty.follows_entries
        };
        assert!(kept(&phi, &right));
        assert!(kept(&phi, &phi.map(|_| 3.0)));
        let [few, errors] = [&phi, &own].map(|m| m.rows(0, 4).into_owned());
        let few = Refined::of(&few, &errors, Certainty::STATED, None);
        assert!(few.certainty.follows_entries);
    }
}

/// One element from counts of 10 electrons an entry with √n for errors, 20 draws: the mean of what
/// is found is right within 4 of its standard errors. By √n as it stands a weighted mean of counts
/// of mean μ is μ − 1, 10 % too dark.
#[test]
fn counts_with_the_roots_of_counts_are_not_too_dark() {
    let mut scene = Scene::load("bench").unwrap();
    [scene.camera.columns, scene.camera.rows] = [8; 2];
    let model = MatrixModel::new(&scene, Kernel::Physical, Some([1, 1])).unwrap();
    let exact = model.phi();
    let electron = exact.mean() / 10.0;
    let (mut sum, mut known) = (0.0, 0.0);
    for seed in 0..20 {
        let mut draw = normal(50 + seed);
        // Counts of mean μ, rounded from a normal number of that mean and variance; 1 at least.
        let counts = exact.map(|x| {
            let mean = x / electron;
            (mean + mean.sqrt() * draw()[0]).round().max(1.0)
        });
        let stderr = counts.map(|n| n.sqrt() * electron);
        let found = recover_objects(
            &model,
            &(counts * electron),
            Noise::StandardError(&stderr, Certainty::STATED),
            Nuisance::default(),
            &[Method::JointGp],
            &Options::default(),
            Control::none(),
        );
        let found = &found[0].outcome.as_ref().unwrap()[0];
        sum += found.reflectance[0] / model.albedo[0] - 1.0;
        known += found.standard_error.as_ref().unwrap()[0] / model.albedo[0];
    }
    let (off, error) = (sum / 20.0, known / 20.0 / 20.0_f64.sqrt());
    assert!(off.abs() < 4.0 * error, "{off} {error}");
}

/// The verdict on right light from 3 photographs a spot knows its errors as from many more, and so
/// fits the deviations of the scene; on light whose spots lie 0.1 in. beside it finds these. By √n
/// of counts of 20 right light is not refuted.
#[test]
fn a_verdict_takes_errors_as_well_as_photographs_tell_them() {
    let mut scene = Scene::load("bench").unwrap();
    [scene.camera.columns, scene.camera.rows] = [8; 2];
    let against = Against {
        kernel: Kernel::Physical,
        integration: Integration::Quadrature,
        occlusion: Occlusion::Ignored,
    };
    let judged = |scene: &Scene, [phi, stderr]: [&Matrix; 2], replicates: Option<u32>| {
        let test = Test {
            significance: 1e-3,
            known: Certainty::new(Errors::Independent, replicates),
        };
        let measured = Measured::new(phi, stderr, None);
        validate(scene, measured, against, test).unwrap().agreement
    };
    let exact = converged(&scene, Kernel::Physical, Extent::UNOBSTRUCTED)
        .unwrap()
        .phi;
    let [phi, stderr] = repeated(&exact, &exact.map(|x| 0.01 * x), 3, 11);
    let right = judged(&scene, [&phi, &stderr], Some(3));
    assert!(right.agrees && right.score.is_some(), "{right:?}");
    assert!(right.pooled.is_some_and(|n| n > 10), "{:?}", right.pooled);
    let moved = scene.with_shifted_spots([0.1, 0.0]).unwrap();
    let wrong = judged(&moved, [&phi, &stderr], Some(3));
    assert!(!wrong.agrees && wrong.verdict().contains("DISAGREE"));
    let mut draw = normal(21);
    let electron = exact.mean() / 20.0;
    let counts = exact.map(|x| {
        (x / electron + (x / electron).sqrt() * draw()[0])
            .round()
            .max(1.0)
    });
    let (phi, stderr) = (&counts * electron, counts.map(|n| n.sqrt() * electron));
    let right = judged(&scene, [&phi, &stderr], None);
    assert!(right.agrees, "{}", right.verdict());
    assert!(!right.unmodelled.iter().any(|u| u == FOLLOWS_ENTRIES));
    // Of two spots it is not known what light to expect.
    scene.laser.spots.truncate(2);
    let [phi, stderr] = [&phi, &stderr].map(|m| m.columns(0, 2).into_owned());
    let few = judged(&scene, [&phi, &stderr], None);
    assert!(few.unmodelled.iter().any(|u| u == FOLLOWS_ENTRIES));
}

/// Counts of few electrons with √n for errors, among them none: their error is that of the light,
/// to a half, whatever the number of pixels, and z of all against the light has χ²/n of 1 within
/// five of its standard errors, of Poisson's law √((2 + 1/μ)/n) for every mean μ.
#[test]
fn counts_of_none_have_errors() {
    let light = Matrix::from_fn(48, 40, |p, l| 2.0 + 0.05 * p as f64 + 0.04 * l as f64);
    let phi = counted(&light, 5);
    let own = phi.map(f64::sqrt);
    for rows in [48, 6] {
        let [phi, own, light] = [&phi, &own, &light].map(|m| m.rows(0, rows).into_owned());
        let refined = Refined::of(&phi, &own, Certainty::STATED, None);
        let none: Vec<usize> = (0..phi.len()).filter(|at| phi[*at] == 0.0).collect();
        assert!(none.len() > 5, "{}", none.len());
        for at in none {
            let off = refined.stderr[at] / light[at].sqrt();
            assert!((0.5..1.5).contains(&off), "{rows}: {off}");
        }
        if rows == 48 {
            let z = (&phi - &light).component_div(&refined.stderr);
            let mean = z.norm_squared() / z.len() as f64;
            let each = light.map(|mu| 2.0 + 1.0 / mu).mean() / z.len() as f64;
            assert!((mean - 1.0).abs() < 5.0 * each.sqrt(), "{mean}");
        }
    }
}

/// Right light of few counts with √n for errors: the verdict at 5 % and the fit at 1e-3
/// reject no oftener than they say, within the binomial 99.9 % of 200 draws; half of the light is
/// rejected always. As of normal noise more verdicts are rejections than is said.
#[test]
fn right_light_of_few_counts_is_rejected_no_oftener_than_is_said() {
    let draws = 200;
    for mean in [0.5, 1.0, 3.0, 10.0] {
        let light = Matrix::from_fn(36, 16, |p, l| {
            mean * (1.0 + 0.4 * libm::sin(p as f64)) * (1.0 + 0.3 * libm::cos(l as f64))
        });
        let (mut alarms, mut misfits, mut skewed) = (0, 0, 0);
        for seed in 0..draws {
            let phi = counted(&light, seed);
            let own = phi.map(f64::sqrt);
            let refined = Refined::of(&phi, &own, Certainty::STATED, None);
            let counted = refined.certainty.counted.unwrap();
            let agrees = |model: &Matrix, is_counted: bool| {
                let stderr = counted.law.stderrs(model, (&phi, &refined.stderr));
                let counted = Counted::new(counted.law, stderr.iter()).filter(|_| is_counted);
                let known = Certainty {
                    counted,
                    ..refined.certainty
                };
                judged(&phi, &stderr, model, known).agrees
            };
            alarms += u64::from(!agrees(&light, true));
            skewed += u64::from(!agrees(&light, false));
            assert!(!agrees(&(&light * 0.5), true), "{mean} {seed}");
            let known = refined.certainty;
            let mut residuals = Residuals::default();
            residuals.add(&phi, &light, &refined.stderr, known);
            let fit = residuals.fit(0.0, known).unwrap();
            misfits += u64::from(!fit.fits || fit.outlier.is_some());
        }
        let [_, most] = binomial_interval(draws, 0.05, 0.999);
        assert!(alarms <= most, "{mean}: {alarms}");
        let [_, few] = binomial_interval(draws, 1e-3, 0.999);
        assert!(misfits <= few, "{mean}: {misfits}");
        assert!(mean > 1.0 || skewed > 2 * most, "{mean}: {skewed}");
    }
}

/// Light of few paths, 32 exponential replicates an entry with their own standard errors, 20 draws:
/// the scale of the picture is right within 4 of its standard errors. With weights of 1/s² it is
/// off by the covariance of mean and variance, 2 σ³/n of an exponential's, which is 2/n of the
/// light.
#[test]
fn light_of_few_paths_is_not_too_dark() {
    let mut scene = Scene::load("bench").unwrap();
    [scene.camera.columns, scene.camera.rows] = [16; 2];
    let model = MatrixModel::new(&scene, Kernel::Physical, Some([1, 1])).unwrap();
    let exact = model.phi();
    let n = 32u32;
    let (mut sum, mut known) = (0.0, 0.0);
    for seed in 0..20 {
        let key = Key {
            seed: 90 + seed,
            spot: 0,
            pixel: 0,
            block: 0,
        };
        let mut draw = Stream::new(Sampling::Pcg, key);
        let all: Vec<Matrix> = (0..n)
            .map(|_| exact.map(|x| -x * libm::log(1.0 - draw.uniform())))
            .collect();
        let count = f64::from(n);
        let phi = all.iter().sum::<Matrix>() / count;
        let squares = all.iter().map(|x| (x - &phi).map(|d| d * d));
        let stderr = squares.sum::<Matrix>();
        let stderr = stderr.map(|s| (s / (count - 1.0) / count).sqrt());
        let found = recover_objects(
            &model,
            &phi,
            Noise::StandardError(&stderr, Certainty::new(Errors::Independent, Some(n))),
            Nuisance::default(),
            &[Method::JointGp],
            &Options::default(),
            Control::none(),
        );
        let found = &found[0].outcome.as_ref().unwrap()[0];
        let fit = found.fit.as_ref().unwrap();
        assert!(fit.fits && fit.pooled.is_some(), "{fit:?}");
        sum += found.reflectance[0] / model.albedo[0] - 1.0;
        known += found.standard_error.as_ref().unwrap()[0] / model.albedo[0];
    }
    let (off, error) = (sum / 20.0, known / 20.0 / 20.0_f64.sqrt());
    assert!(off.abs() < 4.0 * error, "{off} {error}");
}
