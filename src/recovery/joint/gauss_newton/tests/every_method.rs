//! What every method makes of factors, and which are refused.

use super::*;

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
        averages: false,
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

/// With a free scale too where the factors are thousands of times the noise: the picture's own size
/// is not taken for theirs.
#[test]
fn a_free_scale_beside_large_factors_is_found() {
    let bench = Bench::new(6.0, 4, 8);
    let board = bench.board(2).map(|x| 0.2 + 0.6 * x);
    let nuisance = Nuisance {
        free_scale: true,
        frame_gain: Some(0.05),
        ..Nuisance::default()
    };
    for method in [Method::JointGp, Method::JointUnbounded, Method::Joint] {
        let mut normal = normal_stream(77);
        let mut phi = bench.phi(&board) * 3e16;
        let stderr = DMatrix::from_element(phi.nrows(), phi.ncols(), 1e-5 * phi.mean());
        for mut frame in phi.column_iter_mut() {
            frame *= 1.0 + 0.05 * normal();
        }
        let phi = phi.zip_map(&stderr, |x, s| x + s * normal());
        let problem = Problem::new(&phi, &bench.c, &bench.d, Some(&stderr)).unwrap();
        let problem = problem.with_grids(&[[4, 4]]).unwrap();
        let problem = problem.with_nuisance(nuisance).unwrap();
        let found = recover(method, &problem, &Options::default()).unwrap();
        assert!(gains(&found).settled, "{method}: {:?}", gains(&found));
        let off = (&found.reflectance - &board / 0.8).amax();
        assert!(off < 0.1, "{method}: {off}");
        let scale = found.nuisance.as_ref().unwrap().scale.unwrap();
        // Known as well as the mean of 120 factors, and the brightest element.
        assert!(
            (scale / (0.8 * 3e16) - 1.0).abs() < 0.1,
            "{method}: {scale:e}"
        );
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
