//! The geometry, estimated from the photographs themselves.
//!
//! Geometric parameters of the scene and how its spots and walls spread light
//! ([`Parameter`](crate::scene::Parameter)), the picture and, where asked for, a gain of each frame
//! are all unknown. What makes the photographs likeliest with the picture averaged over all that it
//! may be is the estimate ([`posterior`]). Its errors are
//!
//! > cov θ = (F + Λ)⁻¹,   or where more than noise is left (F + Λ)⁻¹ M (F + Λ)⁻¹,   M = Σ_c u_c u_cᵀ
//!
//! if that is larger: u_c is what frame c, or one of 4 × 4 blocks of pixels, says where only the
//! others are fitted ([`left_out`]), so that what the model lacks counts once a frame or block
//! (Huber 1967; Liang and Zeger 1986). Where the likelihood itself, the others following, falls
//! by ½ farther out, that is the error, and so is what priors of the picture say that the
//! photographs do not exclude ([`other_pictures`]). The picture and its covariance are those over
//! all priors by their evidence, the geometry's share included ([`averaged`]). What a picture of
//! twice as many elements along each side would move is an error too where the photographs ask for
//! it, and so is what the next rule of integration would ([`rule`]). All parameters together are
//! held against what was known of them ([`beforehand`]), and what is left over against light that
//! the model leaves out ([`light_left_out`]). Where the likelihood has another peak as high, that
//! place is told ([`elsewhere`]), and another size of the surface if it is much likelier
//! ([`super::resized`]).
//!
//! On the bench, photographs of the converged model with normal noise relative to each entry,
//! hinge, distance and yaw free (or the spots), one start at the scene that is off by so much, 60
//! draws (40 of the spots): raw MTF of `joint` by the right, the wrong and the calibrated
//! geometry, the root mean square error of each parameter over the error that is stated, and how
//! often 1.96 stated errors hold it.
//!
//! | board, noise | off by | MTF right, wrong, calibrated | error over stated | held |
//! | --- | --- | --- | --- | --- |
//! | 2 × 2, 1e-3 | 1°, 0.1 in., 1° | 0.999, 0.887, 0.999 | 1.02, 1.01, 0.85 | 168 of 180 |
//! | 2 × 2, 0.1 | the same | 0.932, 0.854, 0.902 | 0.94, 0.93, 1.03 | 173 of 180 |
//! | 2 × 2, 1e-3 | spots (0.05, 0.05) in. | 0.999, 0.938, 0.999 | 1.03, 0.96 | 75 of 80 |
//! | 4 × 4, 1e-4 | 0.3°, 0.03 in., 0.3° | 0.689, 0.112, 0.686 | 1.02, 0.98, 0.99 | 172 of 180 |
//! | 4 × 4, 1e-5 | the same | 0.919, 0.113, 0.916 | 0.86, 0.84, 0.89 | 176 of 180 |
//!
//! That is by the first rule of integration. By the finer ones ([`rule`]), light by a quadrature of
//! another program, off by normal deviates of the same sizes, 60 draws: of 4 × 4 at 1e-5 errors of
//! 6.2e-4°, 8.7e-5 in. and 4.5e-4°, error over stated 0.99, 0.96 and 1.13, held 167 of 180; at 1e-4
//! 0.98, 0.99, 0.89 and 172; of 2 × 2 at 1e-3 1.01, 1.02, 1.18 and 167. Means of error over stated
//! are up to 0.5: the picture's prior is not that of a board.
//!
//! From a scene five times as far off, three starts, all of 20 draws of the first and of the last
//! two rows end within five stated errors of the truth.
//!
//! The same of a board of 2 × 2 in 4 × 4 elements, past a plate of 1 × 1 in. whose place is free
//! too: traced light, 16 × 16 pixels, 24 spots, through a machine-vision camera (0.005, 0.05 and
//! 0.5 s, 4 frames; 0.7 % noise), 20 draws, off by 1°, 0.1 in., 1° and by 0.1 in. of each
//! coordinate of the plate: MTF 1.000 with the right and with the calibrated geometry, errors over
//! stated 1.04, 0.96, 0.90 and 1.00, 1.07, 1.13, held 112 of 120
//! (`tests/physics/calibrated_past.rs`). Where the plate cuts off the beam of a spot without a size
//! its place has no slope, and the search may not end. Where the scene ends the search goes along
//! its edge, and it is told which unknown that holds ([`edge`]).

mod averaged;
mod beforehand;
mod brightest;
mod calibration;
mod descent;
mod describe;
mod edge;
mod elements;
mod elsewhere;
mod field;
mod finish;
mod free;
mod geometry;
mod identified;
mod left_out;
mod light_left_out;
mod other_pictures;
mod picture;
mod posterior;
mod profile;
mod resized;
mod rule;
mod step;
#[cfg(test)]
mod tests;

pub use beforehand::Beforehand;
pub use calibration::{Calibrated, Calibration, Starts};
pub use descent::Stage;
pub use edge::AtEdge;
pub use elements::FinerElements;
pub use elsewhere::Elsewhere;
pub use free::Free;
pub use identified::{Direction, Identified};
pub use profile::Profile;

use super::common::Common;
use crate::lab::comparison::misplaced::normal;
use crate::lab::comparison::validation::Integration;
use crate::lab::error::LabError;
use crate::lab::uncertainty::refined::Refined;
use crate::lab::uncertainty::unexplained::Unexplained;
use crate::model::{Fineness, Kernel, MatrixModel, Occlusion};
use crate::scene::{Parameter, Scene};
use crate::transport::Control;
use descent::{Problem, first};
use field::End;
use geometry::{Geometry, distance};
use identified::identified;

/// Below this probability of so bad a fit by noise alone more than noise is left.
const LEVEL: f64 = crate::lab::comparison::evidence::FIT_LEVEL;
/// Typical sizes of angles (degrees), percents, lengths over the distance to the view, and gains.
const TYPICAL: [f64; 4] = [1.0, 1.0, 0.01, 0.01];

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
    /// Whether there is light that all frames share, unknown in each pixel.
    pub background: bool,
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

impl CalibrationPlan {
    /// Work, in steps of progress.
    pub fn work(&self) -> u64 {
        self.starts as u64 + 2
    }

    /// The geometry of `scene` by these photographs; standard errors from few replicates are pooled
    /// over pixels and spots where these say more.
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
        let known = photographs.certainty;
        let stderr = photographs.stderr;
        if stderr.is_some_and(|all| all.iter().all(|s| *s == 0.0)) {
            return Err(LabError::Unsuited(
                "every standard error is 0, so that no entry counts; give those of the photographs, or none where their noise is not known",
            ));
        }
        photographs.check()?;
        let of = |own| Refined::of_weights(photographs.phi, own, known, photographs.left_out);
        let refined = stderr.map(of);
        let known = refined.as_ref().map_or(known, |own| own.certainty);
        let photographs = Unexplained {
            stderr: refined.as_ref().map(|own| own.stderr.as_ref()),
            certainty: known,
            ..*photographs
        };
        self.search(scene, &photographs, control)
    }

    /// From all starts to the estimate.
    fn search(
        &self,
        scene: &Scene,
        photographs: &Unexplained<'_>,
        control: Control<'_>,
    ) -> Result<Calibration, LabError> {
        let (parameters, mut priors) = free::parameters(scene, &self.free)?;
        let frames = photographs.phi.ncols();
        let gains = if self.frame_gain.is_some() { frames } else { 0 };
        priors.extend(std::iter::repeat_n(self.frame_gain, gains));
        let model = MatrixModel::with(scene, Kernel::Physical, self.elements, Occlusion::Ignored)?;
        let fineness = match self.integration {
            Integration::Centres => Fineness::Centres,
            Integration::Quadrature => Fineness::Areas(1),
        };
        let pictures = picture::priors(&model.places, self.is_scale_free)?;
        let common = (self.background).then(|| Common::new(photographs, self.error_field));
        let common = common.transpose()?;
        let mut problem = Problem {
            geometry: Geometry {
                scene,
                parameters: &parameters,
                elements: self.elements,
                fineness,
                occlusion: self.occlusion,
                gains,
            },
            photographs: Unexplained {
                phi: common.as_ref().map_or(photographs.phi, |own| &own.phi),
                ..*photographs
            },
            common: common.as_ref(),
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
        let by_centres = fineness == Fineness::Centres && !problem.geometry.is_obstructed();
        if by_centres && parameters.iter().any(Parameter::is_spot_size) {
            return Err(LabError::Unsuited(
                "the size of the spots changes nothing where each is taken for a point: leave laser.spot_diameter out, or integrate over them (--integration quadrature)",
            ));
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
            let start = self.start(k, &problem, &sizes);
            ends.push(self.end(&problem, &start, problem.first, control)?);
            (control.progress)(1);
        }
        ends.sort_by(|a, b| a.total.total_cmp(&b.total));
        ends.extend(self.other_places(&problem, &ends[0], &sizes, control)?);
        (control.progress)(1);
        ends.sort_by(|a, b| a.total.total_cmp(&b.total));
        while let Some(finer) = problem.next_rule(&ends[0])? {
            problem.geometry.fineness = finer;
            for end in &mut ends {
                let mut stages = std::mem::take(&mut end.stages);
                let finer = self.end(&problem, &end.state.values, end.noise(), control)?;
                stages.extend(finer.stages);
                *end = End {
                    stages,
                    is_of_start: end.is_of_start,
                    ..finer
                };
            }
            ends.sort_by(|a, b| a.total.total_cmp(&b.total));
        }
        let resized = self.resized(&problem, &ends[0], control)?;
        let mut found = self.finish(&problem, (&model, told, untold), ends, control)?;
        found.resized = resized.filter(|other| other.is_told(elsewhere::scatter(&found.found)));
        Ok(found)
    }

    /// From `start` and a noise `first` times the stated one to an end.
    fn end(
        &self,
        problem: &Problem<'_>,
        start: &[f64],
        first: f64,
        control: Control<'_>,
    ) -> Result<End, LabError> {
        let (state, stages) = problem.descend(start, first, control)?;
        if self.error_field {
            problem.with_shared_errors((state, stages), control)
        } else {
            Ok(End::new(problem, state, stages))
        }
    }

    /// Where start k begins. Where there is no scene so far off, one unknown after the other is as
    /// far off as it was drawn, or as far the other way, or not at all.
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
        let geometry = &problem.geometry;
        if geometry.refused(&far).is_none() {
            return far;
        }
        let mut start = vec![0.0; far.len()];
        for (j, own) in far.iter().enumerate().take(count) {
            for place in [*own, -own, 0.0] {
                start[j] = place;
                if geometry.refused(&start).is_none() {
                    break;
                }
            }
        }
        start
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
