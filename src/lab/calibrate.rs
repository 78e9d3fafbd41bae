//! The geometry, estimated from the photographs themselves.
//!
//! Geometric parameters of the scene ([`Parameter`](crate::scene::Parameter)), the picture and,
//! where asked for, a gain of each frame are all unknown. What makes the photographs likeliest with
//! the picture averaged over all that it may be is the estimate ([`posterior`]). Its errors are
//!
//! > cov θ = (F + Λ)⁻¹,   or where more than noise is left (F + Λ)⁻¹ M (F + Λ)⁻¹,   M = Σ_c u_c u_cᵀ
//!
//! if that is larger: u_c is what frame c, or one of 4 × 4 blocks of pixels, adds to the slope, so
//! that what the model lacks counts once a frame or block (Huber 1967; Liang and Zeger 1986). Where
//! the likelihood itself, the others following, falls by ½ farther out, that is the error. The
//! picture's own covariance is P + (RX) cov θ (RX)ᵀ.

mod descent;
mod describe;
mod field;
mod geometry;
mod identified;
mod picture;
mod posterior;
mod profile;
#[cfg(test)]
mod tests;

use serde::Serialize;

pub use descent::Stage;
pub use identified::{Direction, Identified};
pub use profile::Profile;

use super::error::LabError;
use super::located::Grid;
use super::misplaced::normal;
use super::unexplained::Unexplained;
use super::validation::Integration;
use crate::matrix::Matrix;
use crate::metrics::{correlation, mtf_raw};
use crate::model::{Fineness, Kernel, MatrixModel, Occlusion};
use crate::num::linalg::Cholesky;
use crate::num::statistics::chi_square_sf;
use crate::recovery::ErrorField;
use crate::scene::{Parameter, Scene};
use crate::store::digest_of;
use crate::transport::Control;
use descent::{Problem, State, first};
use field::End;
use geometry::{Geometry, distance};
use identified::identified;

/// Below this probability of so bad a fit by noise alone more than noise is left.
const LEVEL: f64 = 1e-3;
/// Typical sizes of angles (degrees), percents, lengths over the distance to the view, and gains.
const TYPICAL: [f64; 4] = [1.0, 1.0, 0.01, 0.01];
/// Starts that end within so many standard errors of each other agree.
const AGREE: f64 = 1.0;

/// A parameter that is free, and how well it is known beforehand.
#[derive(Clone, Debug, PartialEq)]
pub struct Free {
    /// Name of one or several parameters.
    pub name: String,
    /// Standard deviation of each, in its unit; none where nothing is known.
    pub sigma: Option<f64>,
}

/// How the geometry is to be estimated.
#[derive(Clone, Debug)]
pub struct CalibrationPlan {
    /// What is free.
    pub free: Vec<Free>,
    /// Relative standard deviation of each frame's unknown gain; none where gains are 1.
    pub frame_gain: Option<f64>,
    /// Whether the scale of all light is unknown.
    pub is_scale_free: bool,
    /// Whether errors that neighbouring pixels share are estimated beside noise of single pixels.
    pub error_field: bool,
    /// Replicates from which the standard errors were estimated; none where they are known.
    pub replicates: Option<u32>,
    /// Elements in place of the scene's.
    pub elements: Option<[usize; 2]>,
    /// Whether things in the way are considered.
    pub occlusion: Occlusion,
    /// How the model integrates.
    pub integration: Integration,
    /// Starts: the scene as it is written, then at random as far off as is expected.
    pub starts: usize,
    /// How many times as far off.
    pub spread: f64,
    /// Seed of the starts.
    pub seed: u64,
}

/// An unknown, as it was found.
#[derive(Clone, Debug, Serialize)]
pub struct Calibrated {
    /// Its name.
    pub name: String,
    /// Its unit.
    pub unit: String,
    /// Standard deviation known beforehand.
    pub prior: Option<f64>,
    /// The estimate, from what the scene says.
    pub value: f64,
    /// Its standard error.
    pub stderr: f64,
    /// By the curvature alone.
    pub by_curvature: f64,
    /// By the slopes of frames, where more than noise is left.
    pub by_frames: Option<f64>,
    /// By those of blocks of pixels.
    pub by_blocks: Option<f64>,
    /// How far a finer rule of integration would move it: a part of the error where light is
    /// integrated, told where it is taken by centres; absent where something stands in the way.
    pub by_rule: Option<f64>,
    /// What the photographs tell of it at the start.
    pub identified: Identified,
    /// Its profile; absent of gains and of more than twelve parameters.
    pub profile: Option<Profile>,
}

/// How far the starts led to one place.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Starts {
    /// How many.
    pub tried: usize,
    /// Those that ended where the best one did.
    pub agree: usize,
}

/// The calibrated scene.
#[derive(Clone, Debug, Serialize)]
pub struct Calibration {
    /// Name of the scene.
    pub scene: String,
    /// Its hash.
    pub scene_hash: String,
    /// Geometric parameters, then gains.
    pub found: Vec<Calibrated>,
    /// Combinations that the photographs alone do not tell.
    pub untold: Vec<Direction>,
    /// Estimated noise over the stated one (1 where it is stated), or W.
    pub noise: f64,
    /// χ² over degrees of freedom at that noise.
    pub misfit: f64,
    /// Degrees of freedom.
    pub dof: f64,
    /// Probability of so bad a fit by noise alone; absent where the noise is not stated.
    pub p: Option<f64>,
    /// The errors that what is left over is taken for, in place of noise of single pixels.
    pub field: Option<ErrorField>,
    /// ln of how much likelier the photographs are with these errors, each with its own geometry.
    pub log_likelier: Option<f64>,
    /// ‖what is not explained‖/‖what other light leaves‖, weighted by the stated noise.
    pub left: f64,
    /// Estimated scale of all light; 1 where it is known.
    pub scale: f64,
    /// τ of the prior of pictures.
    pub spread: f64,
    /// ℓ, in the scene's unit; 0 for elements that know nothing of each other.
    pub length: f64,
    /// The best start's way through the noises.
    pub stages: Vec<Stage>,
    /// Whether the last stage ended by itself.
    pub is_settled: bool,
    /// The starts.
    pub starts: Starts,
    /// The picture, errors of the geometry included.
    pub grids: Vec<Grid>,
    /// Its standard errors with the geometry given, in the order of the grids.
    pub stderr_given: Vec<f64>,
    /// Directions of the picture that the photographs determine.
    pub directions: f64,
    /// Correlation with the scene's own picture and MTF raw, where that is known.
    pub correlation: Option<f64>,
    /// The same.
    pub mtf_raw: Option<f64>,
    /// SHA-256 of the calibrated scene's file, so that it is told if that is changed.
    pub scene_sha256: String,
    /// The calibrated scene as a file.
    #[serde(skip)]
    pub toml: String,
}

impl CalibrationPlan {
    /// Work, in steps of progress.
    pub fn work(&self) -> u64 {
        self.starts as u64 + 1
    }

    /// The geometry of `scene` by these photographs.
    ///
    /// # Errors
    /// [`LabError`]: a parameter that is not there or cannot be told, a scene without a model, no
    /// light, or that it was stopped.
    pub fn calibrate(
        &self,
        scene: &Scene,
        photographs: &Unexplained<'_>,
        control: Control<'_>,
    ) -> Result<Calibration, LabError> {
        let (parameters, mut priors) = self.parameters(scene)?;
        let frames = photographs.phi.ncols();
        let gains = if self.frame_gain.is_some() { frames } else { 0 };
        priors.extend(std::iter::repeat_n(self.frame_gain, gains));
        let model = MatrixModel::with(scene, Kernel::Physical, self.elements, Occlusion::Ignored)?;
        let fineness = match self.integration {
            Integration::Centres => Fineness::Centres,
            Integration::Quadrature => Fineness::Areas,
        };
        let pictures = picture::priors(&model.places, self.is_scale_free)?;
        let problem = Problem {
            geometry: Geometry {
                scene,
                parameters: &parameters,
                elements: self.elements,
                fineness,
                occlusion: self.occlusion,
                gains,
            },
            photographs: *photographs,
            pictures: &pictures,
            is_scale_free: self.is_scale_free,
            first: first(photographs),
            cosines: None,
            log_errors: 0.0,
            priors,
        };
        if self.error_field {
            problem.has_field()?;
        }
        let sizes = sizes(scene, &parameters, gains);
        let zero = vec![0.0; problem.unknowns()];
        // Of a noise that is not stated nothing is known yet: that of the first stage.
        let assumed = match photographs.stderr {
            Some(_) => 1.0,
            None => problem.first,
        };
        let start = problem.state(&zero, assumed, None)?;
        let (told, untold) = identified(&problem, &start, &sizes);
        let free: Vec<&Direction> = untold.iter().filter(|d| d.is_free()).collect();
        if !free.is_empty() {
            return Err(LabError::Untold(describe::untold(&free, &parameters)));
        }
        (control.progress)(1);
        let mut ends: Vec<End> = Vec::new();
        for k in 0..self.starts.max(1) {
            let (state, stages) = problem.descend(&self.start(k, &problem, &sizes), control)?;
            ends.push(if self.error_field {
                problem.with_shared_errors((state, stages), control)?
            } else {
                End::new(&problem, state, stages)
            });
            (control.progress)(1);
        }
        self.finish(&problem, (&model, told, untold), ends)
    }

    fn parameters(&self, scene: &Scene) -> Result<(Vec<Parameter>, Vec<Option<f64>>), LabError> {
        let (mut parameters, mut priors): (Vec<Parameter>, Vec<Option<f64>>) = Default::default();
        for free in &self.free {
            for own in Parameter::named(scene, &free.name)? {
                if !parameters.iter().any(|p| p.name == own.name) {
                    parameters.push(own);
                    priors.push(free.sigma);
                }
            }
        }
        if parameters.is_empty() {
            return Err(LabError::Unsuited(
                "nothing is free; name parameters with --free, or give the scene a table [uncertainty]",
            ));
        }
        Ok((parameters, priors))
    }

    /// Where start k begins.
    fn start(&self, k: usize, problem: &Problem<'_>, sizes: &[f64]) -> Vec<f64> {
        let mut random = normal(self.seed.wrapping_add(k as u64));
        let count = problem.geometry.parameters.len();
        let of = |(j, size): (usize, &f64)| {
            let deviate = random()[0];
            if k == 0 || j >= count {
                return 0.0;
            }
            self.spread * problem.priors[j].unwrap_or(*size) * deviate
        };
        let far: Vec<f64> = sizes.iter().enumerate().map(of).collect();
        // Where the scene does not allow it, half as far.
        let mut share = 1.0;
        loop {
            let values: Vec<f64> = far.iter().map(|x| x * share).collect();
            if share < 0.01 || problem.geometry.scene_at(&values).is_ok() {
                return values;
            }
            share *= 0.5;
        }
    }

    fn finish(
        &self,
        problem: &Problem<'_>,
        (model, told, untold): (&MatrixModel, Vec<Identified>, Vec<Direction>),
        mut ends: Vec<End>,
    ) -> Result<Calibration, LabError> {
        ends.sort_by(|a, b| a.total.total_cmp(&b.total));
        let alone = ends.iter().map(|end| end.without);
        let alone = alone.fold(f64::INFINITY, f64::min);
        let End {
            state: best,
            stages,
            field,
            total,
            ..
        } = &ends[0];
        let left = ends[0].left_over(problem)?;
        let with_field = field.as_ref().map(|field| problem.with_field(field));
        let with_field = with_field.transpose()?;
        let is_noise_known = problem.photographs.stderr.is_some();
        let problem = with_field.as_ref().unwrap_or(problem);
        let information = problem.information(&best.slope);
        let covariance = Cholesky::new(&information).ok_or(LabError::DARK)?.inverse();
        let unknowns = problem.unknowns() as f64;
        let dof = (best.value.count - best.value.freedom - unknowns).max(1.0);
        let p = is_noise_known.then(|| self.by_noise(best.value.chi2, dof));
        let more_than_noise = p.is_none_or(|p| p < LEVEL);
        let robust = |scores: &Matrix| {
            let moved = &covariance * scores;
            &moved * moved.transpose()
        };
        let [by_frames, by_blocks] = [&best.slope.by_frames, &best.slope.by_blocks].map(robust);
        let enough_frames = problem.photographs.phi.ncols() > 2;
        let scene = problem.geometry.scene;
        let names = self.names(problem);
        let finer = problem.finer(best, &covariance)?;
        let mut found: Vec<Calibrated> = Vec::new();
        let mut whole = covariance.clone();
        for (k, identified) in told.into_iter().enumerate() {
            let root = |m: &Matrix| m[(k, k)].max(0.0).sqrt();
            let by_curvature = root(&covariance);
            let by_frames = (more_than_noise && enough_frames).then(|| root(&by_frames));
            // Along the cosines there are no blocks of pixels.
            let by_blocks = (more_than_noise && field.is_none()).then(|| root(&by_blocks));
            let profile = profile::profile(problem, best, &covariance, k)?;
            let by_profile = profile.as_ref().map_or(0.0, Profile::stderr);
            let others = [by_frames, by_blocks].map(|x| x.unwrap_or(0.0));
            let by_rule = finer.as_ref().map(|moved| moved[k].abs());
            let rule = by_rule.filter(|_| self.integration == Integration::Quadrature);
            let noise = others
                .into_iter()
                .fold(by_curvature.max(by_profile), f64::max);
            let rule = rule.unwrap_or(0.0);
            let stderr = (noise * noise + rule * rule).sqrt();
            let more = stderr / by_curvature;
            (0..whole.nrows()).for_each(|j| {
                whole[(k, j)] *= more;
                whole[(j, k)] *= more;
            });
            let (name, unit) = names[k].clone();
            found.push(Calibrated {
                name,
                unit,
                prior: problem.priors[k],
                value: best.values[k],
                stderr,
                by_curvature,
                by_frames,
                by_blocks,
                by_rule,
                identified,
                profile,
            });
        }
        let starts = Starts {
            tried: ends.len(),
            agree: ends
                .iter()
                .filter(|end| agree(&end.state, best, &found))
                .count(),
        };
        let scale = best.prior.scale;
        let rho = &best.value.rho / scale;
        let given = best.slope.covariance.diagonal() / (scale * scale);
        let moved = &best.slope.shift * &whole * best.slope.shift.transpose();
        let both = &given + moved.diagonal() / (scale * scale);
        let grids = model.grids.iter().map(|g| Grid {
            surface: g.surface.clone(),
            count: g.count,
            values: rho.rows(g.first, g.len()).iter().copied().collect(),
            stderr: both
                .rows(g.first, g.len())
                .map(f64::sqrt)
                .iter()
                .copied()
                .collect(),
        });
        let truth = scene.unknown().is_none().then_some(&model.albedo);
        let count = problem.geometry.parameters.len();
        let mut file = scene.displaced_file(problem.geometry.parameters, &best.values[..count])?;
        file.name = format!("{} calibrated", scene.name);
        let toml = file.toml()?;
        Ok(Calibration {
            scene: scene.name.clone(),
            scene_hash: scene.hash.clone(),
            untold,
            noise: field.as_ref().map_or(best.factor, |f| f.errors.pixel),
            field: field.as_ref().map(|f| f.errors),
            log_likelier: field.as_ref().map(|_| alone - total),
            misfit: best.value.chi2 / dof,
            dof,
            p,
            left,
            scale,
            spread: best.prior.spread,
            length: best.prior.length,
            stages: stages.clone(),
            is_settled: best.is_settled,
            starts,
            grids: grids.collect(),
            stderr_given: given.iter().map(|x| x.max(0.0).sqrt()).collect(),
            directions: best.value.freedom,
            correlation: truth.and_then(|t| correlation(rho.as_slice(), t)),
            mtf_raw: truth.and_then(|t| mtf_raw(rho.as_slice(), t)),
            scene_sha256: digest_of(toml.as_bytes()),
            toml,
            found,
        })
    }

    /// Probability of as large a χ² by noise alone. Of errors estimated from K = ν + 1 replicates
    /// each term is the square of Student's t, of mean ν/(ν − 2) and variance 2 (ν − 1)/(ν − 4)
    /// times the square of that: χ² is compared as one of that mean and variance.
    fn by_noise(&self, chi2: f64, dof: f64) -> f64 {
        match self.replicates.map(|k| f64::from(k) - 1.0) {
            Some(nu) if nu > 4.0 => {
                let fewer = dof * (nu - 4.0) / (nu - 1.0);
                chi_square_sf(chi2 / dof * (nu - 2.0) / nu * fewer, fewer)
            }
            _ => chi_square_sf(chi2, dof),
        }
    }

    /// Name and unit of each unknown.
    fn names(&self, problem: &Problem<'_>) -> Vec<(String, String)> {
        let own = problem.geometry.parameters.iter();
        let own = own.map(|p| (p.name.clone(), p.unit.clone()));
        let gains =
            (0..problem.geometry.gains).map(|l| (format!("gain of frame {l}"), String::new()));
        own.chain(gains).collect()
    }
}

/// Typical sizes of the unknowns.
fn sizes(scene: &Scene, parameters: &[Parameter], gains: usize) -> Vec<f64> {
    let [angle, percent, length, gain] = TYPICAL;
    let own = parameters.iter().map(|p| match p {
        p if p.is_angle() => angle,
        p if p.is_percent() => percent,
        _ => length * distance(scene),
    });
    own.chain(std::iter::repeat_n(gain, gains)).collect()
}

/// Whether an end is where the best one is.
fn agree(end: &State, best: &State, found: &[Calibrated]) -> bool {
    let each = end.values.iter().zip(&best.values).zip(found);
    each.into_iter()
        .all(|((a, b), own)| (a - b).abs() <= AGREE * own.stderr)
}
