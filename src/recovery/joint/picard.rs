//! The Picard condition of the joint operator.

use nalgebra::DVector;

use crate::recovery::joint::operator::khatri_rao::operator;
use crate::recovery::joint::operator::linear::about_grey;
use crate::recovery::{Directions, Options, Picard, Problem, RecoveryError, Weighting};

/// The Picard data of all pixels and spots at once: of √W K = U S Vᵀ, K the Khatri–Rao product of C
/// and D without what the nuisance terms take, the singular values s_i, the data |⟨u_i, √W Φ⟩|
/// along each direction, and what noise alone makes of them, √(Σ_pl u_i\[p,l\]² w\[p,l\]
/// σ²\[p,l\]): 1 in all directions where the weights are 1/σ². Directions below the rounding of K
/// are left out. Factors that are known only roughly are taken out softly, about a grey surface.
///
/// # Errors
/// [`RecoveryError::Dark`], [`RecoveryError::TooManyElements`], [`RecoveryError::RankZero`], a
/// decomposition that failed.
pub fn picard_joint(problem: &Problem<'_>, options: &Options) -> Result<Picard, RecoveryError> {
    problem.refuse_darkness()?;
    about_grey(problem, options, |problem| of_linear(problem, options))
}

fn of_linear(problem: &Problem<'_>, options: &Options) -> Result<Picard, RecoveryError> {
    let operator = operator(problem, options)?;
    let solved = operator.solve(crate::num::linalg::Tolerance::Auto)?;
    // The solution holds the data along direction i over s_i.
    let along = &solved.vt * &solved.solution;
    let sigma = solved.sigma.rows(0, solved.rank).into_owned();
    let coefficient = DVector::from_fn(solved.rank, |i, _| (along[i] * sigma[i]).abs());
    Ok(Picard {
        directions: match operator.weighting {
            Weighting::Unweighted => Directions::Joint,
            Weighting::Separable { .. } | Weighting::EntryByEntry => Directions::JointWeighted,
        },
        noise: operator
            .noise(problem, &solved)
            .map(|m| m.diagonal().map(f64::sqrt)),
        sigma,
        coefficient,
    })
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;

    use super::*;
    use crate::num::linalg::svd;
    use crate::recovery::bench::{Bench, normal_stream};
    use crate::recovery::{Nuisance, WeightRule};

    /// The weighted operator and data, entry by entry.
    fn brute(
        bench: &Bench,
        phi: &DMatrix<f64>,
        weight: impl Fn(usize, usize) -> f64,
    ) -> (DMatrix<f64>, DVector<f64>) {
        let (pixels, spots) = phi.shape();
        let at = |row: usize| (row % pixels, row / pixels);
        let k = DMatrix::from_fn(pixels * spots, bench.c.ncols(), |row, j| {
            let (p, l) = at(row);
            weight(p, l) * bench.c[(p, j)] * bench.d[(j, l)]
        });
        let data = DVector::from_fn(pixels * spots, |row, _| {
            let (p, l) = at(row);
            weight(p, l) * phi[(p, l)]
        });
        (k, data)
    }

    #[test]
    fn it_is_the_decomposition_of_the_whole_operator() {
        let bench = Bench::new(6.0, 3, 4);
        let exact = bench.phi(&bench.board(3));
        let stderr = DMatrix::from_fn(16, 120, |p, l| {
            1e-3 * exact.amax() * (1 + p % 3) as f64 * (1 + l % 5) as f64
        });
        let mut normal = normal_stream(4);
        let phi = exact.zip_map(&stderr, |x, s| x + s * normal());
        let problem = Problem::new(&phi, &bench.c, &bench.d, Some(&stderr)).unwrap();
        for weighting in [WeightRule::Noise, WeightRule::Unweighted] {
            let options = Options {
                weighting,
                ..Options::default()
            };
            let found = picard_joint(&problem, &options).unwrap();
            let weighted = weighting == WeightRule::Noise;
            let (k, data) = brute(&bench, &phi, |p, l| {
                if weighted { 1.0 / stderr[(p, l)] } else { 1.0 }
            });
            let whole = svd(&k).unwrap();
            for i in 0..9 {
                let u = whole.u.column(i);
                let noise: f64 = (0..u.len())
                    .map(|row| {
                        (u[row]
                            * if weighted {
                                1.0
                            } else {
                                stderr[(row % 16, row / 16)]
                            })
                        .powi(2)
                    })
                    .sum();
                assert!((found.sigma[i] / whole.sigma[i] - 1.0).abs() < 1e-9);
                assert!((found.coefficient[i] - u.dot(&data).abs()).abs() < 1e-9 * data.norm());
                assert!((found.noise.as_ref().unwrap()[i] / noise.sqrt() - 1.0).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn glare_and_missing_noise() {
        let bench = Bench::new(6.0, 2, 4);
        let phi = bench.phi(&bench.board(2));
        let problem = Problem::new(&phi, &bench.c, &bench.d, None).unwrap();
        let found = picard_joint(&problem, &Options::default()).unwrap();
        assert_eq!((found.directions, &found.noise), (Directions::Joint, &None));
        let stderr = &phi * 1e-3;
        let pattern = DMatrix::from_fn(16, 120, |p, l| 1.0 / (1 + p + l) as f64);
        let nuisance = Nuisance {
            glare: Some(&pattern),
            ..Nuisance::default()
        };
        let problem = Problem::new(&phi, &bench.c, &bench.d, Some(&stderr))
            .and_then(|p| p.with_nuisance(nuisance))
            .unwrap();
        let found = picard_joint(&problem, &Options::default()).unwrap();
        assert_eq!(found.directions, Directions::JointWeighted);
        assert_eq!(found.noise, Some(DVector::from_element(4, 1.0)));
    }
}
