//! The hidden objects of a scene, recovered and measured.

mod object;

use nalgebra::DVector;

use std::ops::Range;

use super::chosen::{Beside, Chosen, words};
use super::doubt::{contest, doubts};
use super::fit::{Judged, Known};
use super::likelier::likelier;
use super::measures::Measures;
use crate::lab::problem::problem;
use crate::lab::study::Work;
use crate::lab::uncertainty::certainty::Certainty;
use crate::lab::uncertainty::refined::Refined;
use crate::matrix::Matrix;
use crate::model::MatrixModel;
use crate::num::control::{Control, share_of};
use crate::recovery::{
    self, BandKind, Bands, Method, Nuisance, Options, Picard, Problem, Recovered, RecoveryError,
    Shared, recover,
};
pub use object::{ObjectBands, RecoveredObject};

/// What a recovery is told of the noise in Φcam.
#[derive(Clone, Copy, Debug)]
pub enum Noise<'a> {
    /// The standard error of each entry, W, and what is known of it.
    StandardError(&'a Matrix, Certainty),
    /// Nothing: methods that need it must be given their parameter.
    Unknown,
}

impl<'a> Noise<'a> {
    /// Standard errors as well as the photographs tell them to methods that weigh entries by them,
    /// or to those that do not.
    fn refined(
        self,
        phi: &Matrix,
        nuisance: Nuisance<'_>,
        are_weights: bool,
    ) -> Option<Refined<'a>> {
        let Self::StandardError(stderr, known) = self else {
            return None;
        };
        let left_out = nuisance.left_out;
        Some(if are_weights {
            Refined::of_weights(phi, stderr, known, left_out)
        } else {
            Refined::of_replicates(stderr, known, left_out)
        })
    }

    /// The same by these errors.
    fn by(self, refined: Option<&'a Refined<'_>>) -> Self {
        refined.map_or(self, |own| Self::StandardError(&own.stderr, own.certainty))
    }

    fn known(self, model: &'a MatrixModel) -> Option<Known<'a>> {
        match self {
            Self::StandardError(stderr, certainty) => Some(Known {
                stderr,
                certainty,
                factors: model.factors.as_ref(),
            }),
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
/// photographs hold. Standard errors that follow from the noisy entries are taken by the light
/// expected of these, and those from replicates are pooled over pixels and spots where these say
/// more; methods that work pixel by pixel take those of many replicates as they are. Methods that
/// are not finished when `control` stops it are
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
    ready(
        model,
        (phi, noise),
        (nuisance, methods),
        |problems, noise| attempts(model, &problems, noise, methods, options, control),
    )
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
    ready(
        model,
        (phi, noise),
        (nuisance, methods),
        |problems, noise| {
            let attempts = attempts(model, &problems, noise, methods, options, control);
            // What has not been decomposed by then takes as long as a method.
            let picards = if control.stopped() {
                Ok(Vec::new())
            } else {
                problems.and_then(|problems| picards(&problems, methods, options))
            };
            (attempts, picards)
        },
    )
}

/// Elements along u and v of each surface.
fn counts(model: &MatrixModel) -> Vec<[usize; 2]> {
    model.grids.iter().map(|grid| grid.count).collect()
}

/// Does `act` with all that is known of the photographs, as the problem of methods that weigh
/// entries and of those that do not, and of their noise.
fn ready<T>(
    model: &MatrixModel,
    (phi, noise): (&Matrix, Noise<'_>),
    (nuisance, methods): (Nuisance<'_>, &[Method]),
    act: impl FnOnce(Result<[Problem<'_>; 2], RecoveryError>, Noise<'_>) -> T,
) -> T {
    let weigh = methods.iter().any(|method| method.is_joint());
    let refined = [weigh, false].map(|weigh| noise.refined(phi, nuisance, weigh));
    let (grids, shared) = (counts(model), [(); 2].map(|()| Shared::default()));
    let problem = |k: usize| {
        let stderr = refined[k].as_ref().map(|own| own.stderr.as_ref());
        let problem = problem(model, phi, stderr)?;
        let mut problem = problem.with_grids(&grids)?.with_nuisance(nuisance)?;
        if !model.places.is_empty() {
            problem = problem.with_places(&model.places)?;
        }
        Ok::<_, RecoveryError>(problem.sharing(&shared[k]))
    };
    let both = || Ok([problem(0)?, problem(1)?]);
    act(both(), noise.by(refined[0].as_ref()))
}

fn attempts(
    model: &MatrixModel,
    problems: &Result<[Problem<'_>; 2], RecoveryError>,
    noise: Noise<'_>,
    methods: &[Method],
    options: &Options,
    control: Control<'_>,
) -> Vec<Attempt> {
    let [problem, plain] = match problems {
        Ok(problems) => problems,
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
                let problem = if method.is_joint() { problem } else { plain };
                recover(*method, &problem.under(own), options)
            })
        })
        .collect();
    let known = noise.known(model);
    let all: Vec<&Recovered> = found.iter().flatten().collect();
    let any = Judged {
        sent_on: model.sent_on.clone(),
        ..Judged::any(problem, known, &all, options)
    };
    // Photographs that nothing explains are likeliest by no assumption.
    let explained = any.best.as_ref().is_none_or(|best| best.possible.fits);
    let first = likelier(&all).filter(|_| explained && any.shared().is_none());
    let of = |own| any.of(problem, known, (own, options));
    let mut judgements: Vec<Judged> = all.iter().map(|own| of(own)).collect();
    let mut pairs: Vec<(&Recovered, &mut Judged)> =
        all.iter().copied().zip(&mut judgements).collect();
    contest(&mut pairs);
    let mut judgements = judgements.into_iter();
    let mut judged = |found: Recovered| {
        let own = judgements.next().unwrap_or_default();
        let mut objects = measured(model, &found, &own);
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
            outcome: found.map(&mut judged),
        })
        .collect()
}

fn picards(
    [problem, plain]: &[Problem<'_>; 2],
    methods: &[Method],
    options: &Options,
) -> Result<Vec<Picard>, RecoveryError> {
    let mut found = vec![recovery::picard(plain)?];
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
    let own = match (judged.shared(), &judged.moved) {
        (Some(_), _) => Some(found.clone().without_errors()),
        (None, Some(moved)) => Some(found.clone().with_more_error(moved)),
        (None, None) => None,
    };
    let found = own.as_ref().unwrap_or(found);
    // The bias of one element is of the truth of all.
    let known = model.grids.iter().all(|grid| grid.is_known);
    let bias = found.bias(&model.albedo).filter(|_| known);
    // Of a free scale both are in units of the brightest element.
    let brightest = model.albedo.iter().copied().fold(0.0, f64::max);
    let unit = if found.has_free_scale() {
        Some(brightest).filter(|x| known && *x > 0.0)
    } else {
        Some(1.0)
    };
    let warnings = doubts(found, judged);
    let explains = judged.fit.as_ref().is_none_or(|fit| fit.fits);
    let cut = |grid: &crate::model::ElementGrid| {
        let range = grid.first..grid.first + grid.len();
        let reflectance = found.reflectance.as_slice()[range.clone()].to_vec();
        let truth = grid.is_known.then(|| model.albedo[range.clone()].to_vec());
        // Other measures do not depend on the unit.
        let in_unit = truth.as_ref().map(|truth| {
            let each = truth.iter().map(|t| t / unit.unwrap_or(1.0));
            each.collect::<Vec<f64>>()
        });
        let scores = in_unit.map(|truth| Measures::of(&reflectance, &truth));
        let own = |m: &Matrix| m.rows(range.start, range.len()).into_owned();
        RecoveredObject {
            surface: grid.surface.clone(),
            method: found.method.name().to_owned(),
            elements: grid.count,
            mtf_raw: scores.and_then(|s| s.mtf_raw),
            mtf_normalized: scores.and_then(|s| s.mtf_normalized),
            correlation: scores.and_then(|s| s.correlation),
            rmse: scores.and_then(|s| s.rmse).filter(|_| unit.is_some()),
            parameter: words(found, explains),
            choice: Chosen::of(found),
            solver: found.solver.clone(),
            estimated: Beside::of(found),
            likelier: None,
            log_evidence: found.log_evidence,
            light: found
                .patterns
                .as_ref()
                .map(|p| p.assumed().light.as_slice()[range.clone()].to_vec()),
            alike: found.patterns.as_ref().and_then(|p| {
                let holds = explains && !found.rests_on_wrong_gains();
                let alike = p.told_if_alike().filter(|_| holds)?;
                let own = |v: &DVector<f64>| v.as_slice()[range.clone()].to_vec();
                Some([own(&alike.mean), own(&alike.deviation)])
            }),
            patterns: found.patterns.clone(),
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
