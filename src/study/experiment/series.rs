//! A series of photographs: every spot once, with one strength and kind of glare and one exposure.

use serde::{Deserialize, Serialize};

use super::analysis::{ANALYSES, Figures, Laboratory, Photographs};
use super::{ExperimentError, ExperimentPlan};
use crate::matrix::Matrix;
use crate::scene::{Glare, Scene, Spread as GlareSpread};
use crate::sensor::{Exposed, Exposure, Light, SensorError, glare, glare_to_signal};

/// The settings of one series, and the light that is scattered in it.
pub(super) struct Series<'a> {
    pub(super) spread: GlareSpread,
    pub(super) ratio: f64,
    pub(super) fraction: f64,
    /// What the lens would scatter of the whole of the light that enters it, pixels × spots, W; the glare is `fraction` of it.
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
    let work = |(spread, pattern): &'a Pattern, ratio: f64, share: f64, frames| {
        let fraction = ratio / glare_to_signal(pattern, signal);
        let brightest = (signal + pattern * fraction).max();
        Series {
            spread: *spread,
            ratio,
            fraction,
            time: share
                * plan
                    .sensor
                    .longest_exposure(brightest, scene.laser.wavelength),
            pattern,
            frames,
        }
    };
    let by_glare = patterns.iter().flat_map(|p| {
        plan.glares
            .iter()
            .map(move |g| work(p, *g, 1.0, plan.frames))
    });
    let by_exposure = patterns
        .iter()
        .flat_map(|p| plan.exposures.iter().map(move |t| work(p, 1.0, *t, 1)));
    by_glare.chain(by_exposure).collect()
}

/// What one seed gives.
#[derive(Debug, Serialize, Deserialize)]
pub struct Seed {
    pub(super) saturated: usize,
    pub(super) noise: f64,
    pub(super) figures: Vec<Result<Figures, String>>,
}

/// Exposes the series, and the covered object beside it, and reads both by every analysis.
pub(super) fn read(
    scene: &Scene,
    plan: &ExperimentPlan,
    laboratory: &Laboratory,
    series: &Series<'_>,
    signal: &Matrix,
    seed: u64,
) -> Result<Seed, ExperimentError> {
    let exposure = Exposure::new(&[series.time], series.frames, series.frames)?;
    let wavelength = scene.laser.wavelength;
    let glare = series.pattern * series.fraction;
    let expose = |light: &Matrix, seed: u64| -> Result<Exposed, SensorError> {
        let light = Light::new(light, wavelength)?.with_glare(&glare)?;
        plan.sensor.expose(&light, &exposure, seed)
    };
    let taken = expose(signal, seed.wrapping_mul(2))?;
    let covered = expose(
        &Matrix::zeros(signal.nrows(), signal.ncols()),
        seed.wrapping_mul(2).wrapping_add(1),
    )?;
    let saturated = taken.count(crate::sensor::Range::Saturated);
    let noise = taken.stderr.norm() / signal.norm();
    let photographs = |e: Exposed| Photographs {
        flux: e.flux,
        stderr: e.stderr,
    };
    let (taken, covered) = (photographs(taken), photographs(covered));
    let figures = ANALYSES
        .iter()
        .map(|a| {
            laboratory
                .read(a, &taken, &covered, series.pattern)
                .map_err(|e| e.to_string())
        })
        .collect();
    Ok(Seed {
        saturated,
        noise,
        figures,
    })
}
