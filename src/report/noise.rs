//! The noise study as text and as figures.

use super::axis::significant;
use super::chart::{Axis, Run, Series, legend, panel, sheet};
use crate::study::{LIMITS, Lost, NoiseCurve, NoiseStudy, Point, Spread};

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
        "{}: {} at which the mean MTF over {} draws falls to {high} and to {low} ({} kernel)\n\n\
         {:>6} {:>8}  {:<17} {:>9} {:>9} {:>9} {:>9}\n",
        study.scene,
        study.axis_title,
        study.seeds,
        study.kernel,
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
    if study
        .curves
        .iter()
        .any(|c| c.points.iter().any(|p| p.failed > 0))
    {
        out += "\n";
        for c in &study.curves {
            for p in c.points.iter().filter(|p| p.failed > 0) {
                out += &format!(
                    "{} × {} checks, {}, {}: {} of {} draws gave nothing: {}\n",
                    c.board,
                    c.board,
                    c.method,
                    significant(p.level, 2),
                    p.failed,
                    p.draws,
                    p.failure.as_deref().unwrap_or("")
                );
            }
        }
    }
    if !study.render_noise.is_empty() {
        out += "\nnoise of renders on the same axis (relative, rms over entries)\n";
        for m in &study.render_noise {
            out += &format!(
                "  {:<12} {:>8} samples  {}\n",
                m.estimator,
                m.samples,
                significant(m.noise, 3)
            );
        }
    }
    out
}

fn level(lost: Lost) -> String {
    match lost {
        Lost::At(level) => significant(level, 2),
        Lost::Before => "always".to_owned(),
        Lost::Never => "never".to_owned(),
        Lost::Unknown => "undefined".to_owned(),
    }
}

/// The curves as comma-separated values with a header line.
pub fn noise_csv(study: &NoiseStudy) -> String {
    let mut out = "board,elements,method,noise,draws,failed,denominator_spread".to_owned();
    for m in Measure::ALL {
        let name = m.name().replace('-', "_");
        out += &format!(",{name},{name}_deviation,{name}_stderr");
    }
    out += "\n";
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
            out += "\n";
        }
    }
    out
}

/// Panels a row.
const COLUMNS: usize = 3;

/// One measure as a figure: a panel for each object and number of elements, a line for each method. Render noise, if it was measured, as upright lines.
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
    let names = objects.first().map_or(0, |o| own(*o).count()) + marks;
    let height = 120 + 330 * rows + 20 * names;
    let title = format!("How much noise each recovery bears: {}", study.scene);
    let mut svg = sheet([1100, height as u32], &title, "");
    let points = || study.curves.iter().flat_map(|c| &c.points);
    let x = Axis::decades(points().map(|p| p.level), study.axis_title.clone());
    let y = match measure {
        Measure::Rmse => Axis::decades(
            points().filter_map(|p| measure.of(p)).map(|s| s.mean),
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
    let upright = study.render_noise.iter().map(|m| Series {
        name: format!("render: {}, {} samples", m.estimator, m.samples),
        points: y.ends.map(|e| [m.noise, e]).to_vec(),
    });
    let mut key = Vec::new();
    for (i, object) in objects.iter().enumerate() {
        let (column, row) = (i % COLUMNS, i / COLUMNS);
        let corner = [80.0 + 350.0 * column as f64, 80.0 + 330.0 * row as f64];
        let series: Vec<Series> = own(*object).map(line).chain(upright.clone()).collect();
        let [board, elements] = object;
        let what = format!("{board} × {board} checks, {elements} × {elements} elements");
        svg.text([corner[0], corner[1] - 10.0], "fill=\"#222222\"", &what);
        panel(&mut svg, corner, [250.0, 230.0], [&x, &y], &series);
        key = series;
    }
    legend(&mut svg, [80.0, 90.0 + 330.0 * rows as f64], &key);
    svg.raw("</svg>\n");
    svg.text
}
