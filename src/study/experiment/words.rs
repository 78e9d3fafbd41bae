//! The findings in plain words, from the numbers alone.

use super::results::{Experiment, Reading, Setting, Threshold};

/// One paragraph. `board` describes the object.
pub(super) fn words(found: &Experiment, board: &str) -> String {
    let mut text = format!(
        "An average pixel gets {} from {board}; {} times as much light enters the lens straight from the laser spot, so a lens that \
         scatters {} of it over the image makes glare as strong as the signal.",
        watts(found.signal),
        round(found.direct_over_signal),
        percent(1.0 / found.direct_over_signal),
    );
    let equal = found
        .by_glare
        .iter()
        .filter(|s| s.spread == found.by_glare[0].spread)
        .min_by(|a, b| off(a.glare).total_cmp(&off(b.glare)));
    if let Some(setting) = equal {
        text += &format!(
            " At glare {} times the signal, frames of {} and {} electrons of signal a pixel, the published analysis finds a modulation of {}",
            round(setting.glare),
            seconds(setting.exposure),
            round(setting.electrons),
            mtf(setting.readings.first()),
        );
        let best = setting
            .readings
            .iter()
            .filter_map(|r| Some((r, r.mtf?.mean)))
            .max_by(|a, b| a.1.total_cmp(&b.1));
        if let Some((best, _)) = best {
            text += &format!(
                "; the best of the others, `{}`, {}",
                best.analysis,
                mtf(Some(best))
            );
        }
        text.push('.');
        let bare = found
            .by_glare
            .iter()
            .find(|s| s.glare <= 0.0)
            .and_then(|s| s.readings.first());
        if let Some(bare) = bare {
            text += &format!(
                " Without any glare the published analysis finds {}",
                mtf(Some(bare))
            );
            text += match bare.mtf {
                Some(m) if m.mean.abs() < Experiment::READABLE => {
                    ": glare alone is not what makes it fail."
                }
                _ => ".",
            };
        }
    }
    let reads = |f: &dyn Fn(&Threshold) -> Option<String>| -> Vec<String> {
        found.thresholds.iter().filter_map(f).collect()
    };
    let glare = reads(&|t| {
        let most = t.glare?;
        Some(format!(
            "`{}` ({} glare) to {} times",
            t.analysis,
            t.spread,
            round(most)
        ))
    });
    text += &match glare.is_empty() {
        true => " No analysis reads the board at any glare of this study.".to_owned(),
        false => format!(
            " The board is readable (modulation {} and more) up to a glare over signal of: {}.",
            Experiment::READABLE,
            glare.join(", ")
        ),
    };
    let exposure = reads(&|t| {
        let least = t.exposure?;
        Some(format!(
            "`{}` ({} glare) from {}",
            t.analysis,
            t.spread,
            seconds(least)
        ))
    });
    if !exposure.is_empty() {
        text += &format!(
            " With glare as strong as the signal it becomes readable by: {}.",
            exposure.join(", ")
        );
    }
    text
}

/// Distance of a ratio from 1, in the logarithm.
fn off(ratio: f64) -> f64 {
    if ratio > 0.0 {
        libm::log(ratio).abs()
    } else {
        f64::INFINITY
    }
}

fn mtf(reading: Option<&Reading>) -> String {
    match reading.and_then(|r| r.mtf) {
        Some(m) => match m.deviation {
            Some(deviation) => format!("{} ± {}", round(m.mean), round(deviation)),
            None => round(m.mean),
        },
        None => "nothing".to_owned(),
    }
}

/// Two significant digits.
fn round(x: f64) -> String {
    let size = x.abs();
    if size > 0.0 && !(1e-3..1e4).contains(&size) {
        return format!("{x:.1e}");
    }
    let decimals = match size {
        s if s >= 9.95 || s == 0.0 => 0,
        s if s >= 0.995 => 1,
        s if s >= 0.0995 => 2,
        s if s >= 0.00995 => 3,
        _ => 4,
    };
    format!("{x:.decimals$}")
}

fn percent(x: f64) -> String {
    format!("{} %", round(100.0 * x))
}

fn seconds(x: f64) -> String {
    match x {
        x if x < 1e-3 => format!("{} µs", round(1e6 * x)),
        x if x < 1.0 => format!("{} ms", round(1e3 * x)),
        x => format!("{} s", round(x)),
    }
}

fn watts(x: f64) -> String {
    let (scale, unit) = match x {
        x if x < 1e-15 => (1e18, "aW"),
        x if x < 1e-12 => (1e15, "fW"),
        x if x < 1e-9 => (1e12, "pW"),
        x if x < 1e-6 => (1e9, "nW"),
        _ => (1e6, "µW"),
    };
    format!("{} {unit}", round(scale * x))
}

/// Largest glare and shortest exposure at which each analysis reads the board, by interpolation in the logarithm of the mean raw modulation
/// between neighbouring settings.
pub(super) fn thresholds(by_glare: &[Setting], by_exposure: &[Setting]) -> Vec<Threshold> {
    let mut found = Vec::new();
    let mut spreads: Vec<&str> = Vec::new();
    for s in by_glare.iter().chain(by_exposure) {
        if !spreads.contains(&s.spread.as_str()) {
            spreads.push(&s.spread);
        }
    }
    for spread in spreads {
        let of = |settings: &'_ [Setting]| -> Vec<Setting> {
            settings
                .iter()
                .filter(|s| s.spread == spread)
                .cloned()
                .collect()
        };
        let (glares, exposures) = (of(by_glare), of(by_exposure));
        let count = glares
            .first()
            .or(exposures.first())
            .map_or(0, |s| s.readings.len());
        for i in 0..count {
            let mean = |s: &Setting| s.readings[i].mtf.map_or(f64::NEG_INFINITY, |m| m.mean);
            let line = |settings: &[Setting], x: fn(&Setting) -> f64| -> Vec<[f64; 2]> {
                settings.iter().map(|s| [x(s), mean(s)]).collect()
            };
            let name = |s: &Setting| s.readings[i].analysis.clone();
            let mut backwards = line(&exposures, |s| s.exposure);
            backwards.reverse();
            found.push(Threshold {
                analysis: glares
                    .first()
                    .or(exposures.first())
                    .map(name)
                    .unwrap_or_default(),
                spread: spread.to_owned(),
                glare: last_readable(&line(&glares, |s| s.glare)),
                exposure: last_readable(&backwards),
            });
        }
    }
    found
}

/// From the first point on, how far the line stays at or above [`Experiment::READABLE`]; `None` where it does not start there. Between
/// points it is straight over the logarithm of x, or over x where one end is 0.
fn last_readable(line: &[[f64; 2]]) -> Option<f64> {
    let level = Experiment::READABLE;
    let [first, ..] = line else { return None };
    if first[1] < level {
        return None;
    }
    let end = line.windows(2).find(|w| w[1][1] < level);
    let Some([[x0, y0], [x1, y1]]) = end.map(|w| [w[0], w[1]]) else {
        return line.last().map(|p| p[0]);
    };
    if !y1.is_finite() {
        return Some(x0);
    }
    let t = (y0 - level) / (y0 - y1);
    Some(if x0 > 0.0 && x1 > 0.0 {
        x0 * libm::pow(x1 / x0, t)
    } else {
        x0 + t * (x1 - x0)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_readable_point_is_interpolated() {
        // Half way in the logarithm between 1 and 100.
        let line = [[0.0, 0.9], [1.0, 0.75], [100.0, 0.25], [1e4, 0.9]];
        assert!((last_readable(&line).unwrap() - 10.0).abs() < 1e-12);
        assert_eq!(last_readable(&[[0.0, 0.4], [1.0, 0.9]]), None);
        assert_eq!(last_readable(&[[0.0, 1.0], [2.0, 0.5]]), Some(2.0));
        assert_eq!(last_readable(&[[0.0, 0.75], [2.0, 0.25]]), Some(1.0));
        assert_eq!(
            last_readable(&[[3.0, 0.75], [2.0, f64::NEG_INFINITY]]),
            Some(3.0)
        );
        assert_eq!(last_readable(&[]), None);
    }

    #[test]
    fn numbers_are_said_with_two_digits() {
        for (x, said) in [
            (0.9532, "0.95"),
            (0.0, "0"),
            (-0.034, "-0.034"),
            (12.6, "13"),
            (1.26, "1.3"),
            (123_456.0, "1.2e5"),
            (4e-5, "4.0e-5"),
        ] {
            assert_eq!(round(x), said);
        }
        assert_eq!(
            (seconds(0.02), watts(3.2e-14)),
            ("20 ms".to_owned(), "32 fW".to_owned())
        );
    }
}
