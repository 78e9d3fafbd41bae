//! The study in words, tables and figures.

use super::best::Best;
use super::curve::{LIMITS, Lost, NoiseCurve, Point, Reach};
use super::picture::Picture;
use super::render::RenderNoise;
use super::study::NoiseStudy;
use crate::lab::ensemble::Spread;
use crate::lab::finding::{
    Axis, Cell, Column, Curve, Describe, Figure, Finding, Mark, Plot, Table,
};
use crate::num::digits::{figure, perhaps};

/// The published method, named beside the best one.
const PUBLISHED: &str = "pinv";
/// More objects than this are left to the table.
const MOST_NAMED: usize = 3;

/// A measure over the draws: its name in files, what a figure calls it, and itself.
type Measure = (&'static str, &'static str, fn(&Point) -> Option<Spread>);

/// Every measure; each has a figure.
const MEASURES: [Measure; 4] = [
    ("mtf_raw", "raw MTF, mean", |p| p.mtf_raw),
    ("mtf_normalized", "normalized MTF, mean", |p| {
        p.mtf_normalized
    }),
    ("correlation", "correlation, mean", |p| p.correlation),
    (RMSE, "RMSE, mean", |p| p.rmse),
];
/// The measure that spans decades, and that has a bound.
const RMSE: &str = "rmse";

impl Describe for NoiseStudy {
    fn describe(&self) -> Finding {
        let mut tables = vec![self.lost(), self.bests()];
        if !self.render_noise.is_empty() {
            tables.push(self.renders());
        }
        tables.push(self.points());
        Finding {
            title: self.title(),
            sentence: self.sentence(),
            notes: self
                .unstudied()
                .chain(self.curves.iter().filter_map(failures))
                .collect(),
            tables,
            figures: MEASURES.map(|measure| self.figure(measure)).to_vec(),
            files: vec![("noise.csv".to_owned(), self.ledger.clone())],
            ..Finding::default()
        }
    }
}

impl NoiseStudy {
    /// The scene, and the sensor if the axis has one.
    fn title(&self) -> String {
        let sensor = self.axis.label().sensor;
        let sensor = sensor.map_or(String::new(), |s| format!(", sensor {s}"));
        format!("How much noise each recovery bears: {}{sensor}", self.scene)
    }

    /// That the scene's own picture was left out, if it was.
    fn unstudied(&self) -> impl Iterator<Item = String> {
        let left_out = self.own.is_none();
        let words = "The scene's own picture is not among these: it is a board of other checks, which --boards names.";
        left_out.then(|| words.to_owned()).into_iter()
    }

    /// Which method bears how much noise, the scene's own object first.
    fn sentence(&self) -> String {
        let is_own = |b: &&Best| self.own == Some((b.picture, b.elements));
        let own = self.best.iter().filter(is_own);
        let others = self.best.iter().filter(|b| !is_own(b));
        let named = own.chain(others).take(MOST_NAMED).map(|b| self.winner(b));
        let named: Vec<String> = named.collect();
        let more = match self.best.len() {
            n if n > MOST_NAMED => format!(" ({} further objects in the table)", n - MOST_NAMED),
            _ => String::new(),
        };
        format!(
            "The mean raw MTF stays at {} of the picture's own or more {} to this level ({}): {}{more}.",
            LIMITS[0],
            if self.axis.falls() { "down" } else { "up" },
            self.axis.label().title,
            named.join("; ")
        )
    }

    /// The best method of an object beside the published one.
    fn winner(&self, b: &Best) -> String {
        let own = self
            .curves
            .iter()
            .find(|c| (c.picture, c.elements) == (b.picture, b.elements) && c.method == PUBLISHED);
        let published = own.filter(|c| b.method.as_deref() != Some(&c.method));
        let published = published.map_or(String::new(), |c| {
            let level = match c.lost_raw[0] {
                Lost::At(x) => figure(x, 2),
                Lost::Between(levels) => between(levels),
                Lost::Before => "not even the quietest".to_owned(),
                Lost::Never => "the loudest studied".to_owned(),
                Lost::Unknown => "unknown".to_owned(),
            };
            format!(" (the published {PUBLISHED}: {level})")
        });
        let mut object = object((b.picture, b.elements), " on ");
        if self.own == Some((b.picture, b.elements)) && b.picture != Picture::Own {
            object = format!("the scene's own picture, {object}");
        }
        match (&b.method, b.level) {
            (Some(method), Some(level)) => {
                let sign = match (b.reach, self.axis.falls()) {
                    (Some(Reach::AtLeast), false) => "at least ",
                    (Some(Reach::AtLeast), true) => "at most ",
                    _ => "",
                };
                format!(
                    "{object}: {sign}{} by {method}{published}",
                    figure(level, 2)
                )
            }
            _ => format!("{object}: no method reaches it{published}"),
        }
    }

    /// Every threshold.
    fn lost(&self) -> Table {
        let [high, low] = LIMITS;
        let label = self.axis.label();
        let mut columns = keys();
        for kind in ["raw", "norm."] {
            columns.extend(LIMITS.map(|l| Column::number(&format!("{kind} {l}"), "", "", 2)));
        }
        let row = |c: &NoiseCurve| {
            let levels = c.lost_raw.iter().chain(&c.lost_normalized);
            let levels = levels.map(|lost| match lost {
                Lost::At(level) => Cell::from(*level),
                Lost::Between(levels) => between(*levels).into(),
                Lost::Before => "lost".into(),
                Lost::Never => "kept".into(),
                Lost::Unknown => "unknown".into(),
            });
            key((c.picture, c.elements), &c.method)
                .chain(levels)
                .collect()
        };
        let caption = format!(
            "{} at which the mean MTF over {} draws falls to {high} and to {low} of the picture's own ({} kernel)",
            label.title, self.seeds, self.kernel
        );
        Table::new(caption, columns, self.curves.iter().map(row)).noted(format!(
            "{} lost: below at the quietest level already; kept: at no level below; unknown: before that some \
             draw gave nothing, or no mean is known. `a to b`: between these two levels, more than a decade \
             (3 bits) apart; study more levels between them (--noise).",
            label.procedure
        ))
    }

    /// The best method of each object, its noise and its distance from the bound.
    fn bests(&self) -> Table {
        let mut columns = keys();
        columns.extend(
            ["level", "RMSE", "RMSE over bound"].map(|name| Column::number(name, "", "", 2)),
        );
        let row = |b: &Best| {
            let level = match b.reach {
                Some(Reach::AtLeast) => format!("to {}", perhaps(b.level, 2)).into(),
                _ => Cell::from(b.level),
            };
            let method = b.method.as_deref().unwrap_or("none");
            let found = [level, b.rmse.into(), b.rmse_over_bound.into()];
            key((b.picture, b.elements), method).chain(found).collect()
        };
        let caption = format!(
            "The best method: mean raw MTF of {} of the picture's own or more up to the loudest noise, of equals the least RMSE",
            LIMITS[0]
        );
        Table::new(caption, columns, self.best.iter().map(row)).noted(
            "`to`: the mean has not fallen at this level, but no higher level was studied or its \
             mean is not known (or above 1.1). RMSE over elements and draws; the bound is \
             √(trace/elements) of that of Cramér and Rao for unbiased recoveries, which methods \
             that use bounds or two values can undercut.",
        )
    }

    /// Noise of renders.
    fn renders(&self) -> Table {
        let row = |m: &RenderNoise| {
            let estimator = Cell::name(&m.estimator);
            vec![estimator, m.samples.into(), m.noise.into(), m.level.into()]
        };
        Table::new(
            "Noise of renders (relative, rms over entries) and the level of an entry as noisy",
            vec![
                Column::text("estimator", ""),
                Column::text("samples", ""),
                Column::number("noise", "", "", 3),
                Column::number("level", "", "", 3),
            ],
            self.render_noise.iter().map(row),
        )
    }

    /// Every point of every curve.
    fn points(&self) -> Table {
        let column = self.axis.label().column;
        let own = ["board", "elements", "method", column, "draws", "failed"];
        let mut keys = [&own[..], &["denominator_spread"]].concat().join(",");
        for (name, ..) in MEASURES {
            keys += &format!(",{name},{name}_deviation,{name}_stderr");
        }
        keys += ",rmse_over_draws,cramer_rao,rmse_over_bound";
        let row = |c: &NoiseCurve, p: &Point| {
            let mut cells: Vec<Cell> = vec![
                Cell::Name(c.picture.to_string()),
                c.elements.into(),
                Cell::name(&c.method),
                p.level.into(),
                p.draws.into(),
                p.failed.into(),
                p.denominator_spread.into(),
            ];
            for (.., of) in MEASURES {
                let s = of(p);
                let [deviation, stderr] = [s.and_then(|s| s.deviation), s.and_then(|s| s.stderr)];
                cells.extend([s.map(|s| s.mean), deviation, stderr].map(Cell::from));
            }
            let bound = [p.rmse_over_draws, p.cramer_rao, p.rmse_over_bound];
            cells.extend(bound.map(Cell::from));
            cells
        };
        let rows = self.curves.iter();
        let rows = rows.flat_map(|c| c.points.iter().map(move |p| row(c, p)));
        Table::of_file("noise-curves.csv", keys.split(','), rows)
    }

    /// One measure: a plot for each object and number of elements, a line for each method. Render
    /// noise, if it was measured, as upright lines; beside the root mean square error the bound of
    /// Cramér and Rao.
    fn figure(&self, (name, title, of): Measure) -> Figure {
        let y = || match name {
            RMSE => Axis::decades(title),
            _ => Axis::clipped(title, [-0.2, 1.0]),
        };
        let line = |name: &str, c: &NoiseCurve, of: &dyn Fn(&Point) -> Option<f64>| {
            let points = c.points.iter().filter_map(|p| Some([p.level, of(p)?]));
            Curve::new(name, Mark::Line, points.collect())
        };
        let renders = || {
            self.render_noise.iter().filter_map(|m| {
                let name = format!("render: {}, {} samples", m.estimator, m.samples);
                Some(Curve::new(name, Mark::Level, vec![[m.level?, 0.0]; 2]))
            })
        };
        let same =
            |a: &NoiseCurve, b: &NoiseCurve| (a.picture, a.elements) == (b.picture, b.elements);
        let plot = |own: &[NoiseCurve]| {
            let lines = own.iter();
            let lines = lines.map(|c| line(&c.method, c, &|p| Some(of(p)?.mean)));
            // What all curves of an object share.
            let bound = own.first().filter(|_| name == RMSE).map(|c| {
                let name = "Cramér–Rao bound of unbiased recoveries";
                line(name, c, &|p| p.cramer_rao)
            });
            let curves = lines.chain(bound).chain(renders()).collect();
            let title = object((own[0].picture, own[0].elements), ", ");
            Plot::new(title, [self.axis.of_plot(), y()], curves)
        };
        let file = format!("noise-{}.svg", name.replace('_', "-"));
        Figure::new(
            file,
            self.title(),
            self.curves.chunk_by(same).map(plot).collect(),
        )
    }
}

/// Columns of what a row is of.
fn keys() -> Vec<Column> {
    ["checks", "elements", "method"]
        .map(|key| Column::text(key, ""))
        .to_vec()
}

/// What a row is of.
fn key((picture, n): (Picture, usize), method: &str) -> impl Iterator<Item = Cell> {
    let checks = match picture {
        Picture::Own => "own picture".to_owned(),
        Picture::Board(checks) => format!("{checks} × {checks}"),
    };
    let elements = format!("{n} × {n}");
    [checks, elements]
        .map(Cell::Name)
        .into_iter()
        .chain([Cell::name(method)])
}

/// Two levels between which a modulation is lost.
fn between([quiet, loud]: [f64; 2]) -> String {
    format!("{} to {}", figure(quiet, 2), figure(loud, 2))
}

/// An object and its elements.
fn object((picture, elements): (Picture, usize), between: &str) -> String {
    let painted = match picture {
        Picture::Own => "the scene's own picture".to_owned(),
        Picture::Board(checks) => format!("{checks} × {checks} checks"),
    };
    format!("{painted}{between}{elements} × {elements} elements")
}

/// Draws from which a method gave nothing, with the quietest level of them and the reason there.
fn failures(c: &NoiseCurve) -> Option<String> {
    let first = c.points.iter().find(|p| p.failed > 0)?;
    let sum = |f: fn(&Point) -> usize| c.points.iter().map(f).sum::<usize>();
    Some(format!(
        "{}, {}: {} of {} draws gave nothing, from {} on: {}",
        object((c.picture, c.elements), ", "),
        c.method,
        sum(|p| p.failed),
        sum(|p| p.draws),
        figure(first.level, 2),
        first.failure.as_deref().unwrap_or("")
    ))
}
