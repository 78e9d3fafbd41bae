use std::sync::atomic::{AtomicBool, Ordering};

use super::*;
use crate::recovery::bench::{Bench, normal_stream};
use crate::recovery::{Nuisance, recover};

fn bands(method: Method, elements: usize, noise: f64, seed: u64) -> (Bands, usize) {
    let bench = Bench::new(6.0, elements, 8);
    let board = bench.board(2);
    let exact = bench.phi(&board);
    let stderr = &exact * noise;
    let mut normal = normal_stream(seed);
    let phi = exact.zip_map(&stderr, |x, s| x + s * normal());
    let problem = Problem::new(&phi, &bench.c, &bench.d, Some(&stderr)).unwrap();
    let options = Options {
        bands: Some(0.95),
        ..Options::default()
    };
    let bands = recover(method, &problem, &options).unwrap().bands.unwrap();
    let covered = bands.covered(board.as_slice());
    (bands, covered)
}

/// 200 seeds of 16 elements. Were the elements of a seed independent, the share would scatter
/// by 0.4 %; two in a hundred are allowed.
#[test]
fn bands_of_an_unbiased_method_cover_as_often_as_they_say() {
    let mut covered = 0;
    for seed in 0..200 {
        let (bands, count) = bands(Method::JointUnbounded, 4, 1e-3, seed);
        assert_eq!(bands.kind, BandKind::Gaussian);
        covered += count;
    }
    let share = covered as f64 / 3200.0;
    assert!((share - 0.95).abs() < 0.02, "{share}");
}

/// Directions that are dropped leave no bands, and it is said why.
#[test]
fn a_biased_picture_has_no_bands() {
    assert_eq!(bands(Method::Pinv, 2, 1e-3, 1).0.kind, BandKind::Gaussian);
    let bench = Bench::new(6.0, 4, 8);
    let exact = bench.phi(&bench.board(2));
    let stderr = &exact * 1e-2;
    let problem = Problem::new(&exact, &bench.c, &bench.d, Some(&stderr)).unwrap();
    let options = Options {
        bands: Some(0.95),
        ..Options::default()
    };
    let found = recover(Method::Tsvd, &problem, &options).unwrap();
    assert_eq!((found.bands, found.no_bands), (None, Some(BIASED)));
}

/// Where no bound holds, the shadows of the ellipsoid ‖R x − d‖² ≤ q: ρ̂ ± √q σ, as the rows are
/// as many as the elements. At the edges of the board they are cut by the bounds.
#[test]
fn the_region_is_the_ellipsoid_where_no_bound_holds() {
    let bench = Bench::new(6.0, 2, 8);
    let exact = bench.phi(&DVector::from_row_slice(&[0.4, 0.5, 0.6, 0.5]));
    let stderr = &exact * 1e-3;
    let mut normal = normal_stream(5);
    let phi = exact.zip_map(&stderr, |x, s| x + s * normal());
    let problem = Problem::new(&phi, &bench.c, &bench.d, Some(&stderr)).unwrap();
    let options = Options {
        bands: Some(0.95),
        ..Options::default()
    };
    let of = |method| recover(method, &problem, &options).unwrap();
    let free = of(Method::JointUnbounded);
    // The 95 % point of χ² of 4 degrees, from tables.
    let half = 9.4877_f64.sqrt();
    for method in [Method::Joint, Method::Nnls] {
        let bands = of(method).bands.unwrap();
        assert_eq!(bands.kind, BandKind::Simultaneous);
        let sigma = free.standard_error.as_ref().unwrap();
        for (j, [lower, upper]) in bands.intervals.into_iter().enumerate() {
            // `joint-unbounded` weighs by a separable fit, and this noise is not quite that.
            let near = 0.05 * half * sigma[j];
            let centre = free.reflectance[j];
            assert!(
                (lower - (centre - half * sigma[j])).abs() < near,
                "{j} {lower}"
            );
            assert!(
                (upper - (centre + half * sigma[j])).abs() < near,
                "{j} {upper}"
            );
        }
    }
    let ends: Vec<[f64; 2]> = (0..8)
        .flat_map(|seed| bands(Method::Joint, 2, 1e-2, seed).0.intervals)
        .collect();
    assert!(ends.iter().all(|[a, b]| *a >= 0.0 && *b <= 1.0 && a < b));
    assert!(ends.iter().any(|i| i[0] == 0.0) && ends.iter().any(|i| i[1] == 1.0));
}

/// One light element among dark ones, the case in which a profile of χ² covers that element in
/// 59 seeds of 100: the neighbours' columns surround its own. Here it is covered as often as
/// promised, and hardly more often: 400 seeds at 95 % give 380 ± 4.4, 99.9 % of the binomial 364
/// … 393; the limits from outside and rows left out may add to it.
#[test]
#[ignore = "slow"]
fn a_lone_light_element_is_covered_as_promised() {
    let bench = Bench::new(3.0, 3, 8);
    let truth = DVector::from_fn(9, |j, _| if j == 4 { 1.0 } else { 0.0 });
    let exact = bench.phi(&truth);
    let stderr = &exact * 1e-2;
    let options = Options {
        bands: Some(0.95),
        ..Options::default()
    };
    let covered = (0..400).filter(|seed| {
        let mut normal = normal_stream(1000 + seed);
        let phi = exact.zip_map(&stderr, |x, s| x + s * normal());
        let problem = Problem::new(&phi, &bench.c, &bench.d, Some(&stderr)).unwrap();
        let found = recover(Method::Nnls, &problem, &options).unwrap();
        found
            .bands
            .is_some_and(|b| b.covered(truth.as_slice()) == 9)
    });
    let covered = covered.count();
    assert!((364..=397).contains(&covered), "{covered}");
}

/// Photographs that no reflectances explain have no bands, and it is said.
#[test]
fn a_refuted_model_has_no_bands() {
    let bench = Bench::new(6.0, 2, 4);
    let phi = bench.phi(&bench.board(2)) * 3.0;
    let stderr = &phi * 1e-3;
    let problem = Problem::new(&phi, &bench.c, &bench.d, Some(&stderr)).unwrap();
    let options = Options {
        bands: Some(0.95),
        ..Options::default()
    };
    let found = recover(Method::Joint, &problem, &options).unwrap();
    assert_eq!((found.bands, found.no_bands), (None, Some(Bands::REFUTED)));
}

#[test]
fn what_has_no_bands_says_why() {
    let bench = Bench::new(6.0, 2, 4);
    let phi = bench.phi(&bench.board(2));
    let problem = Problem::new(&phi, &bench.c, &bench.d, None).unwrap();
    for (method, confidence) in [
        (Method::Joint, 0.95),
        (Method::JointUnbounded, 0.95),
        (Method::Pinv, 1.0),
        (Method::Pinv, f64::NAN),
    ] {
        let options = Options {
            bands: Some(confidence),
            ..Options::default()
        };
        let error = recover(method, &problem, &options).unwrap_err();
        assert!(
            matches!(
                error,
                RecoveryError::NotForMethod { .. } | RecoveryError::BadParameter { .. }
            ),
            "{method} {error}"
        );
    }
    for method in [Method::JointTv, Method::JointTwoValued] {
        let options = Options {
            bands: Some(0.95),
            total_variation: Some(0.1),
            ..Options::default()
        };
        let problem = Problem::new(&phi, &bench.c, &bench.d, None).unwrap();
        let problem = problem.with_grids(&[[2, 2]]).unwrap();
        let found = recover(method, &problem, &options).unwrap();
        assert_eq!((found.bands, found.no_bands), (None, Some(ASSUMED)));
    }
}

/// A free scale leaves the picture between bounds without bands, and the picture is the same as
/// without asking for them.
#[test]
fn a_picture_of_a_free_scale_is_kept_without_its_bands() {
    let bench = Bench::new(6.0, 4, 8);
    let exact = bench.phi(&bench.board(2));
    let stderr = &exact * 1e-3;
    let nuisance = Nuisance {
        free_scale: true,
        ..Nuisance::default()
    };
    let problem = Problem::new(&exact, &bench.c, &bench.d, Some(&stderr)).unwrap();
    let problem = problem.with_nuisance(nuisance).unwrap();
    for method in [Method::Joint, Method::Nnls] {
        let of = |bands| {
            let options = Options {
                bands,
                ..Options::default()
            };
            recover(method, &problem, &options).unwrap()
        };
        let (asked, plain) = (of(Some(0.95)), of(None));
        assert_eq!((asked.bands, asked.no_bands), (None, Some(UNSCALED)));
        assert_eq!(asked.reflectance, plain.reflectance, "{method}");
    }
}

/// Stopped at the first of the ends, the picture is kept, and it is said why it has no bands;
/// stopped before, nothing is.
#[test]
fn a_picture_that_was_stopped_is_kept_without_its_bands() {
    let bench = Bench::new(6.0, 4, 8);
    let exact = bench.phi(&bench.board(2));
    let stderr = &exact * 1e-2;
    let problem = Problem::new(&exact, &bench.c, &bench.d, Some(&stderr)).unwrap();
    let options = Options {
        bands: Some(0.95),
        ..Options::default()
    };
    let whole = recover(Method::Joint, &problem, &options).unwrap();
    let stop = AtomicBool::new(false);
    let control = Control {
        progress: &|_| stop.store(true, Ordering::Relaxed),
        stop: &stop,
    };
    let cut = recover(Method::Joint, &problem.under(control), &options).unwrap();
    assert_eq!((cut.bands, cut.no_bands), (None, Some(STOPPED)));
    assert!(whole.bands.is_some() && cut.reflectance == whole.reflectance);
    let refused = recover(Method::Joint, &problem.under(control), &options);
    assert!(matches!(refused, Err(RecoveryError::Stopped(_))));
}

/// Photographs almost without noise of light that is f times what it is said to be, f = 1 ± S: the
/// truth is in the bands if and only if |f − 1| ≤ 1.96 S. With 1.96 S ≥ 1 nothing is.
#[test]
fn bands_of_a_roughly_known_scale_end_where_the_scale_does() {
    let bench = Bench::new(6.0, 2, 8);
    let truth = DVector::from_row_slice(&[0.2, 0.5, 0.7, 0.1]);
    let exact = bench.phi(&truth);
    let found = |known: f64, factor: f64| {
        let phi = &exact * factor;
        let stderr = &exact * 1e-6;
        let problem = Problem::new(&phi, &bench.c, &bench.d, Some(&stderr)).unwrap();
        let nuisance = Nuisance {
            scale_error: Some(known),
            ..Nuisance::default()
        };
        let options = Options {
            bands: Some(0.95),
            ..Options::default()
        };
        let problem = problem.with_nuisance(nuisance).unwrap();
        recover(Method::JointUnbounded, &problem, &options).unwrap()
    };
    for known in [0.05, 0.3, 0.5] {
        for (deviations, covered) in [(-1.97, 0), (-1.95, 4), (0.0, 4), (1.95, 4), (1.97, 0)] {
            let bands = found(known, 1.0 + deviations * known).bands.unwrap();
            assert_eq!(
                bands.covered(truth.as_slice()),
                covered,
                "{known} {deviations}"
            );
        }
    }
    let none = found(0.6, 1.0);
    assert_eq!((none.bands, none.no_bands), (None, Some(OPEN)));
}
