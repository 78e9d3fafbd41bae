//! Standard errors that were estimated from few replicates, pooled over pixels and spots.
//!
//! A variance s² of ν = N − 1 degrees of freedom scatters by 2/ν of itself, and weights and errors
//! that take it for known come out wrong: of 3 replicates bands of 95 % held 9 to 30 %. Where noise
//! is near a product of a pixel's and a spot's,
//!
//! > σ²\[p,l\] ≈ a\[p\] b\[l\]
//!
//! ([`Separable`]), the many say what each is. By how much σ² scatters about the product is seen in
//! ln(s²/ab), whose variance would be ψ′(ν/2) if it did not; put as that of a variance known from d
//! degrees of freedom, ψ′(d/2), the best of both is
//!
//! > s̃² = (d a b + ν s²)/(d + ν),   known as from d + ν degrees of freedom.
//!
//! After Smyth (2004), Linear models and empirical Bayes methods, Statistical Applications in
//! Genetics and Molecular Biology 3(1), with the product in place of one variance for all.

use super::certainty::{Certainty, Errors, PooledFrom, freedom};
use crate::matrix::Matrix;
use crate::num::quadrature::Rule;
use crate::num::separable::Separable;
use crate::num::statistics::{freedom_of_log_variance, pentagamma, trigamma};

/// Replicates from which errors are as good as known: of 10, 95 % bands of `joint-gp` held 84 to
/// 89 %, of 32 91 to 95 %.
pub(in crate::lab) const ENOUGH_REPLICATES: u32 = 32;

/// Variances whose logarithms scatter less than chance lets them, by so many standard errors, were
/// not estimated entry by entry: that all are alike says nothing of how well they are known.
const LESS_THAN_CHANCE: f64 = 5.0;

/// Nodes of the integrals over u.
const NODES: usize = 16;

/// Standard errors, W, and what is known of them.
#[derive(Debug)]
pub(super) struct Pooled {
    /// Pixels × spots; 0 where there was none.
    pub(super) stderr: Matrix,
    /// As from how many replicates.
    pub(super) certainty: Certainty,
}

impl Pooled {
    /// `stderr` pooled over the entries that are not `left_out`; none where these errors are known,
    /// or well enough, or share their noise, or do not scatter as estimates do.
    pub(super) fn of(
        stderr: &Matrix,
        certainty: Certainty,
        left_out: Option<&Matrix>,
    ) -> Option<Self> {
        let replicates = certainty.replicates.filter(|n| *n < ENOUGH_REPLICATES)?;
        if certainty.errors != Errors::Independent {
            return None;
        }
        let nu = freedom(replicates);
        let variance = stderr.map(|s| s * s);
        let counts = |at: usize| variance[at] > 0.0 && left_out.is_none_or(|out| out[at] == 0.0);
        let at: Vec<usize> = (0..variance.len()).filter(|at| counts(*at)).collect();
        let product = Separable::of(&variance, &at);
        let prior = freedom_of(&product, &variance, &at, nu)?;
        let mut pooled = stderr.clone();
        for &at in &at {
            pooled[at] = ((prior * product.at(at) + nu * variance[at]) / (prior + nu)).sqrt();
        }
        Some(Self {
            stderr: pooled,
            certainty: Certainty {
                replicates: Some((prior + nu + 1.0).min(f64::from(u32::MAX)) as u32),
                pooled_from: Some(expected(replicates, &product, &variance, &at, prior)),
                ..certainty
            },
        })
    }
}

/// What is expected over pooled errors s̃ of d = `prior` and ν degrees of freedom, the noise
/// normal, whatever the law of σ²: of s² = σ² χ²\[ν\]/ν and any f
///
/// > E σ² f(s²) = ν/2 E s² ∫₀¹ u^(ν/2−1) f(u s²) du
/// > E σ⁴ f(s²) = (ν/2)² E s⁴ ∫₀¹ u^(ν/2−1) (1 − u) f(u s²) du
///
/// (the identity of Stein for gamma laws, by parts). The product follows each s² as one of n in its
/// row and column. How well d is known does not matter: it is small where little tells it.
fn expected(
    replicates: u32,
    product: &Separable,
    variance: &Matrix,
    at: &[usize],
    prior: f64,
) -> PooledFrom {
    let nu = freedom(replicates);
    let (m, n) = variance.shape();
    let (mut rows, mut columns) = (vec![0.0; m], vec![0.0; n]);
    for at in at {
        rows[at % m] += 1.0;
        columns[at / m] += 1.0;
    }
    // u = y², so that no power of it is below 0.
    let rule = Rule::gauss_legendre(NODES);
    let nodes = rule.on(0.0, 1.0);
    let nodes = nodes.map(|(y, w)| (y * y, 2.0 * w * libm::pow(y, nu - 1.0)));
    let nodes: Vec<(f64, f64)> = nodes.collect();
    let of = |at: &usize| {
        let (own, product) = (variance[*at], product.at(*at));
        let [in_row, in_column] =
            [rows[at % m], columns[at / m]].map(|count| own / product / count);
        let sums = nodes
            .iter()
            .fold([0.0; 3], |[first, second, both], (u, w)| {
                let less = u - 1.0;
                let there = product * (1.0 + less * in_row) * (1.0 + less * in_column);
                let ratio = own * (prior + nu) / (prior * there + nu * u * own);
                let square = w * ratio * ratio;
                [first + w * ratio, second - less * square, both + square]
            });
        let [first, second, both] = sums;
        let weight = (prior + nu) / (prior * product + nu * own);
        [first, second, both / own, weight]
    };
    let half = 0.5 * nu;
    let sums = at
        .iter()
        .map(of)
        .fold([0.0; 4], |sum, x| std::array::from_fn(|k| sum[k] + x[k]));
    let count = at.len() as f64;
    PooledFrom {
        replicates,
        squares: [half * sums[0] / count, 3.0 * half * half * sums[1] / count],
        variance: half * sums[2] / sums[3],
    }
}

/// The degrees of freedom as from which `product` tells a variance: what its logarithm scatters
/// beyond those of ν, one standard error of that more, and the error of the product itself. Finite;
/// none where there are too few entries, or the scatter is no estimate's.
fn freedom_of(product: &Separable, variance: &Matrix, at: &[usize], nu: f64) -> Option<f64> {
    let n = at.len() as f64;
    if at.len() < 2 * product.fitted {
        return None;
    }
    let logs = at
        .iter()
        .map(|&at| libm::log(variance[at] / product.at(at)));
    let logs: Vec<f64> = logs.collect();
    let mean = logs.iter().sum::<f64>() / n;
    let moment = |k: i32| logs.iter().map(|x| (x - mean).powi(k)).sum::<f64>() / n;
    let (second, fourth) = (moment(2), moment(4));
    let stderr = ((fourth - second * second) / n).sqrt();
    // A fit of m numbers takes m/n of the variance 2/ν of s², and as much of the covariance.
    let own = product.fitted as f64 / n * 2.0 / nu;
    let chance = trigamma(0.5 * nu);
    let beyond = second - (chance - own);
    let by_chance = ((pentagamma(0.5 * nu) + 2.0 * chance * chance) / n).sqrt();
    (beyond > -LESS_THAN_CHANCE * by_chance)
        .then(|| freedom_of_log_variance(beyond.max(0.0) + stderr + own))
}

#[cfg(test)]
pub(in crate::lab) mod tests;
