//! Generalised Tikhonov: differences between neighbouring elements are damped, not the values
//! themselves.
//!
//! Pixel p sees X\[p,j\] = C\[p,j\] ρ_j, which falls over the surface with C however even ρ is; so
//! it is not X that should be smooth but X over C's mean profile c̄_j = (1/p) Σ_p |C\[p,j\]|. With
//! X = Z diag(c̄), D̄ = diag(c̄) D,
//!
//! > minimise ‖Z D̄ − Φ‖² + λ² ‖Z Lᵀ‖²,
//!
//! L the differences along u and along v within each grid. A constant on a grid costs nothing:
//! where C\[p,j\] = w_p c̄_j an even board is recovered unbiased at any λ; where pixels see the
//! elements by different profiles it is biased by the difference of their profiles.
//!
//! Standard form (Eldén 1982), A = D̄ᵀ: LᵀL is the Laplacian of the grid with free edges, whose
//! eigenvectors are products of cosines, its null vectors N the constants. With L̃⁺ = V Λ^{−½} of
//! the others and L⁺_A = (1 − N (A N)⁺ A) L̃⁺ the singular directions of A L⁺_A are damped as those
//! of D are in plain Tikhonov, and those of A N not at all. λ is stated as a fraction of the
//! largest singular value of A L⁺_A.

use nalgebra::DMatrix;

use super::laplacian::modes;
use super::{Inverse, damping, decompose};
use crate::num::linalg::{
    Tolerance, columns_over, columns_times, complement, product, rows_over, svd, svd_to, tr_product,
};
use crate::recovery::{Method, Options, Parameter, Problem, RecoveryError, Spectrum};

/// Elements whose modes, a matrix of elements × elements, are still formed: 512 MiB.
const MOST_ELEMENTS: usize = 8192;

pub(super) fn inverse(problem: &Problem<'_>, options: &Options) -> Result<Inverse, RecoveryError> {
    let method = Method::TikhonovGradient;
    let elements = problem.d.nrows();
    if elements > MOST_ELEMENTS {
        let most = MOST_ELEMENTS;
        return Err(RecoveryError::TooManyElements { elements, most });
    }
    decompose(method, problem, Tolerance::Auto)?;
    let grids = problem.grids.unwrap_or_default();
    if grids.iter().all(|[nu, nv]| nu * nv == 1) {
        return Err(RecoveryError::NoGrids { method });
    }
    let spectrum = spectrum(problem, grids)?;
    let (damping, choice) = damping::choose(method, problem, options, &spectrum)?;
    let filter = spectrum.damped(damping * spectrum.sigma.first().unwrap_or(&0.0));
    let why = (Parameter::Damping(damping), choice);
    Ok(Inverse::filtered(options, &spectrum, &filter, why))
}

fn spectrum(problem: &Problem<'_>, grids: &[[usize; 2]]) -> Result<Spectrum, RecoveryError> {
    let (elements, spots) = problem.d.shape();
    let pixels = problem.c.nrows() as f64;
    let profile: Vec<f64> = problem
        .c
        .column_iter()
        .map(|c| c.iter().map(|x| x.abs()).sum::<f64>() / pixels)
        .collect();
    let a = DMatrix::from_fn(spots, elements, |l, j| problem.d[(j, l)] * profile[j]);
    let (constants, smooth) = modes(grids);

    let level = &a * &constants;
    let flat = svd(&level)?;
    let (free, _) = flat.cut(Tolerance::Auto)?;
    let seen = flat.u.columns(0, free).into_owned();
    // (A N)⁺ row by row: N v_i/σ_i, the even board that direction i of A N stands for.
    let even = &constants * flat.vt.rows(0, free).transpose();
    let even = columns_over(even, &flat.sigma);

    let steep = product(&a, &smooth);
    let oblique = smooth - &even * tr_product(&seen, &steep);
    // Decomposed within the complement of what the constants reach, the directions are orthogonal
    // to it to rounding, however weak.
    let outside = complement(&seen)?;
    let rest = outside.coordinates(&steep);
    let uneven = match rest.nrows() {
        0 => None,
        _ => Some(svd_to(&rest, Tolerance::Auto)?),
    };
    let rounding = spots.max(elements) as f64 * f64::EPSILON * steep.norm();
    let sigma: Vec<f64> = uneven
        .iter()
        .flat_map(|s| s.sigma.iter().copied())
        .collect();
    let kept = sigma.iter().take_while(|&&s| s > rounding).count();

    let mut data = DMatrix::zeros(free + kept, spots);
    let mut solution = DMatrix::zeros(free + kept, elements);
    data.rows_mut(0, free).tr_copy_from(&seen);
    solution.rows_mut(0, free).tr_copy_from(&even);
    if let Some(uneven) = uneven {
        let directions = uneven.u.columns(0, kept).into_owned();
        data.rows_mut(free, kept)
            .tr_copy_from(&outside.vectors(&directions));
        let damped = product(&uneven.vt.rows(0, kept).into_owned(), &oblique.transpose());
        let damped = rows_over(damped, &sigma);
        solution.rows_mut(free, kept).copy_from(&damped);
    }
    let solution = columns_times(solution, &profile);
    Ok(Spectrum {
        image: &data * problem.d.transpose(),
        data,
        solution,
        sigma,
        free,
    })
}

#[cfg(test)]
mod tests {
    use nalgebra::DVector;

    use super::*;
    use crate::recovery::bench::{Bench, modulation, relative_noise};
    use crate::recovery::pixelwise::laplacian::differences;
    use crate::recovery::recover as by_method;

    fn given(damping: f64) -> Options {
        Options {
            damping: Some(damping),
            ..Options::default()
        }
    }

    /// Z (D̄ D̄ᵀ + λ² LᵀL) = Φ D̄ᵀ, the definition of the estimate, for two grids.
    #[test]
    fn it_solves_the_penalised_normal_equations() {
        let bench = Bench::new(6.0, 3, 4);
        let (phi, _) = relative_noise(&bench.phi(&bench.board(3)), 0.1, 2);
        let grids = [[3, 2], [3, 1]];
        let problem = Problem::new(&phi, &bench.c, &bench.d, None)
            .and_then(|p| p.with_grids(&grids))
            .unwrap();
        let mut laplacian = DMatrix::zeros(9, 9);
        for (first, grid) in [(0, grids[0]), (6, grids[1])] {
            let (l, n) = (differences(grid), grid[0] * grid[1]);
            laplacian
                .view_mut((first, first), (n, n))
                .copy_from(&l.tr_mul(&l));
        }
        let profile = DVector::from_fn(9, |j, _| bench.c.column(j).mean());
        let d = DMatrix::from_fn(9, 120, |j, l| profile[j] * bench.d[(j, l)]);
        for damping in [1e-3, 0.1, 10.0] {
            let found = by_method(Method::TikhonovGradient, &problem, &given(damping)).unwrap();
            let lambda = damping * found.sigma[0];
            let system = &d * d.transpose() + &laplacian * (lambda * lambda);
            // Scaled to numbers near one, where the solver of the test has its digits.
            let scale = d.norm().powi(2);
            let z = (system / scale)
                .lu()
                .solve(&(&d * phi.transpose() / scale))
                .unwrap();
            for j in 0..9 {
                let shares = (0..16).map(|p| z[(j, p)] * profile[j] / bench.c[(p, j)]);
                let mean = shares.sum::<f64>() / 16.0;
                assert!(
                    (found.reflectance[j] - mean).abs() < 1e-7,
                    "{damping}: {} {mean}",
                    found.reflectance[j]
                );
            }
        }
    }

    #[test]
    fn an_even_board_is_unbiased_at_any_damping() {
        let bench = Bench::new(3.0, 4, 4);
        let profile = bench.c.row(0).clone_owned();
        let c = DMatrix::from_fn(16, 16, |p, j| profile[j] * (1.0 + p as f64));
        let phi = &c * DMatrix::from_diagonal_element(16, 16, 0.37) * &bench.d;
        let problem = Problem::new(&phi, &c, &bench.d, None)
            .and_then(|p| p.with_grids(&[[4, 4]]))
            .unwrap();
        for damping in [1e-9, 1e-3, 1.0, 1e6] {
            let found = by_method(Method::TikhonovGradient, &problem, &given(damping)).unwrap();
            let worst = found.reflectance.add_scalar(-0.37).amax();
            assert!(worst < 1e-8, "{damping}: {worst:e}");
            // Plain Tikhonov pulls it to zero.
            let plain = by_method(Method::Tikhonov, &problem, &given(damping)).unwrap();
            assert!(damping < 1.0 || plain.reflectance.amax() < 0.3);
        }
        // Strong damping leaves the even board alone of all that is seen: one direction.
        let found = by_method(Method::TikhonovGradient, &problem, &given(1e6)).unwrap();
        assert!((found.effective_rank - 1.0).abs() < 1e-9);
    }

    #[test]
    fn the_rules_choose_its_damping_too() {
        let bench = Bench::new(3.0, 8, 8);
        let board = bench.board(2);
        let (phi, stderr) = relative_noise(&bench.phi(&board), 1e-4, 4);
        let problem = Problem::new(&phi, &bench.c, &bench.d, Some(&stderr))
            .and_then(|p| p.with_grids(&[[8, 8]]))
            .unwrap();
        for rule in crate::recovery::Rule::ALL {
            let options = Options {
                rule,
                ..Options::default()
            };
            let found = by_method(Method::TikhonovGradient, &problem, &options).unwrap();
            assert!(
                found.effective_rank > 2.0 && found.effective_rank < found.rank as f64,
                "{rule}: {}",
                found.effective_rank
            );
            let mtf = modulation(&found.reflectance, &board);
            assert!(mtf > 0.2, "{rule}: {mtf}");
        }
    }

    #[test]
    fn a_single_spot_shows_an_even_board() {
        let bench = Bench::new(3.0, 2, 2);
        let d = bench.d.columns(0, 1).into_owned();
        let profile = bench.c.row(0).clone_owned();
        let c = DMatrix::from_fn(4, 4, |_, j| profile[j]);
        let phi = &c * &d * 0.5;
        let problem = Problem::new(&phi, &c, &d, None)
            .and_then(|p| p.with_grids(&[[2, 2]]))
            .unwrap();
        let found = by_method(Method::TikhonovGradient, &problem, &Options::default()).unwrap();
        assert!(found.reflectance.add_scalar(-0.5).amax() < 1e-12);
        assert_eq!(found.rank, 1);
    }

    #[test]
    fn without_grids_it_says_what_it_needs() {
        let bench = Bench::new(3.0, 2, 2);
        let phi = bench.phi(&bench.board(2));
        let problem = Problem::new(&phi, &bench.c, &bench.d, None).unwrap();
        for problem in [problem, problem.with_grids(&[[1, 1]; 4]).unwrap()] {
            let error = by_method(Method::TikhonovGradient, &problem, &given(0.1)).unwrap_err();
            assert!(
                matches!(error, RecoveryError::NoGrids { .. })
                    && error.to_string().contains("element grids"),
                "{error}"
            );
        }
    }
}
