//! What is farther off than it was said to be: parameters, gains of frames.

use nalgebra::DVector;

use super::named::few;
use super::with_unit;
use crate::lab::comparison::evidence::FIT_LEVEL;
use crate::lab::finding::listed;
use crate::lab::geometry::calibrate::{AtEdge, Calibrated, Calibration};
use crate::lab::geometry::light_left_out::LightLeftOut;
use crate::num::digits::figure;
use crate::num::statistics::sidak_threshold;
use crate::recovery::Deviations;

/// Probability of a single parameter as far off, of all that were known.
const FAR: f64 = 0.01;
/// Even light that dark frames may leave, in percents of the mean light.
const DARK_FRAMES: f64 = 1.0;

impl Calibration {
    /// Whether single parameters, or all together, are farther off than they were known to, or
    /// light that the model leaves out would explain what is left over.
    pub(super) fn is_beyond(&self) -> bool {
        let light = self.left_out_light().next().is_some();
        self.is_beyond_together() || self.far().next().is_some() || light
    }

    /// Where the photographs refute all only what explains most of the misfit.
    fn left_out_light(&self) -> impl Iterator<Item = &LightLeftOut> {
        let misfit = if self.is_refuted() {
            (self.misfit - 1.0) * self.dof
        } else {
            0.0
        };
        LightLeftOut::likely(&self.light_left_out, misfit)
    }

    /// What is said of such light.
    pub(super) fn light_beyond(&self) -> impl Iterator<Item = String> {
        self.left_out_light().map(|light| light.beware("geometry"))
    }

    /// The parameter that even light moves most, over its error, where less does than dark frames
    /// may leave.
    pub(super) fn even_light(&self) -> Option<String> {
        let rise = self.even_light_chi2?;
        let over = |f: &'_ Calibrated| f.by_even_light.map_or(0.0, |moved| moved.abs() / f.stderr);
        let most = self.geometry().max_by(|a, b| over(a).total_cmp(&over(b)))?;
        let percents = over(most).recip();
        (percents < DARK_FRAMES).then(|| {
            format!(
                "Even light of {} % of the mean that is left in the photographs would move {} by one of its errors, and \
                 raise χ² by {} where noise alone scatters it by {}: if there may be as much, `--frame-polynomial 0` \
                 estimates it, at the cost of larger errors.",
                figure(percents, 1),
                most.name,
                figure(rise * percents * percents, 1),
                figure((2.0 * self.dof).sqrt(), 2)
            )
        })
    }

    fn is_beyond_together(&self) -> bool {
        self.beforehand.is_some_and(|of| of.p < FIT_LEVEL)
    }

    /// The parameters that are.
    fn far(&self) -> impl Iterator<Item = &Calibrated> {
        let known = self.geometry().filter(|f| f.prior.is_some()).count();
        let most = sidak_threshold(FAR, known.max(1) as u64);
        self.geometry().filter(move |f| f.off() > most)
    }

    /// What is said of them.
    pub(super) fn beyond(&self) -> Option<String> {
        let said = |f: &Calibrated| format!("{} ({} σ)", f.name, figure(f.off(), 2));
        let mut far = few(self.far(), Calibrated::off, said);
        far.extend(self.beforehand.filter(|_| self.is_beyond_together()).map(|of| {
            format!(
                "all together (χ² {} of {} directions that the photographs tell, at most {} σ; P {})",
                figure(of.chi2, 3),
                of.directions,
                figure(of.largest, 2),
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

    /// What is said of unknowns that an edge of the scene holds.
    pub(super) fn at_edges(&self) -> Option<String> {
        let of = |held: &AtEdge| {
            let own = &self.found[held.index];
            format!(
                "{} at {} ({})",
                own.name,
                with_unit(own.value, 3, &own.unit),
                held.cause
            )
        };
        let held: Vec<String> = self.held.iter().map(of).collect();
        (!held.is_empty()).then(|| {
            format!(
                "Beware: the photographs would go on where the scene ends, and its edge holds {}. The errors of \
                 these do not know the edge, and the rest bends for it. Is what ends there, the wall say, as \
                 large as the scene says and where it says?",
                listed(&held)
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
