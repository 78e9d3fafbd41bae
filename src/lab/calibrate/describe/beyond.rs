//! What is farther off than it was said to be: parameters, gains of frames.

use nalgebra::DVector;

use crate::lab::calibrate::{Calibrated, Calibration};
use crate::lab::evidence::FIT_LEVEL;
use crate::lab::finding::listed;
use crate::num::digits::figure;
use crate::recovery::Deviations;

/// An estimate farther from the scene than this, in the scatter that what was known beforehand lets
/// expect, is told.
const FAR: f64 = 3.0;
/// Of a prior's variance what is always counted as told: an error is known to no better.
const LEAST: f64 = 0.01;

impl Calibration {
    /// Whether what was known beforehand does not hold the parameters together.
    pub(super) fn is_beyond(&self) -> bool {
        self.beforehand.is_some_and(|of| of.p < FIT_LEVEL)
    }

    /// What is said where single parameters, or all together, are farther off than they were known
    /// to.
    pub(super) fn beyond(&self) -> Option<String> {
        let far = self.geometry().filter_map(|f| {
            let prior = f.prior?;
            // The estimate is drawn to 0: its expected scatter is √(prior² − error²).
            let scatter = (prior * prior - f.by_curvature * f.by_curvature)
                .max(LEAST * prior * prior)
                .sqrt();
            (f.value.abs() > FAR * scatter)
                .then(|| format!("{} ({} σ)", f.name, figure(f.value.abs() / scatter, 2)))
        });
        let mut far: Vec<String> = far.collect();
        far.extend(self.beforehand.filter(|_| self.is_beyond()).map(|of| {
            format!(
                "all together (χ² {} of {} directions that the photographs tell, P {})",
                figure(of.chi2, 3),
                of.directions,
                figure(of.p, 1)
            )
        }));
        (!far.is_empty()).then(|| {
            format!(
                "Beware: farther from the scene than what was known beforehand allows: {}. Either that was \
                 stated too well, or the geometry takes up what the model lacks (a wall or surface that \
                 is not matt, other light, another order of the spots), and its errors do not hold that.",
                listed(&far)
            )
        })
    }

    /// What is said where gains are larger.
    pub(super) fn gains_beyond(&self) -> Option<String> {
        let gains: Vec<&Calibrated> = self.gains().collect();
        let known_to = gains.first()?.prior?;
        let of = |each: fn(&Calibrated) -> f64| {
            DVector::from_iterator(gains.len(), gains.iter().map(|g| each(g)))
        };
        let deviations = Deviations {
            size: of(|g| g.value),
            // By the curvature: what the photographs leave of what was known beforehand.
            standard_error: of(|g| g.by_curvature),
            known_to,
            picture_given: false,
        };
        let p = deviations.probability().filter(|p| *p < FIT_LEVEL)?;
        let largest = gains[deviations.size.iamax()];
        Some(format!(
            "Beware: the gains of the frames are LARGER than the {} % that was known beforehand (P {}; {} {} %): errors \
             of the geometry are too small. Give a larger --frame-gain, or leave frames out that are off otherwise \
             (--left-out).",
            figure(100.0 * known_to, 2),
            figure(p, 2),
            largest.name,
            figure(100.0 * largest.value, 2),
        ))
    }
}
