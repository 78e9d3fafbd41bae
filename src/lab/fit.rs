//! Does a recovered picture explain the photographs it was recovered from?
//!
//! Every method answers with reflectances ρ̂; what they would photograph is
//!
//! > Φ̂\[p,l\] = s Σ_j C\[p,j\] ρ̂_j D\[j,l\] + other light that was estimated with them,
//!
//! whether the method worked pixel by pixel, with bounds or without. Then
//!
//! > χ² = Σ z²,   z = (Φ − Φ̂)/σ   over the N entries whose standard error σ is not zero,
//!
//! has the mean N − ν if the picture is right, ν the degrees of freedom that it used up
//! ([`Recovered::freedom_used`]). Where σ was estimated from K replicates z is the normal deviate of
//! the same tail probability as Student's t of K − 1 degrees of freedom.
//!
//! χ²/(N − ν) is compared with χ² of N − ν degrees of freedom where entries are independent, of
//! fewer where those of a row are not, of one where all hang together ([`Errors`]).

use serde::Serialize;

use super::agreement::freedom_of_rows;
use super::evidence::{Errors, freedom};
use crate::matrix::Matrix;
use crate::num::statistics::{chi_square_sf, student_to_normal};
use crate::recovery::{
    Determined, Method, Options, Problem, Recovered, WeightRule, determined, recover,
};
use crate::transport::Plan;

/// A picture that explains the photographs is rejected with this probability.
pub const FIT_LEVEL: f64 = 1e-3;

/// Elements up to which the best picture of all is looked for where no method that was asked for
/// gives it.
const MOST_ELEMENTS: usize = 1024;

/// Elements up to which what the photographs determine is computed.
const MOST_DECOMPOSED: usize = 2048;

/// What is known of standard errors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Certainty {
    /// How the errors of the entries hang together.
    pub errors: Errors,
    /// Replicates from which each was estimated; none where they are known.
    pub replicates: Option<u32>,
}

impl Certainty {
    /// Errors of their own for all entries, their size known.
    pub const STATED: Self = Self {
        errors: Errors::Independent,
        replicates: None,
    };

    /// What a render leaves.
    pub fn of(plan: &Plan) -> Self {
        Self {
            errors: Errors::of(plan.estimator),
            replicates: Some(plan.budget.blocks),
        }
    }
}

/// How well what was recovered explains the photographs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Fit {
    /// χ²/(N − ν): 1 on average for a picture that explains them.
    pub chi2_per_dof: f64,
    /// Degrees of freedom of the χ² that it is compared with.
    pub dof: f64,
    /// Probability of as large a χ² if noise alone were left over.
    pub p: f64,
    /// Entries compared, N.
    pub entries: usize,
    /// Entries left out, because they do not count or their standard error is zero.
    pub left_out: usize,
    /// Below this p the picture is refuted.
    pub level: f64,
    /// Whether it is not.
    pub fits: bool,
}

/// Squared deviates, summed row after row.
#[derive(Debug, Default)]
pub struct Residuals {
    sums: Vec<f64>,
    entries: usize,
    left_out: usize,
}

impl Residuals {
    /// Adds rows (pixels): the photographs, what the picture would photograph, and the standard
    /// errors, W.
    pub fn add(&mut self, phi: &Matrix, seen: &Matrix, stderr: &Matrix, certainty: Certainty) {
        let freedom = certainty.replicates.map(freedom);
        for p in 0..phi.nrows() {
            let mut sum = 0.0;
            for l in 0..phi.ncols() {
                let at = (p, l);
                if stderr[at] <= 0.0 {
                    self.left_out += 1;
                    continue;
                }
                self.entries += 1;
                let t = ((phi[at] - seen[at]) / stderr[at]).abs();
                let z = freedom.map_or(t, |freedom| student_to_normal(t, freedom));
                sum += z * z;
            }
            self.sums.push(sum);
        }
    }

    /// The fit of a picture that used up so many degrees of freedom; none where no entry has a
    /// standard error, and where the picture has as many unknowns as there are entries.
    pub fn fit(&self, used: f64, errors: Errors) -> Option<Fit> {
        let entries = self.entries as f64;
        let left = entries - used;
        if left < 0.5 {
            return None;
        }
        let chi2_per_dof = self.sums.iter().sum::<f64>() / left;
        let dof = match errors {
            Errors::Independent => left,
            Errors::WithinRows => freedom_of_rows(&self.sums, self.entries) * left / entries,
            Errors::Everywhere => 1.0,
        };
        let p = chi_square_sf(chi2_per_dof * dof, dof);
        Some(Fit {
            chi2_per_dof,
            dof,
            p,
            entries: self.entries,
            left_out: self.left_out,
            level: FIT_LEVEL,
            fits: p >= FIT_LEVEL,
        })
    }
}

/// The fit of `found` to the photographs of `problem`.
fn fit(
    problem: &Problem<'_>,
    (stderr, certainty): (&Matrix, Certainty),
    found: &Recovered,
) -> Option<Fit> {
    let mut residuals = Residuals::default();
    let seen = found.photographs(problem);
    let stderr = problem.counted(stderr.clone());
    residuals.add(problem.photographed(), &seen, &stderr, certainty);
    residuals.fit(found.freedom_used(), certainty.errors)
}

/// What the best picture of all can do: whether photographs and matrices belong together, whatever
/// the method.
#[derive(Clone, Debug, PartialEq)]
pub struct Attainable {
    /// Of all reflectances between 0 and 1 (above 0, where the scale is free): of `joint`.
    pub possible: Fit,
    /// Of all numbers: of `joint-unbounded`.
    pub any: Option<Fit>,
    /// The photographs over those of a surface that is white throughout, by least squares: at most
    /// 1 for any surface. 1 with a free scale.
    pub brightness: f64,
}

impl Attainable {
    /// The best among what was `found` already, looked for where it is not there; none without a
    /// noise model, and where there are too many elements for a search that no one asked for.
    pub(super) fn of(
        problem: &Problem<'_>,
        noise: (&Matrix, Certainty),
        found: &[&Recovered],
        options: &Options,
    ) -> Option<Self> {
        let weighted = options.weighting != WeightRule::Unweighted;
        let options = Options {
            bands: None,
            weighting: WeightRule::Noise,
            ..*options
        };
        let by = |method: Method| -> Option<Fit> {
            let known = found.iter().find(|f| f.method == method);
            if let Some(known) = known.filter(|_| weighted) {
                return fit(problem, noise, known);
            }
            if problem.elements() > MOST_ELEMENTS {
                return None;
            }
            let searched = recover(method, problem, &options).ok()?;
            fit(problem, noise, &searched)
        };
        let scale = |f: &&Recovered| f.nuisance.as_ref().and_then(|n| n.scale);
        let free = found.iter().any(|f| scale(f).is_some());
        Some(Self {
            possible: by(Method::Joint)?,
            any: by(Method::JointUnbounded),
            brightness: if free { 1.0 } else { problem.brightness() },
        })
    }
}

/// How far a recovery is to be believed, as the photographs themselves say.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Judged {
    /// Its fit; none where it cannot be judged.
    pub fit: Option<Fit>,
    /// That of the best picture of all, where it is known.
    pub best: Option<Attainable>,
    /// What the photographs determine of each element, where it is known.
    pub determined: Option<Determined>,
}

impl Judged {
    /// What holds for every method: the best of all that was `found` and can be found, and what the
    /// photographs determine.
    pub(super) fn any(
        problem: &Problem<'_>,
        noise: Option<(&Matrix, Certainty)>,
        found: &[&Recovered],
        options: &Options,
    ) -> Self {
        let few = problem.elements() <= MOST_DECOMPOSED && !found.is_empty();
        Self {
            fit: None,
            best: noise
                .filter(|_| !found.is_empty())
                .and_then(|noise| Attainable::of(problem, noise, found, options)),
            determined: few.then(|| determined(problem).ok()).flatten(),
        }
    }

    /// The same with the fit of `found`.
    pub(super) fn of(
        &self,
        problem: &Problem<'_>,
        noise: Option<(&Matrix, Certainty)>,
        found: &Recovered,
    ) -> Self {
        Self {
            fit: noise.and_then(|noise| fit(problem, noise, found)),
            ..self.clone()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lab::ensemble::Photographs;
    use crate::lab::problem::problem;
    use crate::lab::study::tests::small;
    use crate::model::{Kernel, MatrixModel};

    /// One element, C = D = 1, σ = 0.5: ρ̂ is the mean 0.4 of 0.2, 0.3, 0.4, 0.7, so that χ² =
    /// (0.04 + 0.01 + 0 + 0.09)/0.25 = 0.56 with 3 degrees of freedom; a fifth entry has no error.
    /// `joint` held at 1 by photographs of 2 ± 0.5 has χ² = 4·4 with 4.
    #[test]
    fn a_fit_by_hand() {
        let one = |rows, columns| Matrix::from_element(rows, columns, 1.0);
        let (c, d) = (one(1, 1), one(1, 5));
        let stderr = Matrix::from_row_slice(1, 5, &[0.5, 0.5, 0.5, 0.5, 0.0]);
        let phi = Matrix::from_row_slice(1, 5, &[0.2, 0.3, 0.4, 0.7, 0.4]);
        let problem = Problem::new(&phi, &c, &d, Some(&stderr)).unwrap();
        let fitted = |problem: &Problem<'_>, method| {
            let found = recover(method, problem, &Options::default()).unwrap();
            fit(problem, (&stderr, Certainty::STATED), &found).unwrap()
        };
        let free = fitted(&problem, Method::JointUnbounded);
        assert!((free.chi2_per_dof - 0.56 / 3.0).abs() < 1e-12, "{free:?}");
        assert_eq!((free.dof, free.entries, free.left_out), (3.0, 4, 1));
        // P(χ²₃ > x) = erfc(√(x/2)) + √(2x/π) e^(−x/2).
        let x: f64 = 0.56;
        let tail = libm::erfc((0.5 * x).sqrt())
            + (2.0 * x / std::f64::consts::PI).sqrt() * libm::exp(-0.5 * x);
        assert!((free.p - tail).abs() < 1e-9 && free.fits, "{free:?} {tail}");
        let bright = Matrix::from_element(1, 5, 2.0);
        let problem = Problem::new(&bright, &c, &d, Some(&stderr)).unwrap();
        let held = fitted(&problem, Method::Joint);
        assert!(
            (held.chi2_per_dof - 4.0).abs() < 1e-9 && held.dof == 4.0,
            "{held:?}"
        );
        assert!((problem.brightness() - 2.0).abs() < 1e-12);
    }

    /// A right model is called refuted at the rate of the level: 400 seeds at 10 %, within the
    /// binomial 99.9 %. Photographs by the model on its own elements, levels away from the bounds
    /// and at them; where they are at them `joint` keeps to the right side.
    #[test]
    fn p_values_of_a_right_model_are_uniform() {
        let mut model = MatrixModel::new(&small("bench"), Kernel::Physical, Some([2, 2])).unwrap();
        let certainty = Certainty::STATED;
        for (levels, methods) in [
            (
                [0.3, 0.7],
                vec![Method::JointUnbounded, Method::Joint, Method::Nnls],
            ),
            ([0.0, 1.0], vec![Method::JointUnbounded, Method::Joint]),
        ] {
            model.albedo = vec![levels[0], levels[1], levels[1], levels[0]];
            let exact = model.phi();
            for method in methods {
                let alarms = (0..400).filter(|seed| {
                    let shot = Photographs::relative(&exact, 0.05, *seed);
                    let problem = problem(&model, &shot.phi, Some(&shot.stderr)).unwrap();
                    let found = recover(method, &problem, &Options::default()).unwrap();
                    fit(&problem, (&shot.stderr, certainty), &found).unwrap().p < 0.1
                });
                let alarms = alarms.count();
                assert!((21..=61).contains(&alarms), "{method} {levels:?}: {alarms}");
            }
        }
    }

    /// Errors that a pixel's entries share have the degrees of freedom of the pixels, and those that
    /// all share count as one: 400 draws at 10 % give between 21 and 61 alarms; where one deviate
    /// makes all of χ², P is that of one degree exactly.
    #[test]
    fn shared_errors_count_once() {
        let stderr = Matrix::from_element(40, 30, 2.0);
        let none = Matrix::zeros(40, 30);
        for errors in [Errors::WithinRows, Errors::Everywhere] {
            let alarms = (0..400).filter(|seed| {
                let deviates = crate::lab::deviate::normal_deviates(*seed, 40, 30);
                let phi = Matrix::from_fn(40, 30, |p, _| match errors {
                    Errors::Everywhere => 2.0 * deviates[(0, 0)],
                    _ => 2.0 * deviates[(p, 0)],
                });
                let certainty = Certainty {
                    errors,
                    replicates: None,
                };
                let mut residuals = Residuals::default();
                residuals.add(&phi, &none, &stderr, certainty);
                residuals.fit(0.0, errors).unwrap().p < 0.1
            });
            let alarms = alarms.count();
            assert!((21..=61).contains(&alarms), "{errors:?}: {alarms}");
        }
    }

    /// Standard errors of 8 replicates: z = t would be 7/5 in the mean of squares.
    #[test]
    fn errors_from_few_replicates_are_students() {
        let certainty = Certainty {
            errors: Errors::Independent,
            replicates: Some(8),
        };
        let (rows, columns) = (100, 60);
        let draws: Vec<Matrix> = (0..8)
            .map(|seed| crate::lab::deviate::normal_deviates(seed, rows, columns))
            .collect();
        let at = |p, l| -> Vec<f64> { draws.iter().map(|d| d[(p, l)]).collect() };
        let mean = |values: &[f64]| crate::num::summation::mean_and_stderr(values);
        let phi = Matrix::from_fn(rows, columns, |p, l| mean(&at(p, l)).0);
        let stderr = Matrix::from_fn(rows, columns, |p, l| mean(&at(p, l)).1);
        let mut residuals = Residuals::default();
        residuals.add(&phi, &Matrix::zeros(rows, columns), &stderr, certainty);
        let fit = residuals.fit(0.0, Errors::Independent).unwrap();
        // 6000 squares of variance 2: standard error 0.018.
        assert!((fit.chi2_per_dof - 1.0).abs() < 0.09, "{fit:?}");
    }

    #[test]
    fn nothing_left_to_judge_by() {
        let mut residuals = Residuals::default();
        let m = |x| Matrix::from_element(2, 2, x);
        residuals.add(&m(1.0), &m(1.0), &m(0.0), Certainty::STATED);
        assert_eq!(residuals.fit(0.0, Errors::Independent), None);
        residuals.add(&m(1.0), &m(1.0), &m(1.0), Certainty::STATED);
        assert_eq!(residuals.fit(4.0, Errors::Independent), None);
        assert_eq!(residuals.fit(3.0, Errors::Independent).unwrap().left_out, 4);
    }
}
