//! Do the bands around recovered reflectances cover the truth as often as they say?

mod describe;
mod trial;

use std::ops::Range;

use serde::Serialize;

use super::registered::{Registered, prepared};
use crate::lab::options::Opt;
use crate::lab::study::Study;
use crate::matrix::Matrix;
use crate::model::{Kernel, MatrixModel};
use crate::recovery::{Bands, Method};
use crate::transport::{Control, Stopped};
use trial::{Trial, row, trial};

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
    /// Seeds whose photographs no reflectances explain: their bands are empty, and cover nothing.
    pub refuted: usize,
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
    /// Mean width of the bands of the others.
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
                |x| x > 0.0 && x <= 1.0,
                "has no meaning",
                "use a number above 0, up to 1, e.g. 0.01",
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
        let intervals = |b: &Bands| b.intervals.len() == elements;
        let whole =
            |t: &Trial| t.bands.as_ref().is_none_or(intervals) && t.reflectance.len() == elements;
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

#[cfg(test)]
mod tests;
