//! A series of photographs: every spot once, with one strength and kind of glare and one exposure.

use super::analysis::{ANALYSES, Figures, Laboratory, Photographs};
use super::{ExperimentError, ExperimentPlan};
use crate::matrix::Matrix;
use crate::scene::{Glare, Scene, Spread as GlareSpread};
use crate::sensor::{Exposed, Exposure, Light, SensorError, glare, glare_to_signal};

/// The settings of one series, and the light that is scattered in it.
pub(super) struct Series {
    pub(super) spread: GlareSpread,
    pub(super) ratio: f64,
    pub(super) fraction: f64,
    /// Light of the laser that the lens scatters, pixels × spots, W.
    pub(super) glare: Matrix,
    /// The same for the whole of the light that enters.
    pub(super) pattern: Matrix,
    pub(super) time: f64,
    pub(super) frames: u32,
}

/// First the settings of growing glare, even and falling off, then those of growing exposure.
pub(super) fn all(scene: &Scene, plan: &ExperimentPlan, signal: &Matrix) -> Vec<Series> {
    let spreads = [GlareSpread::Uniform, GlareSpread::Falloff(plan.falloff)];
    let patterns = spreads.map(|spread| {
        (
            spread,
            glare(
                scene,
                Glare {
                    fraction: 1.0,
                    spread,
                },
            ),
        )
    });
    let work = |(spread, pattern): &(GlareSpread, Matrix), ratio: f64, share: f64, frames| {
        let fraction = ratio / glare_to_signal(pattern, signal);
        let glare = pattern * fraction;
        let brightest = (signal + &glare).max();
        Series {
            spread: *spread,
            ratio,
            fraction,
            time: share
                * plan
                    .sensor
                    .longest_exposure(brightest, scene.laser.wavelength),
            glare,
            pattern: pattern.clone(),
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
pub(super) struct Seed {
    pub(super) saturated: usize,
    pub(super) noise: f64,
    pub(super) figures: Vec<Result<Figures, String>>,
}

/// Exposes the series, and the covered object beside it, and reads both by every analysis.
pub(super) fn read(
    scene: &Scene,
    plan: &ExperimentPlan,
    laboratory: &Laboratory,
    series: &Series,
    signal: &Matrix,
    seed: u64,
) -> Result<Seed, ExperimentError> {
    let exposure = Exposure::new(&[series.time], series.frames, series.frames)?;
    let wavelength = scene.laser.wavelength;
    let expose = |light: &Matrix, seed: u64| -> Result<Exposed, SensorError> {
        let light = Light::new(light, wavelength)?.with_glare(&series.glare)?;
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
                .read(a, &taken, &covered, &series.pattern)
                .map_err(|e| e.to_string())
        })
        .collect();
    Ok(Seed {
        saturated,
        noise,
        figures,
    })
}
