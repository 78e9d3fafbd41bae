//! The re-enacted experiment as text and as a figure.

use super::axis::significant;
use super::chart::{Axis, Run, Series, legend, panel, sheet};
use crate::study::{Experiment, Setting, Spread};

/// The findings in words, then the normalized modulation of every analysis, one table by glare and one by exposure.
pub fn experiment_table(study: &Experiment) -> String {
    let mut out = format!("{}\n", wrapped(&study.words, 100));
    let glare = |s: &Setting| significant(s.glare, 2);
    out += &block(
        &study.by_glare,
        "normalized modulation by glare over signal, at the longest exposure",
        glare,
    );
    let exposure = |s: &Setting| format!("{} s", significant(s.exposure, 2));
    out += &block(
        &study.by_exposure,
        "normalized modulation by exposure of a frame, glare as strong as the signal",
        exposure,
    );
    out
}

/// One table a spread of the glare: a line an analysis, a column a setting.
fn block(settings: &[Setting], title: &str, head: impl Fn(&Setting) -> String) -> String {
    let mut out = String::new();
    for spread in spreads(settings) {
        let of: Vec<&Setting> = settings.iter().filter(|s| s.spread == spread).collect();
        out += &format!("\n{title}; {spread} glare\n{:<32}", "");
        for s in &of {
            out += &format!(" {:>8}", head(s));
        }
        out.push('\n');
        for i in 0..of[0].readings.len() {
            out += &format!("{:<32}", of[0].readings[i].analysis);
            for s in &of {
                let mtf = s.readings[i].mtf_normalized;
                let mtf = mtf.map_or("–".to_owned(), |m| format!("{:.2}", m.mean));
                out += &format!(" {mtf:>8}");
            }
            out.push('\n');
        }
    }
    out
}

pub(super) fn spreads(settings: &[Setting]) -> Vec<&str> {
    let mut found: Vec<&str> = Vec::new();
    for s in settings {
        if !found.contains(&s.spread.as_str()) {
            found.push(&s.spread);
        }
    }
    found
}

/// Lines of at most `width` characters.
fn wrapped(text: &str, width: usize) -> String {
    let (mut out, mut used) = (String::new(), 0);
    for word in text.split(' ') {
        let length = word.chars().count();
        if used > 0 && used + 1 + length > width {
            out.push('\n');
            used = 0;
        } else if used > 0 {
            out.push(' ');
            used += 1;
        }
        out += word;
        used += length;
    }
    out
}

/// Every reading as comma-separated values with a header line.
pub fn experiment_csv(study: &Experiment) -> String {
    let mut out = "sweep,spread,glare,fraction,exposure_s,electrons,saturated,noise,analysis,mtf,mtf_sd,mtf_normalized,\
                   mtf_normalized_sd,correlation,correlation_sd,failed\n"
        .to_owned();
    for (sweep, settings) in [("glare", &study.by_glare), ("exposure", &study.by_exposure)] {
        for s in settings {
            for r in &s.readings {
                let pair = |x: Option<Spread>| {
                    let sd = |x: Spread| x.deviation.map_or(String::new(), |d| format!("{d:e}"));
                    x.map_or(",".to_owned(), |x| format!("{:e},{}", x.mean, sd(x)))
                };
                out += &format!(
                    "{sweep},{},{:e},{:e},{:e},{:e},{},{:e},\"{}\",{},{},{},{}\n",
                    s.spread,
                    s.glare,
                    s.fraction,
                    s.exposure,
                    s.electrons,
                    s.saturated,
                    s.noise,
                    r.analysis,
                    pair(r.mtf),
                    pair(r.mtf_normalized),
                    pair(r.correlation),
                    r.failed
                );
            }
        }
    }
    out
}

/// The study as a figure: normalized modulation against glare and against exposure, one line an analysis, a column of panels a spread.
pub fn experiment_svg(study: &Experiment) -> String {
    let title = format!("The experiment, again: {}", study.scene);
    let note = format!("sensor {}, mean over {} seeds", study.sensor, study.seeds);
    let columns = spreads(&study.by_glare);
    let width = 330 + 400 * columns.len().max(1) as u32;
    let mut svg = sheet([width, 760], &title, &note);
    let modulation = || Axis {
        run: Run::Linear,
        ends: [-0.4, 1.0],
        title: "normalized modulation".to_owned(),
    };
    for (k, spread) in columns.iter().enumerate() {
        let left = 80.0 + 400.0 * k as f64;
        for (settings, top, title, x) in [
            (
                &study.by_glare,
                80.0,
                "glare over signal",
                (|s: &Setting| s.glare) as fn(&Setting) -> f64,
            ),
            (&study.by_exposure, 430.0, "exposure of a frame, s", |s| {
                s.exposure
            }),
        ] {
            let of: Vec<&Setting> = settings.iter().filter(|s| s.spread == *spread).collect();
            let lines = lines(&of, x);
            let across =
                Axis::decades(of.iter().map(|s| x(s)), format!("{title} ({spread} glare)"));
            panel(
                &mut svg,
                [left, top],
                [310.0, 260.0],
                [&across, &modulation()],
                &lines,
            );
            if k + 1 == columns.len() && top < 100.0 {
                legend(&mut svg, [left + 340.0, 94.0], &lines);
            }
        }
    }
    svg.raw("</svg>\n");
    svg.text
}

fn lines(settings: &[&Setting], x: fn(&Setting) -> f64) -> Vec<Series> {
    let count = settings.first().map_or(0, |s| s.readings.len());
    (0..count)
        .map(|i| Series {
            name: settings[0].readings[i].analysis.clone(),
            points: settings
                .iter()
                .filter_map(|s| Some([x(s), s.readings[i].mtf_normalized?.mean]))
                .collect(),
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_wrapped_between_words() {
        assert_eq!(wrapped("aa bb cc dd", 5), "aa bb\ncc dd");
        assert_eq!(wrapped("aaaaaaa b", 3), "aaaaaaa\nb");
    }
}
