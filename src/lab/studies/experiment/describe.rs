//! What the re-enacted experiment says, from its numbers alone.

mod tables;

use super::results::{Experiment, Reading, Setting, Threshold};
use crate::lab::ensemble::Spread;
use crate::lab::finding::{Axis, Curve, Describe, Figure, Finding, Mark, Plot};
use crate::num::digits::{figure, significant};

/// Neighbouring settings of a larger ratio are named beside a threshold between them.
const WIDE: f64 = 2.0;

/// What of a setting a sweep varies.
type Varied = fn(&Setting) -> f64;

impl Describe for Experiment {
    fn describe(&self) -> Finding {
        let (first, rest) = self.words.split_at(self.words.len().min(2));
        let glare: Varied = |s| s.glare;
        let exposure: Varied = |s| s.exposure;
        let by_glare = "by glare over signal, at the longest exposure";
        let by_exposure = "by exposure of a frame, glare as strong as the signal";
        let mut tables = self.sweep(&self.by_glare, by_glare, glare, "");
        tables.extend(self.sweep(&self.by_exposure, by_exposure, exposure, " s"));
        tables.extend([self.limits(), self.file()]);
        let mut panels = plots(&self.by_glare, "glare over signal", glare);
        panels.extend(plots(&self.by_exposure, "exposure of a frame, s", exposure));
        let title = format!("The experiment, re-enacted: {}", self.scene);
        Finding {
            title: title.clone(),
            sentence: first.join(" "),
            notes: rest.to_vec(),
            tables,
            figures: vec![Figure {
                file: "experiment.svg".to_owned(),
                title,
                note: format!("sensor {}, mean over {} seeds", self.sensor, self.seeds),
                plots: panels,
            }],
            ..Finding::default()
        }
    }
}

/// The findings, a paragraph each; `object` names what is hidden.
pub(super) fn words(found: &Experiment, object: &str) -> Vec<String> {
    let spreads = || Setting::by_spread(&found.by_glare);
    let mut said = vec![format!(
        "An average pixel gets {} from {object}; {} times as much light enters the lens straight from the laser spot, so a lens that scatters {} % of it over the image makes glare as strong as the signal.",
        prefixed(found.signal, "W"),
        two(found.direct_over_signal),
        two(100.0 * (1.0 / found.direct_over_signal)),
    )];
    said.extend(spreads().filter_map(|own| equal(found, own)));
    if let Some(bare) = found.by_glare.iter().find(|s| s.glare <= 0.0) {
        let published = &bare.readings[0];
        let lost = |m: Spread| m.mean < found.readable();
        let end = if published.in_all(found.seeds).is_none_or(lost) {
            ": glare is not the only cause of its failure."
        } else {
            "."
        };
        said.push(format!(
            "Without any glare the published analysis finds {}{end}",
            modulation(published, found.seeds)
        ));
    }
    said.extend(spreads().map(|own| reach(found, own)));
    let settings = found.by_glare.iter().chain(&found.by_exposure);
    let mut readings = settings.flat_map(|s| &s.readings);
    if readings.any(|r| r.in_some(found.seeds).is_some()) {
        let some = "Where an analysis has a modulation in some of the draws alone (the others give a constant picture or nothing) it does not read the picture; the tables say of how many its mean is.";
        said.push(some.to_owned());
    }
    if found.seeds > 1 {
        let more = if (found.traced as u64) < found.seeds {
            format!(", {} times in all", found.traced)
        } else {
            String::new()
        };
        said.push(format!(
            "Each ± is the scatter of one reading over {} seeds: the sensor's noise, and the light traced anew{more}. \
             Glare and exposures are set by the first of these; thresholds are those of the means.",
            found.seeds
        ));
    }
    said
}

/// The photographs with glare as strong as the signal: the published analysis and the one whose
/// modulation is the closest to the picture's own.
fn equal(found: &Experiment, own: &[Setting]) -> Option<String> {
    let off = |s: &Setting| libm::log(s.glare).abs();
    let setting = own.iter().min_by(|a, b| off(a).total_cmp(&off(b)))?;
    let off = |r: &Reading| Some((r.in_all(found.seeds)?.mean - found.own_modulation).abs());
    let readings = setting.readings.iter().filter_map(|r| Some((r, off(r)?)));
    let best = readings.min_by(|a, b| a.1.total_cmp(&b.1));
    let best = best.map_or(String::new(), |(r, _)| {
        format!(", `{}` {}", r.analysis, modulation(r, found.seeds))
    });
    Some(format!(
        "With {} glare of {} times the signal ({} of exposure a frame, {} electrons of signal a pixel) the published analysis finds a normalized modulation of {}{best}.",
        setting.spread,
        two(setting.glare),
        prefixed(setting.exposure, "s"),
        two(setting.electrons),
        modulation(&setting.readings[0], found.seeds),
    ))
}

/// What reads the picture under one spread of glare, and from which exposure on.
fn reach(found: &Experiment, own: &[Setting]) -> String {
    // A board, of two values, is stretched to all of [0, 1].
    let is_board = found.own_modulation >= 1.0;
    let what = if is_board { "board" } else { "picture" };
    let share = if is_board { "" } else { ", half of its own" };
    let spread = own[0].spread.as_str();
    let most = own.iter().map(|s| s.glare).fold(0.0, f64::max);
    let limits = || found.thresholds.iter().filter(|t| t.spread == spread);
    let names = |keep: &dyn Fn(&Threshold) -> Option<String>| -> String {
        let names: Vec<String> = limits().filter_map(keep).collect();
        names.join(", ")
    };
    let name = |t: &Threshold| format!("`{}`", t.analysis);
    let lists = [
        (
            format!(
                "up to the strongest studied, {} times the signal, by",
                two(most)
            ),
            names(&|t| (t.glare? >= most).then(|| name(t))),
        ),
        (
            "up to the glare over signal in brackets by".to_owned(),
            names(&|t| {
                let glare = t.glare.filter(|g| *g < most)?;
                let far = far(t.glare_between, two);
                Some(format!("{} ({}{far})", name(t), two(glare)))
            }),
        ),
        (
            "not even at the least glare studied by".to_owned(),
            names(&|t| t.glare.is_none().then(|| name(t))),
        ),
    ];
    let lists = lists.iter().filter(|(_, list)| !list.is_empty());
    let lists: String = lists
        .map(|(what, list)| format!(" {what} {list};"))
        .collect();
    let exposures = limits().filter_map(|t| Some((t, t.exposure?)));
    let shortest = exposures.min_by(|a, b| a.1.total_cmp(&b.1));
    let exposure = match shortest {
        // Shorter ones were not studied.
        Some((t, exposure))
            if t.exposure_between.is_none()
                && exposure <= found.exposures(spread).fold(f64::INFINITY, f64::min) =>
        {
            format!(
                "the {what} is readable in single frames of {} already, the shortest studied, by {}.",
                prefixed(exposure, "s"),
                name(t)
            )
        }
        Some((t, exposure)) => format!(
            "the {what} is readable in single frames of at least {}{}, by {}.",
            prefixed(exposure, "s"),
            far(t.exposure_between, |x| prefixed(x, "s")),
            name(t)
        ),
        None => format!(
            "none of the exposures studied, single frames of up to {}, is long enough.",
            prefixed(found.exposures(spread).fold(0.0, f64::max), "s")
        ),
    };
    format!(
        "Under {spread} glare the {what} is readable (normalized modulation {} and more{share}){lists} \
         with glare as strong as the signal, {exposure}",
        figure(found.readable(), 2)
    )
}

/// That a threshold lies in or at a wide gap, and in which.
fn far(between: Option<[f64; 2]>, number: impl Fn(f64) -> String) -> String {
    let wide = between.filter(|[low, high]| *high > WIDE * low);
    wide.map_or(String::new(), |[low, high]| {
        format!(
            ", between {} and {} nothing was studied",
            number(low),
            number(high)
        )
    })
}

/// The normalized modulation, and in how many of the `seeds` it is defined where not in all.
fn modulation(reading: &Reading, seeds: u64) -> String {
    let of = reading.in_some(seeds);
    let of = of.map_or(String::new(), |of| format!(" (in {of} draws)"));
    match reading.mtf_normalized {
        Some(Spread {
            mean,
            deviation: Some(deviation),
            ..
        }) => format!("{} ± {}{of}", two(mean), two(deviation)),
        Some(m) => two(m.mean) + &of,
        None => "nothing".to_owned(),
    }
}

fn two(x: f64) -> String {
    significant(x, 2)
}

/// A number below 1000 of a unit with its prefix.
fn prefixed(x: f64, unit: &str) -> String {
    let prefixes = [
        (1e18, "a"),
        (1e15, "f"),
        (1e12, "p"),
        (1e9, "n"),
        (1e6, "µ"),
        (1e3, "m"),
    ];
    let fits = |(scale, _): &(f64, &str)| scale * x < 1e3;
    let (scale, prefix) = prefixes.into_iter().find(fits).unwrap_or((1.0, ""));
    format!("{} {prefix}{unit}", two(scale * x))
}

/// A plot for each spread of the glare, a line an analysis.
fn plots(settings: &[Setting], title: &str, x: Varied) -> Vec<Plot> {
    let of = |own: &[Setting]| {
        let curve = |i: usize| {
            let point = |s: &Setting| Some([x(s), s.readings[i].mtf_normalized?.mean]);
            let points = own.iter().filter_map(point).collect();
            Curve::new(&own[0].readings[i].analysis, Mark::Line, points)
        };
        let upwards = Axis::linear("normalized modulation", [-0.4, 1.0]);
        let curves = (0..own[0].readings.len()).map(curve).collect();
        let glare = format!("{} glare", own[0].spread);
        Plot::new(glare, [Axis::decades(title), upwards], curves)
    };
    Setting::by_spread(settings).map(of).collect()
}

impl Experiment {
    /// The exposures that were studied with this spread of the glare, s.
    fn exposures(&self, spread: &str) -> impl Iterator<Item = f64> {
        let own = self.by_exposure.iter().filter(move |s| s.spread == spread);
        own.map(|s| s.exposure)
    }
}

#[cfg(test)]
mod tests;
