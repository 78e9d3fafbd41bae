use super::*;
use crate::lab::agreement::agree;
use crate::lab::evidence::Errors;
use crate::lab::score::{Derivatives, Parameter};
use crate::num::stream::{Key, Sampling, Stream};

const ROWS: usize = 12;
const COLUMNS: usize = 3;
const TEST: Test = Test {
    significance: 0.01,
    replicates: u32::MAX,
    errors: Errors::Independent,
};

fn normal(seed: u64) -> Matrix {
    let mut stream = Stream::new(
        Sampling::Pcg,
        Key {
            seed,
            spot: 0,
            pixel: 0,
            block: 0,
        },
    );
    Matrix::from_fn(ROWS, COLUMNS, |_, _| stream.normal())
}

/// The unknowns of the least Σ (y − X b)²/σ², and their errors, by the normal equations.
fn least_squares(y: &Matrix, columns: &[Matrix], sigma: f64) -> Vec<[f64; 2]> {
    let x = Matrix::from_fn(y.len(), columns.len(), |i, k| columns[k][i]);
    let inverse = (x.transpose() * &x).try_inverse().unwrap();
    let y = Matrix::from_column_slice(y.len(), 1, y.as_slice());
    let b = &inverse * x.transpose() * y;
    let pair = |k: usize| [b[k], sigma * inverse[(k, k)].sqrt()];
    (0..columns.len()).map(pair).collect()
}

/// A scale, two patterns in each of three frames and one deviation: fitted after the others were
/// taken out, the deviation and its error are those of all eight unknowns at once, and the scale is
/// that of the seven without it. Also of a deviation of one spot alone.
#[test]
fn what_is_fitted_first_is_as_if_fitted_together() {
    let model = normal(1).map(|x| 5.0 + x);
    let d = normal(2);
    let patterns = Matrix::from_fn(ROWS, 2, |p, k| (p as f64 / 7.0).powi(k as i32));
    let sigma = 20.0;
    let phi = &model * 300.0 + &d * 9.0 + normal(3) * sigma;
    let stderr = model.map(|_| sigma);
    let in_frame = |of: &dyn Fn(usize) -> f64, l: usize| {
        Matrix::from_fn(ROWS, COLUMNS, |p, c| if c == l { of(p) } else { 0.0 })
    };
    let mut columns = vec![model.clone()];
    for l in 0..COLUMNS {
        columns.extend((0..2).map(|k| in_frame(&|p| patterns[(p, k)], l)));
    }
    let own = in_frame(&|p| d[(p, 1)], 1);
    let with = |d: &Matrix| [columns.clone(), vec![d.clone()]].concat();
    // θ changes s θ d of the photographs.
    let scale = least_squares(&phi, &columns, sigma)[0];
    let of_all = least_squares(&phi, &with(&d), sigma)[7].map(|x| x / scale[0]);
    let of_one = least_squares(&phi, &with(&own), sigma)[7].map(|x| x / scale[0]);

    let evidence = Evidence {
        traced: &phi,
        stderr: &stderr,
        model: &model,
        bound: None,
        left_out: None,
        eliminated: None,
    };
    let beside = OtherLight {
        patterns: Some(&patterns),
        is_scale_free: true,
    };
    let left = beside.taken_out(&evidence, TEST).unwrap().unwrap();
    let parameter = Parameter {
        name: "all".to_owned(),
        unit: String::new(),
        same: Vec::new(),
        each_spot: Some("one".to_owned()),
    };
    let derivatives = Derivatives {
        parameters: &[parameter],
        of: &|_| Some(d.clone()),
    };
    let adjusted = Evidence {
        traced: &left.phi,
        stderr: &left.stderr,
        eliminated: Some(&left.eliminated),
        ..evidence
    };
    let (found, _) = agree(adjusted, TEST, Some(&derivatives));
    let score = found.score.unwrap();
    let near = |[a, b]: [f64; 2], [c, d]: [f64; 2]| {
        let off = |x: f64, y: f64| (x - y).abs() / y.abs();
        assert!(off(a, c) < 1e-9 && off(b, d) < 1e-9, "{a} ± {b}, {c} ± {d}");
    };
    let [s, error, _] = left.scale.unwrap();
    near([s, error], scale);
    let fitted = |d: &crate::lab::score::Deviation| [d.value, d.stderr];
    near(fitted(&score.deviations[0]), of_all);
    near(fitted(&score.spots[1]), of_one);
    assert_eq!(found.fitted, 7);
    // Σ z² of the seven unknowns' least squares, over 36 − 7.
    let estimate = least_squares(&phi, &columns, sigma);
    let explained = columns.iter().zip(&estimate);
    let rest = explained.fold(phi.clone(), |rest, (c, [b, _])| rest - c * *b);
    let squares = rest.norm_squared() / sigma / sigma / 29.0;
    assert!((found.chi2_per_dof / squares - 1.0).abs() < 1e-9);
}
