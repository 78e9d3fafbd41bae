//! Gram matrices against those of the whole operator.

use super::super::stacked::stack;
use super::*;
use crate::num::linalg::Triangle;
use crate::recovery::Nuisance;
use crate::recovery::bench::{Bench, normal_stream};

/// Differences of the objective are those of rows reduced by orthogonal transformations,
/// with and without constants and glare, to what may be lost; of frames of several strips too.
#[test]
fn it_is_the_objective_of_the_rows() {
    it_is_the_objective_of(Bench::new(3.0, 6, 8));
    let mut few = Bench::new(3.0, 6, 24);
    assert!(few.c.nrows() > STRIP);
    few.d = DMatrix::from_fn(36, 20, |j, l| few.d[(j, 6 * l)]);
    it_is_the_objective_of(few);
}

fn it_is_the_objective_of(bench: Bench) {
    let exact = bench.phi(&bench.board(2));
    let stderr = exact.map(|x| 0.02 * x.abs() + 1e-3 * exact.amax());
    let mut normal = normal_stream(3);
    let phi = exact.zip_map(&stderr, |x, s| x + s * normal());
    let (pixels, spots) = exact.shape();
    let pattern = DMatrix::from_fn(pixels, spots, |p, l| 1.0 + ((p * 7 + l) % 11) as f64);
    let plain = Nuisance::default();
    let cases = [
        plain,
        Nuisance {
            frame_constant: true,
            ..plain
        },
        Nuisance {
            frame_constant: true,
            glare: Some(&pattern),
            ..plain
        },
    ];
    for nuisance in cases {
        let problem = Problem::new(&phi, &bench.c, &bench.d, Some(&stderr)).unwrap();
        let problem = problem.with_nuisance(nuisance).unwrap();
        let root = |p: usize, l: usize| 1.0 / stderr[(p, l)];
        let found = reduced(&problem, root).unwrap().unwrap().triangle;
        let whole = stack(&problem, root).unwrap().triangle;
        assert!(
            found.r.nrows() < 36 && whole.r.nrows() == 36,
            "{}",
            found.r.nrows()
        );
        let of =
            |t: &Triangle, x: &DVector<f64>| (&t.r * x - &t.d).norm_squared() + t.rest * t.rest;
        for _ in 0..10 {
            let x = DVector::from_fn(36, |_, _| libm::erfc(normal()) / 2.0);
            let [a, b] = [&found, &whole].map(|t| of(t, &x).sqrt());
            assert!((a - b).abs() < (36.0 * LOST).sqrt(), "{a} {b}");
        }
    }
    let background = Nuisance {
        background: true,
        ..plain
    };
    let problem = Problem::new(&phi, &bench.c, &bench.d, Some(&stderr)).unwrap();
    let problem = problem.with_nuisance(background).unwrap();
    assert!(reduced(&problem, |_, _| 1.0).unwrap().is_none());
    // In units of a millionth of the noise too much is below the rounding.
    let problem = Problem::new(&phi, &bench.c, &bench.d, Some(&stderr)).unwrap();
    let finer = |p: usize, l: usize| 1e6 / stderr[(p, l)];
    assert!(reduced(&problem, finer).unwrap().is_none());
}
