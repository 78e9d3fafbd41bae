//! Variances smoothed over pixels and spots.
//!
//! Where noise is that of light m, or the same everywhere, its variance is
//!
//! > ln σ²\[p,l\] ≈ α ln m\[p,l\] + a\[p\] + b\[l\],
//!
//! α 0 of noise alike everywhere, 1 of counts, 2 of noise that is a share of the light. Noise of
//! traced light is skewed, for few paths are bright: an entry that is dark by chance has a small
//! estimate s of its error by chance, and weights of 1/s² make the whole too dark. The smooth
//! variance is of all entries, and does not know the noise of one.

use super::certainty::{Certainty, Errors, PooledFrom, freedom};
use super::pooled::{ENOUGH_REPLICATES, Pooled};
use crate::matrix::{Matrix, expected};
use crate::num::statistics::{freedom_of_log_variance, trigamma};

/// An entry with so many times the smoothed variance is weighed by its own: not by chance does an
/// error of many replicates come out 4 times too large.
pub(in crate::lab) const BEYOND: f64 = 16.0;
/// Up to such a variance of ln σ² about what is smooth, weights by that are nearly the best: those
/// of a normal law lose exp of it in variance.
pub(in crate::lab) const SMOOTH: f64 = 0.5;
/// The variance as a power of the light times a factor by row and one by column, fitted to the
/// logarithms of the entries that are known and positive, and how these scatter about it, their
/// variance. Without light it has the mean of its row and column.
pub(in crate::lab) fn smoothed(
    variance: &Matrix,
    light: &Matrix,
    known: &dyn Fn(usize) -> bool,
) -> (Matrix, f64) {
    let (by_line, of_variance) = split(variance, known);
    let (_, of_light) = split(light, known);
    let power = of_variance.dot(&of_light) / of_light.norm_squared();
    let power = if power.is_finite() { power } else { 0.0 };
    let of_light = of_light * power;
    let count = (0..variance.len()).filter(|at| known(*at)).count();
    let scatter = (of_variance - &of_light).norm_squared() / count.max(1) as f64;
    ((by_line + of_light).map(libm::exp), scatter)
}

/// Errors that were estimated from many replicates, smoothed by the light that is [`expected`] of
/// `phi` without the `left_out`; none of few replicates, of errors that are known or shared, or
/// where they scatter by far more than chance. They are scaled so that their squares have the mean
/// of those estimated; an error far beyond is left as it is.
pub(super) fn pooled(
    phi: &Matrix,
    stderr: &Matrix,
    certainty: Certainty,
    left_out: Option<&Matrix>,
) -> Option<Pooled> {
    let replicates = certainty.replicates.filter(|n| *n >= ENOUGH_REPLICATES)?;
    let is_told = certainty.pooled_from.is_some() || certainty.counted.is_some();
    if is_told || certainty.errors != Errors::Independent || phi.shape() != stderr.shape() {
        return None;
    }
    let nu = freedom(replicates);
    let variance = stderr.map(|s| s * s);
    let known = |at: usize| variance[at] > 0.0 && left_out.is_none_or(|out| out[at] == 0.0);
    let light = expected(phi, &variance, left_out).ok()??;
    let at: Vec<usize> = (0..variance.len()).filter(|at| known(*at)).collect();
    let mean =
        |of: &dyn Fn(usize) -> f64| at.iter().map(|at| of(*at)).sum::<f64>() / at.len() as f64;
    // What is left of light that is a product to its noise is that noise, by which entries are not
    // to be weighed.
    let left = split(&light, &known).1.norm_squared() / at.len() as f64;
    let is_lit = |at: &usize| light[*at] > 0.0;
    let lit = at.iter().copied().filter(is_lit);
    let noise = lit.map(|at| libm::log(variance[at] / (light[at] * light[at])));
    let noise = noise.sum::<f64>() / at.len() as f64;
    let is_more = left > libm::exp(noise);
    let own = if is_more {
        light.clone()
    } else {
        light.map(|_| 1.0)
    };
    let (mut smooth, scatter) = smoothed(&variance, &own, &known);
    let beyond = scatter - trigamma(0.5 * nu);
    if at.is_empty() || beyond > SMOOTH {
        return None;
    }
    let near: Vec<bool> = (0..variance.len())
        .map(|at| known(at) && variance[at] < BEYOND * smooth[at])
        .collect();
    let of_near = |of: &dyn Fn(usize) -> f64| mean(&|at| if near[at] { of(at) } else { 0.0 });
    let scale = of_near(&|at| variance[at] / smooth[at]) / of_near(&|_| 1.0);
    for (at, near) in near.iter().enumerate() {
        smooth[at] = if *near {
            scale * smooth[at]
        } else {
            variance[at]
        };
    }
    let prior = freedom_of_log_variance(beyond.max(1.0 / at.len() as f64));
    let ratio = |at: usize| variance[at] / smooth[at];
    // Of the scale of the light.
    let weight = |at: usize| light[at] * light[at] / smooth[at];
    // Of normal noise E s⁴ is (1 + 2/ν) E σ⁴.
    let fourth = 3.0 * mean(&|at| ratio(at).powi(2)) / (1.0 + 2.0 / nu);
    Some(Pooled {
        certainty: Certainty {
            replicates: Some((prior + 1.0).min(f64::from(u32::MAX)) as u32),
            pooled_from: Some(PooledFrom {
                replicates,
                squares: [mean(&ratio), fourth],
                variance: mean(&|at| weight(at) * ratio(at)) / mean(&weight),
            }),
            ..certainty
        },
        stderr: smooth.map(f64::sqrt),
    })
}

/// Logarithms as a term by row and one by column, and what is left of each; 0 of an entry that is
/// not known or not positive.
fn split(values: &Matrix, known: &dyn Fn(usize) -> bool) -> (Matrix, Matrix) {
    let (rows, columns) = values.shape();
    let (mut by_row, mut by_column) = (vec![[0.0; 2]; rows], vec![[0.0; 2]; columns]);
    let mut all = [0.0; 2];
    let log = |at: usize| (known(at) && values[at] > 0.0).then(|| libm::log(values[at]));
    let logs: Vec<Option<f64>> = (0..values.len()).map(log).collect();
    for (at, log) in logs.iter().enumerate() {
        if let Some(log) = log {
            for sum in [&mut by_row[at % rows], &mut by_column[at / rows], &mut all] {
                sum[0] += log;
                sum[1] += 1.0;
            }
        }
    }
    let whole = all[0] / all[1].max(1.0);
    let mean = |[sum, n]: [f64; 2]| if n > 0.0 { sum / n } else { whole };
    let by_line = Matrix::from_fn(rows, columns, |p, l| {
        mean(by_row[p]) + mean(by_column[l]) - whole
    });
    let left = Matrix::from_fn(rows, columns, |p, l| {
        logs[p + l * rows].map_or(0.0, |log| log - by_line[(p, l)])
    });
    (by_line, left)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lab::comparison::misplaced::normal;
    use crate::lab::uncertainty::pooled::tests::repeated;

    fn from(replicates: u32) -> Certainty {
        Certainty::new(Errors::Independent, Some(replicates))
    }

    /// Noise of counts is found to a third of what each of 32 replicates is off by, 1/√62 of
    /// itself; squares over it have the moments 1 and 3 of a normal law, to 5 of their errors.
    /// Errors that scatter e-fold are none of the light, and those that are known, of few
    /// replicates or shared, are left.
    #[test]
    fn noise_of_the_light_is_told_by_all_entries() {
        let light = Matrix::from_fn(60, 40, |p, l| {
            let [p, l] = [p as f64, l as f64];
            (1.0 + p) * (2.0 + l) * (2.0 + libm::sin(p * l / 100.0))
        });
        let sigma = light.map(f64::sqrt);
        let [phi, stderr] = repeated(&light, &sigma, 32, 5);
        let found = pooled(&phi, &stderr, from(32), None).unwrap();
        let off = |own: &Matrix| {
            let right = sigma.map(|s| s / 32.0_f64.sqrt());
            own.zip_map(&right, |a, b| (a / b - 1.0) * (a / b - 1.0))
                .mean()
                .sqrt()
        };
        assert!(off(&found.stderr) < off(&stderr) / 3.0);
        let own = found.certainty.pooled_from.unwrap();
        // By the scale; and s⁴ scatters by 2 √(2/ν) of itself.
        assert!((own.squares[0] - 1.0).abs() < 1e-9);
        let error = 6.0 * (2.0 / 31.0 / 2400.0_f64).sqrt();
        assert!((own.squares[1] - 3.0).abs() < 5.0 * error);
        assert!((own.variance - 1.0).abs() < 0.05, "{own:?}");
        assert!(found.certainty.replicates.unwrap() > 100);
        let mut draw = normal(6);
        let scattered = stderr.map(|s| s * libm::exp(draw()[0]));
        let shared = Certainty::new(Errors::WithinRows, Some(32));
        for (stderr, certainty) in [
            (&scattered, from(32)),
            (&stderr, from(31)),
            (&stderr, Certainty::STATED),
            (&stderr, shared),
        ] {
            assert!(pooled(&phi, stderr, certainty, None).is_none());
        }
    }
}
