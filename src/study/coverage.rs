//! Do the bands around recovered reflectances cover the truth as often as they say?

use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;
use serde::Serialize;

use super::deviate::normal_deviates;
use crate::matrix::Matrix;
use crate::model::MatrixModel;
use crate::recovery::{BandKind, Bands, Method, Options, Problem, RecoveryError, recover};

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
    /// Share of elements whose true albedo lies in its band, over all seeds.
    pub covered: Option<f64>,
    /// Standard error of that share, from the spread over seeds: the elements of one recovery are correlated.
    pub stderr: Option<f64>,
    /// The element that is covered least often.
    pub least: Option<f64>,
    /// Root mean square, over elements, of the mean error over seeds: the bias, up to its own standard error.
    pub bias: Option<f64>,
    /// Mean width of the bands.
    pub width: Option<f64>,
    /// Why there are none.
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

/// Adds normal noise to what `model` says, recovers, and counts. The model is right by construction, so that only noise and method are on trial; the recovery is
/// told the true standard deviations. `steps` hears how many recoveries of all are done. `None` if stopped.
pub fn coverage(
    (scene, scene_hash): (&str, &str),
    model: &MatrixModel,
    plan: &CoveragePlan,
    stop: &AtomicBool,
    steps: &(dyn Fn(usize, usize) + Sync),
) -> Option<Coverage> {
    let exact = model.phi();
    let stderr = exact.map(|x| x.abs() * plan.noise);
    let (done, all) = (
        std::sync::atomic::AtomicUsize::new(0),
        plan.methods.len() * plan.seeds as usize,
    );
    let mut rows = Vec::new();
    for &method in &plan.methods {
        let trials: Vec<Option<Result<Trial, RecoveryError>>> = (0..plan.seeds)
            .into_par_iter()
            .map(|k| {
                if stop.load(Ordering::Relaxed) {
                    return None;
                }
                let found = trial(
                    model,
                    &exact,
                    &stderr,
                    method,
                    plan,
                    plan.first_seed.wrapping_add(k),
                );
                steps(done.fetch_add(1, Ordering::Relaxed) + 1, all);
                Some(found)
            })
            .collect();
        let trials: Vec<_> = trials.into_iter().collect::<Option<_>>()?;
        rows.push(row(method, &model.albedo, trials));
    }
    Some(Coverage {
        scene: scene.to_owned(),
        scene_hash: scene_hash.to_owned(),
        noise: plan.noise,
        confidence: plan.confidence,
        seeds: plan.seeds,
        elements: model.albedo.len(),
        rows,
    })
}

/// One recovery.
struct Trial {
    bands: Bands,
    reflectance: Vec<f64>,
}

fn trial(
    model: &MatrixModel,
    exact: &Matrix,
    stderr: &Matrix,
    method: Method,
    plan: &CoveragePlan,
    seed: u64,
) -> Result<Trial, RecoveryError> {
    let normal = normal_deviates(seed, exact.nrows(), exact.ncols());
    let phi = exact + stderr.component_mul(&normal);
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

fn row(method: Method, truth: &[f64], trials: Vec<Result<Trial, RecoveryError>>) -> CoverageRow {
    let mut row = CoverageRow {
        method: method.name().to_owned(),
        bands: None,
        covered: None,
        stderr: None,
        least: None,
        bias: None,
        width: None,
        reason: None,
    };
    let trials: Vec<Trial> = match trials.into_iter().collect() {
        Ok(trials) => trials,
        Err(e) => {
            row.reason = Some(e.to_string());
            return row;
        }
    };
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
