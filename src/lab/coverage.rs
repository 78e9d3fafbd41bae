//! Do the bands around recovered reflectances cover the truth as often as they say?

use std::ops::Range;

use serde::{Deserialize, Serialize};

use super::ensemble::{Draws, Photographs};
use super::finding::{Cell, Column, Describe, Finding, Table, Tone, listed};
use super::options::Opt;
use super::registered::{Registered, prepared};
use super::study::Study;
use crate::matrix::Matrix;
use crate::model::{Kernel, MatrixModel};
use crate::num::digits::figure;
use crate::recovery::{BandKind, Bands, Method, Options, RecoveryError};
use crate::transport::{Control, Stopped};

/// How coverage is counted.
#[derive(Clone, Debug)]
pub struct CoveragePlan {
    /// Standard deviation of every entry of Φcam, relative to the entry.
    pub noise: f64,
    /// Confidence of the bands.
    pub confidence: f64,
    /// Methods, in the order of the table.
    pub methods: Vec<Method>,
    /// Seeds of the noise.
    pub seeds: u64,
    /// First seed.
    pub first_seed: u64,
}

/// What the bands of one method cover.
#[derive(Clone, Debug, Default, Serialize)]
pub struct CoverageRow {
    /// Method.
    pub method: String,
    /// What its bands are, in words; none where it has none.
    pub bands: Option<String>,
    /// Seeds for which the method gave nothing; they are left out.
    pub failed: usize,
    /// Share of elements whose true albedo lies in its band, over all other seeds.
    pub covered: Option<f64>,
    /// Standard error of that share, from the spread over seeds: the elements of one recovery are
    /// correlated. At least 1/(n + 2) of n seeds, which agree by chance too (Laplace's rule).
    pub stderr: Option<f64>,
    /// The element that is covered least often.
    pub least: Option<f64>,
    /// Share of seeds in which every element is covered.
    pub together: Option<f64>,
    /// Root mean square, over elements, of the mean error over seeds: the bias, up to its own
    /// standard error.
    pub bias: Option<f64>,
    /// Mean width of the bands.
    pub width: Option<f64>,
    /// Why the last of the failed seeds gave nothing.
    pub reason: Option<String>,
}

/// The study of a scene.
#[derive(Clone, Debug, Serialize)]
pub struct Coverage {
    /// Name of the scene.
    pub scene: String,
    /// Its hash.
    pub scene_hash: String,
    /// Relative noise.
    pub noise: f64,
    /// Confidence of the bands.
    pub confidence: f64,
    /// Seeds.
    pub seeds: u64,
    /// Elements.
    pub elements: usize,
    /// One a method.
    pub rows: Vec<CoverageRow>,
}

/// What bands cover is short of what they state where it is more than so many standard errors
/// below.
const SHORT: f64 = 3.0;

impl CoverageRow {
    /// Whether its bands cover less than `confidence`; none where it has no bands.
    fn falls_short(&self, confidence: f64) -> Option<bool> {
        let covered = self.covered?;
        Some(
            self.stderr
                .is_some_and(|s| covered < confidence - SHORT * s),
        )
    }

    /// What its bands cover, in percent.
    fn percent(&self) -> Option<Cell> {
        Some(Cell::Estimate {
            value: 100.0 * self.covered?,
            stderr: self.stderr.map(|s| 100.0 * s),
        })
    }

    /// The method and what its bands cover, in words.
    fn words(&self) -> String {
        let covered = 100.0 * self.covered.unwrap_or(f64::NAN);
        let error = self
            .stderr
            .map_or(String::new(), |s| format!(" ± {:.1}", 100.0 * s));
        format!("{} {covered:.1} %{error}", self.method)
    }
}

impl Describe for Coverage {
    fn describe(&self) -> Finding {
        let named = |short: bool| -> Vec<String> {
            let own = self
                .rows
                .iter()
                .filter(|r| r.falls_short(self.confidence) == Some(short));
            own.map(CoverageRow::words).collect()
        };
        let (fine, short) = (named(false), named(true));
        let failing = match short.as_slice() {
            [] => String::new(),
            some => format!(
                "; these fall short by more than three standard errors: {}",
                listed(some)
            ),
        };
        let silent = match self.rows.iter().filter(|r| r.covered.is_none()).count() {
            0 => String::new(),
            n => format!(" {n} of the methods gave no bands."),
        };
        let stated = format!("{} %", figure(100.0 * self.confidence, 3));
        let noise = figure(self.noise, 2);
        let row = |r: &CoverageRow| {
            vec![
                Cell::Name(r.method.clone()),
                r.bands.as_deref().unwrap_or("–").into(),
                r.percent().unwrap_or(Cell::Number(None)),
                r.least.map(|x| 100.0 * x).into(),
                r.together.map(|x| 100.0 * x).into(),
                r.bias.into(),
                r.width.into(),
            ]
        };
        let reason = |r: &CoverageRow| {
            let reason = r.reason.as_ref()?;
            Some(format!(
                "{}: {} of {} seeds gave nothing: {reason}.",
                r.method, r.failed, self.seeds
            ))
        };
        let table = Table {
            caption: format!(
                "What bands of {stated} cover: {} elements, noise {noise} of each entry, {} seeds",
                self.elements, self.seeds
            ),
            columns: vec![
                Column::text("method", ""),
                Column::text("promise", ""),
                Column::number("covered", "", "%", 3),
                Column::number("the least covered element", "", "%", 3),
                Column::number("all at once", "", "%", 3),
                Column::number("rms bias", "", "", 2),
                Column::number("mean width", "", "", 2),
            ],
            rows: self.rows.iter().map(row).collect(),
            note: self
                .rows
                .iter()
                .filter_map(reason)
                .collect::<Vec<_>>()
                .join(" "),
            ..Table::default()
        };
        Finding {
            title: format!("How often bands cover the truth: {}", self.scene),
            tone: if short.is_empty() {
                Tone::Good
            } else {
                Tone::Bad
            },
            sentence: format!(
                "Bands of {stated} on {} at a noise of {noise} cover the true reflectance at \
                 least as often as stated: {}{failing}.{silent}",
                self.scene,
                listed(&fine)
            ),
            tables: vec![table],
            ..Finding::default()
        }
    }
}

/// Seeds of a task.
const GROUP: u64 = 10;

/// `phicam study coverage`.
pub(super) const STUDY: Registered = Registered {
    name: "coverage",
    about: "How often bands around recovered reflectances cover the truth: table and JSON",
    scene: Some("bench"),
    files: "",
    options: &[
        Opt::methods("Methods, separated by commas", "joint,nnls,joint-gp"),
        Opt::whole("elements", "Elements a side, in place of the scene's").within(1, 1024),
        Opt::number("noise", "Noise of the photographs, relative to each entry")
            .or("0.01")
            .rule(
                |x| x > 0.0 && x.is_finite(),
                "has no meaning",
                "use a number above 0, e.g. 0.01",
            ),
        Opt::number(
            "confidence",
            "Probability with which each element shall be covered",
        )
        .or("0.95")
        .rule(
            |x| x > 0.0 && x < 1.0,
            "has no meaning",
            "use a number between 0 and 1, e.g. 0.95",
        ),
        Opt::whole("seeds", "Draws of the noise")
            .or("200")
            .within(1, 1_000_000),
        Opt::seed("First seed"),
    ],
    prepare: |scene, values| {
        let plan = CoveragePlan {
            noise: values.one("noise")?,
            confidence: values.one("confidence")?,
            methods: values.methods()?,
            seeds: values.one("seeds")?,
            first_seed: values.one("seed")?,
        };
        let elements = values.maybe("elements")?.map(|n| [n; 2]);
        let model = MatrixModel::new(scene, Kernel::Physical, elements)?;
        let of = (scene.name.as_str(), scene.hash.as_str());
        Ok(prepared(CoverageTasks::new(of, model, plan)))
    },
};

/// Adds normal noise to what a model says, recovers, and counts. The model is right by
/// construction, so that only noise and method are on trial; the recovery is told the true standard
/// deviations. A task is one method under a few seeds.
#[derive(Debug)]
pub struct CoverageTasks {
    scene: String,
    scene_hash: String,
    model: MatrixModel,
    plan: CoveragePlan,
}

impl CoverageTasks {
    /// The study of `model`, that of the scene of this name and hash.
    pub fn new((scene, scene_hash): (&str, &str), model: MatrixModel, plan: CoveragePlan) -> Self {
        Self {
            scene: scene.to_owned(),
            scene_hash: scene_hash.to_owned(),
            model,
            plan,
        }
    }

    fn groups(&self) -> usize {
        self.plan.seeds.div_ceil(GROUP) as usize
    }

    /// The method of a task, and its seeds, counted from the first.
    fn at(&self, index: usize) -> (Method, Range<u64>) {
        let from = (index % self.groups()) as u64 * GROUP;
        let method = self.plan.methods[index / self.groups()];
        (method, from..(from + GROUP).min(self.plan.seeds))
    }
}

impl Study for CoverageTasks {
    /// Φcam without noise, pixels × spots, W.
    type Context = Matrix;
    type Output = Vec<Result<Trial, String>>;
    type Result = Coverage;
    type Error = Stopped;

    fn name(&self) -> &'static str {
        "coverage"
    }

    fn tasks(&self) -> usize {
        self.plan.methods.len() * self.groups()
    }

    fn context(&self, _: Control<'_>) -> Result<Matrix, Stopped> {
        Ok(self.model.phi())
    }

    fn task(
        &self,
        exact: &Matrix,
        index: usize,
        control: Control<'_>,
    ) -> Result<Self::Output, Stopped> {
        let (method, seeds) = self.at(index);
        let one = |k: u64| {
            control.check()?;
            let seed = self.plan.first_seed.wrapping_add(k);
            let found = trial(&self.model, exact, method, &self.plan, seed);
            Ok(found.map_err(|e| e.to_string()))
        };
        seeds.map(one).collect()
    }

    fn fits(&self, _: &Matrix, index: usize, part: &Self::Output) -> bool {
        let (elements, seeds) = (self.model.albedo.len(), self.at(index).1);
        let whole = |t: &Trial| [t.bands.intervals.len(), t.reflectance.len()] == [elements; 2];
        part.len() as u64 == seeds.end - seeds.start && part.iter().flatten().all(whole)
    }

    fn finish(&self, _: &Matrix, parts: Vec<Self::Output>) -> Result<Coverage, Stopped> {
        let mut parts = parts.into_iter();
        let methods = self.plan.methods.iter();
        let rows = methods.map(|method| {
            let own: Vec<_> = parts.by_ref().take(self.groups()).flatten().collect();
            row(*method, &self.model.albedo, &own)
        });
        Ok(Coverage {
            rows: rows.collect(),
            scene: self.scene.clone(),
            scene_hash: self.scene_hash.clone(),
            noise: self.plan.noise,
            confidence: self.plan.confidence,
            seeds: self.plan.seeds,
            elements: self.model.albedo.len(),
        })
    }
}

/// One recovery.
#[derive(Debug, Serialize, Deserialize)]
pub struct Trial {
    bands: Bands,
    reflectance: Vec<f64>,
}

fn trial(
    model: &MatrixModel,
    exact: &Matrix,
    method: Method,
    plan: &CoveragePlan,
    seed: u64,
) -> Result<Trial, RecoveryError> {
    let options = Options {
        bands: Some(plan.confidence),
        ..Options::default()
    };
    let found = Photographs::relative(exact, plan.noise, seed).recover(model, method, &options)?;
    let bands = found.bands.ok_or(RecoveryError::NotForMethod {
        method,
        what: found.no_bands.unwrap_or("gave no bands"),
        cure: "ask for bands of another method",
    })?;
    Ok(Trial {
        bands,
        reflectance: found.reflectance.as_slice().to_vec(),
    })
}

fn row(method: Method, truth: &[f64], trials: &[Result<Trial, String>]) -> CoverageRow {
    let Draws {
        found: trials,
        failures,
    } = Draws::of(trials);
    let nothing = CoverageRow {
        method: method.name().to_owned(),
        failed: failures.len(),
        reason: failures.last().map(|why| (*why).to_owned()),
        ..CoverageRow::default()
    };
    let Some(first) = trials.first() else {
        return nothing;
    };
    let (n, r) = (trials.len() as f64, truth.len() as f64);
    let shares: Vec<f64> = trials
        .iter()
        .map(|t| t.bands.covered(truth) as f64 / r)
        .collect();
    let mean = shares.iter().sum::<f64>() / n;
    let square: f64 = shares.iter().map(|s| (s - mean) * (s - mean)).sum();
    let of_element = |j: usize| {
        let within =
            |t: &&&Trial| (t.bands.intervals[j][0]..=t.bands.intervals[j][1]).contains(&truth[j]);
        trials.iter().filter(within).count() as f64 / n
    };
    let bias_of = |j: usize| {
        trials
            .iter()
            .map(|t| t.reflectance[j] - truth[j])
            .sum::<f64>()
            / n
    };
    let squares = (0..truth.len()).map(|j| bias_of(j) * bias_of(j));
    let widths = trials
        .iter()
        .flat_map(|t| &t.bands.intervals)
        .map(|[a, b]| b - a);
    CoverageRow {
        bands: Some(words(first.bands.kind).to_owned()),
        covered: Some(mean),
        stderr: (trials.len() > 1).then(|| {
            let by_spread = (square / (n * (n - 1.0))).sqrt();
            by_spread.max(1.0 / (n + 2.0))
        }),
        least: (0..truth.len()).map(of_element).reduce(f64::min),
        together: Some(shares.iter().filter(|s| **s == 1.0).count() as f64 / n),
        bias: Some((squares.sum::<f64>() / r).sqrt()),
        width: Some(widths.sum::<f64>() / (n * r)),
        ..nothing
    }
}

fn words(kind: BandKind) -> &'static str {
    match kind {
        BandKind::Gaussian | BandKind::Posterior => "each alone",
        BandKind::Simultaneous => "all together",
    }
}

#[cfg(test)]
mod tests;
