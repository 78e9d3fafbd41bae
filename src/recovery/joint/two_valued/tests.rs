use super::*;
use crate::recovery::bench::{Bench, normal_stream};
use crate::recovery::recover;

fn noisy(bench: &Bench, truth: &DVector<f64>, noise: f64, seed: u64) -> [DMatrix<f64>; 2] {
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
