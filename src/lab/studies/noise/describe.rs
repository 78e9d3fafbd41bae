//! The study in words, tables and figures.

mod tables;

use super::best::Best;
use super::curve::{Held, LIMITS, Lost, NoiseCurve, Point, Reach};
use super::picture::Picture;
use super::study::NoiseStudy;
use crate::lab::comparison::validation::Integration;
use crate::lab::ensemble::Spread;
use crate::lab::finding::{Axis, Curve, Describe, Figure, Finding, Mark, Plot};
use crate::num::digits::figure;

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
                .chain([self.integrated()])
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

    /// How photographs and model integrate.
    fn integrated(&self) -> String {
        let centres = Integration::Centres.name();
        let mut elements: Vec<usize> = self.curves.iter().map(|c| c.elements).collect();
        elements.dedup();
        let by_centres = |e: &usize| {
            let of = |c: &NoiseCurve| c.elements == *e && c.integration == centres;
            self.curves.iter().any(of)
        };
        let (mut at, rest): (Vec<usize>, Vec<usize>) = elements.into_iter().partition(by_centres);
        at.sort_unstable();
        at.dedup();
        let sides: Vec<String> = at.iter().map(|e| format!("{e} × {e}")).collect();
        match (at.is_empty(), rest.is_empty()) {
            (true, _) => "Photographs and model are integrated over elements, footprints and spots, as recover does it. Methods that work \
                          pixel by pixel invert C·D, which such light is not quite: this they lose without noise."
                .to_owned(),
            (_, all) => format!(
                "Photographs and model take {}elements, pixels and spots at their centres. The light of a bench is the integral over \
                 them, which recover inverts: errors and bound of few elements differ from these by tens of percent.",
                if all { String::new() } else { format!("{} ", sides.join(", ")) }
            ),
        }
    }

    /// That the scene's own picture was left out, and which boards have no place.
    fn unstudied(&self) -> impl Iterator<Item = String> {
        let left_out = self.own.is_none();
        let words = "The scene's own picture is not among these: it is a board of other checks, which --boards names.";
        let unplaced = self.unplaced.iter().map(|checks| {
            format!(
                "A board of {checks} × {checks} checks was not studied: {checks} divides no number of --elements."
            )
        });
        let own = left_out.then(|| words.to_owned());
        own.into_iter().chain(unplaced)
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
                let within = self.within(b);
                format!(
                    "{object}: {sign}{} by {method}{within}{published}",
                    figure(level, 2)
                )
            }
            _ if self.has_no_contrast((b.picture, b.elements)) => {
                format!(
                    "{object}: it has no contrast, and so no MTF: see its root mean square error"
                )
            }
            _ if self.is_unknown((b.picture, b.elements)) => {
                let why = match self.seeds {
                    1 => ", as one draw tells no mean",
                    _ => "",
                };
                format!("{object}: no method is known to reach it{why}{published}")
            }
            _ => format!("{object}: no method reaches it{published}"),
        }
    }

    /// Whether of some method nothing is known on an object.
    fn is_unknown(&self, object: (Picture, usize)) -> bool {
        let mut own = self
            .curves
            .iter()
            .filter(|c| (c.picture, c.elements) == object);
        own.any(|c| c.lost_raw[0] == Lost::Unknown)
    }

    /// How far the scatter of the draws may move the level of the best method.
    fn within(&self, b: &Best) -> String {
        let Some([from, to]) = b.within.filter(|[from, to]| from != to) else {
            return String::new();
        };
        let level = |held: Option<Held>| match held {
            None => "less than the quietest studied".to_owned(),
            Some(held) => figure(held.level, 2),
        };
        let beyond = match (to.map(|held| held.reach), self.axis.falls()) {
            (Some(Reach::AtLeast), false) => " or more",
            (Some(Reach::AtLeast), true) => " or less",
            _ => "",
        };
        format!(
            " (from {} to {}{beyond} by the scatter of {} draws)",
            level(from),
            level(to),
            self.seeds
        )
    }

    /// Whether no recovery of an object has a modulation, though there are some.
    fn has_no_contrast(&self, object: (Picture, usize)) -> bool {
        let own = self
            .curves
            .iter()
            .filter(|c| (c.picture, c.elements) == object);
        let mut found = own.flat_map(|c| &c.points).filter(|p| p.failed < p.draws);
        found.next().is_some_and(|p| p.mtf_raw.is_none()) && found.all(|p| p.mtf_raw.is_none())
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
