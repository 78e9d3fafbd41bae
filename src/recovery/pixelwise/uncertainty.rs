//! What noise and regularisation do to the mean over pixels ρ̂_j = (1/p) Σ_pl Φ\[p,l\]
//! D^#\[l,j\]/C\[p,j\].

use nalgebra::{DMatrix, DVector};

use crate::num::linalg::{
    LinalgError, Tolerance, columns_over, columns_times, product, rows_times, svd_to, tr_product,
};

/// Elements whose sums are held at once.
const ELEMENTS: usize = 256;

/// Standard errors for independent entries: var ρ̂_j = Σ_pl σ²\[p,l\] (D^#\[l,j\]/(p C\[p,j\]))²,
/// D^# = Vᵀ S. Cost p·l·r, memory that of Φ.
pub(super) fn standard_error(
    stderr: &DMatrix<f64>,
    (data, solution): (&DMatrix<f64>, &DMatrix<f64>),
    c: &DMatrix<f64>,
) -> DVector<f64> {
    let (pixels, elements) = c.shape();
    let variance = stderr.component_mul(stderr);
    let across = data.transpose();
    let mut errors = DVector::zeros(elements);
    for first in (0..elements).step_by(ELEMENTS) {
        let count = ELEMENTS.min(elements - first);
        let share = c.columns(first, count).map(|x| 1.0 / (x * x));
        let seen = tr_product(&variance, &share);
        let sharp = product(&across, &solution.columns(first, count).into_owned());
        for j in 0..count {
            let terms = seen.column(j).zip_map(&sharp.column(j), |v, s| v * s * s);
            let sum = terms.sum();
            errors[first + j] = sum.sqrt() / pixels as f64;
        }
    }
    errors
}

/// The covariance matrix for independent entries, r × r:
///
/// > cov_jk = (1/p²) Σ_l D^#\[l,j\] D^#\[l,k\] Σ_p σ²\[p,l\]/(C\[p,j\] C\[p,k\])
///
/// The sums as they stand cost p·l·r². 1/C is smooth in p and j, so its columns, scaled to norm 1,
/// are U T with few (k) orthonormal columns to rounding, and Σ_p σ² … = Tᵀ (Uᵀ diag(σ²_l) U) T:
/// l·(p·k² + k²·r + k·r²) operations.
pub(super) fn covariance(
    stderr: &DMatrix<f64>,
    sharp: &DMatrix<f64>,
    c: &DMatrix<f64>,
) -> Result<DMatrix<f64>, LinalgError> {
    let (pixels, elements) = c.shape();
    let over_c = c.map(|x| 1.0 / x);
    let norms: Vec<f64> = over_c.column_iter().map(|column| column.norm()).collect();
    let smooth = svd_to(&columns_over(over_c, &norms), Tolerance::Auto)?;
    let (rank, _) = smooth.cut(Tolerance::Auto)?;
    let u = smooth.u.columns(0, rank).into_owned();
    let t = rows_times(smooth.vt.rows(0, rank).into_owned(), &smooth.sigma);
    let mut sum = DMatrix::zeros(elements, elements);
    for (errors, inverse) in stderr.column_iter().zip(sharp.row_iter()) {
        let noise = rows_times(u.clone(), errors.iter());
        let along = columns_times(t.clone(), inverse.iter());
        // Products of transposed copies: nalgebra blocks those, and not tr_mul.
        let weighted = noise.transpose() * &noise * &along;
        sum.gemm(1.0, &along.transpose(), &weighted, 1.0);
    }
    let pixels = pixels as f64;
    Ok(DMatrix::from_fn(elements, elements, |j, k| {
        // Both halves are the same sum; their mean is symmetric to the last bit.
        0.5 * (sum[(j, k)] + sum[(k, j)]) * (norms[j] / pixels) * (norms[k] / pixels)
    }))
}

/// The resolution matrix R of E ρ̂ = R ρ, r × r: R_jk = (D D^#)_kj · (1/p) Σ_p C\[p,k\]/C\[p,j\].
/// Cost p·r².
pub(super) fn resolution(c: &DMatrix<f64>, product: &DMatrix<f64>) -> DMatrix<f64> {
    let share = tr_product(&c.map(|x| 1.0 / x), c) / c.nrows() as f64;
    share.component_mul(&product.transpose())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::num::linalg::svd;
    use crate::recovery::bench::{Bench, normal_stream, relative_noise};
    use crate::recovery::{Method, Options, Problem, Uncertainty, recover};

    /// Every linear method that 2 × 2 elements and 120 spots allow, with a parameter.
    const METHODS: [Method; 7] = [
        Method::Pinv,
        Method::RightInverse,
        Method::Rdivide,
        Method::RdivideMinNorm,
        Method::Tsvd,
        Method::Tikhonov,
        Method::TikhonovGradient,
    ];

    fn options() -> Options {
        Options {
            rank: Some(3),
            damping: Some(0.05),
            ..Options::default()
        }
    }

    fn uneven(bench: &Bench) -> DMatrix<f64> {
        let (pixels, spots) = (bench.c.nrows(), bench.d.ncols());
        DMatrix::from_fn(pixels, spots, |p, l| {
            1e-14 * (1.0 + ((p * 5 + l * 3) % 11) as f64)
        })
    }

    #[test]
    fn the_covariance_is_its_definition() {
        let bench = Bench::new(3.0, 3, 4);
        let stderr = uneven(&bench);
        let sharp = DMatrix::from_fn(120, 9, |l, j| ((l * 7 + j * 5) % 13) as f64 - 6.0);
        let found = covariance(&stderr, &sharp, &bench.c).unwrap();
        for j in 0..9 {
            for k in 0..9 {
                let mut sum = 0.0;
                for p in 0..16 {
                    for l in 0..120 {
                        sum += stderr[(p, l)].powi(2) * sharp[(l, j)] * sharp[(l, k)]
                            / (bench.c[(p, j)] * bench.c[(p, k)]);
                    }
                }
                let scale = (found[(j, j)] * found[(k, k)]).sqrt();
                assert!((found[(j, k)] - sum / 256.0).abs() < 1e-12 * scale);
            }
        }
        let factors = (&DMatrix::identity(120, 120), &sharp);
        let errors = standard_error(&stderr, factors, &bench.c);
        let diagonal = found.diagonal().map(f64::sqrt);
        assert!((diagonal.component_div(&errors)).add_scalar(-1.0).amax() < 1e-12);
    }

    /// z² = (ρ̂ − Rρ)ᵀ cov⁻¹ (ρ̂ − Rρ) is χ² of as many degrees as the covariance has rank, for
    /// every method.
    #[test]
    fn noise_spreads_the_estimate_by_its_covariance() {
        let bench = Bench::new(6.0, 2, 3);
        let board = bench.board(2);
        let exact = bench.phi(&board);
        let stderr = uneven(&bench);
        for method in METHODS {
            let mut normal = normal_stream(17);
            let trials = 400;
            let (mut sum, mut degrees) = (0.0, 0);
            for _ in 0..trials {
                let phi = exact.zip_map(&stderr, |x, s| x + s * normal());
                let problem = Problem::new(&phi, &bench.c, &bench.d, Some(&stderr))
                    .and_then(|p| p.with_grids(&[[2, 2]]))
                    .unwrap();
                let found = recover(method, &problem, &options()).unwrap();
                let error = &found.reflectance - found.resolution.unwrap() * &board;
                let errors = found.standard_error.unwrap();
                let covariance = found.covariance.unwrap();
                let correlation = DMatrix::from_fn(4, 4, |j, k| {
                    covariance[(j, k)] / (errors[j].max(1e-300) * errors[k].max(1e-300))
                });
                let z = error.zip_map(&errors, |e, s| if s > 0.0 { e / s } else { 0.0 });
                let eigen = svd(&correlation).unwrap();
                let (rank, _) = eigen.cut(Tolerance::Relative(1e-9)).unwrap();
                degrees = rank;
                for i in 0..rank {
                    sum += (eigen.vt.row(i) * &z)[0].powi(2) / eigen.sigma[i];
                }
            }
            // χ² of T·k degrees over T·k: five standard deviations √(2/(T k)).
            let all = f64::from(trials) * degrees as f64;
            let mean = sum / all;
            assert!(
                degrees >= 3 && (mean - 1.0).abs() < 5.0 * (2.0 / all).sqrt(),
                "{method}: {mean} with {degrees} degrees"
            );
        }
    }

    /// Column k of R is what a unit of reflectance in element k alone gives, by the map itself.
    #[test]
    fn the_resolution_is_the_response_to_one_element() {
        let bench = Bench::new(6.0, 2, 3);
        for method in METHODS.into_iter().chain([Method::JointUnbounded]) {
            for k in 0..4 {
                let one = DVector::from_fn(4, |j, _| f64::from(u8::from(j == k)));
                let phi = bench.phi(&one);
                let problem = Problem::new(&phi, &bench.c, &bench.d, None)
                    .and_then(|p| p.with_grids(&[[2, 2]]))
                    .unwrap();
                let found = recover(method, &problem, &options()).unwrap();
                let resolution = found.resolution.unwrap();
                let error = (resolution.column(k) - &found.reflectance).amax();
                assert!(error < 1e-10, "{method}, element {k}: {error:e}");
                assert!((resolution.trace() - found.effective_rank).abs() < 1e-10);
            }
        }
    }

    #[test]
    fn the_covariance_can_be_left_out() {
        let bench = Bench::new(6.0, 2, 3);
        let (phi, stderr) = relative_noise(&bench.phi(&bench.board(2)), 1e-3, 2);
        let problem = Problem::new(&phi, &bench.c, &bench.d, Some(&stderr)).unwrap();
        let options = Options {
            uncertainty: Uncertainty::StandardError,
            ..Options::default()
        };
        let found = recover(Method::Pinv, &problem, &options).unwrap();
        assert!(found.covariance.is_none() && found.standard_error.is_some());
    }
}
