//! The noise study as text and as figures.

use super::axis::significant;
use super::chart::{Axis, Panel, Run, Series, legend, sheet};
use crate::study::{Best, LIMITS, Lost, NoiseCurve, NoiseStudy, Point, Reach, Spacing, Spread};

/// What a figure shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    /// Raw MTF.
    MtfRaw,
    /// Normalized MTF.
    MtfNormalized,
    /// Correlation with the truth.
    Correlation,
    /// Root mean square error.
    Rmse,
}

impl Measure {
    /// Every measure.
    pub const ALL: [Self; 4] = [
        Self::MtfRaw,
        Self::MtfNormalized,
        Self::Correlation,
        Self::Rmse,
    ];

    /// Its name in the files of a study.
    pub fn name(self) -> &'static str {
        match self {
            Self::MtfRaw => "mtf-raw",
            Self::MtfNormalized => "mtf-normalized",
            Self::Correlation => "correlation",
            Self::Rmse => "rmse",
        }
    }

    fn of(self, point: &Point) -> Option<Spread> {
        match self {
            Self::MtfRaw => point.mtf_raw,
            Self::MtfNormalized => point.mtf_normalized,
            Self::Correlation => point.correlation,
            Self::Rmse => point.rmse,
        }
    }

    fn title(self) -> &'static str {
        match self {
            Self::MtfRaw => "raw MTF, mean",
            Self::MtfNormalized => "normalized MTF, mean",
            Self::Correlation => "correlation, mean",
            Self::Rmse => "RMSE, mean",
        }
    }
}

/// The study as plain text: for each object, elements and method the noise at which the mean MTF is lost.
pub fn noise_table(study: &NoiseStudy) -> String {
    let [high, low] = LIMITS;
    let mut out = format!(
        "{}: {} at which the mean MTF over {} draws falls to {high} and to {low} ({} kernel)\n{}\n\n\
         {:>6} {:>8}  {:<17} {:>9} {:>9} {:>9} {:>9}\n",
        place(study),
        study.axis_title,
        study.seeds,
        study.kernel,
        study.axis_words,
        "checks",
        "elements",
        "method",
        format!("raw {high}"),
        format!("raw {low}"),
        format!("norm. {high}"),
        format!("norm. {low}"),
    );
    for c in &study.curves {
        let side = |n: usize| format!("{n} × {n}");
        out += &format!(
            "{:>6} {:>8}  {:<17}",
            side(c.board),
            side(c.elements),
            c.method
        );
        for lost in c.lost_raw.iter().chain(&c.lost_normalized) {
            out += &format!(" {:>9}", level(*lost));
        }
        out += "\n";
    }
    out += "always: below at the quietest level already; never: not below at any; undefined: before that some draw gave nothing, or no mean is known\n";
    let failed: Vec<String> = study.curves.iter().filter_map(failure).collect();
    if !failed.is_empty() {
        out += &format!("\n{}", failed.concat());
    }
    if !study.render_noise.is_empty() {
        out +=
            "\nnoise of renders (relative, rms over entries) and the level of an entry as noisy\n";
        for m in &study.render_noise {
            out += &format!(
                "  {:<12} {:>8} samples  {}  {}\n",
                m.estimator,
                m.samples,
                significant(m.noise, 3),
                figure(m.level, 3)
            );
        }
    }
    out + &best_table(study)
}

/// Draws from which a method gave nothing, with the quietest level of them and what it said there.
fn failure(c: &NoiseCurve) -> Option<String> {
    let first = c.points.iter().find(|p| p.failed > 0)?;
    let sum = |f: fn(&Point) -> usize| c.points.iter().map(f).sum::<usize>();
    let (board, elements) = (c.board, c.elements);
    Some(format!(
        "{board} × {board} checks, {elements} × {elements} elements, {}: {} of {} draws gave nothing, from {} on: {}\n",
        c.method,
        sum(|p| p.failed),
        sum(|p| p.draws),
        significant(first.level, 2),
        first.failure.as_deref().unwrap_or("")
    ))
}

/// The best method of each object, its noise and its distance from the bound.
fn best_table(study: &NoiseStudy) -> String {
    let high = LIMITS[0];
    let mut out = format!(
        "\nthe best method: mean raw MTF of {high} or more up to the loudest noise, of equals the least RMSE\n\
         {:>6} {:>8}  {:<17} {:>12} {:>9} {:>9}\n",
        "checks",
        "elements",
        "method",
        format!("level at {high}"),
        "RMSE",
        "RMSE/CRB"
    );
    for b in &study.best {
        let Best {
            board,
            elements,
            method,
            level,
            reach,
            rmse,
            rmse_over_bound,
        } = b;
        let sign = match reach {
            Some(Reach::AtLeast) => "to ",
            _ => "",
        };
        let side = |n: &usize| format!("{n} × {n}");
        out += &format!(
            "{:>6} {:>8}  {:<17} {:>12} {:>9} {:>9}\n",
            side(board),
            side(elements),
            method.as_deref().unwrap_or("none"),
            format!("{sign}{}", figure(*level, 2)),
            figure(*rmse, 2),
            figure(*rmse_over_bound, 2)
        );
    }
    out + "`to`: it has not fallen there, but beyond no level was studied or no mean is known (or it is above 1.1). RMSE over elements and draws; CRB: √(trace/elements) of the\n\
           Cramér–Rao bound of unbiased recoveries, which methods that use bounds or two values can undercut.\n"
}

/// The scene, and the sensor if the axis has one.
pub(super) fn place(study: &NoiseStudy) -> String {
    match &study.sensor {
        Some(sensor) => format!("{}, sensor {sensor}", study.scene),
        None => study.scene.clone(),
    }
}

fn figure(x: Option<f64>, digits: usize) -> String {
    x.map_or("–".to_owned(), |x| significant(x, digits))
}

pub(super) fn level(lost: Lost) -> String {
    match lost {
        Lost::At(level) => significant(level, 2),
        Lost::Before => "always".to_owned(),
        Lost::Never => "never".to_owned(),
        Lost::Unknown => "undefined".to_owned(),
    }
}

/// The curves as comma-separated values with a header line.
pub fn noise_csv(study: &NoiseStudy) -> String {
    let mut out = format!(
        "board,elements,method,{},draws,failed,denominator_spread",
        study.axis_column
    );
    for m in Measure::ALL {
        let name = m.name().replace('-', "_");
        out += &format!(",{name},{name}_deviation,{name}_stderr");
    }
    out += ",rmse_over_draws,cramer_rao,rmse_over_bound\n";
    let number = |x: Option<f64>| x.map_or(String::new(), |x| format!("{x:e}"));
    for c in &study.curves {
        for p in &c.points {
            out += &format!(
                "{},{},{},{:e},{},{},{}",
                c.board,
                c.elements,
                c.method,
                p.level,
                p.draws,
                p.failed,
                number(p.denominator_spread)
            );
            for m in Measure::ALL {
                let s = m.of(p);
                let fields = [
                    s.map(|s| s.mean),
                    s.and_then(|s| s.deviation),
                    s.and_then(|s| s.stderr),
                ];
                out += &format!(",{}", fields.map(number).join(","));
            }
            let bound = [p.rmse_over_draws, p.cramer_rao, p.rmse_over_bound];
            out += &format!(",{}\n", bound.map(number).join(","));
        }
    }
    out
}

/// Panels a row.
const COLUMNS: usize = 3;
/// A sheet is at least this wide, for the names of the curves, px.
const MOST_NARROW: usize = 560;

/// One measure as a figure: a panel for each object and number of elements, a line for each method. Render noise, if it was measured, as upright lines;
/// beside the root mean square error the bound of Cramér and Rao.
pub fn noise_svg(study: &NoiseStudy, measure: Measure) -> String {
    let mut objects: Vec<[usize; 2]> = study.curves.iter().map(|c| [c.board, c.elements]).collect();
    objects.dedup();
    let rows = objects.len().div_ceil(COLUMNS);
    let own = |object: [usize; 2]| {
        study
            .curves
            .iter()
            .filter(move |c| [c.board, c.elements] == object)
    };
    let marks = study.render_noise.len();
    let names = objects.first().map_or(0, |o| own(*o).count()) + marks + 1;
    let height = 120 + 330 * rows + 20 * names;
    let title = format!("How much noise each recovery bears: {}", place(study));
    let width = (50 + 350 * objects.len().min(COLUMNS)).max(MOST_NARROW);
    let mut svg = sheet([width as u32, height as u32], &title, "");
    let points = || study.curves.iter().flat_map(|c| &c.points);
    let x = match study.axis_spacing {
        Spacing::Logarithmic => Axis::decades(points().map(|p| p.level), study.axis_title.clone()),
        Spacing::Linear => Axis::around(points().map(|p| p.level), study.axis_title.clone()),
    };
    let y = match measure {
        Measure::Rmse => Axis::decades(
            points().flat_map(|p| {
                [measure.of(p).map(|s| s.mean), p.cramer_rao]
                    .into_iter()
                    .flatten()
            }),
            measure.title(),
        ),
        _ => Axis {
            run: Run::Linear,
            ends: [-0.2, 1.0],
            title: measure.title().to_owned(),
        },
    };
    let line = |c: &NoiseCurve| Series {
        name: c.method.clone(),
        points: c
            .points
            .iter()
            .filter_map(|p| Some([p.level, measure.of(p)?.mean]))
            .collect(),
    };
    let bound = |c: &NoiseCurve| Series {
        name: "Cramér–Rao bound of unbiased recoveries".to_owned(),
        points: c
            .points
            .iter()
            .filter_map(|p| Some([p.level, p.cramer_rao?]))
            .collect(),
    };
    let upright = study.render_noise.iter().filter_map(|m| {
        let level = m.level?;
        Some(Series {
            name: format!("render: {}, {} samples", m.estimator, m.samples),
            points: y.ends.map(|e| [level, e]).to_vec(),
        })
    });
    let mut key = Vec::new();
    for (i, object) in objects.iter().enumerate() {
        let (column, row) = (i % COLUMNS, i / COLUMNS);
        let corner = [80.0 + 350.0 * column as f64, 80.0 + 330.0 * row as f64];
        // What all curves of an object share.
        let shared = own(*object)
            .take(1)
            .filter(|_| measure == Measure::Rmse)
            .map(bound);
        let lines = own(*object).map(line);
        let series: Vec<Series> = lines.chain(shared).chain(upright.clone()).collect();
        let [board, elements] = object;
        let what = format!("{board} × {board} checks, {elements} × {elements} elements");
        svg.text([corner[0], corner[1] - 10.0], "fill=\"#222222\"", &what);
        Panel {
            corner,
            size: [250.0, 230.0],
            axes: [&x, &y],
            title: &what,
            series: &series,
            published: &[],
        }
        .draw(&mut svg);
        key = series;
    }
    legend(&mut svg, [80.0, 90.0 + 330.0 * rows as f64], &key);
    svg.raw("</svg>\n");
    svg.text
}
