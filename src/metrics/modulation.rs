//! The modified modulation transfer function of an object of light and dark elements.
//!
//! > MTF = (W − B)/(W + B)
//!
//! W and B are the means of the recovered values over the object's light and its dark elements.
//! Light elements are those above the middle of the truth's range, dark ones those below or on it.
//!
//! Two conventions exist and are kept apart by name: [`mtf_raw`] is the equation,
//! [`mtf_normalized`] what the published code computes, which stretches the recovered values to [0,
//! 1] first and so hides any loss of contrast that all elements share.

/// W and B: the means of the recovered values over light and dark elements. `None` as for
/// [`mtf_raw`], but W + B may be 0.
pub fn light_and_dark(recovered: &[f64], truth: &[f64]) -> Option<(f64, f64)> {
    if recovered.len() != truth.len() || !recovered.iter().chain(truth).all(|x| x.is_finite()) {
        return None;
    }
    let (low, high) = range(truth)?;
    if low == high {
        return None;
    }
    let middle = 0.5 * low + 0.5 * high;
    let mean = |light: bool| {
        let (sum, count) = recovered
            .iter()
            .zip(truth)
            .filter(|(_, t)| (**t > middle) == light)
            .fold((0.0, 0.0), |(sum, count), (r, _)| (sum + r, count + 1.0));
        // Neither class is empty between truths of two values; were one lost to rounding, 0/0 is
        // caught below.
        sum / count
    };
    let (light, dark) = (mean(true), mean(false));
    (light.is_finite() && dark.is_finite()).then_some((light, dark))
}

fn range(values: &[f64]) -> Option<(f64, f64)> {
    let first = *values.first()?;
    Some(
        values
            .iter()
            .fold((first, first), |(low, high), &x| (low.min(x), high.max(x))),
    )
}

/// (W − B)/(W + B) of the recovered values as they are, for `recovered` and `truth` of one length.
///
/// 1 is perfect for a dark of zero, 0 is no contrast, below 0 the contrast is inverted. A recovery
/// that swings below zero can make W + B small or negative; the equation's value is returned then,
/// and its size may exceed 1.
///
/// `None` where the truth has no contrast, lengths differ, a value is not finite, or W + B is
/// exactly 0.
pub fn mtf_raw(recovered: &[f64], truth: &[f64]) -> Option<f64> {
    let (light, dark) = light_and_dark(recovered, truth)?;
    let ratio = (light - dark) / (light + dark);
    ratio.is_finite().then_some(ratio)
}

/// The same after the recovered values have been stretched to fill [0, 1], (x − min)/(max − min).
/// It lies between −1 and 1.
///
/// `None` as for [`mtf_raw`], and where all recovered values are equal, so that nothing can be
/// stretched.
pub fn mtf_normalized(recovered: &[f64], truth: &[f64]) -> Option<f64> {
    let (light, dark) = light_and_dark(recovered, truth)?;
    let (low, high) = range(recovered)?;
    let width = high - low;
    // The stretch is affine, so it may be applied to the means.
    let ratio = (light - dark) / ((light - low) + (dark - low));
    (width > 0.0 && width.is_finite() && ratio.is_finite()).then_some(ratio)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TRUTH: [f64; 4] = [0.0, 1.0, 1.0, 0.0];

    #[test]
    fn the_truth_itself_has_full_modulation() {
        assert_eq!(mtf_raw(&TRUTH, &TRUTH), Some(1.0));
        assert_eq!(mtf_normalized(&TRUTH, &TRUTH), Some(1.0));
    }

    #[test]
    fn the_two_conventions_differ_as_defined() {
        // W = 0.7, B = 0.4 → 3/11. Stretched from [0.3, 0.8]: W = 0.8, B = 0.2 → 0.6.
        let recovered = [0.3, 0.6, 0.8, 0.5];
        assert!((mtf_raw(&recovered, &TRUTH).unwrap() - 3.0 / 11.0).abs() < 1e-15);
        assert!((mtf_normalized(&recovered, &TRUTH).unwrap() - 0.6).abs() < 1e-15);
    }

    #[test]
    fn an_offset_is_seen_by_raw_and_hidden_by_normalized() {
        // Board of contrast ¼ around 2: (2.25 − 1.75)/4 = 1/8.
        let recovered = TRUTH.map(|t| 1.75 + 0.5 * t);
        assert_eq!(mtf_raw(&recovered, &TRUTH), Some(0.125));
        assert_eq!(mtf_normalized(&recovered, &TRUTH), Some(1.0));
    }

    #[test]
    fn inverted_and_wild_recoveries_keep_the_equations_value() {
        let inverted = TRUTH.map(|t| 1.0 - t);
        assert_eq!(mtf_raw(&inverted, &TRUTH), Some(-1.0));
        // W = 1, B = −3: 4/(−2).
        assert_eq!(mtf_raw(&[-3.0, 1.0, 1.0, -3.0], &TRUTH), Some(-2.0));
        assert_eq!(mtf_raw(&[-1.0, 1.0, 1.0, -1.0], &TRUTH), None);
        assert_eq!(mtf_normalized(&[-1.0, 1.0, 1.0, -1.0], &TRUTH), Some(1.0));
    }

    #[test]
    fn grey_truth_splits_at_mid_range() {
        assert_eq!(mtf_raw(&[1.0, 3.0, 6.0], &[0.0, 0.5, 1.0]), Some(0.5));
        // Middle of [0.2, 0.8] is 0.5: light are 0.6 and 0.8, so W = 4.5, B = 1.5.
        let truth = [0.2, 0.4, 0.6, 0.8];
        assert!((mtf_raw(&[1.0, 2.0, 3.0, 6.0], &truth).unwrap() - 3.0 / 6.0).abs() < 1e-15);
    }

    #[test]
    fn nothing_is_said_where_nothing_can_be() {
        for mtf in [mtf_raw, mtf_normalized] {
            assert_eq!(mtf(&TRUTH, &[0.5; 4]), None);
            assert_eq!(mtf(&TRUTH, &TRUTH[..3]), None);
            assert_eq!(mtf(&[], &[]), None);
            assert_eq!(mtf(&[0.0, f64::NAN, 1.0, 0.0], &TRUTH), None);
            assert_eq!(mtf(&TRUTH, &[0.0, f64::INFINITY, 1.0, 0.0]), None);
            assert_eq!(mtf(&[f64::MAX; 4], &TRUTH), None);
        }
        assert_eq!(mtf_raw(&[0.5; 4], &TRUTH), Some(0.0));
        assert_eq!(mtf_normalized(&[0.5; 4], &TRUTH), None);
    }
}
