//! What is known of standard errors.

use super::counted::Counted;
use crate::num::digits::figure;
use crate::num::named::named;
use crate::num::statistics::{chi_square_sf, student_to_normal, unskewed};
use crate::transport::{Estimator, Plan};

named! {
    /// How the errors of traced entries hang together.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum Errors {
        /// Every entry has its own random numbers.
        Independent = "independent": "None",
        /// Entries of one pixel share theirs: only different rows are independent.
        WithinRows = "pixel": "Those of one pixel, as of estimator shared",
        /// All entries share theirs.
        Everywhere = "all": "All, as of estimator factored",
    }
}

/// A part that is common, times the spots, above which errors are no longer independent: 5 % of the
/// error of their mean.
const NOTICED: f64 = 0.1;

impl Errors {
    /// Those of an estimator.
    pub fn of(estimator: Estimator) -> Self {
        match estimator {
            Estimator::Independent => Self::Independent,
            Estimator::Shared => Self::WithinRows,
            Estimator::Factored => Self::Everywhere,
        }
    }

    /// Those of photographs of `spots` spots, a part `common` of whose variance all spots of a
    /// pixel have in common: the error of their mean is √(1 + c (l − 1)) times that of independent
    /// ones.
    pub fn of_common(common: f64, spots: usize) -> Self {
        Self::of_photographs(common * spots as f64 > NOTICED)
    }

    /// Those of photographs, all spots of a pixel of which share some or not.
    pub fn of_photographs(shares_by_pixel: bool) -> Self {
        if shares_by_pixel {
            Self::WithinRows
        } else {
            Self::Independent
        }
    }

    /// Which entries share their errors, in words: a recovery adds up entries as if none did.
    pub fn shared(self) -> Option<&'static str> {
        match self {
            Self::Independent => None,
            Self::WithinRows => Some("all spots of a pixel share theirs"),
            Self::Everywhere => Some("all entries share theirs"),
        }
    }
}

/// That errors of which entries share `which` do not average out, in what is found of `what`, and
/// the cure.
pub(in crate::lab) fn hang_together([which, cure]: [&str; 2], what: &str) -> String {
    format!(
        "The errors of these photographs HANG TOGETHER: {which}, and they do not average out. Those of \
         {what} take each entry's for its own, and may be several times too small. {cure}."
    )
}

/// What gives each entry errors of its own: of a render, and of photographs.
const RENDERED: &str = "Render by --estimator independent";
const PHOTOGRAPHED: &str =
    "Take more of the dark frames that all spots share, or estimate their part (--background)";

/// What errors were pooled from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PooledFrom {
    /// Replicates of each.
    pub replicates: u32,
    /// What is expected of the square of a deviate over them, and of its fourth power.
    pub squares: [f64; 2],
    /// E σ²/s⁴ over E 1/s², s the pooled errors and σ those that they estimate: how many times too
    /// small a variance is that takes s for σ, of what all entries change alike with; of smoothed
    /// errors, of what they change with in proportion to their light.
    pub variance: f64,
}

/// Errors that are too small by less are right: those from 32 replicates.
const TOO_SMALL: f64 = 1.075;

/// How many times too small, in words.
pub(in crate::lab) fn times_too_small(times: f64) -> String {
    if times.is_finite() {
        format!("about {} times TOO SMALL", figure(times, 2))
    } else {
        "several times TOO SMALL".to_owned()
    }
}

/// What is known of standard errors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Certainty {
    /// How the errors of the entries hang together.
    pub errors: Errors,
    /// Replicates from which each was estimated, or as from which it is known; none where they are
    /// known.
    pub replicates: Option<u32>,
    /// Paths of each entry, of traced light.
    pub paths: Option<u64>,
    /// From what each was estimated before those of pixels and spots were pooled; none where they
    /// were not.
    pub pooled_from: Option<PooledFrom>,
    /// Whether they follow from the noisy entries, and what light to expect in these is not known.
    pub follows_entries: bool,
    /// Where they are those of counts.
    pub counted: Option<Counted>,
    /// Variance of their squares over the squares of these, where all are off alike: those of a
    /// camera whose gain was estimated.
    pub unknown: f64,
}

impl Certainty {
    /// Errors of their own for all entries, their size known.
    pub const STATED: Self = Self::new(Errors::Independent, None);

    /// Errors that were each estimated from so many replicates.
    pub const fn new(errors: Errors, replicates: Option<u32>) -> Self {
        Self {
            errors,
            replicates,
            paths: None,
            pooled_from: None,
            follows_entries: false,
            counted: None,
            unknown: 0.0,
        }
    }

    /// What a render leaves.
    pub fn of(plan: &Plan) -> Self {
        Self {
            paths: Some(plan.budget.samples()),
            ..Self::new(Errors::of(plan.estimator), Some(plan.budget.blocks))
        }
    }

    /// The same, known as from so many `replicates` where that is said.
    #[must_use]
    pub fn or(self, replicates: Option<u32>) -> Self {
        Self {
            replicates: replicates.or(self.replicates),
            ..self
        }
    }

    /// Which entries share their errors, and what gives each its own, in words; none where none do.
    /// No photographs share theirs among all entries.
    pub(in crate::lab) fn shared(self) -> Option<[&'static str; 2]> {
        let which = self.errors.shared()?;
        let is_render = self.paths.is_some() || self.errors == Errors::Everywhere;
        Some([which, if is_render { RENDERED } else { PHOTOGRAPHED }])
    }

    /// As from how many replicates errors are known where they were pooled.
    pub fn pooled(self) -> Option<u32> {
        self.pooled_from.and(self.replicates)
    }

    /// Degrees of freedom of each standard error; many where it is known.
    pub(in crate::lab) fn freedom(self) -> f64 {
        freedom(self.replicates.unwrap_or(u32::MAX))
    }

    /// The standard normal deviate as improbable as a deviate over a standard error, of noise that
    /// is normal.
    pub(in crate::lab) fn normal(self, t: f64) -> f64 {
        match self.replicates {
            Some(_) => student_to_normal(t, self.freedom()),
            None => t,
        }
    }

    /// The standard error, W, of an entry of which this light is expected: of counts its own, not
    /// that `given`.
    pub(in crate::lab) fn stderr(self, light: f64, given: f64) -> f64 {
        let own = self.counted.filter(|_| given > 0.0);
        own.and_then(|own| own.law.stderr(light)).unwrap_or(given)
    }

    /// The same of such a z, where the noise over this standard error, W, is that of counts.
    pub(in crate::lab) fn of_counts(self, z: f64, stderr: f64) -> f64 {
        match self.counted.filter(|_| stderr > 0.0) {
            Some(counted) => unskewed(z, counted.skewness(stderr)),
            None => z,
        }
    }

    /// Degrees of freedom of the sum of so many squared deviates. Pooled errors share those of what
    /// was pooled: of ν each the mean variance is known to 2/(ν N) of itself; of counts the
    /// variance of a square is 2 + κ; all may be off alike by u:
    ///
    /// > Var Σz²/N = 2/N (1 + 1/ν),   2/N (1 + κ/2 + N u²/2)
    pub(in crate::lab) fn of_chi2(self, squares: f64) -> f64 {
        match self.pooled_from.map(|own| freedom(own.replicates)) {
            Some(own) => squares * own / (own + 1.0),
            None => squares / (1.0 + 0.5 * (self.excess() + squares * self.unknown)),
        }
    }

    /// The square of a deviate t over a standard error, 1 on average: of pooled errors over
    /// [`PooledFrom::squares`], whatever the law of σ², else of the normal deviate as improbable.
    pub(in crate::lab) fn square(self, t: f64) -> f64 {
        match self.pooled_from {
            Some(own) => t * t / own.squares[0],
            None => self.normal(t.abs()).powi(2),
        }
    }

    /// Degrees of freedom of the sum of so many of these: of pooled errors by the variance of t².
    pub(in crate::lab) fn of_squares(self, count: f64) -> f64 {
        match self.pooled_from {
            Some(own) => {
                let [square, fourth] = own.squares;
                let each = 0.5 * (fourth / (square * square) - 1.0);
                count / (each + 1.0 / freedom(own.replicates))
            }
            None => self.of_chi2(count),
        }
    }

    /// κ of counts.
    fn excess(self) -> f64 {
        self.counted.map_or(0.0, |own| own.excess)
    }

    /// How many times too small errors are of what is fitted with weights of 1/s², as if the
    /// standard errors s were known: the fit has the variance Σ σ²/s⁴ over (Σ 1/s²)², and states
    /// 1/Σ 1/s². Of ν degrees of freedom the ratio is ν/(ν − 4), without end up to 4. None where
    /// they are known, or well enough.
    pub(in crate::lab) fn too_small(self) -> Option<f64> {
        let nu = freedom(self.replicates?);
        let variance = match self.pooled_from {
            Some(own) => own.variance,
            None if nu > 4.0 => nu / (nu - 4.0),
            None => f64::INFINITY,
        };
        let times = variance.sqrt();
        (times > TOO_SMALL).then_some(times)
    }

    /// Probability of as large a sum χ² of squared deviates over standard errors by noise alone. Of
    /// errors of ν > 4 degrees of freedom each square is that of Student's t, of mean ν/(ν − 2) and
    /// variance 2 (ν − 1)/(ν − 4) times the square of that, of pooled ones that of
    /// [`PooledFrom::squares`], and of counts the variance 2 + κ: χ² is compared as one of that
    /// mean and variance.
    pub(in crate::lab) fn by_noise(self, chi2: f64, dof: f64) -> f64 {
        let nu = self.freedom();
        let [mean, fewer] = match (self.pooled_from, self.replicates) {
            (Some(own), _) => [own.squares[0], self.of_squares(dof)],
            (None, Some(_)) if nu > 4.0 => [nu / (nu - 2.0), dof * (nu - 4.0) / (nu - 1.0)],
            (None, _) => [1.0, self.of_chi2(dof)],
        };
        chi_square_sf(chi2 / dof / mean * fewer, fewer)
    }
}

/// Standard errors 1/√n beyond which a correlation of what is left of neighbours is no chance.
pub(super) const BEYOND_CHANCE: f64 = 6.0;

/// The correlation of what is left of neighbouring pixels, over `entries` entries of independent
/// noise (of variances unknown as many as have the scatter √Σ (z z′)² of Σ z z′), where chance
/// leaves none so large; `beside` is Σ z z′ over neighbours and `squares` Σ z².
pub(in crate::lab) fn correlated(beside: f64, squares: f64, entries: f64) -> Option<f64> {
    let correlation = beside / squares;
    (correlation * entries.sqrt() > BEYOND_CHANCE).then_some(correlation)
}

/// What is said of it, in what is found of `what`.
pub(in crate::lab) fn neighbours_share(correlation: f64, what: &str) -> String {
    format!(
        "what is left of neighbouring pixels HANGS TOGETHER (correlation {}): they share noise, as where \
         photographs were resampled or blurred, or the model lacks something smooth. Bin the pixels until \
         it is gone, or take --error-field, with no noise stated; {what}",
        figure(correlation, 2)
    )
}

/// A χ²/dof below this, and as seldom by chance, is not that of independent noise.
const CLOSE: f64 = 0.95;
const SELDOM: f64 = 1e-6;

/// Whether photographs are closer than noise of their standard errors lets them be, by χ²/dof and
/// the probability of as large a one: the errors are too large, or entries share them.
pub(in crate::lab) fn fits_better(chi2_per_dof: f64, p: f64) -> bool {
    chi2_per_dof < CLOSE && 1.0 - p < SELDOM
}

/// What is said of errors that follow from noisy entries, of whatever is estimated by them.
pub(in crate::lab) const FOLLOWS_ENTRIES: &str = "the standard errors of the photographs follow from their noisy entries (√n of counts, a share of each): entries that noise has made darker count more, and the light as a whole seems too dark. Of fewer than 8 pixels or spots it is not known what light to expect; give errors of the mean light";

/// Degrees of freedom of a standard error from so many replicates.
pub(super) fn freedom(replicates: u32) -> f64 {
    f64::from(replicates.max(2) - 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::num::statistics::fisher_sf;

    /// N squares over one variance that was pooled from ν degrees of freedom each have the law of
    /// Fisher of N and ν N: of 400 entries from 3 replicates 5 % lie where χ² says 5 %, to a tenth
    /// of itself. As if the variance were known 9 % would. One variance of all that is known from ν
    /// degrees of freedom, u² = 2/ν, is Fisher's of N and ν.
    #[test]
    fn squares_over_a_pooled_variance_follow_fishers_law() {
        let pooled = Certainty {
            replicates: Some(500),
            pooled_from: Some(PooledFrom {
                replicates: 3,
                squares: [1.0, 3.0],
                variance: 1.0,
            }),
            ..Certainty::STATED
        };
        let camera = Certainty {
            unknown: 2.0 / 800.0,
            ..Certainty::STATED
        };
        let entries = 400.0;
        for (known, nu, least, most) in [
            (pooled, 2.0, 0.045, 0.055),
            (camera, 2.0, 0.045, 0.055),
            (Certainty::STATED, 2.0, 0.08, 0.1),
        ] {
            let dof = known.of_chi2(entries);
            // χ²/dof that is exceeded in 5 %.
            let [mut low, mut high] = [1.0, 2.0];
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                if chi_square_sf(middle * dof, dof) > 0.05 {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            let p = fisher_sf(low, entries, nu * entries);
            assert!((least..most).contains(&p), "{p}");
        }
    }
}
