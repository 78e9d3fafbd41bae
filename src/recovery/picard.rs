//! The Picard condition: does the signal fall faster than the singular values, and where does noise
//! take over?

use nalgebra::DVector;

use super::{Problem, RecoveryError};
use crate::num::linalg::{Tolerance, product};

/// Whose singular directions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Directions {
    /// The laser side's; root mean squares over the pixels, W.
    LaserSide,
    /// Those of the joint operator, all entries weighted alike; W.
    Joint,
    /// Those of the joint operator weighted by the noise; about standard deviations.
    JointWeighted,
}

/// The data in singular directions. Of the laser side D = U Σ Vᵀ ([`picard`]): an inverse divides
/// each by its σ_i, so a direction is of use only while its coefficient lies above the noise. Root
/// mean squares over the pixels. Of the joint operator: [`picard_joint`](super::picard_joint).
#[derive(Debug, Clone, PartialEq)]
pub struct Picard {
    /// Whose directions, and so the unit.
    pub directions: Directions,
    /// Singular values of D, descending; C times D is in W. Or those of the joint operator. Of a
    /// large problem only those above rounding.
    pub sigma: DVector<f64>,
    /// √((1/p) Σ_p (Φ v_i)_p²), W. Or |⟨u_i, √W Φ⟩|.
    pub coefficient: DVector<f64>,
    /// What noise alone makes of it, √((1/p) Σ_pl σ²\[p,l\] v_il²), W, or √(Σ_pl u_i\[p,l\]²
    /// w\[p,l\] σ²\[p,l\]); none without a noise model.
    pub noise: Option<DVector<f64>>,
}

/// The Picard data of Φ and D.
///
/// # Errors
/// [`RecoveryError::Dark`], [`RecoveryError::RankZero`], a decomposition that failed.
pub fn picard(problem: &Problem<'_>) -> Result<Picard, RecoveryError> {
    problem.refuse_darkness()?;
    let laser = problem.laser(Tolerance::Auto)?;
    let pixels = problem.phi.nrows() as f64;
    let along = product(problem.phi, &laser.vt.transpose());
    let root_mean_square = |sum: f64| (sum / pixels).sqrt();
    let coefficient = DVector::from_iterator(
        laser.sigma.len(),
        along
            .column_iter()
            .map(|c| root_mean_square(c.norm_squared())),
    );
    let noise = problem.noise().map(|stderr| {
        let squares = laser.vt.component_mul(&laser.vt);
        let variance = DVector::from_iterator(
            stderr.ncols(),
            stderr.column_iter().map(|c| c.norm_squared()),
        );
        (squares * variance).map(root_mean_square)
    });
    Ok(Picard {
        directions: Directions::LaserSide,
        sigma: laser.sigma,
        coefficient,
        noise,
    })
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;

    use super::*;
    use crate::num::linalg::svd;
    use crate::recovery::bench::{Bench, normal_stream};

    #[test]
    fn without_noise_the_coefficients_are_sigma_times_the_object() {
        // Φ = Y D with Y = C ∘ ρ: Φ v_i = σ_i Y u_i, and all of Φ is found along the directions.
        let bench = Bench::new(6.0, 3, 4);
        let phi = bench.phi(&bench.board(3));
        let found = picard(&Problem::new(&phi, &bench.c, &bench.d, None).unwrap()).unwrap();
        let mut y = bench.c.clone();
        for (mut column, &rho) in y.column_iter_mut().zip(bench.board(3).iter()) {
            column *= rho;
        }
        let u = svd(&bench.d).unwrap().u;
        for i in 0..9 {
            let want = found.sigma[i] * (&y * u.column(i)).norm() / 4.0;
            assert!((found.coefficient[i] - want).abs() < 1e-14 * found.coefficient[0]);
        }
        assert!((found.coefficient.norm() * 4.0 / phi.norm() - 1.0).abs() < 1e-12);
        assert_eq!(found.noise, None);
    }

    #[test]
    fn pure_noise_lies_at_its_level() {
        let bench = Bench::new(3.0, 4, 16);
        let stderr = DMatrix::from_fn(256, 120, |p, l| (1 + p % 3 + l % 7) as f64);
        let mut normal = normal_stream(12);
        let phi = stderr.map(|s| s * normal());
        let problem = Problem::new(&phi, &bench.c, &bench.d, Some(&stderr)).unwrap();
        let found = picard(&problem).unwrap();
        // A mean of 256 squares scatters by √(2/256) of itself, its root by half: five of those, a
        // bit more for unequal weights.
        let ratio = found.coefficient.component_div(&found.noise.unwrap());
        assert!(ratio.add_scalar(-1.0).amax() < 0.3, "{ratio}");
        assert!((ratio.mean() - 1.0).abs() < 0.05);
    }
}
