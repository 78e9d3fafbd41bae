//! Up to which glare, and from which exposure on, an analysis reads the picture.

use super::results::{Experiment, Setting, Threshold};
use crate::lab::studies::loss::size_at;

/// Largest glare and shortest exposure at which each analysis reads the picture: its mean
/// normalized modulation is [`Experiment::READABLE`] of the picture's `own` or more, and defined in
/// each of the `seeds`. Both sweeps have the same spreads and analyses.
pub(super) fn thresholds(
    [by_glare, by_exposure]: [&[Setting]; 2],
    own: f64,
    seeds: u64,
) -> Vec<Threshold> {
    let spreads = Setting::by_spread(by_glare).zip(Setting::by_spread(by_exposure));
    let of = |(glares, exposures): (&[Setting], &[Setting])| -> Vec<Threshold> {
        let one = |i: usize| {
            let mean = |s: &Setting| {
                let found = s.readings[i].in_all(seeds);
                found.map_or(f64::NEG_INFINITY, |m| m.mean / own)
            };
            let rising: Vec<_> = glares.iter().map(|s| [s.glare, mean(s)]).collect();
            let falling: Vec<_> = exposures
                .iter()
                .rev()
                .map(|s| [s.exposure, mean(s)])
                .collect();
            let at = |line: &[[f64; 2]]| {
                let (at, between) = last_readable(line, Experiment::READABLE).unzip();
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

/// From the first point on, how far the line stays at or above `level`, a share; `None` where it
/// does not start there. Between which points it falls below is told. Where there is no reading it
/// goes as far as there is one.
fn last_readable(line: &[[f64; 2]], level: f64) -> Option<(f64, Option<[f64; 2]>)> {
    let [first, ..] = line else { return None };
    if first[1] < level {
        return None;
    }
    let end = line.windows(2).find(|w| w[1][1] < level);
    let Some([near, far]) = end.map(|w| [w[0], w[1]]) else {
        return line.last().map(|p| (p[0], None));
    };
    let between = [near[0].min(far[0]), near[0].max(far[0])];
    if !far[1].is_finite() {
        return Some((near[0], Some(between)));
    }
    Some((size_at([near, far], level), Some(between)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_readable_point_is_interpolated() {
        // From a loss of 0.25 to one of 1, half way to 0.5 in the logarithm: of 1 and 100 at 10.
        let line = [[0.0, 0.9], [1.0, 0.75], [100.0, 0.0], [1e4, 0.9]];
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
