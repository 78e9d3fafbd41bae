//! Do two matrices agree within the error bars of one of them?

use serde::{Deserialize, Serialize};

use crate::matrix::Matrix;
use crate::num::statistics::{
    chi_square_sf, normal_two_sided, sidak_p, sidak_threshold, student_to_normal,
};
use crate::num::summation::mean_and_stderr;
use crate::transport::Estimator;

/// How the errors of traced entries hang together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Errors {
    /// Every entry has its own random numbers.
    Independent,
    /// Entries of one pixel share theirs: only different rows are independent.
    WithinRows,
    /// All entries share theirs.
    Everywhere,
}

impl Errors {
    /// Those of an estimator.
    pub fn of(estimator: Estimator) -> Self {
        match estimator {
            Estimator::Independent => Self::Independent,
            Estimator::Shared => Self::WithinRows,
            Estimator::Factored => Self::Everywhere,
        }
    }
}

/// What is compared.
#[derive(Clone, Copy, Debug)]
pub struct Evidence<'a> {
    /// Traced Φcam, pixels × spots, W.
    pub traced: &'a Matrix,
    /// Standard error of each traced entry, W.
    pub stderr: &'a Matrix,
    /// Modelled Φcam, W.
    pub model: &'a Matrix,
    /// What the model may be off by in each entry, W ≥ 0; absent for a converged model.
    pub bound: Option<&'a Matrix>,
}

/// How it is tested.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Test {
    /// Probability of rejecting a right model.
    pub significance: f64,
    /// Replicates from which each standard error was estimated.
    pub replicates: u32,
    /// How the errors hang together.
    pub errors: Errors,
}

/// One entry of Φcam, traced and modelled.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Entry {
    /// Pixel index.
    pub pixel: usize,
    /// Spot index.
    pub spot: usize,
    /// Traced flux, W.
    pub traced: f64,
    /// Modelled flux, W.
    pub modelled: f64,
    /// Standard normal deviate of the difference.
    pub z: f64,
}

/// Traced against modelled Φcam.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Agreement {
    /// Whether both tests pass at the significance level.
    pub agrees: bool,
    /// `physical` or `published`.
    pub kernel: String,
    /// How the model integrates: `centres` or `quadrature`.
    pub integration: String,
    /// Family-wise error rate of the verdict.
    pub significance: f64,
    /// Entries compared.
    pub entries: usize,
    /// Mean of z² over the entries: 1 on average if the model is right.
    pub chi2_per_dof: f64,
    /// Independent degrees of freedom of that mean.
    pub dof: f64,
    /// Its upper tail probability.
    pub chi2_p: f64,
    /// Largest |z|.
    pub largest_z: f64,
    /// Largest |z| that the significance level allows for this many entries (Šidák).
    pub z_limit: f64,
    /// Probability of a |z| as large among all entries (Šidák).
    pub largest_p: f64,
    /// Relative Frobenius difference ‖traced − modelled‖/‖modelled‖.
    pub relative_difference: f64,
    /// What the traced standard error alone makes of that: ‖stderr‖/‖modelled‖.
    pub relative_noise: f64,
    /// Discretisation bound of the model, relative Frobenius norm.
    pub relative_discretisation: f64,
    /// Best single scale of the model: traced ≈ scale · modelled.
    pub best_scale: f64,
    /// The entries with the largest |z|.
    pub worst: Vec<Entry>,
}

/// Two sums of positive doubles cannot be told apart more finely than this.
const ROUNDING: f64 = 1e-14;
/// Entries listed by name.
const WORST: usize = 10;

/// Compares entry by entry. Returns the verdict (with empty `kernel` and `integration`) and the z
/// of every entry.
///
/// The deviate of an entry is t = (traced − model)/stderr, Student-distributed with `replicates` −
/// 1 degrees of freedom, and z the standard normal deviate of the same tail probability. A stated
/// `bound` of the model is taken off |traced − model| first. Two tests share the significance level
/// equally:
///
/// * the largest |z| against the Šidák limit for all entries;
/// * χ² = Σz². Under [`Errors::WithinRows`] the z of a row move together, but rows are independent:
///   the scatter of the row sums tells how many independent entries Σz² amounts to (Satterthwaite),
///   between the number of rows and that of entries. Under [`Errors::Everywhere`] it counts as one
///   entry's: whatever the correlations, the mean of z² exceeds a limit this far out less often
///   than a single z² does.
///
/// Entries whose standard error is 0 (light that never varies, or never arrives) are compared to
/// rounding.
pub fn agree(evidence: Evidence<'_>, test: Test) -> (Agreement, Matrix) {
    let Evidence {
        traced,
        stderr,
        model,
        bound,
    } = evidence;
    let freedom = f64::from(test.replicates.max(2) - 1);
    let z = Matrix::from_fn(traced.nrows(), traced.ncols(), |p, l| {
        let at = (p, l);
        let difference = traced[at] - model[at];
        let beyond = (difference.abs() - bound.map_or(0.0, |b| b[at])).max(0.0);
        let scale = stderr[at].max(ROUNDING * (traced[at].abs() + model[at].abs()));
        if beyond == 0.0 {
            0.0
        } else {
            student_to_normal(beyond / scale, freedom).copysign(difference)
        }
    });
    let entries = z.len();
    let largest = z.amax();
    let chi2_per_dof = z.norm_squared() / entries as f64;
    let dof = match test.errors {
        Errors::Independent => entries as f64,
        Errors::WithinRows => effective_freedom(&z),
        Errors::Everywhere => 1.0,
    };
    let chi2_p = chi_square_sf(chi2_per_dof * dof, dof);
    let half = 0.5 * test.significance;
    let largest_p = sidak_p(normal_two_sided(largest), entries as u64);
    // Relative to a dark model everything is unbounded, but nothing remains nothing.
    let norm = model.norm();
    let relative = |x: f64| if x > 0.0 { x / norm } else { 0.0 };
    let agreement = Agreement {
        agrees: chi2_p >= half && largest_p >= half,
        kernel: String::new(),
        integration: String::new(),
        significance: test.significance,
        entries,
        chi2_per_dof,
        dof,
        chi2_p,
        largest_z: largest,
        z_limit: sidak_threshold(half, entries as u64),
        largest_p,
        relative_difference: relative((traced - model).norm()),
        relative_noise: relative(stderr.norm()),
        relative_discretisation: bound.map_or(0.0, |b| relative(b.norm())),
        best_scale: if norm > 0.0 {
            traced.dot(model) / (norm * norm)
        } else {
            1.0
        },
        worst: worst(&z, traced, model),
    };
    (agreement, z)
}

/// Fewer rows than this do not tell their own scatter.
const ENOUGH_ROWS: usize = 16;

fn effective_freedom(z: &Matrix) -> f64 {
    let sums: Vec<f64> = z.row_iter().map(|r| r.norm_squared()).collect();
    freedom_of_rows(&sums, z.len())
}

/// ν such that Σz² has the mean and the variance of (entries/ν)·χ²_ν if the model is right: ν =
/// 2·entries²/Var Σz², the variance estimated from the scatter of the `sums` over each row. With
/// too few rows, their number, which is the least it can be.
pub(super) fn freedom_of_rows(sums: &[f64], entries: usize) -> f64 {
    let (rows, entries) = (sums.len() as f64, entries as f64);
    if sums.len() < ENOUGH_ROWS {
        return rows;
    }
    let (_, stderr) = mean_and_stderr(sums);
    let variance = stderr * stderr * rows * rows;
    if variance > 0.0 {
        (2.0 * entries * entries / variance).clamp(rows, entries)
    } else {
        rows
    }
}

/// The entries with the largest |z|, largest first.
fn worst(z: &Matrix, traced: &Matrix, model: &Matrix) -> Vec<Entry> {
    let mut order: Vec<usize> = (0..z.len()).collect();
    order.sort_by(|a, b| z[*b].abs().total_cmp(&z[*a].abs()).then(a.cmp(b)));
    let entry = |i: usize| Entry {
        pixel: i % z.nrows(),
        spot: i / z.nrows(),
        traced: traced[i],
        modelled: model[i],
        z: z[i],
    };
    order.into_iter().take(WORST).map(entry).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::num::stream::{Key, Sampling, Stream};

    const ROWS: usize = 40;
    const COLUMNS: usize = 30;
    const REPLICATES: u32 = 16;

    /// Normal replicates around 1 with standard deviation 0.04, their mean and standard error;
    /// `shared` gives all entries of a row the same noise.
    fn sample(seed: u64, shared: bool) -> (Matrix, Matrix) {
        let mut traced = Matrix::zeros(ROWS, COLUMNS);
        let mut stderr = Matrix::zeros(ROWS, COLUMNS);
        for p in 0..ROWS {
            for l in 0..COLUMNS {
                let spot = if shared { 0 } else { l as u32 };
                let mut stream = Stream::new(
                    Sampling::Pcg,
                    Key {
                        seed,
                        spot,
                        pixel: p as u32,
                        block: 0,
                    },
                );
                let replicates: Vec<f64> = (0..REPLICATES)
                    .map(|_| {
                        // Box–Muller.
                        let [a, b, ..] = stream.next_four();
                        1.0 + 0.04
                            * (-2.0 * (1.0 - a).ln()).sqrt()
                            * (std::f64::consts::TAU * b).cos()
                    })
                    .collect();
                let (mean, error) = mean_and_stderr(&replicates);
                traced[(p, l)] = mean;
                stderr[(p, l)] = error;
            }
        }
        (traced, stderr)
    }

    fn verdict(
        seed: u64,
        model: f64,
        bound: Option<f64>,
        errors: Errors,
        significance: f64,
    ) -> Agreement {
        let (traced, stderr) = sample(seed, errors == Errors::WithinRows);
        let model = Matrix::from_element(ROWS, COLUMNS, model);
        let bound = bound.map(|b| Matrix::from_element(ROWS, COLUMNS, b));
        let evidence = Evidence {
            traced: &traced,
            stderr: &stderr,
            model: &model,
            bound: bound.as_ref(),
        };
        agree(
            evidence,
            Test {
                significance,
                replicates: REPLICATES,
                errors,
            },
        )
        .0
    }

    /// False alarms on a right model: 400 trials at 10 % give 40 ± 6; 99.9 % of the binomial lies
    /// in 21 … 61. The share of the largest |z| (5 %) shrinks with the correlation, to 5 % in 30
    /// where rows are all one: 5.2 % remain, 6 … 37.
    #[test]
    #[ignore = "slow"]
    fn false_alarms_come_at_the_stated_rate() {
        let alarms = |errors| {
            (0..400)
                .filter(|s| !verdict(*s, 1.0, None, errors, 0.1).agrees)
                .count()
        };
        let independent = alarms(Errors::Independent);
        assert!(
            (21..=61).contains(&independent),
            "{independent} of 400 at 10 %"
        );
        let shared = alarms(Errors::WithinRows);
        assert!((6..=37).contains(&shared), "{shared} of 400 at 5.2 %");
    }

    #[test]
    fn chi_square_is_one_per_degree_of_freedom() {
        let mean = (0..20)
            .map(|s| verdict(s, 1.0, None, Errors::Independent, 0.01).chi2_per_dof)
            .sum::<f64>()
            / 20.0;
        // 24 000 values of z², each of variance 2: standard error 0.009.
        assert!((mean - 1.0).abs() < 0.04, "{mean}");
    }

    /// Noise of 1 % (0.04/√16): a model off by 1 % is rejected by both kinds of test, and accepted
    /// under a bound of 1 %.
    #[test]
    fn wrong_models_are_rejected_unless_their_bound_covers_it() {
        for errors in [Errors::Independent, Errors::WithinRows] {
            assert!(!verdict(1, 1.01, None, errors, 0.001).agrees);
            assert!(verdict(1, 1.01, Some(0.01), errors, 0.001).agrees);
        }
    }

    #[test]
    fn entries_without_error_are_compared_to_rounding() {
        let traced = Matrix::from_element(2, 2, 1.0);
        let zero = Matrix::zeros(2, 2);
        let test = Test {
            significance: 0.01,
            replicates: 32,
            errors: Errors::Independent,
        };
        for (value, agrees) in [
            (1.0, true),
            (1.0 + 2e-16, true),
            (1.0 + 1e-10, false),
            (0.0, false),
        ] {
            let model = Matrix::from_element(2, 2, value);
            let evidence = Evidence {
                traced: &traced,
                stderr: &zero,
                model: &model,
                bound: None,
            };
            let (verdict, z) = agree(evidence, test);
            assert_eq!(verdict.agrees, agrees, "{value}");
            assert!(z.iter().all(|z| z.is_finite()));
        }
        let (nothing, _) = agree(
            Evidence {
                traced: &zero,
                stderr: &zero,
                model: &zero,
                bound: None,
            },
            test,
        );
        assert!(nothing.agrees);
    }
}
