//! What a recovery returns.

mod choice;

use nalgebra::{DMatrix, DVector};
use serde::Serialize;

use super::{Bands, ErrorField, Estimated, Gains, Method, Patterns, Problem, RecoveryError, bands};
pub use choice::{Choice, Parameter, Weighting};

/// Reflectances of `joint-tv` that differ by less are one patch's.
const ONE_VALUE: f64 = 1e-9;

/// How an iterative solver ended.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Solver {
    /// In its own words.
    pub status: String,
    /// Interior-point iterations.
    pub iterations: u32,
    /// Active-set steps after them.
    pub refinements: usize,
    /// The objective ½ Σ w_p v_l (Φ − C diag(ρ) D)², less what no ρ can change; of `joint-tv` with
    /// its penalty.
    pub objective: f64,
    /// Upper bound on the objective's distance from its minimum, same unit. Of `joint-two-valued`:
    /// from a bound that no pattern of two values can undercut; zero says that the pattern is the
    /// best of all.
    pub gap: f64,
}

/// Recovered reflectances and how they came about.
#[derive(Debug, Clone, PartialEq)]
pub struct Recovered {
    /// ρ, one per element; not clipped, except by the bounds of `joint`.
    pub reflectance: DVector<f64>,
    /// Standard error of each reflectance as the noise model makes it; none without a noise model,
    /// and none under bounds. Infinite for elements of which directions that were cut as rounding
    /// may take more: no number that these photographs give is an error of theirs. None of
    /// [`Self::rests_on_wrong_gains`].
    pub standard_error: Option<DVector<f64>>,
    /// Covariance of the reflectances (r × r) as the noise model makes it: of every method without
    /// bounds. Of the noise alone, of elements without a finite standard error as well.
    pub covariance: Option<DMatrix<f64>>,
    /// The resolution matrix R (r × r) of E ρ̂ = R ρ, of every method without bounds: (R − 1) ρ is
    /// the bias, column k the image of element k alone. It takes the parameter as given, not as
    /// chosen from the data.
    pub resolution: Option<DMatrix<f64>>,
    /// The method used.
    pub method: Method,
    /// The regularisation used.
    pub parameter: Parameter,
    /// Why that one.
    pub choice: Choice,
    /// How the entries of Φ were weighted.
    pub weighting: Weighting,
    /// Singular values of the matrix inverted, descending: D for the methods that work pixel by
    /// pixel (its standard form for `tikhonov-gradient`), the whole (weighted) operator for the
    /// joint ones. Of a large matrix of few directions only those above rounding.
    pub sigma: DVector<f64>,
    /// Singular directions that were not dropped.
    pub rank: usize,
    /// Σ of the filter factors: `rank` where directions are kept or dropped, less where they are
    /// damped.
    pub effective_rank: f64,
    /// ‖Φ − C diag(ρ) D‖, Frobenius, W.
    pub residual: f64,
    /// The same over ‖Φ‖; zero where Φ is zero.
    pub relative_residual: f64,
    /// The iterative solver's report, of the bounded methods.
    pub solver: Option<Solver>,
    /// What was estimated beside the reflectances, where it was asked for.
    pub nuisance: Option<Estimated>,
    /// ln of the probability density that the method's assumption gives the photographs, over that
    /// of the numbers that fit them best: at most 0, and comparable among methods. Of `joint-gp`
    /// and `joint-two-valued`. With factors that are known only roughly over that of the numbers
    /// that fit best without them, by Laplace's method for the factors, so that it also says (by
    /// the difference from the evidence without) whether the photographs ask for them; none then
    /// where the noise is unknown.
    pub log_evidence: Option<f64>,
    /// What is known of the pattern, of `joint-two-valued` where the scale is known.
    pub patterns: Option<Patterns>,
    /// Bands around the reflectances, where they were asked for and the method can promise any.
    pub bands: Option<Bands>,
    /// Why there are none, where they were asked for.
    pub no_bands: Option<&'static str>,
    /// κ, the pixels over which what is left over hangs together: of `joint-gp` where the noise is
    /// unknown and [`Options::frame`](super::Options::frame) is not. Its errors are those of noise
    /// of κ times the variance then, unless `field` says more.
    pub alike: Option<f64>,
    /// The errors that it takes what is left over for, where
    /// [`Options::error_field`](super::Options::error_field) asks for that.
    pub field: Option<ErrorField>,
    /// ln of how much likelier the photographs are with these errors than with noise of single
    /// pixels alone, each as large as is likeliest and with the prior that is the likeliest for it.
    pub log_likelier: Option<f64>,
    /// What was left undone, where it was stopped and this is the best till then.
    pub unfinished: Option<&'static str>,
}

impl Recovered {
    /// The same without what supposes that each entry has an error of its own: standard errors,
    /// covariance, bands, probabilities and evidence.
    #[must_use]
    pub fn without_errors(self) -> Self {
        Self {
            standard_error: None,
            covariance: None,
            log_evidence: None,
            patterns: None,
            bands: None,
            no_bands: None,
            ..self
        }
    }

    /// The same with an error d of each element beside that of the noise, which no more photographs
    /// make less: standard errors √(σ² + d²), covariance and limits of bands in proportion where
    /// there are standard errors, limits d farther where there are none.
    #[must_use]
    pub fn with_more_error(mut self, d: &DVector<f64>) -> Self {
        let more = self.standard_error.as_mut().map(|own| {
            let more = own.zip_map(d, |s, d| match s {
                s if s > 0.0 && s < f64::INFINITY => libm::hypot(s, d) / s,
                _ => 1.0,
            });
            own.component_mul_assign(&more);
            more
        });
        if let (Some(covariance), Some(more)) = (&mut self.covariance, &more) {
            *covariance = covariance.component_mul(&(more * more.transpose()));
        }
        let intervals = self.bands.iter_mut().flat_map(|b| &mut b.intervals);
        for (j, [lower, upper]) in intervals.enumerate() {
            let at = self.reflectance[j];
            let by = more.as_ref().map(|more| more[j]);
            *lower = by.map_or(*lower - d[j], |more| at - (at - *lower) * more);
            *upper = by.map_or(*upper + d[j], |more| at + (*upper - at) * more);
        }
        self
    }

    /// The bias (R − 1) ρ that regularisation gives an estimate of the reflectances `truth`; none
    /// without a resolution matrix, with a free scale, or for another number of elements. Of
    /// dropped directions ρ̂ itself knows nothing: put it in place of the truth, and the bias of
    /// `tsvd` comes out near zero.
    pub fn bias(&self, truth: &[f64]) -> Option<DVector<f64>> {
        let resolution = self.resolution.as_ref()?;
        (!self.has_free_scale() && truth.len() == resolution.ncols()).then(|| {
            let truth = DVector::from_column_slice(truth);
            resolution * &truth - truth
        })
    }

    /// What ρ̂ would photograph, s C diag(ρ̂) D and the nuisance terms found with it, pixels ×
    /// spots, W. `problem` is the one that it was recovered from, or some rows (pixels) of it.
    pub fn photographs(&self, problem: &Problem<'_>) -> DMatrix<f64> {
        let Some(found) = &self.nuisance else {
            return problem.light(&self.reflectance);
        };
        let seen = &self.reflectance * found.scale.unwrap_or(1.0);
        let (pixels, spots) = problem.phi.shape();
        let light = problem.light(&seen);
        let light = match &found.gains {
            Some(gains) => gains.times(light),
            None => light,
        };
        light + found.light(&problem.nuisance, pixels, spots)
    }

    /// Degrees of freedom ν that the recovery uses up, nuisance terms included: the trace of the
    /// resolution of a method without bounds; of one with bounds the elements between them (of
    /// `joint-tv` patches of one value count once, Tibshirani and Taylor 2012); the levels that
    /// `joint-two-valued` estimates.
    pub fn freedom_used(&self) -> f64 {
        let between = || {
            self.reflectance
                .iter()
                .copied()
                .filter(|x| !self.on_bound(*x))
        };
        let own = match self.method {
            Method::Joint | Method::Nnls => (between().count() as f64).min(self.rank as f64),
            Method::JointTv => {
                let mut values: Vec<f64> = between().collect();
                values.sort_by(f64::total_cmp);
                values.dedup_by(|a, b| (*a - *b).abs() < ONE_VALUE);
                values.len() as f64
            }
            Method::JointTwoValued if self.choice == Choice::Given => 0.0,
            Method::JointTwoValued => 2.0,
            _ => self.effective_rank,
        };
        let terms = self
            .nuisance
            .as_ref()
            .map_or(0, |n| n.freedom + usize::from(n.scale.is_some()));
        let gains = self.nuisance.as_ref().and_then(|n| n.gains.as_ref());
        own + terms as f64 + gains.map_or(0.0, Gains::freedom)
    }

    /// Elements that a bound of the method holds; none of a method without bounds.
    pub fn bounded(&self) -> usize {
        self.reflectance
            .iter()
            .filter(|x| self.on_bound(**x))
            .count()
    }

    /// Whether a bound of the method holds an element of this reflectance. With a free scale the
    /// brightest element is 1 by convention: that is the scale's degree of freedom.
    fn on_bound(&self, x: f64) -> bool {
        match self.method {
            Method::Nnls => x <= 0.0,
            Method::Joint | Method::JointTv => x <= 0.0 || x >= 1.0,
            _ => false,
        }
    }

    /// x = s ρ.
    pub fn seen(&self) -> DVector<f64> {
        let scale = self.nuisance.as_ref().and_then(|n| n.scale);
        &self.reflectance * scale.unwrap_or(1.0)
    }

    /// Whether the brightest element is the unit, because the scale is free.
    pub fn has_free_scale(&self) -> bool {
        self.nuisance.as_ref().is_some_and(|n| n.scale.is_some())
    }

    /// Adds ρ̂ ± z σ, or says why there is none.
    pub(super) fn add_gaussian_bands(&mut self, confidence: f64) -> Result<(), RecoveryError> {
        let error = self.standard_error.as_ref();
        let error = error.ok_or(bands::without_noise(self.method))?;
        let elements = self.reflectance.len() as f64;
        let whole = self.effective_rank > elements * (1.0 - 1e-12);
        let gains = self.nuisance.as_ref().and_then(|n| n.gains.as_ref());
        let scale = gains.and_then(|gains| gains.whole.as_ref());
        let found = match scale {
            _ if !whole || self.has_free_scale() => Err(bands::BIASED),
            Some(scale) => bands::scaled((&self.reflectance, error), scale.known_to, confidence),
            None => Ok(bands::gaussian(&self.reflectance, error, confidence)),
        };
        match found {
            Ok(found) => self.bands = Some(found),
            Err(why) => self.no_bands = Some(why),
        }
        Ok(())
    }

    /// Whether factors that are known only roughly were found with a pattern of two values that the
    /// photographs refute: levels and errors are then those of wrong factors.
    pub fn rests_on_wrong_gains(&self) -> bool {
        let has_gains = self.nuisance.as_ref().is_some_and(|n| n.gains.is_some());
        let exact = self.patterns.as_ref().and_then(|p| p.assumed().exact);
        has_gains && exact.is_some_and(|exact| exact < Patterns::UNLIKELY)
    }

    /// Standard errors of ∞ where what was cut as rounding may take more of an element: of
    /// reflectances ½ ± ½, ½ ‖(R − 1)_j‖ with `lost`_j = ‖(R − 1)_j‖². Of a cut that was asked for
    /// by its rank R − 1 is regularisation, and its bias no part of a standard error.
    pub(super) fn without_errors_of_the_unseen(
        mut self,
        lost: impl FnOnce() -> DVector<f64>,
    ) -> Self {
        if let (Choice::Tolerance { .. }, Some(errors)) = (self.choice, &mut self.standard_error) {
            for (error, lost) in errors.iter_mut().zip(lost().iter()) {
                if 0.5 * lost.max(0.0).sqrt() > *error {
                    *error = f64::INFINITY;
                }
            }
        }
        self
    }

    /// A recovery without parameter, weights or noise model, its residual measured.
    pub(super) fn plain(
        method: Method,
        problem: &Problem<'_>,
        reflectance: DVector<f64>,
        sigma: DVector<f64>,
        rank: usize,
    ) -> Result<Self, RecoveryError> {
        let residual = problem.misfit(&reflectance)?;
        let norms = [residual, problem.phi.norm()];
        Ok(Self::with_norms(method, norms, reflectance, sigma, rank))
    }

    /// The same with ‖Φ − C diag(ρ) D‖ and ‖Φ‖ known.
    pub(super) fn with_norms(
        method: Method,
        [residual, whole]: [f64; 2],
        reflectance: DVector<f64>,
        sigma: DVector<f64>,
        rank: usize,
    ) -> Self {
        Recovered {
            reflectance,
            standard_error: None,
            covariance: None,
            resolution: None,
            method,
            parameter: Parameter::None,
            choice: Choice::None,
            weighting: Weighting::Unweighted,
            sigma,
            rank,
            effective_rank: rank as f64,
            residual,
            relative_residual: if whole > 0.0 { residual / whole } else { 0.0 },
            solver: None,
            nuisance: None,
            log_evidence: None,
            patterns: None,
            bands: None,
            no_bands: None,
            alike: None,
            field: None,
            log_likelier: None,
            unfinished: None,
        }
    }
}
