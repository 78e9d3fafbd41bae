//! Whether the gains of frames are as large as they were said to be.

use nalgebra::DVector;

use crate::lab::calibrate::{Calibrated, Calibration};
use crate::lab::evidence::FIT_LEVEL;
use crate::num::digits::figure;
use crate::recovery::Deviations;

impl Calibration {
    /// What is said where they are larger.
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
