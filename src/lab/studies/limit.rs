//! The most noise at which a picture is resolved.

use nalgebra::DVector;
use rayon::prelude::*;

use super::sensitivity::{sensitivity, stacked};
use super::subject::{RESOLVED, Subject, recovered};
use crate::lab::deviate::normal_deviates;
use crate::lab::ensemble::Photographs;
use crate::lab::error::LabError;
use crate::lab::uncertainty::noise_law::NoiseLaw;
use crate::matrix::Matrix;
use crate::model::MatrixModel;
use crate::num::linalg::{Tolerance, cut, rows_times, svd};
use crate::num::quadratic::{Bounds, box_least_squares};
use crate::num::summation::tree_sum;
use crate::recovery::RecoveryError;
use crate::scene::Scene;
use crate::transport::Control;

/// Decades of noise, from 1 down, in which the limit is looked for, and halvings.
const DECADES: f64 = 14.0;
const HALVINGS: usize = 8;
/// Elements up to which photographs are reduced to as many numbers.
const FEW: usize = 256;

/// How a limit is found: draws of the noise at each level, the first of which has the seed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Limit {
    pub(super) noise: NoiseLaw,
    pub(super) draws: u64,
    pub(super) seed: u64,
}

/// A picture with what its photographs are at noise 1.
struct Posed<'a> {
    model: &'a MatrixModel,
    subject: Subject,
    truth: Vec<f64>,
    exact: Matrix,
    reduced: Option<Matrix>,
}

impl Limit {
    /// The most noise at which `joint` resolves the picture on average over the draws, by halving
    /// ln ε; `None` below 1e-14, and of a picture from which no light comes into view.
    ///
    /// # Errors
    /// [`LabError`].
    pub(super) fn of(
        &self,
        scene: &Scene,
        model: &MatrixModel,
        subject: Subject,
        control: Control<'_>,
    ) -> Result<Option<f64>, LabError> {
        let Some(posed) = Posed::new(scene, model, subject, self.noise)? else {
            return Ok(None);
        };
        let resolved = |decades: f64| -> Result<bool, LabError> {
            let level = libm::pow(10.0, -decades);
            let draw = |draw| {
                control.check()?;
                posed.likeness(self.noise, level, self.seed.wrapping_add(draw), control)
            };
            let found: Result<Vec<f64>, LabError> =
                (0..self.draws).into_par_iter().map(draw).collect();
            Ok(tree_sum(&found?) >= RESOLVED * self.draws as f64)
        };
        if resolved(0.0)? {
            return Ok(Some(1.0));
        }
        let [mut lost, mut kept] = [0.0, DECADES];
        if !resolved(kept)? {
            return Ok(None);
        }
        for _ in 0..HALVINGS {
            let middle = 0.5 * (lost + kept);
            if resolved(middle)? {
                kept = middle;
            } else {
                lost = middle;
            }
        }
        Ok(Some(libm::pow(10.0, -kept)))
    }
}

impl<'a> Posed<'a> {
    /// Of few elements photographs are reduced: with the whitened sensitivities J = U S Vᵀ of all
    /// entries, Uᵀ takes photographs with normal noise to S Vᵀ ρ with independent normal noise of
    /// deviation ε, and what `joint` makes of them with the weight of each entry is the same.
    /// `None` where no light comes into view.
    fn new(
        scene: &Scene,
        model: &'a MatrixModel,
        subject: Subject,
        noise: NoiseLaw,
    ) -> Result<Option<Self>, LabError> {
        let truth = subject.albedo(scene, model);
        let exact = model.phi_of(&truth);
        if exact.amax() == 0.0 {
            return Ok(None);
        }
        let few = truth.len() <= FEW && model.camera_side.nrows() > 1;
        let reduced = few.then(|| -> Result<Matrix, LabError> {
            let stderr = noise.stderrs(&exact, 1.0);
            let frame = |l: usize| {
                let mut frame = sensitivity(model, l);
                for (mut row, stderr) in frame.row_iter_mut().zip(stderr.column(l).iter()) {
                    row /= *stderr;
                }
                frame
            };
            // As `joint` does: directions below one rounding of the strongest carry nothing.
            let all = svd(&stacked(exact.ncols(), frame)?)?;
            let rounding = Tolerance::Relative(f64::EPSILON);
            let (rows, _) = cut(all.sigma.as_slice(), 1, 1, rounding)?;
            Ok(rows_times(all.vt.rows(0, rows).into_owned(), &all.sigma))
        });
        Ok(Some(Self {
            model,
            subject,
            truth,
            exact,
            reduced: reduced.transpose()?,
        }))
    }

    /// How like the truth what is recovered from one draw is; 0 where that is not defined.
    fn likeness(
        &self,
        noise: NoiseLaw,
        level: f64,
        seed: u64,
        control: Control<'_>,
    ) -> Result<f64, LabError> {
        let found = match &self.reduced {
            None => {
                let stderr = noise.stderrs(&self.exact, level);
                let photographs = Photographs::drawn(&self.exact, stderr, seed);
                recovered(self.model, self.subject, &self.truth, &photographs, control)?.likeness
            }
            Some(reduced) => {
                let truth = DVector::from_column_slice(&self.truth);
                let deviates = normal_deviates(seed, reduced.nrows(), 1);
                let r = reduced / level;
                let d = &r * truth + deviates.column(0);
                let bounds = Bounds::all(self.truth.len(), 0.0, 1.0);
                let found = box_least_squares(&r, &d, &bounds).map_err(RecoveryError::from)?;
                self.subject
                    .likeness(found.solution.as_slice(), &self.truth)
            }
        };
        Ok(found.unwrap_or(0.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Kernel;

    /// Reduced or not, photographs of one picture recover it as well, to within what the mean of
    /// 200 draws scatters.
    #[test]
    fn reduced_photographs_say_the_same() {
        let scene = Scene::load("thesis").unwrap();
        let mut scene = scene.clone();
        (scene.camera.columns, scene.camera.rows) = (4, 4);
        scene.laser.spots.truncate(24);
        let model = MatrixModel::new(&scene, Kernel::Physical, Some([2; 2])).unwrap();
        let board = Subject::Board(2);
        let mean = |reduced: bool| {
            let posed = Posed::new(&scene, &model, board, NoiseLaw::Relative);
            let mut posed = posed.unwrap().unwrap();
            if !reduced {
                posed.reduced = None;
            }
            let draw = |seed| {
                let control = Control::none();
                posed
                    .likeness(NoiseLaw::Relative, 0.03, seed, control)
                    .unwrap()
            };
            (0..200).map(draw).sum::<f64>() / 200.0
        };
        let [with, without] = [true, false].map(mean);
        assert!(
            (with - without).abs() < 0.03 && (0.5..0.99).contains(&with),
            "{with} {without}"
        );
    }
}
