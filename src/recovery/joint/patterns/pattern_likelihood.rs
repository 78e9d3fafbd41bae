//! The likelihood of a pattern of two levels, whatever its levels are.

use nalgebra::{DMatrix, DVector};

use super::factor::Factor;
use super::levels::{LevelFit, possible};
use super::neighbours::AlikePrior;
use crate::num::control::Control;
use crate::num::quadrature::Rule;

/// χ² = ‖R x − d‖², x_j one of two levels, given or not.
pub(super) struct PatternLikelihood<'a> {
    pub(super) r: &'a DMatrix<f64>,
    pub(super) d: &'a DVector<f64>,
    /// The light of elements that are all 1.
    pub(super) all: DVector<f64>,
    pub(super) given: Option<[f64; 2]>,
    /// To what a common factor of the light of given levels is known; else it is 1.
    pub(super) scale_error: Option<f64>,
    /// What neighbours say beforehand; else every pattern is as likely.
    pub(super) alike: Option<&'a AlikePrior>,
    pub(super) control: Control<'a>,
}

impl<'a> PatternLikelihood<'a> {
    pub(super) fn new(r: &'a DMatrix<f64>, d: &'a DVector<f64>, given: Option<[f64; 2]>) -> Self {
        let all = r.column_sum();
        Self {
            r,
            d,
            all,
            given,
            scale_error: None,
            alike: None,
            control: Control::none(),
        }
    }

    /// The light of the light elements.
    pub(super) fn lit(&self, light: &[bool]) -> DVector<f64> {
        let mut sum = DVector::zeros(self.d.len());
        for (column, _) in self.r.column_iter().zip(light).filter(|(_, light)| **light) {
            sum += column;
        }
        sum
    }

    /// The light of all elements, of these levels, by that of the light ones.
    pub(super) fn light(&self, lit: &DVector<f64>, [dark, light]: [f64; 2]) -> DVector<f64> {
        &self.all * dark + lit * (light - dark)
    }
}

/// A pattern's weight, exp(−½ χ²) over all its levels and factors, times what neighbours say
/// beforehand.
pub(super) struct Weighed {
    /// ln of it.
    pub(super) log: f64,
    /// Means of the dark and the light level under it, and of their squares.
    pub(super) levels: [[f64; 2]; 2],
    /// χ² of its best levels or factor; infinite where these cannot be.
    pub(super) chi2: f64,
}

impl Weighed {
    /// Mean of the light level less that of the dark one.
    pub(super) fn contrast(&self) -> f64 {
        self.levels[1][0] - self.levels[0][0]
    }
}

impl PatternLikelihood<'_> {
    /// ln of how much likelier a pattern is beforehand than of fair coins; none where it cannot be.
    pub(super) fn beforehand(&self, light: &[bool]) -> Option<f64> {
        self.alike.map_or(Some(0.0), |prior| prior.log(light))
    }

    /// A pattern's weight over levels that differ by these contrasts, where they are not given;
    /// none where levels are not told apart or none can be.
    pub(super) fn weigh(
        &self,
        light: &[bool],
        rule: &Rule,
        contrasts: [f64; 2],
    ) -> Option<Weighed> {
        let beforehand = self.beforehand(light)?;
        let count = light.iter().filter(|light| **light).count();
        let lit = (&self.lit(light), count);
        let weighed = self.weigh_lit(lit, rule, contrasts, f64::NEG_INFINITY)?;
        Some(Weighed {
            log: weighed.log + beforehand,
            ..weighed
        })
    }

    /// The same of the light of so many light elements, whatever neighbours say, unless ln of it is
    /// less than `least` whatever its levels are.
    pub(super) fn weigh_lit(
        &self,
        (lit, count): (&DVector<f64>, usize),
        rule: &Rule,
        contrasts: [f64; 2],
        least: f64,
    ) -> Option<Weighed> {
        if let Some([dark, light]) = self.given {
            let m = self.light(lit, [dark, light]);
            let (log, chi2) = match self.scale_error {
                Some(sigma) => {
                    let factor = Factor::new(&m, self.d, sigma);
                    (factor.log, factor.chi2)
                }
                None => {
                    let chi2 = (self.d - m).norm_squared();
                    (-0.5 * chi2, chi2)
                }
            };
            return Some(Weighed {
                log,
                levels: [dark, light].map(|x| [x, x * x]),
                chi2,
            });
        }
        if count == 0 || count == self.r.ncols() {
            return self.one_level(count > 0, rule);
        }
        let fit = LevelFit::new(self.d, &(&self.all - lit), lit)?;
        if -0.5 * fit.chi2 < least {
            return None;
        }
        let weight = fit.weight(rule, contrasts)?;
        Some(Weighed {
            log: weight.log,
            levels: weight.moments,
            chi2: if possible(fit.best) {
                fit.chi2
            } else {
                f64::INFINITY
            },
        })
    }

    /// Of a pattern without light elements or without dark ones: of the one level x that is seen,
    /// with what remains for the other, 2 (1 − x) or 2 x, by quadrature.
    fn one_level(&self, light: bool, rule: &Rule) -> Option<Weighed> {
        let (own, along) = (self.all.norm_squared(), self.all.dot(self.d));
        let (best, sd) = (along / own, own.sqrt().recip());
        let middle = best.clamp(0.0, 1.0);
        let (low, high) = ((middle - 9.0 * sd).max(0.0), (middle + 9.0 * sd).min(1.0));
        let least = (self.d - &self.all * middle).norm_squared();
        // χ² above the least, without the cancellation of large numbers.
        let more = |x: f64| own * (x - middle) * (x + middle - 2.0 * best);
        let (mut sum, mut moments) = (0.0, [[0.0; 2]; 2]);
        for (x, weight) in rule.on(low, high) {
            let room = if light { x } else { 1.0 - x };
            let own = weight * 2.0 * room * libm::exp(-0.5 * more(x));
            sum += own;
            // The level that is not seen lies evenly in [0, x] or [x, 1].
            let (from, to) = if light { (0.0, x) } else { (x, 1.0) };
            let unseen = [(from + to) / 2.0, (from * from + from * to + to * to) / 3.0];
            let levels = if light {
                [unseen, [x, x * x]]
            } else {
                [[x, x * x], unseen]
            };
            for (moment, level) in moments.iter_mut().zip(levels) {
                moment[0] += own * level[0];
                moment[1] += own * level[1];
            }
        }
        (sum > 0.0).then(|| Weighed {
            log: -0.5 * least + libm::log(sum),
            levels: moments.map(|m| m.map(|x| x / sum)),
            chi2: least,
        })
    }
}
