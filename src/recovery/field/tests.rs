use nalgebra::DMatrix;

use super::*;
use crate::num::cosines::{along_cosines, from_cosines};
use crate::recovery::bench::normal_stream;

/// Far apart on a large photograph the field is the exponential covariance of the plane, τ² e^(−
/// d/ℓ): both sides of the border away, 1 % of τ².
#[test]
fn the_field_is_exponential() {
    let frame = [120, 120];
    let v = spectrum(frame, 6.0);
    let middle = 60;
    let mut alone = DMatrix::zeros(120 * 120, 1);
    alone[middle + middle * 120] = 1.0;
    let mut alone = along_cosines(&alone, frame);
    alone.iter_mut().zip(&v).for_each(|(x, v)| *x *= v);
    let covariance = from_cosines(&alone, frame);
    let at = |x: usize, y: usize| covariance[x + y * 120];
    let own = at(middle, middle);
    for [x, y] in [[3, 0], [0, 6], [5, 5], [12, 0]] {
        let distance = libm::hypot(x as f64, y as f64);
        let found = at(middle + x, middle + y) / own;
        // The corner of e^(−d/ℓ) is blurred by a pixel's reach.
        assert!(
            (found - libm::exp(-distance / 6.0)).abs() < 0.06,
            "{x} {y}: {found}"
        );
    }
}

/// Squares of 60 frames drawn from a field of one of the ranges that are tried: its numbers come
/// back, and of noise alone no field.
#[test]
fn a_field_is_told_from_its_squares() {
    let frame = [24, 20];
    let range = libm::exp(5.0 * 0.35);
    let mut normal = normal_stream(5);
    for (pixel, shared) in [(0.3, 2.0), (1.0, 0.3)] {
        let shape = spectrum(frame, range);
        let v = shape.iter().map(|w| pixel * pixel + shared * shared * w);
        let squares: Vec<f64> = v
            .map(|v| v * (0..60).map(|_| normal().powi(2)).sum::<f64>() / 60.0)
            .collect();
        let found = ErrorField::likeliest(&squares, frame);
        assert!((found.pixel / pixel - 1.0).abs() < 0.05, "{found:?}");
        assert!((found.shared / shared - 1.0).abs() < 0.1, "{found:?}");
        assert!((found.range / range - 1.0).abs() < 0.3, "{found:?}");
    }
    let white: Vec<f64> = (0..480)
        .map(|_| (0..60).map(|_| normal().powi(2)).sum::<f64>() / 60.0)
        .collect();
    let found = ErrorField::likeliest(&white, frame);
    assert!(
        (found.pixel - 1.0).abs() < 0.02 && found.shared < 0.1,
        "{found:?}"
    );
}
