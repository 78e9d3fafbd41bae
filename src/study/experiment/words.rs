//! The findings in plain words, from the numbers alone.

use super::results::{Experiment, Reading, Setting, Threshold};

/// One paragraph. `object` names what is hidden.
pub(super) fn words(found: &Experiment, object: &str) -> String {
    let mut text = format!(
        "An average pixel gets {} from {object}; {} times as much light enters the lens straight from the laser spot, so a lens that \
         scatters {} of it over the image makes glare as strong as the signal.",
        watts(found.signal),
        round(found.direct_over_signal),
        percent(1.0 / found.direct_over_signal),
    );
    for spread in spreads(found) {
        let of = || found.by_glare.iter().filter(move |s| s.spread == spread);
        text += &equal(
            of().min_by(|a, b| off(a.glare).total_cmp(&off(b.glare))),
            spread,
        );
    }
    if let Some(bare) = found.by_glare.iter().find(|s| s.glare <= 0.0) {
        text += &format!(
            " Without any glare the published analysis finds {}",
            mtf(bare.readings.first())
        );
        text += match bare.readings.first().and_then(|r| r.mtf_normalized) {
            Some(m) if m.mean < Experiment::READABLE => ": glare alone is not what makes it fail.",
            _ => ".",
        };
    }
    for spread in spreads(found) {
        text += &reach(found, spread);
    }
    text
}

/// The photographs with glare as strong as the signal: the published analysis and the best one.
fn equal(setting: Option<&Setting>, spread: &str) -> String {
    let Some(setting) = setting else {
        return String::new();
    };
    let mut text = format!(
        " With {spread} glare of {} times the signal ({} of exposure a frame, {} electrons of signal a pixel) the published analysis finds a \
         normalized modulation of {}",
        round(setting.glare),
        seconds(setting.exposure),
        round(setting.electrons),
        mtf(setting.readings.first()),
    );
    let best = setting
        .readings
        .iter()
        .filter_map(|r| Some((r, r.mtf_normalized?.mean)))
        .max_by(|a, b| a.1.total_cmp(&b.1));
    if let Some((best, _)) = best {
        text += &format!(", `{}` {}", best.analysis, mtf(Some(best)));
    }
    text + "."
}

/// What reads the board under one spread of glare, and from which exposure on.
fn reach(found: &Experiment, spread: &str) -> String {
    let own: Vec<&Threshold> = found
        .thresholds
        .iter()
        .filter(|t| t.spread == spread)
        .collect();
    let most = found
        .by_glare
        .iter()
        .filter(|s| s.spread == spread)
        .map(|s| s.glare)
        .fold(0.0, f64::max);
    let names = |keep: &dyn Fn(&Threshold) -> Option<String>| -> String {
        own.iter()
            .filter_map(|t| keep(t))
            .collect::<Vec<_>>()
            .join(", ")
    };
    let always = names(&|t| (t.glare? >= most).then(|| format!("`{}`", t.analysis)));
    let some = names(&|t| {
        let glare = t.glare.filter(|g| *g < most)?;
        Some(format!("`{}` ({})", t.analysis, round(glare)))
    });
    let never = names(&|t| t.glare.is_none().then(|| format!("`{}`", t.analysis)));
    let mut text = format!(
        " Under {spread} glare the board is readable (normalized modulation {} and more)",
        Experiment::READABLE
    );
    for (list, what) in [
        (
            always,
            format!(
                "up to the strongest studied, {} times the signal, by",
                round(most)
            ),
        ),
        (
            some,
            "up to the glare over signal in brackets by".to_owned(),
        ),
        (never, "at no glare by".to_owned()),
    ] {
        if !list.is_empty() {
            text += &format!(" {what} {list};");
        }
    }
    let first = own
        .iter()
        .filter_map(|t| Some((t, t.exposure?)))
        .min_by(|a, b| a.1.total_cmp(&b.1));
    text += &match first {
        Some((t, exposure)) => format!(
            " with glare as strong as the signal it needs single frames of at least {}, by `{}`.",
            seconds(exposure),
            t.analysis
        ),
        None => " with glare as strong as the signal no exposure of single frames makes it so."
            .to_owned(),
    };
    text
}

fn spreads(found: &Experiment) -> Vec<&str> {
    let mut names: Vec<&str> = Vec::new();
    for s in &found.by_glare {
        if !names.contains(&s.spread.as_str()) {
            names.push(&s.spread);
        }
    }
    names
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
    match reading.and_then(|r| r.mtf_normalized) {
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

/// Largest glare and shortest exposure at which each analysis reads the board, by interpolation of the mean normalized modulation over the logarithm
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
            let mean = |s: &Setting| {
                s.readings[i]
                    .mtf_normalized
                    .map_or(f64::NEG_INFINITY, |m| m.mean)
            };
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
