//! One laser side, many photographs and parameters.
//!
//! Of D = U Σ Vᵀ every direction i adds its own part to what `pinv`, `tsvd` and `tikhonov` recover,
//!
//! > ρ_j = Σ_i f_i a_ij,   a_ij = (u_ji/σ_i) · (1/p) Σ_p (Φ V)\[p,i\]/C\[p,j\],
//!
//! and only the filter factors f_i know of the parameter. So D is decomposed once, the parts are
//! summed once for each Φ (p·l·k + p·k·r operations for p pixels, l spots, r elements, k
//! directions), and one more parameter costs k·r.

use nalgebra::{DMatrix, DVector};

use super::{damping, decompose, refuse_unseen, tsvd};
use crate::num::linalg::{Tolerance, product, tr_product};
use crate::recovery::{Choice, Method, Options, Parameter, Problem, RecoveryError, Rule, Spectrum};

/// The laser side decomposed as far as rounding allows.
pub struct LaserSide {
    spectrum: Spectrum,
}

/// What each direction of a laser side adds to the reflectances that given photographs show.
pub struct Parts<'s> {
    spectrum: &'s Spectrum,
    /// a_ij, k × r.
    parts: DMatrix<f64>,
}

impl LaserSide {
    /// Decomposes D of `problem`.
    ///
    /// # Errors
    /// [`RecoveryError::Unseen`] where C cannot be divided by, [`RecoveryError::RankZero`] where D
    /// is zero.
    pub fn new(problem: &Problem<'_>) -> Result<Self, RecoveryError> {
        let laser = decompose(Method::Pinv, problem, Tolerance::Auto)?;
        let (rank, _) = laser.cut(Tolerance::Auto)?;
        Ok(LaserSide {
            spectrum: Spectrum::of(&laser, rank),
        })
    }

    /// Singular values of D above rounding, descending: as many directions as `pinv` inverts.
    pub fn sigma(&self) -> &[f64] {
        self.spectrum.filtered()
    }

    /// The parameter that [`recover`](crate::recovery::recover) gives `tsvd` or `tikhonov` by the
    /// discrepancy principle, and that of `pinv`; `problem` has the D of this laser side.
    ///
    /// # Errors
    /// What the rule refuses; [`RecoveryError::NotForMethod`] for other methods.
    pub fn automatic(
        &self,
        method: Method,
        problem: &Problem<'_>,
    ) -> Result<(Parameter, Choice), RecoveryError> {
        problem.refuse_darkness()?;
        match method {
            Method::Pinv => Ok((Parameter::Rank(self.sigma().len()), Choice::None)),
            Method::Tsvd => tsvd::choose(problem, Rule::Discrepancy, &self.spectrum)
                .map(|(rank, choice)| (Parameter::Rank(rank), choice)),
            Method::Tikhonov => {
                damping::choose(method, problem, &Options::default(), &self.spectrum)
                    .map(|(damping, choice)| (Parameter::Damping(damping), choice))
            }
            _ => Err(RecoveryError::NotForMethod {
                method,
                what: "does not work by the singular directions of the laser side",
                cure: "use pinv, tsvd or tikhonov",
            }),
        }
    }

    /// What each direction adds; `problem` has the D of this laser side.
    ///
    /// # Errors
    /// [`RecoveryError::Unseen`] where C cannot be divided by.
    pub fn parts(&self, problem: &Problem<'_>) -> Result<Parts<'_>, RecoveryError> {
        refuse_unseen(Method::Pinv, problem)?;
        let seen = product(problem.phi, &self.spectrum.data.transpose());
        let mean = tr_product(&seen, &problem.c.map(|x| 1.0 / x)) / problem.c.nrows() as f64;
        Ok(Parts {
            spectrum: &self.spectrum,
            parts: mean.component_mul(&self.spectrum.solution),
        })
    }
}

impl Parts<'_> {
    /// The reflectances for a number of directions kept, or a damping as a fraction of the largest
    /// singular value; `None` for other parameters.
    pub fn reflectance(&self, parameter: Parameter) -> Option<DVector<f64>> {
        let filter = match parameter {
            Parameter::Rank(kept) => self.spectrum.truncated(kept),
            Parameter::Damping(damping) => self.spectrum.damped(damping * self.spectrum.sigma[0]),
            _ => return None,
        };
        Some(self.parts.tr_mul(&DVector::from_vec(filter)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recovery::bench::{Bench, relative_noise};
    use crate::recovery::recover;

    /// The parts make what `recover` makes, for every method, parameter and noise, with the
    /// parameter that it chooses.
    #[test]
    fn parts_add_up_to_the_recovery() {
        let bench = Bench::new(3.0, 8, 9);
        for (noise, seed) in [(1e-5, 1), (1e-2, 2)] {
            let (phi, stderr) = relative_noise(&bench.phi(&bench.board(2)), noise, seed);
            let problem = Problem::new(&phi, &bench.c, &bench.d, Some(&stderr)).unwrap();
            let side = LaserSide::new(&problem).unwrap();
            let parts = side.parts(&problem).unwrap();
            let same = |method, options: &Options, parameter| {
                let known = recover(method, &problem, options).unwrap();
                let found = parts.reflectance(parameter).unwrap();
                // Both sum the same terms in another order: some hundred roundings of the largest
                // value.
                let scale = known.reflectance.amax();
                let off = (&found - &known.reflectance).amax();
                assert!(off < 1e-10 * scale, "{method}: {off:e} of {scale:e}");
                known
            };
            for rank in [1, 5, 30] {
                let options = Options {
                    rank: Some(rank),
                    ..Options::default()
                };
                same(Method::Tsvd, &options, Parameter::Rank(rank));
            }
            for damping in [1e-1, 1e-4] {
                let options = Options {
                    damping: Some(damping),
                    ..Options::default()
                };
                same(Method::Tikhonov, &options, Parameter::Damping(damping));
            }
            for method in [Method::Pinv, Method::Tsvd, Method::Tikhonov] {
                let (parameter, choice) = side.automatic(method, &problem).unwrap();
                let known = same(method, &Options::default(), parameter);
                assert_eq!(known.parameter, parameter, "{method}");
                if method != Method::Pinv {
                    assert_eq!(known.choice, choice, "{method}");
                }
                assert_eq!(
                    known.sigma.rows(0, side.sigma().len()).as_slice(),
                    side.sigma()
                );
            }
        }
    }

    #[test]
    fn what_it_cannot_do_is_refused() {
        let bench = Bench::new(3.0, 2, 2);
        let phi = bench.phi(&bench.board(2));
        let problem = Problem::new(&phi, &bench.c, &bench.d, None).unwrap();
        let side = LaserSide::new(&problem).unwrap();
        let of = |method| side.automatic(method, &problem).unwrap_err();
        assert!(matches!(
            of(Method::Tsvd),
            RecoveryError::NoNoiseModel { .. }
        ));
        assert!(matches!(
            of(Method::Joint),
            RecoveryError::NotForMethod { .. }
        ));
        let parts = side.parts(&problem).unwrap();
        assert!(parts.reflectance(Parameter::None).is_none());
        let mut c = bench.c.clone();
        c[(3, 1)] = 0.0;
        let unseen = Problem::new(&phi, &c, &bench.d, None).unwrap();
        assert!(matches!(
            side.parts(&unseen),
            Err(RecoveryError::Unseen { .. })
        ));
        assert!(LaserSide::new(&unseen).is_err());
    }
}
