//! Generalised cross-validation (Golub, Heath and Wahba 1979).
//!
//! Each entry of Φ is predicted from the others; the mean square of what is missed, made
//! independent of the choice of axes, is
//!
//! > V = (‖Φ P − Φ‖²/(p l)) / (1 − tr P/l)²,
//!
//! P = Σ f_i v_i v_iᵀ the projector that all p pixels share, and the least V is taken. It needs no
//! noise model. It takes the errors of the entries as independent and equal; so do the estimates
//! themselves, which weigh all entries alike, and no weights are used here either. Where the errors
//! are smaller in the weak directions than in the strong ones, as those of Monte Carlo are, it
//! therefore keeps too many directions.

use super::Data;
use crate::num::search;
use crate::recovery::Choice;

impl Data<'_> {
    /// Degrees of freedom that the filter leaves in a row of Φ, l − tr P.
    fn freedom(&self, filter: &[f64]) -> f64 {
        self.spots - filter.iter().sum::<f64>()
    }

    /// V, W².
    pub(super) fn predicted(&self, filter: &[f64]) -> f64 {
        let share = self.freedom(filter) / self.spots;
        self.residual(filter) / (self.pixels * self.spots) / (share * share)
    }

    fn gcv(&self, filter: &[f64]) -> Choice {
        Choice::Gcv {
            residual: self.residual(filter).sqrt(),
            freedom: self.freedom(filter),
            predicted: self.predicted(filter).sqrt(),
        }
    }

    /// The truncation with the least V that leaves a degree of freedom; `None` for a single spot,
    /// which leaves none.
    pub(in crate::recovery) fn kept_by_gcv(&self) -> Option<(usize, Choice)> {
        let most = self.spectrum.len().min(self.spots as usize - 1);
        let score = |kept: &usize| self.predicted(&self.spectrum.truncated(*kept));
        let kept = (1..=most).min_by(|a, b| score(a).total_cmp(&score(b)))?;
        Some((kept, self.gcv(&self.spectrum.truncated(kept))))
    }

    /// The damping λ with the least V between the smallest and the largest singular value.
    pub(in crate::recovery) fn damped_by_gcv(&self) -> Option<(f64, Choice)> {
        let sigma = self.spectrum.filtered();
        let (low, high) = (*sigma.last()?, *sigma.first()?);
        let score = |lambda: f64| -libm::log(self.predicted(&self.spectrum.damped(lambda)));
        let (lambda, _) = search::largest(low, high, score);
        Some((lambda, self.gcv(&self.spectrum.damped(lambda))))
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};

    use crate::num::linalg::svd;
    use crate::recovery::bench::{Bench, normal_stream, relative_noise};
    use crate::recovery::rule::Data;
    use crate::recovery::{Choice, Method, Options, Problem, Rule, Spectrum, recover};

    /// Where the projector has equal diagonal entries, as that of a circulant D has, V is ordinary
    /// cross-validation: each entry is left out in turn, the damped problem solved without it, and
    /// the entry predicted.
    #[test]
    fn it_is_the_error_of_entries_left_out() {
        let n = 9;
        let d = DMatrix::from_fn(n, n, |i, j| {
            let k = (i + n - j) % n;
            libm::exp(-(k.min(n - k) as f64))
        });
        let mut normal = normal_stream(31);
        let phi = DMatrix::from_fn(2, n, |_, _| normal());
        let c = DMatrix::from_element(2, n, 1.0);
        let problem = Problem::new(&phi, &c, &d, None).unwrap();
        let spectrum = Spectrum::of(&svd(&d).unwrap(), n);
        let data = Data::new(&problem, &spectrum);
        for lambda in [0.01, 0.3, 2.0] {
            let mut sum = 0.0;
            for p in 0..2 {
                for out in 0..n {
                    let (d, row) = (d.clone().remove_column(out), phi.row(p).clone_owned());
                    let row = row.remove_column(out);
                    let normal = &d * d.transpose() + DMatrix::identity(n, n) * (lambda * lambda);
                    let x: DVector<f64> = normal.lu().solve(&(&d * row.transpose())).unwrap();
                    let full = x.dot(&problem.d.column(out));
                    sum += (full - phi[(p, out)]).powi(2);
                }
            }
            let found = data.predicted(&spectrum.damped(lambda));
            assert!((found / (sum / (2.0 * n as f64)) - 1.0).abs() < 1e-10);
        }
    }

    #[test]
    #[ignore = "slow"]
    fn the_least_prediction_error_is_chosen_without_a_noise_model() {
        let bench = Bench::new(3.0, 8, 8);
        let (phi, _) = relative_noise(&bench.phi(&bench.board(2)), 1e-3, 3);
        let problem = Problem::new(&phi, &bench.c, &bench.d, None)
            .and_then(|p| p.with_grids(&[[8, 8]]))
            .unwrap();
        let rule = Options {
            rule: Rule::Gcv,
            ..Options::default()
        };
        let score = |method, options: &Options| {
            let found = recover(method, &problem, options).unwrap();
            let projected = &phi * found_projector(method, &problem, &found);
            let freedom = 120.0 - found.effective_rank;
            let residual = (projected - &phi).norm();
            (found, residual, freedom)
        };
        for method in [Method::Tsvd, Method::Tikhonov, Method::TikhonovGradient] {
            let (found, residual, freedom) = score(method, &rule);
            let Choice::Gcv {
                residual: said,
                freedom: left,
                predicted,
            } = found.choice
            else {
                panic!("{:?}", found.choice)
            };
            assert!(
                (said / residual - 1.0).abs() < 1e-9 && (left - freedom).abs() < 1e-9,
                "{method}: {said:e} {residual:e}, {left} {freedom}, {:?}",
                found.parameter
            );
            let formula = residual / (64.0f64 * 120.0).sqrt() / (freedom / 120.0);
            assert!((predicted / formula - 1.0).abs() < 1e-9, "{method}");
            // A little more or less of the parameter predicts no better.
            for factor in [0.5, 0.8, 1.25, 2.0] {
                let other = match found.parameter {
                    crate::recovery::Parameter::Rank(k) => Options {
                        rank: Some(if factor < 1.0 { k - 1 } else { k + 1 }),
                        ..Options::default()
                    },
                    crate::recovery::Parameter::Damping(x) => Options {
                        damping: Some(x * factor),
                        ..Options::default()
                    },
                    other => panic!("{other:?} of {method}"),
                };
                let (_, residual, freedom) = score(method, &other);
                assert!(residual / freedom >= said / left * (1.0 - 1e-9), "{method}");
            }
        }
    }

    /// P = D^# D by its definition, D^# from the method's answers to single spots (C = 1).
    fn found_projector(
        method: Method,
        problem: &Problem<'_>,
        found: &crate::recovery::Recovered,
    ) -> DMatrix<f64> {
        let options = match found.parameter {
            crate::recovery::Parameter::Rank(k) => Options {
                rank: Some(k),
                ..Options::default()
            },
            crate::recovery::Parameter::Damping(x) => Options {
                damping: Some(x),
                ..Options::default()
            },
            _ => Options::default(),
        };
        // Whatever its rows, C with one relative profile c̄ leaves D^# the same but for scale: X =
        // ρ ∘ C for one pixel.
        let pixels = problem.c.nrows() as f64;
        let mean = DMatrix::from_fn(1, problem.c.ncols(), |_, j| {
            problem.c.column(j).sum() / pixels
        });
        let mut sharp = DMatrix::zeros(problem.d.ncols(), problem.d.nrows());
        for l in 0..problem.d.ncols() {
            let phi = DMatrix::from_fn(1, problem.d.ncols(), |_, i| f64::from(u8::from(i == l)));
            let one = Problem::new(&phi, &mean, problem.d, None)
                .and_then(|p| p.with_grids(&[[8, 8]]))
                .unwrap();
            let x = recover(method, &one, &options).unwrap().reflectance;
            sharp
                .row_mut(l)
                .copy_from(&x.transpose().component_mul(&mean));
        }
        sharp * problem.d
    }
}
