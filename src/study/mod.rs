//! Floor 6: studies. Experiments that compose the floors below and return plain results.
//!
//! * [`agree`]: traced against modelled Φcam, a verdict by test statistics.
//! * [`validate`]: the same for a scene, the model computed on the way.
//! * [`error_budget`]: the difference between frames and model taken apart into its causes.
//! * [`ConvergenceTasks`]: how fast the error of each estimator falls.
//! * [`power`](fn@power): what [`validate`] detects, and how often it errs.
//! * [`ToleranceTasks`]: how wrong the assumed geometry may be.
//! * [`BrdfTasks`]: the model on a wall that is not Lambertian, its BRDF known, ignored, or wrong.
//! * [`CoverageTasks`]: how often the bands of recovered reflectances cover the truth.
//! * [`ExperimentTasks`]: the failed laboratory experiment, re-enacted.
//! * [`GalleryTasks`]: one run's object by every usual method over regularisation and noise, to leaf through.
//! * [`indicator`](fn@indicator): what predicts how well the published inversion works.
//! * [`noise`](fn@noise): how much noise each recovery bears.
//! * [`portrait`](fn@portrait): a picture of the scene in ordinary light, for people.
//! * [`reproduce`]: the published tables and figures, computed again.
//! * [`recover_objects`]: every recovery method on one Φcam, measured against the true object; [`picards`] show what of it noise leaves.
//!
//! Those that take long are a [`Division`]: independent tasks that one process works off by [`whole`], and many machines share.

mod agreement;
mod brdf;
mod budget;
mod convergence;
mod coverage;
mod deviate;
mod ensemble;
mod experiment;
mod gallery;
mod indicator;
mod inversion;
mod noise;
mod objects;
mod portrait;
mod power;
pub mod reproduce;
mod results;
mod task;
mod tolerance;
mod validation;

pub use agreement::{Errors, Evidence, Test, agree};
pub use brdf::{Assumption, BrdfError, BrdfPlan, BrdfStudy, BrdfTasks, Quality, Ratio};
pub use budget::{BudgetError, BudgetPlan, BudgetTasks, Closure, ErrorBudget, Term, error_budget};
pub use convergence::{Convergence, ConvergenceError, ConvergenceTasks, Curve, Step};
pub use coverage::{Coverage, CoveragePlan, CoverageRow, CoverageTasks};
pub use ensemble::Estimate;
pub use experiment::{
    Experiment, ExperimentError, ExperimentPlan, ExperimentTasks, Reading, Setting, Threshold,
};
pub use gallery::{Automatic, Gallery, GalleryPlan, GallerySurface, GalleryTasks, Picture, Series};
pub use indicator::{
    Coefficients, Comparison, Configuration, Indicator, IndicatorError, IndicatorPlan,
    IndicatorTasks, Layout, NoisyOutcome, NoisyPoint, NoisySummary, indicator,
};
pub use noise::{
    Best, Held, LIMITS, LedgerError, Lost, Measures, NamedSensor, NoiseAxis, NoiseCurve,
    NoiseError, NoiseFinding, NoisePlan, NoiseStudy, NoiseTasks, Point, Reach, RenderNoise,
    Spacing, Spread, Trial, noise, read_ledger, write_ledger,
};
pub use objects::{Attempt, Noise, measured, picards, recover_objects};
pub use portrait::{
    Colour, Marking, Portrait, PortraitPlan, Viewpoint, ViewpointError, Wishes, portrait, stand,
};
pub use power::{Detection, Power, PowerError, PowerPlan, PowerRow, PowerTasks, power};
pub use results::{Agreement, Entry, ObjectBands, RecoveredObject, RunResults, Settings};
pub use task::{Division, LAYOUT, Sharing, Steps, TaskError, decode, encode, parts, whole};
pub use tolerance::{Misplacement, Sensitivity, Tolerance, ToleranceTasks};
pub use validation::{Integration, Validation, ValidationError, validate};
