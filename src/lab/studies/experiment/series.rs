//! A series of photographs: every spot once, with one strength and kind of glare and one exposure.

use serde::{Deserialize, Serialize};

use super::analysis::{ANALYSES, Laboratory};
use super::results::ExperimentPlan;
use crate::lab::error::LabError;
use crate::lab::recovered::measures::Measures;
use crate::matrix::Matrix;
use crate::scene::{Glare, Scene, Spread as GlareSpread};
use crate::sensor::{Exposure, Light, Range, Stated, glare, glare_to_signal};

/// The settings of one series, and the light that is scattered in it.
pub(super) struct Series<'a> {
    pub(super) spread: GlareSpread,
    pub(super) ratio: f64,
    pub(super) fraction: f64,
    /// What the lens would scatter of the whole of the light that enters it, pixels × spots, W; the
    /// glare is `fraction` of it.
    pub(super) pattern: &'a Matrix,
    pub(super) time: f64,
    pub(super) frames: u32,
}

/// A kind of glare, and what the lens would scatter of the whole of the light that enters it.
pub(super) type Pattern = (GlareSpread, Matrix);

/// Even glare, and glare that falls off.
pub(super) fn patterns(scene: &Scene, plan: &ExperimentPlan) -> [Pattern; 2] {
    [GlareSpread::Uniform, GlareSpread::Falloff(plan.falloff)].map(|spread| {
        let whole = Glare {
            fraction: 1.0,
            spread,
        };
        (spread, glare(scene, whole))
    })
}

/// First the settings of growing glare, one kind after the other, then those of growing exposure.
pub(super) fn all<'a>(
    scene: &Scene,
    plan: &ExperimentPlan,
    patterns: &'a [Pattern],
    signal: &Matrix,
) -> Vec<Series<'a>> {
    let series = |(spread, pattern): &'a Pattern, ratio: f64, share: f64, frames: u32| {
        let fraction = ratio / glare_to_signal(pattern, signal);
        let brightest = (signal + pattern * fraction).max();
        let longest = plan
            .sensor
            .longest_exposure(brightest, scene.laser.wavelength);
        Series {
            spread: *spread,
            ratio,
            fraction,
            pattern,
            time: share * longest,
            frames,
        }
    };
    let by_glare = |p| {
        plan.glares
            .iter()
            .map(move |glare| series(p, *glare, 1.0, plan.frames))
    };
    let by_exposure = |p| {
        plan.exposures
            .iter()
            .map(move |share| series(p, 1.0, *share, 1))
    };
    let first = patterns.iter().flat_map(by_glare);
    first.chain(patterns.iter().flat_map(by_exposure)).collect()
}

/// What one seed gives.
#[derive(Debug, Serialize, Deserialize)]
pub struct Seed {
    pub(super) saturated: usize,
    pub(super) noise: f64,
    /// By every analysis, or why it gave nothing.
    pub(super) measures: Vec<Result<Measures, String>>,
}

/// Exposes the series, and the covered object beside it, and reads both by every analysis.
pub(super) fn read(
    scene: &Scene,
    plan: &ExperimentPlan,
    laboratory: &Laboratory,
    series: &Series<'_>,
    signal: &Matrix,
    seed: u64,
) -> Result<Seed, LabError> {
    let exposure = Exposure::new(&[series.time], series.frames, series.frames)?;
    let glare = series.pattern * series.fraction;
    let expose = |light: &Matrix, seed: u64| {
        let light = Light::new(light, scene.laser.wavelength)?.with_glare(&glare)?;
        plan.sensor.expose(&light, &exposure, Stated::Oracle, seed)
    };
    let dark = Matrix::zeros(signal.nrows(), signal.ncols());
    let taken = expose(signal, seed.wrapping_mul(2))?;
    let covered = expose(&dark, seed.wrapping_mul(2).wrapping_add(1))?;
    let measured = ANALYSES.iter().map(|analysis| {
        let found = laboratory.read(analysis, &taken, &covered, series.pattern);
        found.map_err(|e| e.to_string())
    });
    Ok(Seed {
        saturated: taken.count(Range::Saturated),
        noise: taken.stderr.norm() / signal.norm(),
        measures: measured.collect(),
    })
}
