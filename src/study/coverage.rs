//! Do the bands around recovered reflectances cover the truth as often as they say?

use std::convert::Infallible;
use std::ops::Range;
use std::sync::atomic::Ordering;

use serde::{Deserialize, Serialize};

use super::deviate::normal_deviates;
use super::task::Division;
use crate::matrix::Matrix;
use crate::model::MatrixModel;
use crate::recovery::{BandKind, Bands, Method, Options, Problem, RecoveryError, recover};
use crate::transport::Control;

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
#[derive(Clone, Debug, Serialize)]
pub struct CoverageRow {
    /// Method.
    pub method: String,
    /// What its bands are, in words; none where it has none.
    pub bands: Option<String>,
    /// Seeds for which the method gave nothing; they are left out.
    pub failed: usize,
    /// Share of elements whose true albedo lies in its band, over all other seeds.
    pub covered: Option<f64>,
    /// Standard error of that share, from the spread over seeds: the elements of one recovery are correlated.
    pub stderr: Option<f64>,
    /// The element that is covered least often.
    pub least: Option<f64>,
    /// Root mean square, over elements, of the mean error over seeds: the bias, up to its own standard error.
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

/// Seeds of a task.
const GROUP: u64 = 10;

/// Adds normal noise to what a model says, recovers, and counts. The model is right by construction, so that only noise and method are on trial; the recovery is
/// told the true standard deviations. A task is one method under a few seeds.
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

/// Φcam without noise and the standard errors, pixels × spots, W.
#[derive(Debug)]
pub struct Exact {
    phi: Matrix,
    stderr: Matrix,
}

impl Division for CoverageTasks {
    type Ground = Exact;
    type Part = Vec<Result<Trial, String>>;
    type Finding = Coverage;
    type Error = Infallible;

    fn tasks(&self) -> usize {
        self.plan.methods.len() * self.groups()
    }

    fn ground(&self, _: Control<'_>) -> Result<Option<Exact>, Infallible> {
        let phi = self.model.phi();
        let stderr = phi.map(|x| x.abs() * self.plan.noise);
        Ok(Some(Exact { phi, stderr }))
    }

    fn task(
        &self,
        exact: &Exact,
        index: usize,
        control: Control<'_>,
    ) -> Result<Option<Self::Part>, Infallible> {
        let (method, seeds) = self.at(index);
        let one = |k: u64| {
            if control.stop.load(Ordering::Relaxed) {
                return None;
            }
            let seed = self.plan.first_seed.wrapping_add(k);
            let found = trial(&self.model, exact, method, &self.plan, seed);
            Some(found.map_err(|e| e.to_string()))
        };
        Ok(seeds.map(one).collect())
    }

    fn fits(&self, _: &Exact, index: usize, part: &Self::Part) -> bool {
        let (elements, seeds) = (self.model.albedo.len(), self.at(index).1);
        let whole = |t: &Trial| [t.bands.intervals.len(), t.reflectance.len()] == [elements; 2];
        part.len() as u64 == seeds.end - seeds.start && part.iter().flatten().all(whole)
    }

    fn finish(&self, _: &Exact, parts: Vec<Self::Part>) -> Result<Coverage, Infallible> {
        let mut parts = parts.into_iter();
        let methods = self.plan.methods.iter();
        let rows = methods.map(|method| {
            let own = parts.by_ref().take(self.groups()).flatten().collect();
            row(*method, &self.model.albedo, own)
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
    Exact { phi, stderr }: &Exact,
    method: Method,
    plan: &CoveragePlan,
    seed: u64,
) -> Result<Trial, RecoveryError> {
    let normal = normal_deviates(seed, phi.nrows(), phi.ncols());
    let phi = phi + stderr.component_mul(&normal);
    let grids: Vec<[usize; 2]> = model.grids.iter().map(|g| g.count).collect();
    let problem = Problem::new(&phi, &model.camera_side, &model.laser_side, Some(stderr))?
        .with_grids(&grids)?;
    let options = Options {
        bands: Some(plan.confidence),
        ..Options::default()
    };
    let found = recover(method, &problem, &options)?;
    let bands = found.bands.ok_or(RecoveryError::NotForMethod {
        method,
        what: "gave no bands",
        cure: "ask for bands of another method",
    })?;
    Ok(Trial {
        bands,
        reflectance: found.reflectance.as_slice().to_vec(),
    })
}

fn row(method: Method, truth: &[f64], trials: Vec<Result<Trial, String>>) -> CoverageRow {
    let mut row = CoverageRow {
        method: method.name().to_owned(),
        bands: None,
        failed: 0,
        covered: None,
        stderr: None,
        least: None,
        bias: None,
        width: None,
        reason: None,
    };
    let all = trials.len();
    let reasons = trials.iter().filter_map(|t| t.as_ref().err());
    row.reason = reasons.cloned().next_back();
    let trials: Vec<Trial> = trials.into_iter().flatten().collect();
    row.failed = all - trials.len();
    let Some(first) = trials.first() else {
        return row;
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
            |t: &&Trial| (t.bands.intervals[j][0]..=t.bands.intervals[j][1]).contains(&truth[j]);
        trials.iter().filter(within).count() as f64 / n
    };
    let bias_of = |j: usize| {
        trials
            .iter()
            .map(|t| t.reflectance[j] - truth[j])
            .sum::<f64>()
            / n
    };
    let widths = trials
        .iter()
        .flat_map(|t| &t.bands.intervals)
        .map(|[a, b]| b - a);
    row.bands = Some(words(first.bands.kind).to_owned());
    row.covered = Some(mean);
    row.stderr = (trials.len() > 1).then(|| (square / (n * (n - 1.0))).sqrt());
    row.least = (0..truth.len()).map(of_element).reduce(f64::min);
    row.bias = Some(
        ((0..truth.len())
            .map(|j| bias_of(j) * bias_of(j))
            .sum::<f64>()
            / r)
            .sqrt(),
    );
    row.width = Some(widths.sum::<f64>() / (n * r));
    row
}

fn words(kind: BandKind) -> &'static str {
    match kind {
        BandKind::Gaussian => "unbiased",
        BandKind::GaussianAroundMean => "bias left out",
        BandKind::Profile => "profile",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Kernel;
    use crate::study::task::tests::{divides, refuses, small};

    /// Twelve seeds are a full task and a rest.
    #[test]
    fn it_divides() {
        let scene = small("bench");
        let model = MatrixModel::new(&scene, Kernel::Physical, Some([2, 2])).unwrap();
        let plan = CoveragePlan {
            noise: 0.01,
            confidence: 0.95,
            methods: vec![Method::Pinv, Method::Joint],
            seeds: 12,
            first_seed: 5,
        };
        let tasks = CoverageTasks::new(("name", "hash"), model, plan);
        assert_eq!(divides(&tasks).rows.len(), 2);
        refuses(&tasks, 1, &(0..3).map(|_| Err(String::new())).collect());
    }
}
