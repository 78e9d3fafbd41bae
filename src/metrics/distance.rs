//! Correlation and distances.

use nalgebra::DMatrix;

fn comparable(a: &[f64], b: &[f64]) -> bool {
    a.len() == b.len() && !a.is_empty() && a.iter().chain(b).all(|x| x.is_finite())
}

/// Values divided by their largest absolute one, so that squares neither overflow nor vanish, and
/// that divisor.
fn scaled(values: impl Iterator<Item = f64> + Clone) -> Option<(Vec<f64>, f64)> {
    let largest = values.clone().fold(0.0f64, |m, x| m.max(x.abs()));
    let divisor = if largest > 0.0 { largest } else { 1.0 };
    largest
        .is_finite()
        .then(|| (values.map(|x| x / divisor).collect(), divisor))
}

/// Pearson's correlation Σ(a − ā)(b − b̄)/√(Σ(a − ā)² Σ(b − b̄)²), in [−1, 1].
///
/// `None` where either side is constant or empty, lengths differ, or a value is not finite.
pub fn correlation(a: &[f64], b: &[f64]) -> Option<f64> {
    if !comparable(a, b) {
        return None;
    }
    let centred = |values: &[f64]| {
        let (unit, _) = scaled(values.iter().copied())?;
        let mean = unit.iter().sum::<f64>() / unit.len() as f64;
        // The scaled entries of a constant are all 1 or all −1, so its deviations are exactly 0 and
        // the ratio below is not finite.
        Some(unit.iter().map(|x| x - mean).collect::<Vec<f64>>())
    };
    let (a, b) = (centred(a)?, centred(b)?);
    let dot = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| x * y).sum::<f64>();
    let ratio = dot(&a, &b) / (dot(&a, &a).sqrt() * dot(&b, &b).sqrt());
    ratio.is_finite().then(|| ratio.clamp(-1.0, 1.0))
}

/// Root mean square of a − b, in their unit.
///
/// `None` where lengths differ or are zero, a value is not finite, or a difference overflows.
pub fn rmse(a: &[f64], b: &[f64]) -> Option<f64> {
    if !comparable(a, b) {
        return None;
    }
    let (unit, divisor) = scaled(a.iter().zip(b).map(|(x, y)| x - y))?;
    let mean = unit.iter().map(|x| x * x).sum::<f64>() / unit.len() as f64;
    let rms = mean.sqrt() * divisor;
    rms.is_finite().then_some(rms)
}

/// ‖A − B‖/‖B‖ in Frobenius norms, B the reference.
///
/// `None` where shapes differ or are empty, a value is not finite, or the reference is zero.
pub fn relative_frobenius(a: &DMatrix<f64>, reference: &DMatrix<f64>) -> Option<f64> {
    if a.shape() != reference.shape() {
        return None;
    }
    let zero = vec![0.0; reference.len()];
    let ratio = rmse(a.as_slice(), reference.as_slice())? / rmse(reference.as_slice(), &zero)?;
    ratio.is_finite().then_some(ratio)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn correlation_by_hand() {
        // a − ā = (−1, 0, 1), b − b̄ = (−1, −1, 2): 3/√(2·6).
        let r = correlation(&[1.0, 2.0, 3.0], &[1.0, 1.0, 4.0]).unwrap();
        assert!((r - 3.0 / 12f64.sqrt()).abs() < 1e-15);
        assert!((correlation(&[1.0, 2.0], &[5.0, -3.0]).unwrap() + 1.0).abs() < 1e-15);
        let affine: Vec<f64> = (0..9)
            .map(|i| 1e-200 * (7.0 + 3.0 * f64::from(i * i)))
            .collect();
        let plain: Vec<f64> = (0..9).map(|i| f64::from(i * i)).collect();
        assert!((correlation(&affine, &plain).unwrap() - 1.0).abs() < 1e-14);
    }

    #[test]
    fn distances_by_hand() {
        let near = |found: Option<f64>, exact: f64| (found.unwrap() / exact - 1.0).abs() < 1e-15;
        assert!(near(rmse(&[3.0, 0.0], &[0.0, 4.0]), 12.5f64.sqrt()));
        assert!(near(
            rmse(&[3e200, 0.0], &[0.0, 4e200]),
            12.5f64.sqrt() * 1e200
        ));
        assert_eq!(rmse(&[1.0], &[1.0]), Some(0.0));
        let reference = DMatrix::from_row_slice(2, 2, &[3.0, 0.0, 0.0, 4.0]);
        let off = DMatrix::from_row_slice(2, 2, &[3.0, 0.5, 0.0, 4.0]);
        assert!(near(relative_frobenius(&off, &reference), 0.1));
        assert!(
            (relative_frobenius(&(off * 1e-190), &(reference * 1e-190)).unwrap() - 0.1).abs()
                < 1e-14
        );
    }

    #[test]
    fn nothing_is_said_where_nothing_can_be() {
        let bad: [(&[f64], &[f64]); 4] = [
            (&[], &[]),
            (&[1.0], &[1.0, 2.0]),
            (&[f64::NAN, 1.0], &[1.0, 2.0]),
            (&[1.0, 2.0], &[1.0, f64::INFINITY]),
        ];
        for (a, b) in bad {
            assert_eq!((correlation(a, b), rmse(a, b)), (None, None));
        }
        assert_eq!(correlation(&[0.1; 3], &[1.0, 2.0, 3.0]), None);
        assert_eq!(rmse(&[f64::MAX], &[-f64::MAX]), None);
        let zero = DMatrix::zeros(2, 2);
        assert_eq!(relative_frobenius(&zero, &zero), None);
        assert_eq!(relative_frobenius(&zero, &DMatrix::zeros(1, 4)), None);
        assert_eq!(
            relative_frobenius(&DMatrix::zeros(0, 0), &DMatrix::zeros(0, 0)),
            None
        );
    }
}
