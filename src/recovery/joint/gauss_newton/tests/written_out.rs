//! Against the whole problem written out.

use super::*;

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
