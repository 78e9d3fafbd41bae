//! Up to which glare, and from which exposure on, an analysis reads the picture.

use super::results::{Setting, Threshold};

/// Largest glare and shortest exposure at which each analysis reads the picture with a modulation
/// of at least `level`, by interpolation of the mean normalized modulation over the logarithm
/// between neighbouring settings. Both sweeps have the same spreads and analyses.
pub(super) fn thresholds(
    by_glare: &[Setting],
    by_exposure: &[Setting],
    level: f64,
) -> Vec<Threshold> {
    let spreads = Setting::by_spread(by_glare).zip(Setting::by_spread(by_exposure));
    let of = |(glares, exposures): (&[Setting], &[Setting])| -> Vec<Threshold> {
        let one = |i: usize| {
            let mean = |s: &Setting| {
                let found = s.readings[i].mtf_normalized;
                found.map_or(f64::NEG_INFINITY, |m| m.mean)
            };
            let rising: Vec<_> = glares.iter().map(|s| [s.glare, mean(s)]).collect();
            let falling: Vec<_> = exposures
                .iter()
                .rev()
                .map(|s| [s.exposure, mean(s)])
                .collect();
            let at = |line: &[[f64; 2]]| {
                let (at, between) = last_readable(line, level).unzip();
                (at, between.flatten())
            };
            let (glare, glare_between) = at(&rising);
            let (exposure, exposure_between) = at(&falling);
            Threshold {
                analysis: glares[0].readings[i].analysis.clone(),
                spread: glares[0].spread.clone(),
                glare,
                glare_between,
                exposure,
                exposure_between,
            }
        };
        (0..glares[0].readings.len()).map(one).collect()
    };
    spreads.flat_map(of).collect()
}

/// From the first point on, how far the line stays at or above `level`; `None` where it does not
/// start there. Between points, which are told, it is straight over the logarithm of x, or over x
/// where one end is 0.
fn last_readable(line: &[[f64; 2]], level: f64) -> Option<(f64, Option<[f64; 2]>)> {
    let [first, ..] = line else { return None };
    if first[1] < level {
        return None;
    }
    let end = line.windows(2).find(|w| w[1][1] < level);
    let Some([[x0, y0], [x1, y1]]) = end.map(|w| [w[0], w[1]]) else {
        return line.last().map(|p| (p[0], None));
    };
    // Where there is no reading, as far as there is one.
    let t = if y1.is_finite() {
        (y0 - level) / (y0 - y1)
    } else {
        0.0
    };
    let at = if x0 > 0.0 && x1 > 0.0 {
        x0 * libm::pow(x1 / x0, t)
    } else {
        x0 + t * (x1 - x0)
    };
    let between = [x0.min(x1), x0.max(x1)];
    Some((at, (t < 1.0).then_some(between)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_readable_point_is_interpolated() {
        // Half way in the logarithm between 1 and 100.
        let line = [[0.0, 0.9], [1.0, 0.75], [100.0, 0.25], [1e4, 0.9]];
        let (at, between) = last_readable(&line, 0.5).unwrap();
        assert!((at - 10.0).abs() < 1e-12 && between == Some([1.0, 100.0]));
        assert_eq!(last_readable(&[[0.0, 0.4], [1.0, 0.9]], 0.5), None);
        assert_eq!(
            last_readable(&[[0.0, 1.0], [2.0, 0.5]], 0.5),
            Some((2.0, None))
        );
        assert_eq!(
            last_readable(&[[0.0, 0.75], [2.0, 0.25]], 0.5),
            Some((1.0, Some([0.0, 2.0])))
        );
        assert_eq!(
            last_readable(&[[3.0, 0.75], [2.0, f64::NEG_INFINITY]], 0.5),
            Some((3.0, Some([2.0, 3.0])))
        );
        assert_eq!(last_readable(&[], 0.5), None);
    }
}
