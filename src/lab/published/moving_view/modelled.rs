//! Modelled photographs under relative noise.

use nalgebra::DVector;
use serde::{Deserialize, Serialize};

use super::super::plan::ReproducePlan;
use super::layout::{BOARDS, HALF_WIDTHS, KEPT, PIXELS, VIEWS, View, board, scene};
use super::system::{System, Weighted};
use crate::lab::LabError;
use crate::lab::deviate::normal_deviates;
use crate::metrics::mtf_raw;
use crate::model::Kernel;
use crate::recovery::Method;
use crate::scene::Scene;
use crate::transport::Control;

/// Twice the powers of ten of the noise, from the quietest on.
const HALF_POWERS: std::ops::RangeInclusive<i32> = -12..=-1;

/// The noise of a level.
fn level(half_power: i32) -> f64 {
    libm::exp10(0.5 * f64::from(half_power))
}

/// The loudest noise that is tried.
pub(super) fn loudest() -> f64 {
    level(*HALF_POWERS.end())
}

/// What one level of noise leaves of one board.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Point {
    /// Standard deviation of each entry of Φ over its value.
    pub(super) noise: f64,
    pub(super) effective_rank: usize,
    /// Standard error of the difference between the mean reflectances of light and dark elements,
    /// by unbounded least squares.
    pub(super) contrast_error: f64,
    /// Mean raw MTF of `joint` over the draws; none where nothing was drawn.
    pub(super) mtf: Option<f64>,
}

/// One board in one configuration.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Course {
    pub(super) checks: usize,
    pub(super) points: Vec<Point>,
}

impl Course {
    /// Its points, each with it.
    pub(super) fn each(&self) -> impl Iterator<Item = (&Self, &Point)> {
        self.points.iter().map(move |p| (self, p))
    }

    /// The noise at which the raw MTF falls below [`KEPT`], between two levels by the logarithm;
    /// the loudest where it never does, none where it is lost at the quietest or was not drawn.
    pub(super) fn borne(&self) -> Option<f64> {
        let mtf = |p: &Point| p.mtf.filter(|m| *m >= KEPT);
        let kept = self.points.iter().take_while(|p| mtf(p).is_some()).count();
        let last = self.points.get(kept.checked_sub(1)?)?;
        let (Some(high), Some(next)) = (mtf(last), self.points.get(kept)) else {
            return Some(last.noise);
        };
        let share = (high - KEPT) / (high - next.mtf?);
        Some(last.noise * libm::pow(next.noise / last.noise, share))
    }
}

/// A quarter of the plan's draws: each of them is a least-squares problem under bounds.
pub(super) fn draws(plan: &ReproducePlan) -> u64 {
    plan.seeds.div_ceil(4)
}

/// What is modelled; noise is drawn under the physical kernel.
#[derive(Clone, Copy)]
pub(super) struct Configuration {
    scene: &'static str,
    pub(super) half_width: f64,
    pub(super) kernel: Kernel,
    pub(super) view: View,
}

impl Configuration {
    /// Whether it is of the physical kernel and this half-width.
    pub(super) fn is_physical(&self, half_width: f64) -> bool {
        self.kernel == Kernel::Physical && self.half_width == half_width
    }
}

/// Every configuration.
pub(super) fn cases() -> Vec<Configuration> {
    let kernels = [Kernel::Physical, Kernel::Published];
    let both = HALF_WIDTHS
        .into_iter()
        .flat_map(|h| kernels.map(|k| (h, k)));
    let views = |((scene, half_width), kernel)| {
        VIEWS.map(|view| Configuration {
            scene,
            half_width,
            kernel,
            view,
        })
    };
    both.flat_map(views).collect()
}

/// What a configuration comes to.
#[derive(Debug, Serialize, Deserialize)]
pub struct Modelled {
    /// Singular values of K, W.
    pub(super) sigma: Vec<f64>,
    /// Board by board.
    pub(super) courses: Vec<Course>,
}

/// Configurations with what they come to.
pub(super) type Models = [(Configuration, Modelled)];

impl Modelled {
    /// The configuration numbered `index`.
    pub(in super::super) fn compute(
        index: usize,
        plan: &ReproducePlan,
        control: Control<'_>,
    ) -> Result<Self, LabError> {
        let Configuration {
            scene: name,
            kernel,
            view,
            ..
        } = cases()[index];
        let scene = scene(name, PIXELS)?;
        let system = System::new(&scene, view, kernel, 1)?;
        let course = |checks: usize| {
            let points = points(&system, &scene, kernel, checks, plan, control)?;
            Ok(Course { checks, points })
        };
        let courses: Result<_, LabError> = BOARDS.into_iter().map(course).collect();
        Ok(Self {
            courses: courses?,
            sigma: system.sigma()?,
        })
    }

    pub(super) fn condition(&self) -> f64 {
        self.sigma[0] / self.sigma[self.sigma.len() - 1]
    }

    /// Whether it may be one.
    pub(in super::super) fn fits(&self) -> bool {
        let whole = |(c, checks): (&Course, usize)| {
            c.checks == checks && c.points.len() == HALF_POWERS.count()
        };
        !self.sigma.is_empty()
            && self.courses.len() == BOARDS.len()
            && self.courses.iter().zip(BOARDS).all(whole)
    }
}

fn points(
    system: &System,
    scene: &Scene,
    kernel: Kernel,
    checks: usize,
    plan: &ReproducePlan,
    control: Control<'_>,
) -> Result<Vec<Point>, LabError> {
    let truth = board(checks);
    // Relative noise: every entry's error is `noise` times its value.
    let exact = system.light(&truth);
    let weighted = system.weighted(&exact)?;
    let clean = weighted.along(&DVector::from_element(exact.len(), 1.0));
    let draws = match kernel {
        Kernel::Physical => draws(plan),
        Kernel::Published => 0,
    };
    let (pixels, spots) = (scene.camera.pixels(), scene.laser.spots.len());
    let deviates = (0..draws)
        .map(|k| {
            let z = normal_deviates(plan.first_seed.wrapping_add(k), pixels, spots);
            weighted.along(&DVector::from_column_slice(z.as_slice()))
        })
        .collect::<Vec<_>>();
    let unit = contrast_error(&weighted, &clean, &truth)?;
    let point = |half_power: i32| {
        control.check()?;
        let noise = level(half_power);
        let mut sum = 0.0;
        for z in &deviates {
            let found = weighted.recover(Method::Joint, &(&clean + z * noise), noise)?;
            sum += mtf_raw(found.reflectance.as_slice(), &truth).unwrap_or(0.0);
        }
        Ok(Point {
            noise,
            effective_rank: weighted.effective_rank(noise),
            contrast_error: noise * unit,
            mtf: (draws > 0).then(|| sum / draws as f64),
        })
    };
    HALF_POWERS.map(point).collect()
}

/// √(wᵀ Cov(ρ̂) w) of unbounded least squares under unit noise, w the mean over the light elements
/// less that over the dark ones.
pub(super) fn contrast_error(
    weighted: &Weighted,
    along: &DVector<f64>,
    truth: &[f64],
) -> Result<f64, LabError> {
    let found = weighted.recover(Method::JointUnbounded, along, 1.0)?;
    let light = truth.iter().sum::<f64>();
    let dark = truth.len() as f64 - light;
    let of = |t: &f64| if *t > 0.5 { 1.0 / light } else { -1.0 / dark };
    let contrast = DVector::from_iterator(truth.len(), truth.iter().map(of));
    let variance = found.covariance.map(|c| contrast.dot(&(c * &contrast)));
    Ok(variance.map_or(f64::NAN, f64::sqrt))
}
