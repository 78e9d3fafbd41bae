//! An axis in a figure: where it ends, where values lie on it, and its ticks.

use crate::lab::finding::{Axis, Spacing};
use crate::num::digits::{scientific, significant, superscript};

/// An even axis reaches beyond its values by this share of them, so that no mark lies on the frame.
const BEYOND: f64 = 0.03;
/// Named decades of an axis: as many as have room side by side on the narrowest plot.
const MOST_DECADES: i32 = 7;
/// Ticks of an even axis.
const MOST_TICKS: usize = 7;

/// An axis with the ends that it has in a figure.
pub(super) struct Ruler<'a> {
    /// What it shows.
    pub axis: &'a Axis,
    /// Values at its two ends.
    pub ends: [f64; 2],
}

impl<'a> Ruler<'a> {
    /// For the values that it shows.
    pub(super) fn around(axis: &'a Axis, values: impl Iterator<Item = f64>) -> Self {
        let widest = |ends: [f64; 2], values: &mut dyn Iterator<Item = f64>| {
            values.fold(ends, |[a, b], x| [a.min(x), b.max(x)])
        };
        let mut values = values.filter(|x| x.is_finite());
        let ends = match &axis.spacing {
            Spacing::Linear(ends) => slackened(widest(*ends, &mut values)),
            Spacing::Clipped(ends) => *ends,
            Spacing::Logarithmic => {
                let none = [f64::INFINITY, f64::NEG_INFINITY];
                decades(widest(
                    none,
                    &mut values.filter(|x| *x >= f64::MIN_POSITIVE),
                ))
            }
            Spacing::Categories(names) => [-0.5, names.len() as f64 - 0.5],
        };
        Self { axis, ends }
    }

    /// The names of its categories, if it has them.
    pub(super) fn categories(&self) -> Option<&'a [String]> {
        match &self.axis.spacing {
            Spacing::Categories(names) => Some(names),
            _ => None,
        }
    }

    /// Whether it runs by decades.
    pub(super) fn is_logarithmic(&self) -> bool {
        self.axis.spacing == Spacing::Logarithmic
    }

    /// Where x lies between the ends, 0 to 1; beyond them below 0 and above 1, not a number where x
    /// has no place.
    fn share(&self, x: f64) -> f64 {
        let [a, b] = self.ends;
        if !self.is_logarithmic() {
            (x - a) / (b - a)
        } else if x > 0.0 {
            libm::log(x / a) / libm::log(b / a)
        } else {
            f64::NAN
        }
    }

    /// Where x lies between the ends, 0 to 1; `None` where the axis does not reach.
    pub(super) fn fraction(&self, x: f64) -> Option<f64> {
        let t = self.share(x);
        (-1e-9..=1.0 + 1e-9).contains(&t).then_some(t)
    }

    /// The place between the ends that is nearest to x, the first end where x has none.
    pub(super) fn nearest(&self, x: f64) -> f64 {
        let share = self.share(x);
        if share.is_nan() {
            0.0
        } else {
            share.clamp(0.0, 1.0)
        }
    }

    /// Values with a tick and its text. Every decade has a tick, and as many of them a text as have
    /// room.
    pub(super) fn ticks(&self) -> Vec<(f64, String)> {
        let [a, b] = self.ends;
        if let Some(names) = self.categories() {
            let name = |(i, name): (usize, &String)| (i as f64, name.clone());
            return names.iter().enumerate().map(name).collect();
        }
        if !self.is_logarithmic() {
            let text = |x| (x, scientific(&tick(x)));
            return ticks(a, b, MOST_TICKS).into_iter().map(text).collect();
        }
        let (low, high) = (libm::log10(a).round() as i32, libm::log10(b).round() as i32);
        let each = (high - low + MOST_DECADES) / MOST_DECADES;
        let name = |d: i32| match d.rem_euclid(each.max(1)) {
            0 => format!("10{}", superscript(d)),
            _ => String::new(),
        };
        let decade = |d| (libm::exp10(f64::from(d)), name(d));
        (low..=high).map(decade).collect()
    }
}

/// Ends a little beyond the values, and apart where these are one or none.
fn slackened([low, high]: [f64; 2]) -> [f64; 2] {
    let span = high - low;
    if span > 0.0 {
        [low - BEYOND * span, high + BEYOND * span]
    } else if low.is_finite() {
        [low - 1.0, low + 1.0]
    } else {
        [0.0, 1.0]
    }
}

/// The decades around positive values.
fn decades([low, high]: [f64; 2]) -> [f64; 2] {
    let [low, high] = if high > 0.0 { [low, high] } else { [0.1, 1.0] };
    let (a, b) = (libm::log10(low).floor(), libm::log10(high).ceil());
    [a, b.max(a + 1.0)].map(libm::exp10)
}

/// Places low ≤ x ≤ high that are multiples of 1, 2 or 5 times a power of ten, at most `most` + 1
/// of them.
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

/// The smallest of 1, 2, 5 · 10ⁿ that fits into `span` no more than `most` times; `None` for an
/// empty or infinite span.
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

    fn ruler(axis: &Axis, values: &[f64]) -> [f64; 2] {
        Ruler::around(axis, values.iter().copied()).ends
    }

    #[test]
    fn decades_span_the_values_and_place_them() {
        let axis = Axis::decades("");
        let ruler = Ruler::around(&axis, [3e-4, 0.02, 0.0, f64::NAN].into_iter());
        let [a, b] = ruler.ends;
        assert!((a / 1e-4 - 1.0).abs() < 1e-12 && (b / 0.1 - 1.0).abs() < 1e-12);
        assert!((ruler.fraction(1e-3).unwrap() - 1.0 / 3.0).abs() < 1e-12);
        assert_eq!((ruler.fraction(0.0), ruler.fraction(1.0)), (None, None));
        assert_eq!((ruler.nearest(0.0), ruler.nearest(1.0)), (0.0, 1.0));
        let texts: Vec<String> = ruler.ticks().into_iter().map(|t| t.1).collect();
        assert_eq!(texts, ["10⁻⁴", "10⁻³", "10⁻²", "10⁻¹"]);
    }

    #[test]
    fn even_axes_hold_their_values_unless_they_are_clipped() {
        let values = [24.0, 4.0, f64::NAN, 8.0];
        let ends = ruler(&Axis::linear("", [5.0, 14.0]), &values);
        assert_eq!(ends, [4.0 - 0.6, 24.0 + 0.6]);
        assert_eq!(ruler(&Axis::clipped("", [5.0, 14.0]), &values), [5.0, 14.0]);
        let around = Axis::linear("", [f64::INFINITY, f64::NEG_INFINITY]);
        assert_eq!(
            (ruler(&around, &[8.0]), ruler(&around, &[])),
            ([7.0, 9.0], [0.0, 1.0])
        );
    }

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
