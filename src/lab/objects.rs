//! The hidden objects of a scene, recovered and measured.

use std::ops::Range;

use serde::Serialize;

use super::chosen::{Beside, Chosen, Ended, Probable, words};
use super::doubt::doubts;
use super::fit::{Certainty, Fit, Judged};
use super::likelier::likelier;
use super::measures::Measures;
use super::problem::problem;
use super::study::Work;
use crate::matrix::Matrix;
use crate::model::MatrixModel;
use crate::num::control::{Control, share_of};
use crate::recovery::{
    self, BandKind, Bands, Method, Nuisance, Options, Picard, Problem, Recovered, RecoveryError,
    Shared, recover,
};

/// A recovered hidden surface.
#[derive(Clone, Debug, Serialize)]
pub struct RecoveredObject {
    /// Name of the hidden surface.
    pub surface: String,
    /// Method.
    pub method: String,
    /// Elements along u and v.
    pub elements: [usize; 2],
    /// Recovered reflectance of element iu + iv·nu.
    pub reflectance: Vec<f64>,
    /// True albedo of the elements; absent, as all that is measured against it, where the scene
    /// does not know it.
    pub truth: Option<Vec<f64>>,
    /// (White − Black)/(White + Black); absent if the truth has no contrast.
    pub mtf_raw: Option<f64>,
    /// The same after stretching the recovered values to [0, 1].
    pub mtf_normalized: Option<f64>,
    /// Pearson correlation with the truth.
    pub correlation: Option<f64>,
    /// Root mean square error against the truth.
    pub rmse: Option<f64>,
    /// Parameter used and why, in words.
    pub parameter: String,
    /// The same in numbers.
    pub choice: Chosen,
    /// How the solver ended; absent where none iterates.
    pub solver: Option<Ended>,
    /// What was estimated beside the reflectances; absent where nothing was asked for.
    pub estimated: Option<Beside>,
    /// Of the picture that is expected to be the nearest to the truth, which assumption makes the
    /// photographs likelier, and by how much; absent of the other methods.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub likelier: Option<String>,
    /// ln of how likely its method's assumption makes the photographs, over the numbers that fit
    /// them best; absent for methods that do not know.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub log_evidence: Option<f64>,
    /// Probability of each element to be light, of `joint-two-valued`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub light: Option<Vec<f64>>,
    /// What is known of its pattern and levels.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub patterns: Option<Probable>,
    /// Bands around the reflectances, where they were asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bands: Option<ObjectBands>,
    /// Standard error of each reflectance; absent without a noise model and under bounds.
    pub standard_error: Option<Vec<f64>>,
    /// What regularisation alone adds to the truth, (R − 1) ρ with ρ the scene's; absent under
    /// bounds and with a free scale.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bias: Option<Vec<f64>>,
    /// Directions that the method resolves: trace of its resolution matrix.
    pub effective_rank: f64,
    /// How many of the elements of all surfaces the photographs determine at their noise, whatever
    /// the method; absent where the noise is not known.
    pub determined: Option<f64>,
    /// Share of each element that they determine, 0 to 1 ([`recovery::determined`]); absent
    /// likewise.
    pub determined_share: Option<Vec<f64>>,
    /// Elements of all surfaces.
    pub unknowns: usize,
    /// Whether all surfaces together explain the photographs; absent where that cannot be judged.
    pub fit: Option<Fit>,
    /// The same of the best reflectances between 0 and 1 that there are: whether photographs and
    /// model belong together, whatever the method. Absent where it is not known.
    pub best_fit: Option<Fit>,
    /// What speaks against believing it, each with its cure.
    pub warnings: Vec<String>,
    /// Covariance of its elements (rows) with those of all hidden surfaces (columns, in file
    /// order).
    #[serde(skip)]
    pub covariance: Option<Matrix>,
    /// Its rows of the resolution matrix: what each of its elements shows of the elements of all
    /// hidden surfaces.
    #[serde(skip)]
    pub resolution: Option<Matrix>,
}

/// Intervals of the elements of a recovered surface.
#[derive(Clone, Debug, Serialize)]
pub struct ObjectBands {
    /// Probability that each alone shall cover.
    pub confidence: f64,
    /// What they are: `gaussian`, each element alone, or `simultaneous`, all elements together.
    pub kind: String,
    /// Lower limits.
    pub lower: Vec<f64>,
    /// Upper limits.
    pub upper: Vec<f64>,
}

impl RecoveredObject {
    /// Whether the photographs refute the model: no reflectances between 0 and 1 explain them.
    pub fn contradicted(&self) -> bool {
        self.best_fit.as_ref().is_some_and(|best| !best.fits)
    }
}

/// What a recovery is told of the noise in Φcam.
#[derive(Clone, Copy, Debug)]
pub enum Noise<'a> {
    /// The standard error of each entry, W, and what is known of it.
    StandardError(&'a Matrix, Certainty),
    /// Nothing: methods that need it must be given their parameter.
    Unknown,
}

impl<'a> Noise<'a> {
    fn known(self) -> Option<(&'a Matrix, Certainty)> {
        match self {
            Self::StandardError(stderr, certainty) => Some((stderr, certainty)),
            Self::Unknown => None,
        }
    }
}

/// One method's outcome on all hidden surfaces.
#[derive(Debug)]
pub struct Attempt {
    /// The method.
    pub method: Method,
    /// One object per hidden surface, or why there is none.
    pub outcome: Result<Vec<RecoveredObject>, RecoveryError>,
}

/// Recovers the hidden reflectance from `phi` (pixels × spots, W) by each of `methods`, and
/// measures it against the true albedo at the element centres. `nuisance` is what else the
/// photographs hold. Methods that are not finished when `control` stops it are
/// [`RecoveryError::Stopped`].
pub fn recover_objects(
    model: &MatrixModel,
    phi: &Matrix,
    noise: Noise<'_>,
    nuisance: Nuisance<'_>,
    methods: &[Method],
    options: &Options,
    control: Control<'_>,
) -> Vec<Attempt> {
    let (grids, shared) = (counts(model), Shared::default());
    let problem = ready(model, phi, noise, nuisance, &grids, &shared);
    attempts(model, &problem, noise, methods, options, control)
}

/// The same with Φ in the singular directions of the model's laser side, and, where one of
/// `methods` works on all pixels and spots at once, in those of the joint operator: see
/// [`recovery::picard`] and [`recovery::picard_joint`].
///
/// # Errors
/// Of the directions those of both, but not where there are too many elements for a joint method:
/// then it is left out.
pub fn recover_with_picards(
    model: &MatrixModel,
    phi: &Matrix,
    noise: Noise<'_>,
    nuisance: Nuisance<'_>,
    methods: &[Method],
    options: &Options,
    control: Control<'_>,
) -> (Vec<Attempt>, Result<Vec<Picard>, RecoveryError>) {
    let (grids, shared) = (counts(model), Shared::default());
    let problem = ready(model, phi, noise, nuisance, &grids, &shared);
    let attempts = attempts(model, &problem, noise, methods, options, control);
    // What has not been decomposed by then takes as long as a method.
    let picards = if control.stopped() {
        Ok(Vec::new())
    } else {
        problem.and_then(|problem| picards(&problem, methods, options))
    };
    (attempts, picards)
}

/// Elements along u and v of each surface.
fn counts(model: &MatrixModel) -> Vec<[usize; 2]> {
    model.grids.iter().map(|grid| grid.count).collect()
}

/// All that is known of the photographs, as one problem.
fn ready<'a>(
    model: &'a MatrixModel,
    phi: &'a Matrix,
    noise: Noise<'a>,
    nuisance: Nuisance<'a>,
    grids: &'a [[usize; 2]],
    shared: &'a Shared,
) -> Result<Problem<'a>, RecoveryError> {
    let problem = problem(model, phi, noise.known().map(|known| known.0))?;
    let mut problem = problem.with_grids(grids)?.with_nuisance(nuisance)?;
    if !model.places.is_empty() {
        problem = problem.with_places(&model.places)?;
    }
    Ok(problem.sharing(shared))
}

fn attempts(
    model: &MatrixModel,
    problem: &Result<Problem<'_>, RecoveryError>,
    noise: Noise<'_>,
    methods: &[Method],
    options: &Options,
    control: Control<'_>,
) -> Vec<Attempt> {
    let problem = match problem {
        Ok(problem) => problem,
        Err(e) => {
            let refused = |&method: &Method| Attempt {
                method,
                outcome: Err(e.clone()),
            };
            return methods.iter().map(refused).collect();
        }
    };
    let found: Vec<Result<Recovered, RecoveryError>> = methods
        .iter()
        .map(|method| {
            share_of(control, Work::EACH_METHOD, |own| {
                recover(*method, &problem.under(own), options)
            })
        })
        .collect();
    let known = noise.known();
    let all: Vec<&Recovered> = found.iter().flatten().collect();
    let any = Judged::any(problem, known, &all, options);
    // Photographs that nothing explains are likeliest by no assumption.
    let explained = any.best.as_ref().is_none_or(|best| best.possible.fits);
    let first = likelier(&all).filter(|_| explained && any.shared().is_none());
    let judged = |found: Recovered| {
        let mut objects = measured(model, &found, &any.of(problem, known, &found));
        let own = first.as_ref().filter(|(method, _)| *method == found.method);
        let words = own.map(|(_, words)| words.clone());
        objects
            .iter_mut()
            .for_each(|o| o.likelier.clone_from(&words));
        objects
    };
    methods
        .iter()
        .zip(found)
        .map(|(&method, found)| Attempt {
            method,
            outcome: found.map(judged),
        })
        .collect()
}

fn picards(
    problem: &Problem<'_>,
    methods: &[Method],
    options: &Options,
) -> Result<Vec<Picard>, RecoveryError> {
    let mut found = vec![recovery::picard(problem)?];
    if methods.iter().any(|m| m.is_joint()) {
        match recovery::picard_joint(problem, options) {
            Err(RecoveryError::TooManyElements { .. }) => {}
            joint => found.push(joint?),
        }
    }
    Ok(found)
}

/// What was recovered, surface by surface, measured against the true albedo at the element centres,
/// and what the photographs say of it.
pub fn measured(model: &MatrixModel, found: &Recovered, judged: &Judged) -> Vec<RecoveredObject> {
    let alone = judged.shared().map(|_| found.clone().without_errors());
    let found = alone.as_ref().unwrap_or(found);
    // The bias of one element is of the truth of all.
    let known = model.grids.iter().all(|grid| grid.is_known);
    let bias = found.bias(&model.albedo).filter(|_| known);
    let warnings = doubts(found, judged);
    let explains = judged.fit.as_ref().is_none_or(|fit| fit.fits);
    let cut = |grid: &crate::model::ElementGrid| {
        let range = grid.first..grid.first + grid.len();
        let reflectance = found.reflectance.as_slice()[range.clone()].to_vec();
        let truth = grid.is_known.then(|| model.albedo[range.clone()].to_vec());
        let scores = truth.as_ref().map(|t| Measures::of(&reflectance, t));
        let own = |m: &Matrix| m.rows(range.start, range.len()).into_owned();
        RecoveredObject {
            surface: grid.surface.clone(),
            method: found.method.name().to_owned(),
            elements: grid.count,
            mtf_raw: scores.and_then(|s| s.mtf_raw),
            mtf_normalized: scores.and_then(|s| s.mtf_normalized),
            correlation: scores.and_then(|s| s.correlation),
            rmse: scores.and_then(|s| s.rmse),
            parameter: words(found, explains),
            choice: Chosen::of(found),
            solver: Ended::of(found),
            estimated: Beside::of(found),
            likelier: None,
            log_evidence: found.log_evidence,
            light: found
                .patterns
                .as_ref()
                .map(|p| p.light.as_slice()[range.clone()].to_vec()),
            patterns: Probable::of(found),
            bands: found
                .bands
                .as_ref()
                .map(|bands| object_bands(bands, range.clone())),
            standard_error: found
                .standard_error
                .as_ref()
                .map(|s| s.as_slice()[range.clone()].to_vec()),
            bias: bias.as_ref().map(|b| b.as_slice()[range.clone()].to_vec()),
            effective_rank: found.effective_rank,
            determined: judged.determined.as_ref().map(|d| d.rank),
            determined_share: judged
                .determined
                .as_ref()
                .map(|d| d.shares.as_slice()[range.clone()].to_vec()),
            unknowns: found.reflectance.len(),
            fit: judged.fit.clone(),
            best_fit: judged.best.as_ref().map(|best| best.possible.clone()),
            warnings: warnings.clone(),
            covariance: found.covariance.as_ref().map(own),
            resolution: found.resolution.as_ref().map(own),
            reflectance,
            truth,
        }
    };
    model.grids.iter().map(cut).collect()
}

fn object_bands(bands: &Bands, range: Range<usize>) -> ObjectBands {
    let kind = match bands.kind {
        BandKind::Gaussian => "gaussian",
        BandKind::Posterior => "posterior",
        BandKind::Simultaneous => "simultaneous",
    };
    let intervals = &bands.intervals[range];
    ObjectBands {
        confidence: bands.confidence,
        kind: kind.to_owned(),
        lower: intervals.iter().map(|i| i[0]).collect(),
        upper: intervals.iter().map(|i| i[1]).collect(),
    }
}
