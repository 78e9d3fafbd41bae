//! Recoveries to leaf through: every usual method, over its regularisation and over noise added to
//! the photographs.
//!
//! The photographs are those of the run, Φ, with more noise on top,
//!
//! > Φ' = Φ + ε m N,   m the mean of |Φ|,   σ'² = σ² + (ε m)²,
//!
//! N one fixed draw of standard normal numbers for all levels ε, so that from level to level
//! nothing changes but its size. Every picture is a recovery from Φ' as [`recover`] makes it, and
//! where the discrepancy principle, told σ', sets the parameter of a method, that recovery is among
//! the pictures.
//!
//! [`recover`]: crate::recovery::recover

mod plan;
mod recovery_task;
mod run_gallery;

use std::sync::atomic::Ordering;

use rayon::prelude::*;

use super::measures::Measures;
use super::objects::RecoveredObject;
use crate::lab::deviate::normal_deviates;
use crate::matrix::Matrix;
use crate::model::MatrixModel;
use crate::recovery::{LaserSide, Method, Parameter, RecoveryError};
use crate::scene::{Division, Scene};
use crate::transport::Control;

pub use plan::GalleryPlan;
use plan::{Fitted, ladder, works_by_directions};
use recovery_task::{Chosen, Outcome, RecoveryTask, laser_side};
pub use run_gallery::{Automatic, GalleryPicture, GallerySurface, RunGallery, Series};

/// The recoveries of a gallery, ready to be made.
pub struct GalleryTasks<'a> {
    model: &'a MatrixModel,
    surfaces: Vec<GallerySurface>,
    phi: &'a Matrix,
    stderr: &'a Matrix,
    known: &'a [RecoveredObject],
    plan: GalleryPlan,
    fitted: Fitted,
    mean: f64,
}

impl<'a> GalleryTasks<'a> {
    /// The gallery of photographs `phi` with standard errors `stderr` (pixels × spots, W). `known`
    /// are recoveries from them that are there already, of methods without a parameter. None where
    /// there is no light, and so nothing to recover.
    pub fn new(
        scene: &Scene,
        model: &'a MatrixModel,
        (phi, stderr): (&'a Matrix, &'a Matrix),
        known: &'a [RecoveredObject],
        plan: GalleryPlan,
    ) -> Option<Self> {
        let mean = phi.iter().map(|x| x.abs()).sum::<f64>() / phi.len() as f64;
        if !(mean > 0.0 && mean.is_finite()) {
            return None;
        }
        let (pixels, spots) = phi.shape();
        let surfaces = surfaces(scene, model);
        Some(Self {
            fitted: plan.fitted([pixels, spots, model.albedo.len()]),
            model,
            surfaces,
            phi,
            stderr,
            known,
            plan,
            mean,
        })
    }

    /// Steps that `control` is told of.
    pub fn count(&self) -> u64 {
        self.tasks().len() as u64
    }

    /// Makes them; none if stopped.
    pub fn gallery(&self, control: Control<'_>) -> Option<RunGallery> {
        let (pixels, spots) = if self.fitted.noises.is_empty() {
            (0, 0)
        } else {
            self.phi.shape()
        };
        let deviates = normal_deviates(self.plan.seed, pixels, spots);
        let side = laser_side(self.model, self.phi, self.stderr);
        let tasks = self.tasks();
        let done = tasks.par_iter().map(|task| {
            if control.stop.load(Ordering::Relaxed) {
                return None;
            }
            let found = self.outcome(*task, &side, &deviates);
            (control.progress)(1);
            Some(found)
        });
        let outcomes: Vec<Outcome<'_>> = done.collect::<Option<_>>()?;
        let sigma = side.as_ref().map_or(&[][..], LaserSide::sigma);
        let series = self.plan.methods.iter().filter_map(|&method| {
            let all = tasks.iter().zip(&outcomes);
            let own: Vec<&Outcome<'_>> = all
                .filter(|(task, _)| task.of(method))
                .map(|(_, o)| o)
                .collect();
            (!own.is_empty()).then(|| self.series(method, sigma, &own))
        });
        Some(RunGallery {
            series: series.collect(),
            surfaces: self.surfaces.clone(),
            noises: self.fitted.noises.clone(),
            mean: self.mean,
            left_out: self.fitted.left_out.clone(),
        })
    }

    /// Each noise by the directions of the laser side, and by each of the other methods.
    fn tasks(&self) -> Vec<RecoveryTask> {
        let noises = 0..self.fitted.noises.len();
        let mut tasks = Vec::new();
        if self.fitted.by_directions {
            tasks.extend(noises.clone().map(RecoveryTask::Directions));
        }
        for &method in self
            .plan
            .methods
            .iter()
            .filter(|m| !works_by_directions(**m))
        {
            tasks.extend(
                noises
                    .clone()
                    .map(|noise| RecoveryTask::Whole(noise, method)),
            );
        }
        tasks
    }

    fn outcome<'s>(
        &self,
        task: RecoveryTask,
        side: &'s Result<LaserSide, RecoveryError>,
        deviates: &Matrix,
    ) -> Outcome<'s> {
        match task {
            RecoveryTask::Directions(noise) => {
                let photographs = self.photographs(noise, deviates);
                Outcome::by_directions(side, self.model, &photographs, &self.plan.methods)
            }
            RecoveryTask::Whole(noise, method) => match self.known(method) {
                Some(known) if noise == 0 => known,
                _ if noise > 0 && self.fitted.traced_alone.contains(&method) => {
                    Outcome::Nothing("left out: too much work beside the run".to_owned())
                }
                _ => Outcome::whole(method, self.model, &self.photographs(noise, deviates)),
            },
        }
    }

    /// Φ' and σ' of a level.
    fn photographs(&self, noise: usize, deviates: &Matrix) -> [Matrix; 2] {
        let sigma = self.fitted.noises[noise] * self.mean;
        if sigma == 0.0 {
            return [self.phi.clone(), self.stderr.clone()];
        }
        [
            self.phi.zip_map(deviates, |x, n| x + sigma * n),
            self.stderr.map(|s| (s * s + sigma * sigma).sqrt()),
        ]
    }

    /// What the run has recovered from the photographs as they are.
    fn known(&self, method: Method) -> Option<Outcome<'static>> {
        let own: Vec<&RecoveredObject> = self
            .known
            .iter()
            .filter(|o| o.method == method.name())
            .collect();
        let reflectance: Vec<f64> = own
            .iter()
            .flat_map(|o| o.reflectance.iter().copied())
            .collect();
        let words = own.first()?.parameter.clone();
        (reflectance.len() == self.model.albedo.len()).then_some(Outcome::Whole(reflectance, words))
    }

    fn series(&self, method: Method, sigma: &[f64], outcomes: &[&Outcome<'_>]) -> Series {
        let automatic: Vec<Chosen> = outcomes.iter().map(|o| o.automatic(method)).collect();
        let chosen: Vec<Parameter> = automatic
            .iter()
            .flatten()
            .map(|(parameter, _)| *parameter)
            .collect();
        let steps = ladder(method, sigma, self.fitted.steps, &chosen);
        let at = |(parameter, words): &(Parameter, String)| Automatic {
            step: steps.iter().position(|s| s == parameter).unwrap_or(0),
            words: words.clone(),
        };
        let automatic = automatic
            .iter()
            .map(|a| a.as_ref().map(at).map_err(Clone::clone));
        let pictures = outcomes.par_iter().map(|outcome| {
            let picture =
                |step: &Parameter| outcome.reflectance(*step).map(|found| self.picture(found));
            steps.iter().map(picture).collect()
        });
        Series {
            method,
            automatic: automatic.collect(),
            pictures: pictures.collect(),
            steps,
        }
    }

    fn picture(&self, reflectance: Vec<f64>) -> GalleryPicture {
        let measures = self.model.grids.iter().map(|grid| {
            let own = grid.first..grid.first + grid.len();
            Measures::of(&reflectance[own.clone()], &self.model.albedo[own])
        });
        GalleryPicture {
            measures: measures.collect(),
            reflectance,
        }
    }
}

fn surfaces(scene: &Scene, model: &MatrixModel) -> Vec<GallerySurface> {
    let both = model.grids.iter().zip(scene.hidden());
    both.map(|(grid, (_, surface))| GallerySurface {
        name: grid.surface.clone(),
        elements: grid.count,
        cells: surface.division == Division::Cells,
        truth: model.albedo[grid.first..grid.first + grid.len()].to_vec(),
    })
    .collect()
}

#[cfg(test)]
mod tests;
