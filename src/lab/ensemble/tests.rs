//! Spreads of known samples.

use super::*;
use crate::num::stream::{Key, Sampling, Stream};

/// Members with independent uniform noise of standard deviation σ around `truth`.
fn noisy(truth: &Matrix, sigma: f64, seed: u64) -> Ensemble {
    let member = |block| {
        let key = Key {
            seed,
            spot: 0,
            pixel: 0,
            block,
        };
        let mut stream = Stream::new(Sampling::Pcg, key);
        truth.map(|x| x + sigma * 12f64.sqrt() * (stream.uniform() - 0.5))
    };
    Ensemble::new((0..8).map(member).collect())
}

#[test]
fn the_spread_is_that_of_a_hand_calculation() {
    // Mean 2, squares 1 + 0 + 1, variance 1, standard error 1/√3.
    let found = Spread::of(&[1.0, 2.0, 3.0]).unwrap();
    assert_eq!(
        (found.draws, found.mean, found.deviation),
        (3, 2.0, Some(1.0))
    );
    assert!((found.stderr.unwrap() - 1.0 / 3f64.sqrt()).abs() < 1e-15);
    let one = Spread::of(&[7.0]).unwrap();
    assert_eq!((one.deviation, one.stderr), (None, None));
    assert_eq!(Spread::of(&[]), None);
}

#[test]
fn draws_that_gave_nothing_are_no_part_of_the_mean() {
    let outcomes = [
        Ok(1.0),
        Err("first".to_owned()),
        Ok(-3.0),
        Ok(3.0),
        Err("last".to_owned()),
    ];
    let draws = Draws::of(&outcomes);
    assert_eq!(draws.failures, ["first", "last"]);
    let positive = draws.spread(|x| Some(*x).filter(|x| *x > 0.0)).unwrap();
    assert_eq!((positive.draws, positive.mean), (2, 2.0));
}

/// The norm of a small matrix under noise four times as large: unbiased within its own standard
/// error, over 200 trials.
#[test]
fn the_norm_is_freed_of_noise_and_its_error_is_honest() {
    let truth = Matrix::from_fn(30, 20, |i, j| 0.1 * f64::from((i * 7 + j * 3) as u32 % 5));
    let want = truth.norm();
    let mut z = Vec::new();
    for seed in 0..200 {
        let found = noisy(&truth, 0.8, seed).norm();
        z.push((found.value - want) / found.stderr);
    }
    let n = z.len() as f64;
    let centre = z.iter().sum::<f64>() / n;
    let spread = (z.iter().map(|x| x * x).sum::<f64>() / n).sqrt();
    // Student-like with 7 degrees of freedom: standard deviation 1.18, of the mean 0.084.
    assert!(centre.abs() < 0.4, "biased: mean z {centre}");
    assert!((0.8..1.7).contains(&spread), "dishonest: rms z {spread}");
}

#[test]
fn nothing_is_zero_within_its_error() {
    let found = noisy(&Matrix::zeros(30, 20), 1.0, 1).norm();
    assert!(found.value < 3.0 * found.stderr, "{found:?}");
}
