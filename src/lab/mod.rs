//! Floor 6: studies. Experiments that compose the floors below and return plain results.
//!
//! By folders, lowest first; beside them is what all share (`study.rs`: what a study is,
//! `finding.rs`: what a result is, `problem.rs`: a scene with its model, `ensemble.rs`: draws):
//!
//! | folder | what |
//! | --- | --- |
//! | `uncertainty` | what is known of the standard errors of photographs |
//! | `comparison` | photographs against a model: evidence, verdict, the parameters that are off |
//! | `recovered` | pictures: every method on one Φcam, which to believe, what speaks against it |
//! | `geometry` | where things are, from the photographs |
//! | `studies` | one file or folder each; `registry.rs` lists those with a command |
//! | `run` | what is told of one run |
//! | `published` | the published study computed again |
//!
//! * [`agree`]: traced against modelled Φcam, a verdict by test statistics.
//! * [`validate`]: the same for a scene, the model computed on the way; which parameter of it is
//!   off ([`Score`]).
//! * [`BudgetTasks`]: the difference between frames and model taken apart into its causes.
//! * [`ConvergenceTasks`]: how fast the error of each estimator falls.
//! * [`PowerTasks`]: what [`validate`] detects, and how often it errs.
//! * [`ToleranceTasks`]: how wrong the assumed geometry may be.
//! * [`BrdfTasks`]: the model on a wall that is not Lambertian, its BRDF known, ignored, or wrong.
//! * [`CoverageTasks`]: how often the bands of recovered reflectances cover the truth.
//! * [`ExperimentTasks`]: the failed laboratory experiment, re-enacted.
//! * [`GalleryTasks`]: one run's object by every usual method over regularisation and noise, to
//!   leaf through.
//! * [`IndicatorTasks`]: what predicts how well the published inversion works.
//! * [`NoiseTasks`]: how much noise each recovery bears.
//! * [`preview`](fn@preview): a picture of the scene in ordinary light, for people.
//! * [`published`]: the published tables and figures, computed again.
//! * [`recover_objects`]: every recovery method on one Φcam, measured against the true object;
//!   [`recover_with_picards`] show what of it noise leaves.
//!
//! Those that take long are a [`Study`]: independent tasks that one process works off by [`run`],
//! and many machines share.
//!
//! A study of one's own, in one file: how much light the darkness of the wall costs. The light of
//! three bounces meets the wall twice, so Φ ∝ ρ².
//!
//! ```
//! use phicam::lab::finding::{
//!     Axis, Cell, Column, Curve, Describe, Figure, Finding, Mark, Plot, Table, Tone,
//! };
//! use phicam::lab::{Study, run};
//! use phicam::scene::{Scene, SceneError, file::SceneFile};
//! use phicam::transport::{
//!     Budget, Control, Estimator, Plan, RenderError, Sampling, Stopped, render,
//! };
//! use serde::{Deserialize, Serialize};
//!
//! /// How much light arrives from walls of different albedo.
//! struct DarkWall {
//!     albedos: Vec<f64>,
//!     plan: Plan,
//! }
//!
//! /// Albedo of the wall, and all light that the camera gets, W.
//! #[derive(Clone, Copy, Serialize, Deserialize)]
//! struct Point {
//!     albedo: f64,
//!     flux: f64,
//! }
//!
//! #[derive(Serialize)]
//! struct Falloff(Vec<Point>);
//!
//! #[derive(Debug, thiserror::Error)]
//! enum Error {
//!     #[error(transparent)]
//!     Scene(#[from] SceneError),
//!     #[error(transparent)]
//!     Render(#[from] RenderError),
//!     #[error(transparent)]
//!     Stopped(#[from] Stopped),
//! }
//!
//! impl Study for DarkWall {
//!     type Context = SceneFile; // the same for every task, computed once a process
//!     type Output = Point; // of one task: what a shard or a later run takes up
//!     type Result = Falloff;
//!     type Error = Error;
//!
//!     fn tasks(&self) -> usize {
//!         self.albedos.len()
//!     }
//!     fn context(&self, _: Control<'_>) -> Result<SceneFile, Error> {
//!         let mut file = SceneFile::default();
//!         file.laser.as_mut().expect("the bench has a laser").spots.per_side = Some(2);
//!         Ok(file)
//!     }
//!     fn task(&self, file: &SceneFile, index: usize, control: Control<'_>) -> Result<Point, Error> {
//!         let (mut file, albedo) = (file.clone(), self.albedos[index]);
//!         let wall = file.surface.iter_mut().find(|s| s.name == "wall").expect("the bench has one");
//!         wall.material.lambertian = Some(albedo.into());
//!         let scene = Scene::new(&file, None)?;
//!         let traced = render(&scene, &self.plan, 0..scene.laser.spots.len(), control)?;
//!         Ok(Point { albedo, flux: traced.flux.sum() })
//!     }
//!     fn fits(&self, _: &SceneFile, index: usize, point: &Point) -> bool {
//!         point.albedo == self.albedos[index]
//!     }
//!     fn finish(&self, _: &SceneFile, points: Vec<Point>) -> Result<Falloff, Error> {
//!         Ok(Falloff(points))
//!     }
//! }
//!
//! impl Describe for Falloff {
//!     fn describe(&self) -> Finding {
//!         let worst = self.0.iter().map(|p| {
//!             let expected = self.0[0].flux * (p.albedo / self.0[0].albedo).powi(2);
//!             (p.flux / expected - 1.0).abs()
//!         });
//!         let worst = worst.fold(0.0, f64::max);
//!         let square = worst < 1e-9;
//!         let points = self.0.iter().map(|p| [p.albedo, p.flux]).collect();
//!         Finding {
//!             title: "Light from a dark wall".to_owned(),
//!             tone: if square { Tone::Good } else { Tone::Bad },
//!             sentence: format!("Φ falls as ρ², to {worst:.0e} of it"),
//!             notes: vec!["Every render has the same paths; their noise cancels.".to_owned()],
//!             tables: vec![Table {
//!                 file: Some("dark-wall.csv".to_owned()),
//!                 columns: vec![
//!                     Column::number("albedo", "albedo", "", 2),
//!                     Column::number("flux", "flux", "W", 4),
//!                 ],
//!                 rows: self.0.iter().map(|p| [p.albedo, p.flux].map(Cell::from).to_vec()).collect(),
//!                 ..Table::default()
//!             }],
//!             figures: vec![Figure {
//!                 file: "dark-wall.svg".to_owned(),
//!                 title: "Light from a dark wall".to_owned(),
//!                 plots: vec![Plot {
//!                     title: String::new(),
//!                     axes: [Axis::decades("albedo"), Axis::decades("flux, W")],
//!                     curves: vec![Curve::new("traced", Mark::Points, points)],
//!                 }],
//!                 ..Figure::default()
//!             }],
//!             ..Finding::default()
//!         }
//!     }
//! }
//!
//! let budget = Budget::new(32, Sampling::Sobol)?;
//! let plan = Plan { estimator: Estimator::Shared, sampling: Sampling::Sobol, seed: 1, budget };
//! let study = DarkWall { albedos: vec![1.0, 0.5, 0.25], plan };
//! let finding = run(&study, Control::none())?.describe();
//! assert_eq!((finding.tone, finding.tables[0].rows.len()), (Tone::Good, 3));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod bytes;
mod check;
mod comparison;
mod deviate;
mod ensemble;
mod error;
pub mod finding;
mod geometry;
pub mod options;
mod preview;
mod problem;
pub mod published;
mod recovered;
mod run;
#[cfg(test)]
#[path = "sample_tests.rs"]
pub(crate) mod sample;
mod studies;
mod study;
mod uncertainty;

pub use bytes::{LAYOUT, TaskError, decode, encode, encoded};
pub use comparison::agreement::{Agreement, Entry, EntryBound, agree};
pub use comparison::eliminated::Eliminated;
pub use comparison::evidence::{Evidence, FIT_LEVEL, Test};
pub use comparison::gains::{Deviations, Gains};
pub use comparison::measured::{Measured, ValidationError};
pub use comparison::score::{Derivatives, Deviation, ElementLight, Parameter, PictureFit, Score};
pub use comparison::unmodelled::{from_wall_to_wall, unmodelled};
pub use comparison::validation::{Against, Integration, Validation, validate};
pub use ensemble::{Estimate, Spread};
pub use error::{LabError, StudyError};
pub use geometry::calibrate::{
    AtEdge, Beforehand, Calibrated, Calibration, CalibrationPlan, Direction, Elsewhere,
    FinerElements, Free, Identified, Profile, Stage, Starts,
};
pub use geometry::light_left_out::LightLeftOut;
pub use geometry::located::{
    Bright, Grid, LOCATABLE, Likelihood, Located, LocatedPlan, Mistaken, Order,
};
pub use geometry::resized::Resized;
pub use preview::{
    Colour, Preview, PreviewError, PreviewPlan, ViewOptions, Viewpoint, auto_viewpoint, preview,
};
pub use problem::{MOST_INTEGRATED, inverted};
pub use recovered::chosen::{Beside, Chosen};
pub use recovered::fit::{Apart, Attainable, Fit, Judged, Outlier, Residuals, Rival};
pub use recovered::gallery::{
    Automatic, GalleryPicture, GalleryPlan, GallerySurface, GalleryTasks, RunGallery, Series,
};
pub use recovered::measures::Measures;
pub use recovered::objects::{
    Attempt, Noise, ObjectBands, RecoveredObject, measured, recover_objects, recover_with_picards,
};
pub use recovered::recoveries::{
    by_surface, describe_recovery, determined, fits, recovery, warnings,
};
pub use recovered::trust::by_trust;
pub use run::aim::{SAMPLES, aimed};
pub use run::answer::{Answer, Claim};
pub use run::exposure::describe_exposure;
pub use run::pilot::{Foretold, darkness, foretold};
pub use run::results::RunResults;
pub use run::summary::describe_render;
pub use studies::brdf::{Assumption, BrdfPlan, BrdfStudy, BrdfTasks, Quality, Ratio};
pub use studies::budget::{BudgetPlan, BudgetTasks, Closure, ErrorBudget, Term};
pub use studies::convergence::{Bend, Convergence, ConvergenceTasks, Curve, Step};
pub use studies::coverage::{Coverage, CoveragePlan, CoverageRow, CoverageTasks};
pub use studies::experiment::{
    Experiment, ExperimentPlan, ExperimentTasks, Reading, Setting, Threshold,
};
pub use studies::indicator::{
    Coefficients, Comparison, Configuration, Indicator, IndicatorPlan, IndicatorTasks, Layout,
    NoisyOutcome, NoisyPoint, NoisySummary,
};
pub use studies::noise::{
    AxisLabel, Best, Held, LIMITS, Lost, NamedSensor, NoiseAxis, NoiseCurve, NoisePlan, NoiseStudy,
    NoiseTasks, Picture, Point, Reach, RenderNoise,
};
pub use studies::power::{Detection, Power, PowerPlan, PowerRow, PowerTasks};
pub use studies::registered::{AnyStudy, Found, Prepare, Registered, prepared};
pub use studies::registry::STUDIES;
pub use studies::tolerance::{Misplacement, Sensitivity, Tolerance, ToleranceTasks};
pub use study::{Sharing, Study, Work, context, outputs, run};
pub use uncertainty::certainty::{Certainty, Errors, PooledFrom};
pub use uncertainty::counted::Counted;
pub use uncertainty::light_law::LightLaw;
pub use uncertainty::smooth::polynomials;
pub use uncertainty::tails::Tails;
pub use uncertainty::unexplained::{Photographs, Unexplained, fewer};
