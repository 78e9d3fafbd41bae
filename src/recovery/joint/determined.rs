//! What the data determine of each element, whatever the method.

use nalgebra::DVector;

use crate::num::linalg::{Tolerance, cut};
use crate::recovery::joint::operator::khatri_rao::operator;
use crate::recovery::joint::operator::linear::about_grey;
use crate::recovery::joint::operator::scale;
use crate::recovery::{Options, Problem, RecoveryError, WeightRule, Weighting};

/// Standard deviation of what is known of a reflectance beforehand: half of the range from 0 to 1.
const BEFORE: f64 = 0.5;

/// A misfit of weights by pixel and spot to those of the noise, in ln σ, above which they are not
/// taken for the noise itself.
const SEPARABLE: f64 = 1e-3;

/// A share of an element's variance below which the photographs say nothing of it.
const UNSEEN: f64 = 1e-3;

/// How much of each element the photographs determine.
#[derive(Debug, Clone, PartialEq)]
pub struct Determined {
    /// Share of each element, 0 to 1: by what part the photographs lower the variance of its
    /// reflectance.
    pub shares: DVector<f64>,
    /// Their sum: so many of the elements are determined.
    pub rank: f64,
}

/// The diagonal of the resolution matrix of the photographs at their noise (Rodgers 2000, averaging
/// kernel): with the singular values s_i of the operator in standard deviations of the noise, what
/// nuisance terms take left out, and nothing known of the reflectances but that they lie about ½
/// with a standard deviation of ½,
///
/// > R_jj = Σ_i V_ij² s_i² τ²/(1 + s_i² τ²) = 1 − var(ρ_j | Φ)/τ²,   τ = ½.
///
/// With a free scale the same of s ρ, τ half of what a grey surface says of s. Where τ s_i is the
/// signal of a direction, this counts the directions that rise above the noise in a Picard plot. It
/// depends on geometry and noise, not on Φ; with factors that are known only roughly or a free
/// scale on how bright Φ is.
///
/// # Errors
/// [`RecoveryError::NotForMethod`] without a noise model, [`RecoveryError::TooManyElements`], a
/// failed decomposition.
pub fn determined(problem: &Problem<'_>) -> Result<Determined, RecoveryError> {
    if problem.noise().is_none() {
        return Err(RecoveryError::NotForMethod {
            method: crate::recovery::Method::Joint,
            what: "has no resolution at unknown noise",
            cure: "give the standard error of phi (phi.stderr.npy)",
        });
    }
    let by = |weighting| {
        let options = Options {
            weighting,
            ..Options::default()
        };
        about_grey(problem, &options, |problem| operator(problem, &options))
    };
    let mut found = by(WeightRule::Noise)?;
    if matches!(found.weighting, Weighting::Separable { misfit } if misfit > SEPARABLE) {
        found = by(WeightRule::Entries)?;
    }
    let found = found.directions()?;
    let (directions, _) = &*found;
    let before = BEFORE * scale::unit(problem)?;
    let mut shares = DVector::zeros(problem.c.ncols());
    for (s, v) in directions.sigma.iter().zip(directions.vt.row_iter()) {
        let signal = (s * before) * (s * before);
        let share = signal / (1.0 + signal);
        for (sum, v) in shares.iter_mut().zip(v.iter()) {
            *sum += v * v * share;
        }
    }
    Ok(Determined {
        rank: shares.sum(),
        shares,
    })
}

/// The elements, in order, of which the photographs say nothing, even if all others were known: the
/// signal a_j = τ ‖√W A_j‖ of element j alone, of 0.5 ± τ beforehand, would lower its variance by
///
/// > a_j²/(1 + a_j²) < 1e-3;
///
/// where the noise is not known, its light is a rounding of the brightest direction's. What a
/// method shows there is what it assumes.
///
/// # Errors
/// Those of [`determined`](determined()) but for a missing noise model.
pub fn unseen(problem: &Problem<'_>) -> Result<Vec<usize>, RecoveryError> {
    let operator = operator(problem, &Options::default())?;
    let directions = operator.directions()?;
    let (found, _) = &*directions;
    let sizes = found.column_norms();
    let rounding = operator.tolerance(Tolerance::Auto);
    let (rows, sigma) = (operator.rows(), found.sigma.as_slice());
    let (_, cutoff) = cut(sigma, rows, sizes.len(), rounding)?;
    let least = match operator.weighting {
        Weighting::Unweighted => 0.0,
        _ => (UNSEEN / (1.0 - UNSEEN)).sqrt() / (BEFORE * scale::unit(problem)?),
    };
    let is_dark = |j: &usize| sizes[*j] <= cutoff.max(least);
    Ok((0..sizes.len()).filter(is_dark).collect())
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;

    use super::*;
    use crate::recovery::Nuisance;
    use crate::recovery::bench::{Bench, normal_stream};

    /// One element seen in n entries of signal a and noise σ: F = n a²/σ², R = F/(F + 4). Two
    /// elements that no entry tells apart share what one would have of twice the F: R = F/(2 F + 4)
    /// each.
    #[test]
    fn shares_by_hand() {
        let m = |rows, columns, x| DMatrix::from_element(rows, columns, x);
        let (phi, stderr) = (m(2, 3, 1.0), m(2, 3, 0.5));
        let information = 6.0 * 0.3 * 0.3 / 0.25;
        let one = m(2, 1, 0.3);
        let problem = Problem::new(&phi, &one, &DMatrix::from_element(1, 3, 1.0), Some(&stderr))
            .map(|p| determined(&p).unwrap())
            .unwrap();
        assert!((problem.rank - information / (information + 4.0)).abs() < 1e-12);
        let (two, d) = (m(2, 2, 0.3), m(2, 3, 1.0));
        let problem = Problem::new(&phi, &two, &d, Some(&stderr)).unwrap();
        for share in determined(&problem).unwrap().shares.iter() {
            assert!((share - information / (2.0 * information + 4.0)).abs() < 1e-12);
        }
        assert!(determined(&Problem::new(&phi, &two, &d, None).unwrap()).is_err());
    }

    /// 1 − var(ρ_j | Φ)/τ² by the inverse of the normal matrix; less noise determines more, and
    /// what is estimated besides takes of it.
    #[test]
    fn shares_are_what_the_variance_loses() {
        let bench = Bench::new(6.0, 2, 4);
        let phi = bench.phi(&bench.board(2).map(|x| 0.2 + 0.5 * x));
        let stderr = DMatrix::from_element(16, 120, 0.1 * phi.mean());
        let mut normal = normal_stream(5);
        // Of no form by pixel and spot: what a few entries of little noise tell counts as it is.
        let uneven = stderr.map(|s| s * libm::exp(1.5 * normal()));
        for stderr in [&stderr, &uneven] {
            let problem = Problem::new(&phi, &bench.c, &bench.d, Some(stderr)).unwrap();
            let found = determined(&problem).unwrap();
            let of = |j: usize, k: usize| -> f64 {
                let sides = |p: usize, l: usize| {
                    let both =
                        bench.c[(p, j)] * bench.d[(j, l)] * bench.c[(p, k)] * bench.d[(k, l)];
                    both / (stderr[(p, l)] * stderr[(p, l)])
                };
                let sum: f64 = (0..16 * 120).map(|i| sides(i % 16, i / 16)).sum();
                sum + if j == k { 4.0 } else { 0.0 }
            };
            let after = DMatrix::from_fn(4, 4, of).try_inverse().unwrap();
            for j in 0..4 {
                assert!((found.shares[j] - (1.0 - 4.0 * after[(j, j)])).abs() < 1e-9);
            }
        }
        let problem = Problem::new(&phi, &bench.c, &bench.d, Some(&stderr)).unwrap();
        let found = determined(&problem).unwrap();
        let loud = stderr.map(|s| 10.0 * s);
        let loud = Problem::new(&phi, &bench.c, &bench.d, Some(&loud)).unwrap();
        assert!(determined(&loud).unwrap().rank < found.rank);
        let more = Nuisance {
            frame_constant: true,
            ..Nuisance::default()
        };
        assert!(
            determined(&problem.with_nuisance(more).unwrap())
                .unwrap()
                .rank
                < found.rank
        );
    }

    /// Light of one element in n entries of signal a and noise σ says nothing of it where its share
    /// by hand, n a²τ²/σ²/(1 + n a²τ²/σ²), is below 1e-3; one of two that no entry tells apart is
    /// seen, though half of it is determined. Without noise only what has no light is not.
    #[test]
    fn unseen_elements_by_hand() {
        let (phi, d) = (
            DMatrix::from_element(2, 3, 1.0),
            DMatrix::from_element(4, 3, 1.0),
        );
        let (sigma, n) = (0.5, 6.0);
        let at_share = |share: f64| sigma * 2.0 * (share / (1.0 - share) / n).sqrt();
        let c = |own: f64| DMatrix::from_fn(2, 4, |_, j| [0.3, own, 0.0, 0.3][j]);
        let stderr = DMatrix::from_element(2, 3, sigma);
        for (share, known, dark) in [
            (0.99e-3, Some(&stderr), vec![1, 2]),
            (1.01e-3, Some(&stderr), vec![2]),
            (0.99e-3, None, vec![2]),
        ] {
            let c = c(at_share(share));
            let problem = Problem::new(&phi, &c, &d, known).unwrap();
            assert_eq!(unseen(&problem), Ok(dark), "{share}");
        }
    }
}
