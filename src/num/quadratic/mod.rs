//! Least squares in a box: the one door to the convex solver `clarabel`.

mod active_set;
mod interior_point;

use nalgebra::{DMatrix, DVector};

use super::linalg::LinalgError;

/// Largest duality gap accepted, as a fraction of ½(‖d‖² + ‖R‖²).
const GAP_ALLOWED: f64 = 1e-9;

/// The minimiser of ½‖R x − d‖² over 0 ≤ x ≤ 1.
#[derive(Debug, Clone, PartialEq)]
pub struct BoxSolution {
    /// x, every entry in [0, 1].
    pub solution: DVector<f64>,
    /// What the interior-point solver said of itself.
    pub status: String,
    /// Interior-point iterations.
    pub iterations: u32,
    /// Steps of the active-set refinement after it.
    pub refinements: usize,
    /// ½‖R x − d‖².
    pub objective: f64,
    /// Upper bound on how far the objective lies above its minimum, from the optimality conditions at x and so
    /// independent of either solver.
    pub gap: f64,
}

/// Why no minimiser was found.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum QuadraticError {
    /// A matrix or vector that cannot be used.
    #[error(transparent)]
    Linalg(#[from] LinalgError),
    /// The solver refused the problem.
    #[error(
        "the bounded least-squares problem was refused by the solver ({0}); check the sizes and scales of its matrices"
    )]
    Refused(String),
    /// The solver ended away from the minimum.
    #[error(
        "bounded least squares ended {gap:.1e} above its minimum (relative; allowed {allowed:.1e}), solver status {status}; \
         scale the problem, or recover without bounds"
    )]
    NotSolved {
        /// What the solver said.
        status: String,
        /// Duality gap relative to ½(‖d‖² + ‖R‖²).
        gap: f64,
        /// The largest such gap accepted.
        allowed: f64,
    },
}

/// Where a variable stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Place {
    Free,
    Lower,
    Upper,
}

/// min ½‖R x − d‖² subject to 0 ≤ x ≤ 1, for R of k × n.
///
/// The condition of R is never squared: the interior-point solver works on the residuals as variables,
///
/// > min ½ yᵀy   subject to   y = R x − d,   0 ≤ x ≤ 1,
///
/// with R's columns scaled to unit length. Its answer tells which bounds hold; an active-set refinement (Stark and
/// Parker's bounded-variable least squares, started there) then solves for the rest by QR to full precision, never
/// raising the objective. The returned gap is the least that three dual points ν prove by weak duality, with g = Rᵀν:
///
/// > f(x) − f* ≤ ½‖R x − d − ν‖² + Σ_j max(g_j x_j, −g_j (1 − x_j)),
///
/// ν the residual R x − d, its part orthogonal to the columns of the variables between their bounds (which rounding of a
/// large d disturbs least), and the solver's own y.
///
/// # Errors
/// Empty or non-finite input, shapes that do not fit, or a gap above 1e-9 · ½(‖d‖² + ‖R‖²).
pub fn box_least_squares(
    r: &DMatrix<f64>,
    d: &DVector<f64>,
) -> Result<BoxSolution, QuadraticError> {
    let (k, n) = r.shape();
    if r.is_empty() {
        return Err(LinalgError::Empty {
            rows: k,
            columns: n,
        }
        .into());
    }
    if d.len() != k {
        return Err(LinalgError::Shape {
            what: "entries of d against rows of R",
            expected: k,
            found: d.len(),
        }
        .into());
    }
    let scale = r.amax().max(d.amax());
    if let Some(at) = r.iter().chain(d.iter()).position(|x| !x.is_finite()) {
        let value = if at < k * n { r[at] } else { d[at - k * n] };
        return Err(LinalgError::NotFinite {
            row: at % k,
            column: at / k,
            value,
        }
        .into());
    }
    let exponent = if scale > 0.0 { libm::ilogb(scale) } else { 0 };
    let down = |x: f64| libm::scalbn(x, -exponent);
    let (r, d) = (r.map(down), d.map(down));

    let start = interior_point::solve(&r, &d)?;
    let (solution, refinements) = active_set::refine(&r, &d, start.x, start.places)?;
    let residual = &r * &solution - &d;
    let orthogonal = active_set::orthogonal_to_free(&r, &residual, &solution)?;
    let gap = [&residual, &orthogonal, &start.y]
        .map(|dual| duality_gap(&r, &residual, dual, &solution))
        .into_iter()
        .fold(f64::INFINITY, f64::min);
    let unit = 0.5 * (r.norm_squared() + d.norm_squared());
    if gap.is_nan() || gap > GAP_ALLOWED * unit {
        return Err(QuadraticError::NotSolved {
            status: start.status,
            gap: gap / unit,
            allowed: GAP_ALLOWED,
        });
    }
    let up = |x: f64| libm::scalbn(x, 2 * exponent);
    Ok(BoxSolution {
        solution,
        status: start.status,
        iterations: start.iterations,
        refinements,
        objective: up(0.5 * residual.norm_squared()),
        gap: up(gap),
    })
}

/// The bound on f(x) − f* that the dual point ν proves; NaN where ν is.
fn duality_gap(
    r: &DMatrix<f64>,
    residual: &DVector<f64>,
    dual: &DVector<f64>,
    x: &DVector<f64>,
) -> f64 {
    let gradient = r.transpose() * dual;
    let bounds: f64 = gradient
        .iter()
        .zip(x.iter())
        .map(|(g, x)| (g * x).max(-g * (1.0 - x)))
        .sum();
    0.5 * (residual - dual).norm_squared() + bounds
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_diagonal_problem_is_the_clipped_quotient() {
        // Separable: x_j = clamp(d_j/R_jj, 0, 1).
        let r = DMatrix::from_diagonal(&DVector::from_row_slice(&[2.0, 1e-3, 5.0, 1.0]));
        let d = DVector::from_row_slice(&[1.0, 5.0, -3.0, 0.25]);
        let found = box_least_squares(&r, &d).unwrap();
        assert!((found.solution - DVector::from_row_slice(&[0.5, 1.0, 0.0, 0.25])).amax() < 1e-15);
        // What is left: 5 − 0.001 and −3 − 0.
        assert!((found.objective - 0.5 * (4.999f64.powi(2) + 9.0)).abs() < 1e-14 * found.objective);
    }

    #[test]
    fn a_coupled_problem_matches_its_hand_solution() {
        // min (x₁ + x₂ − 3)² + (x₁ − x₂)²: free minimum (1.5, 1.5), in the box (1, 1).
        // min (x₁ + 2x₂ − 1)² + (x₁ + 1)²: free x₁ = −1; with x₁ = 0 the rest gives x₂ = ½.
        let r = DMatrix::from_row_slice(2, 2, &[1.0, 1.0, 1.0, -1.0]);
        let found = box_least_squares(&r, &DVector::from_row_slice(&[3.0, 0.0])).unwrap();
        assert!((found.solution - DVector::from_row_slice(&[1.0, 1.0])).amax() < 1e-15);
        let r = DMatrix::from_row_slice(2, 2, &[1.0, 2.0, 1.0, 0.0]);
        let found = box_least_squares(&r, &DVector::from_row_slice(&[1.0, -1.0])).unwrap();
        assert!((found.solution - DVector::from_row_slice(&[0.0, 0.5])).amax() < 1e-14);
        assert!(found.gap < 1e-14);
    }

    #[test]
    fn ill_conditioned_corner_is_found_at_any_scale() {
        // Hilbert 10 × 10 (condition 1.6e13), d from a corner of the box and a point inside it.
        let r = DMatrix::from_fn(10, 10, |i, j| 1.0 / (i + j + 1) as f64);
        let corner = DVector::from_fn(10, |j, _| f64::from(u8::from(j % 3 == 0)));
        for factor in [1.0, 1e-13, 1e120] {
            let found = box_least_squares(&(&r * factor), &(&r * &corner * factor)).unwrap();
            // Conditioned by the corner: the bounds decide what the matrix cannot; eps·cond = 3e-3 without them.
            assert!(
                (&found.solution - &corner).amax() < 1e-3,
                "{factor}: {}",
                found.solution
            );
            assert!(
                found.gap <= 1e-15 * factor * factor,
                "{factor}: {}",
                found.gap
            );
        }
    }

    #[test]
    fn every_dual_point_bounds_the_distance_from_the_minimum() {
        let r = DMatrix::from_fn(9, 6, |i, j| (((i * 31 + j * 17) % 13) as f64 - 6.0) / 6.0);
        let d = DVector::from_fn(9, |i, _| ((i * 7) % 5) as f64 - 1.0);
        let least = box_least_squares(&r, &d).unwrap();
        for k in 0..50 {
            let number = |i: usize| ((k * 29 + i * 53) % 97) as f64 / 96.0;
            let x = DVector::from_fn(6, |j, _| number(j));
            let dual = DVector::from_fn(9, |i, _| 4.0 * number(i + 6) - 2.0);
            let residual = &r * &x - &d;
            let excess = 0.5 * residual.norm_squared() - least.objective;
            for dual in [&dual, &residual] {
                assert!(duality_gap(&r, &residual, dual, &x) >= excess - 1e-12);
            }
        }
        // At the minimum the residual's own bound is tight.
        let residual = &r * &least.solution - &d;
        assert!(duality_gap(&r, &residual, &residual, &least.solution) < 1e-12);
    }

    #[test]
    fn degenerate_and_bad_input() {
        let flat = box_least_squares(&DMatrix::zeros(2, 3), &DVector::from_row_slice(&[1.0, 2.0]))
            .unwrap();
        assert!(flat.solution.iter().all(|x| (0.0..=1.0).contains(x)));
        assert_eq!((flat.gap, flat.objective), (0.0, 2.5));
        let wide = box_least_squares(
            &DMatrix::from_element(1, 3, 1.0),
            &DVector::from_element(1, 1.5),
        )
        .unwrap();
        assert!((wide.solution.sum() - 1.5).abs() < 1e-14);
        assert!(box_least_squares(&DMatrix::zeros(0, 3), &DVector::zeros(0)).is_err());
        assert!(box_least_squares(&DMatrix::zeros(2, 3), &DVector::zeros(3)).is_err());
        assert!(
            box_least_squares(&DMatrix::from_element(1, 1, f64::NAN), &DVector::zeros(1)).is_err()
        );
        assert!(
            box_least_squares(
                &DMatrix::zeros(1, 1),
                &DVector::from_element(1, f64::INFINITY)
            )
            .is_err()
        );
    }
}
