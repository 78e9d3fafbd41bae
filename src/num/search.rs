//! The largest value of a function of a positive number.

/// Values of the number looked at in a decade, before the best of them is refined.
const PER_DECADE: f64 = 20.0;

/// The λ in [low, high] with the largest `value`, and that value: a logarithmic scan, then golden
/// sections between the neighbours of the best. Values that are not numbers count as smallest.
pub fn largest(low: f64, high: f64, value: impl Fn(f64) -> f64) -> (f64, f64) {
    let value = |x: f64| match value(x) {
        v if v.is_nan() => f64::NEG_INFINITY,
        v => v,
    };
    let (a, b) = (libm::log(low), libm::log(high));
    let steps = ((b - a) / std::f64::consts::LN_10 * PER_DECADE)
        .ceil()
        .max(1.0);
    let at = |k: f64| a + (b - a) * (k / steps).clamp(0.0, 1.0);
    let scan = (0..=steps as usize).map(|k| (k as f64, value(libm::exp(at(k as f64)))));
    let (best, _) = scan.fold((0.0, f64::NEG_INFINITY), |best, next| {
        if next.1 > best.1 { next } else { best }
    });
    let golden = 0.5 * (5f64.sqrt() - 1.0);
    let (mut left, mut right) = (at(best - 1.0), at(best + 1.0));
    while right - left > 1e-9 {
        let span = golden * (right - left);
        if value(libm::exp(right - span)) >= value(libm::exp(left + span)) {
            right = left + span;
        } else {
            left = right - span;
        }
    }
    [at(best), 0.5 * (left + right)]
        .map(libm::exp)
        .into_iter()
        .map(|x| (x, value(x)))
        .fold((low, f64::NEG_INFINITY), |best, next| {
            if next.1 > best.1 { next } else { best }
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_highest_of_several_hills_is_found() {
        let hill =
            |x: f64, top: f64, height: f64| height - 30.0 * (libm::log(x) - libm::log(top)).powi(2);
        let (x, value) = largest(1e-12, 1.0, |x| hill(x, 1e-4, 1.0).max(hill(x, 3e-9, 2.0)));
        // A maximum is flat: its place is known to the root of rounding.
        assert!((x / 3e-9 - 1.0).abs() < 1e-6 && (value - 2.0).abs() < 1e-12);
        // A value that rises to an end is taken there, and what is no number is passed by.
        assert!((largest(1e-3, 1.0, |x| x).0 - 1.0).abs() < 1e-9);
        let (x, _) = largest(1e-3, 1.0, |x| if x > 0.1 { f64::NAN } else { x });
        assert!(x <= 0.1 && x > 0.09, "{x}");
        assert_eq!(largest(2.0, 2.0, |x| x).0, libm::exp(libm::log(2.0)));
    }
}
