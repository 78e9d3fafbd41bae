//! Numbers for people: ticks of an axis, significant digits.

/// Places low ≤ x ≤ high that are multiples of 1, 2 or 5 times a power of ten, at most `most` + 1 of them.
pub(super) fn ticks(low: f64, high: f64, most: usize) -> Vec<f64> {
    let Some(step) = step(high - low, most) else {
        return Vec::new();
    };
    let first = (low / step - 1e-9).ceil();
    (0..=most)
        .map(|k| (first + k as f64) * step)
        .take_while(|x| *x <= high + 1e-9 * step)
        .map(|x| if x == 0.0 { 0.0 } else { x })
        .collect()
}

/// The smallest of 1, 2, 5 · 10ⁿ that fits into `span` no more than `most` times; `None` for an empty or infinite span.
pub(super) fn step(span: f64, most: usize) -> Option<f64> {
    if !(span > 0.0 && span.is_finite()) || most == 0 {
        return None;
    }
    let least = span / most as f64;
    let power = libm::exp10(libm::log10(least).floor());
    let step = [1.0, 2.0, 5.0, 10.0]
        .map(|m| m * power)
        .into_iter()
        .find(|s| *s >= least * (1.0 - 1e-9))?;
    (step > 0.0 && step.is_finite()).then_some(step)
}

/// `x` with `digits` significant digits: plain between 1e-3 and 1e5, else as 1.2e-7.
pub(super) fn significant(x: f64, digits: usize) -> String {
    if x.is_nan() {
        return "not a number".to_owned();
    }
    if x.is_infinite() {
        return if x > 0.0 { "unbounded" } else { "−unbounded" }.to_owned();
    }
    if x == 0.0 {
        return "0".to_owned();
    }
    let digits = digits.max(1);
    // Rounding first: 9.996 has the exponent of 10.0.
    let scientific = format!("{x:.*e}", digits - 1);
    let exponent: i32 = scientific
        .split_once('e')
        .and_then(|(_, e)| e.parse().ok())
        .unwrap_or(0);
    let text = if (-3..5).contains(&exponent) {
        let places = (digits as i32 - 1 - exponent).max(0) as usize;
        format!("{x:.places$}")
    } else {
        scientific
    };
    text.replace('-', "−").replace("e−", "e-")
}

/// A tick without superfluous digits: 0.5, 20, 1e-12.
pub(super) fn tick(x: f64) -> String {
    let text = significant(x, 6);
    match text.split_once('e') {
        Some((mantissa, exponent)) => format!("{}e{exponent}", trimmed(mantissa)),
        None => trimmed(&text).to_owned(),
    }
}

fn trimmed(text: &str) -> &str {
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.')
    } else {
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_inside() {
        assert_eq!(
            ticks(0.0, 15.5, 8),
            [0.0, 2.0, 4.0, 6.0, 8.0, 10.0, 12.0, 14.0]
        );
        assert_eq!(
            ticks(-0.3, 0.2, 5),
            [-0.3, -0.2, -0.1, 0.0, 0.1, 0.2].map(|x: f64| (x * 10.0).round() * 0.1)
        );
        for (low, high) in [
            (0.0, 0.0),
            (0.0, f64::INFINITY),
            (f64::NAN, 1.0),
            (-1e308, 1e308),
            (5.0, 1.0),
        ] {
            assert!(ticks(low, high, 5).is_empty(), "{low} {high}");
        }
        for (low, high) in [(1e300, 1.1e300), (-1e-300, 1e-300), (1.0, 1.0 + 1e-15)] {
            assert!(ticks(low, high, 5).len() <= 6);
        }
    }

    #[test]
    fn digits_are_the_significant_ones() {
        for (x, digits, want) in [
            (0.012345, 3, "0.0123"),
            (9.996, 3, "10.0"),
            (1234.5, 2, "1234"),
            (-0.5, 2, "−0.50"),
            (1.6e-12, 2, "1.6e-12"),
            (-2.5e7, 3, "−2.50e7"),
            (0.0, 3, "0"),
            (f64::NAN, 3, "not a number"),
        ] {
            assert_eq!(significant(x, digits), want);
        }
        assert_eq!(tick(20.0), "20");
        assert_eq!(tick(0.1 + 0.2), "0.3");
        assert_eq!(tick(2e-12), "2e-12");
    }
}
