use super::*;
use crate::lab::comparison::agreement::agree;
use crate::lab::comparison::score::{Derivatives, Parameter};
use crate::lab::uncertainty::certainty::Certainty;
use crate::num::linalg::{Tolerance, pinv};
use crate::num::stream::{Key, Sampling, Stream};

const ROWS: usize = 12;
const COLUMNS: usize = 3;
const TEST: Test = Test {
    significance: 0.01,
    known: Certainty::STATED,
};

/// Of singular values: what depends on others is below it.
const TOLERANCE: Tolerance = Tolerance::Relative(1e-9);

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

/// Least squares of y by columns with errors of covariance `v`: the unknowns, their errors and the
/// least of rᵀ v⁻¹ r, by the normal equations. The last unknown is the one of interest: others may
/// depend on each other.
fn least_squares(y: &[f64], columns: &[Vec<f64>], v: &Matrix) -> ([f64; 2], f64) {
    let x = Matrix::from_fn(y.len(), columns.len(), |i, k| columns[k][i]);
    let y = Matrix::from_column_slice(y.len(), 1, y);
    let weight = v.clone().try_inverse().unwrap();
    let normal = x.transpose() * &weight * &x;
    let inverse = pinv(&normal, TOLERANCE).unwrap().matrix;
    let b = &inverse * x.transpose() * &weight * &y;
    let rest = &y - x * &b;
    let last = columns.len() - 1;
    let least = (rest.transpose() * weight * rest)[(0, 0)];
    ([b[last], inverse[(last, last)].sqrt()], least)
}

/// One deviation, of all spots or of one, is fitted after what is beside the model was taken out:
/// value and error are those of all unknowns at once, factors being noise that a frame's entries
/// share; so are the factors, the scale and its error, and χ².
#[test]
fn what_is_fitted_first_is_as_if_fitted_together() {
    let patterns = Matrix::from_fn(ROWS, 2, |p, k| (p as f64 / 7.0).powi(k as i32));
    let glare = normal(4);
    let none = Nuisance::default();
    let smooth = Nuisance {
        frame_patterns: Some(&patterns),
        ..none
    };
    let image = Nuisance {
        background: true,
        ..none
    };
    let both = Nuisance {
        background: true,
        ..smooth
    };
    let free_scale = true;
    let (frame_gain, scale_error) = (Some(0.02), Some(0.03));
    for (beside, is_holed) in [
        (
            Nuisance {
                free_scale,
                ..smooth
            },
            false,
        ),
        (image, false),
        (Nuisance { free_scale, ..both }, false),
        (both, true),
        (
            Nuisance {
                glare: Some(&glare),
                free_scale,
                ..none
            },
            true,
        ),
        (Nuisance { frame_gain, ..none }, false),
        (
            Nuisance {
                scale_error,
                ..none
            },
            true,
        ),
        (
            Nuisance {
                frame_gain,
                scale_error,
                ..none
            },
            false,
        ),
        (
            Nuisance {
                frame_gain,
                free_scale,
                ..smooth
            },
            false,
        ),
        (
            Nuisance {
                frame_gain,
                scale_error,
                ..both
            },
            true,
        ),
    ] {
        is_as_if_fitted_together(&beside, is_holed);
    }
}

/// With so much beside the model, some entries not counting where `is_holed`.
fn is_as_if_fitted_together(beside: &Nuisance<'_>, is_holed: bool) {
    let model = normal(1).map(|x| 5.0 + x);
    let d = normal(2);
    let sigma = if beside.free_scale { 20.0 } else { 0.1 };
    let unit = if beside.free_scale { 300.0 } else { 1.0 };
    // Errors of their own, no product of one by pixel and one by spot.
    let stderr = normal(5).map(|x| sigma * libm::exp(x));
    let phi = &model * unit + &d * (0.03 * unit) + normal(3).component_mul(&stderr);
    // Pixel 4 is never seen, and two entries are left out.
    let is_hole = |p: usize, l: usize| is_holed && (p == 4 || (p, l) == (2, 1) || (p, l) == (7, 0));
    let holes = Matrix::from_fn(ROWS, COLUMNS, |p, l| f64::from(u8::from(is_hole(p, l))));

    let kept: Vec<usize> = (0..phi.len()).filter(|i| holes[*i] == 0.0).collect();
    let seen = |m: &Matrix| -> Vec<f64> { kept.iter().map(|i| m[*i]).collect() };
    let only = |keep: &dyn Fn(usize, usize) -> f64| seen(&Matrix::from_fn(ROWS, COLUMNS, keep));
    let in_frame =
        |m: &dyn Fn(usize) -> f64, own: usize| only(&|p, l| if l == own { m(p) } else { 0.0 });
    let mut others = Vec::new();
    for l in 0..COLUMNS {
        if let Some(patterns) = beside.frame_patterns {
            others.extend((0..2).map(|k| in_frame(&|p| patterns[(p, k)], l)));
        }
        if let Some(glare) = beside.glare {
            others.push(in_frame(&|p| glare[(p, l)], l));
        }
    }
    if beside.background {
        let image = |own| only(&|p, _| f64::from(u8::from(p == own)));
        others.extend((0..ROWS).map(image));
    }
    let evidence = Evidence {
        traced: &phi,
        stderr: &stderr,
        model: &model,
        bound: None,
        left_out: Some(&holes),
        eliminated: None,
    };
    let left = Left::of(&evidence, TEST, beside).unwrap().unwrap();

    let near = |what: &str, found: f64, expected: f64| {
        let off = (found - expected).abs() / expected.abs();
        assert!(off < 1e-8, "{what}: {found} in place of {expected}");
    };
    // The scale is fitted with factors of the frames as noise that has no part in its weights.
    let own: Vec<f64> = seen(&stderr).iter().map(|sigma| sigma * sigma).collect();
    let mut noise = Matrix::from_diagonal(&own.clone().into());
    let columns = [others.clone(), vec![seen(&model)]].concat();
    let s = if beside.free_scale {
        let [s, error, _] = left.scale.unwrap();
        let ([expected, own], _) = least_squares(&seen(&phi), &columns, &noise);
        near("scale", s, expected);
        let factors = (0..COLUMNS).map(|l| {
            let light = in_frame(&|p| s * model[(p, l)], l);
            let ([change, _], _) = least_squares(&light, &columns, &noise);
            change * beside.frame_gain.unwrap_or(0.0)
        });
        let of_factors: f64 = factors.map(|x| x * x).sum();
        near("scale's error", error, (own * own + of_factors).sqrt());
        s
    } else {
        1.0
    };
    let mut roots = Vec::new();
    if let Some(sigma) = beside.frame_gain {
        roots.extend((0..COLUMNS).map(|l| in_frame(&|p| sigma * s * model[(p, l)], l)));
    }
    if let Some(sigma) = beside.scale_error {
        roots.push(only(&|p, l| sigma * s * model[(p, l)]));
    }
    for root in &roots {
        let root = Matrix::from_column_slice(root.len(), 1, root);
        noise += &root * root.transpose();
    }

    let parameter = Parameter {
        reach: None,
        name: "all".to_owned(),
        unit: String::new(),
        same: Vec::new(),
        each_spot: Some("one".to_owned()),
    };
    let derivatives = Derivatives {
        parameters: &[parameter],
        of: &|_| Some(d.clone()),
        moved: &|_, _| None,
        picture: None,
        bends: false,
        are_named: true,
    };
    let adjusted = Evidence {
        traced: &left.phi,
        stderr: &left.stderr,
        eliminated: Some(&left.eliminated),
        ..evidence
    };
    let (found, _) = agree(adjusted, TEST, Some(&derivatives));
    let score = found.score.unwrap();
    let mut columns = others;
    if beside.free_scale {
        columns.push(seen(&model));
    }
    let off = seen(&(&phi - &model * s));
    // θ changes s θ d of the photographs.
    let all = seen(&d);
    let one = in_frame(&|p| d[(p, 1)], 1);
    for (fitted, own) in [(&score.deviations[0], all), (&score.spots[1], one)] {
        let with = [columns.clone(), vec![own]].concat();
        let ([value, error], _) = least_squares(&off, &with, &noise);
        near("value", fitted.value, value / s);
        near("error", fitted.stderr, error / s);
    }
    let x = Matrix::from_fn(kept.len(), columns.len(), |i, k| columns[k][i]);
    let rank = pinv(&x, TOLERANCE).map_or(0, |found| found.rank);
    assert_eq!(found.fitted, rank);
    // A column that is nothing leaves the least squares of the others.
    columns.push(vec![0.0; kept.len()]);
    let (_, least) = least_squares(&off, &columns, &noise);
    let free = (kept.len() - rank) as f64;
    near("χ²", found.chi2_per_dof, least / free);
    let Some(gains) = left.gains else {
        assert!(roots.is_empty());
        return;
    };
    // Factors as unknowns of their own, each with the entry 0 ± 1 of its prior.
    let count = roots.len();
    let prior = |k: usize| (0..count).map(move |i| f64::from(u8::from(i == k)));
    let columns: Vec<Vec<f64>> = columns.into_iter().map(|c| with_zeros(c, count)).collect();
    let widened = Matrix::from_fn(kept.len() + count, kept.len() + count, |i, j| {
        let own = own.get(i).copied().unwrap_or(1.0);
        if i == j { own } else { 0.0 }
    });
    let frames = gains.frames.iter().chain(&gains.whole);
    let sizes = frames.flat_map(|of| {
        let one = move |k: usize| [of.size[k], of.standard_error[k]].map(|x| x / of.known_to);
        (0..of.size.len()).map(one)
    });
    for (k, [size, error]) in sizes.enumerate() {
        let own = (0..count).map(|j| roots[j].iter().copied().chain(prior(j)).collect());
        let mut all: Vec<Vec<f64>> = own.collect();
        let last = all.remove(k);
        let columns = [columns.clone(), all, vec![last]].concat();
        let off = with_zeros(off.clone(), count);
        let ([value, expected], _) = least_squares(&off, &columns, &widened);
        near("factor", size, value);
        near("factor's error", error, expected);
    }
}

/// With entries 0 of the priors after it.
fn with_zeros(mut of: Vec<f64>, count: usize) -> Vec<f64> {
    of.extend(std::iter::repeat_n(0.0, count));
    of
}
