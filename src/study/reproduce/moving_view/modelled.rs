//! Modelled photographs under relative noise.

use nalgebra::DVector;
use serde::{Deserialize, Serialize};

use super::super::{ReproduceError, ReproducePlan, Watch};
use super::layout::{self, View};
use super::system::{System, Weighted};
use super::{BOARDS, HALF_WIDTHS, KEPT, PIXELS, board};
use crate::metrics::mtf_raw;
use crate::model::Kernel;
use crate::recovery::Method;
use crate::scene::Scene;
use crate::study::deviate::normal_deviates;

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
    /// Standard error of the difference between the mean reflectances of light and dark elements, by unbounded least squares.
    pub(super) contrast_error: f64,
    /// Mean raw MTF of `joint` over the draws; none where nothing was drawn.
    pub(super) mtf: Option<f64>,
}

/// One board in one configuration.
pub(super) struct Course {
    pub(super) checks: usize,
    pub(super) points: Vec<Point>,
}

impl Course {
    /// The noise at which the raw MTF falls below [`KEPT`], between two levels by the logarithm; the loudest where it never does, none where it is lost at the
    /// quietest or was not drawn.
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

/// Half-width, kernel and view, with what follows from them.
pub(super) struct Configuration {
    pub(super) half_width: f64,
    pub(super) kernel: Kernel,
    pub(super) view: View,
    /// Singular values of K, W.
    pub(super) sigma: Vec<f64>,
    pub(super) courses: Vec<Course>,
}

impl Configuration {
    pub(super) fn condition(&self) -> f64 {
        self.sigma[0] / self.sigma[self.sigma.len() - 1]
    }
}

/// A quarter of the plan's draws: each of them is a least-squares problem under bounds.
pub(super) fn draws(plan: &ReproducePlan) -> u64 {
    plan.seeds.div_ceil(4)
}

/// Half-width, scene, kernel and view of every configuration; noise is drawn under the physical kernel.
pub(super) fn cases() -> Vec<(f64, &'static str, Kernel, View)> {
    let mut cases = Vec::new();
    for (name, half_width) in HALF_WIDTHS {
        for kernel in [Kernel::Physical, Kernel::Published] {
            cases.extend(layout::VIEWS.map(|view| (half_width, name, kernel, view)));
        }
    }
    cases
}

/// What a configuration comes to, as it travels.
#[derive(Debug, Serialize, Deserialize)]
pub struct Modelled {
    /// Singular values of K, W.
    sigma: Vec<f64>,
    /// Board by board.
    courses: Vec<Vec<Point>>,
}

impl Modelled {
    /// The configuration numbered `index`.
    pub(in super::super) fn compute(
        index: usize,
        plan: &ReproducePlan,
        watch: Watch<'_>,
    ) -> Result<Self, ReproduceError> {
        let (_, name, kernel, view) = cases()[index];
        let scene = layout::scene(name, PIXELS)?;
        let system = System::new(&scene, view, kernel, 1)?;
        let course = |checks: &usize| course(&system, &scene, kernel, *checks, plan, watch);
        Ok(Self {
            courses: BOARDS.iter().map(course).collect::<Result<_, _>>()?,
            sigma: system.sigma()?,
        })
    }

    /// Whether it may be one.
    pub(in super::super) fn fits(&self) -> bool {
        let whole = |points: &Vec<Point>| points.len() == HALF_POWERS.count();
        !self.sigma.is_empty()
            && self.courses.len() == BOARDS.len()
            && self.courses.iter().all(whole)
    }
}

/// The configurations, from what they come to.
pub(super) fn configurations(found: Vec<Modelled>) -> Vec<Configuration> {
    let course = |(checks, points): (&usize, Vec<Point>)| Course {
        checks: *checks,
        points,
    };
    let of = |((half_width, _, kernel, view), found): (_, Modelled)| Configuration {
        half_width,
        kernel,
        view,
        sigma: found.sigma,
        courses: BOARDS.iter().zip(found.courses).map(course).collect(),
    };
    cases().into_iter().zip(found).map(of).collect()
}

fn course(
    system: &System,
    scene: &Scene,
    kernel: Kernel,
    checks: usize,
    plan: &ReproducePlan,
    watch: Watch<'_>,
) -> Result<Vec<Point>, ReproduceError> {
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
        watch.go_on()?;
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

/// √(wᵀ Cov(ρ̂) w) of unbounded least squares under unit noise, w the mean over the light elements less that over the dark ones.
pub(super) fn contrast_error(
    weighted: &Weighted,
    along: &DVector<f64>,
    truth: &[f64],
) -> Result<f64, ReproduceError> {
    let found = weighted.recover(Method::JointUnbounded, along, 1.0)?;
    let light = truth.iter().sum::<f64>();
    let dark = truth.len() as f64 - light;
    let of = |t: &f64| if *t > 0.5 { 1.0 / light } else { -1.0 / dark };
    let contrast = DVector::from_iterator(truth.len(), truth.iter().map(of));
    let variance = found.covariance.map(|c| contrast.dot(&(c * &contrast)));
    Ok(variance.map_or(f64::NAN, f64::sqrt))
}
