//! Least squares in a box: the one door to the convex solver `clarabel`.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettingsBuilder, DefaultSolver, IPSolver, NonnegativeConeT, ZeroConeT,
};
use nalgebra::{DMatrix, DVector};

use super::linalg::{LinalgError, Tolerance, least_squares};

/// Largest duality gap accepted, as a fraction of ½(‖d‖² + ‖R‖²).
const GAP_ALLOWED: f64 = 1e-9;

/// Floating-point operations that the active-set refinement may spend.
const REFINEMENT_BUDGET: f64 = 1e11;

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
/// raising the objective. With g = Rᵀ(R x − d) the returned gap is
///
/// > f(x) − f* ≤ Σ_j max(g_j x_j, −g_j (1 − x_j)).
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

    let (start, places, status, iterations) = interior_point(&r, &d)?;
    let (solution, refinements) = refine(&r, &d, start, places)?;
    let residual = &r * &solution - &d;
    let gap = duality_gap(&r, &residual, &solution);
    let unit = 0.5 * (r.norm_squared() + d.norm_squared());
    if gap.is_nan() || gap > GAP_ALLOWED * unit {
        return Err(QuadraticError::NotSolved {
            status,
            gap: gap / unit,
            allowed: GAP_ALLOWED,
        });
    }
    let up = |x: f64| libm::scalbn(x, 2 * exponent);
    Ok(BoxSolution {
        solution,
        status,
        iterations,
        refinements,
        objective: up(0.5 * residual.norm_squared()),
        gap: up(gap),
    })
}

fn duality_gap(r: &DMatrix<f64>, residual: &DVector<f64>, x: &DVector<f64>) -> f64 {
    let gradient = r.transpose() * residual;
    gradient
        .iter()
        .zip(x.iter())
        .map(|(g, x)| (g * x).max(-g * (1.0 - x)))
        .sum()
}

/// The interior-point solution clipped to the box, where each variable stands, the solver's status and iterations.
#[allow(clippy::type_complexity)]
fn interior_point(
    r: &DMatrix<f64>,
    d: &DVector<f64>,
) -> Result<(DVector<f64>, Vec<Place>, String, u32), QuadraticError> {
    let (k, n) = r.shape();
    let lengths: Vec<f64> = r
        .column_iter()
        .map(|c| if c.norm() > 0.0 { c.norm() } else { 1.0 })
        .collect();
    let size = d.norm().max(lengths.iter().copied().fold(0.0, f64::max));
    // Variables (x_j·length_j/size, y/size); rows: y − R x = −d, then −x ≤ 0, then x ≤ length/size.
    let (mut row, mut column, mut value) = (Vec::new(), Vec::new(), Vec::new());
    let mut put = |i, j, v: f64| {
        if v != 0.0 {
            row.push(i);
            column.push(j);
            value.push(v);
        }
    };
    for j in 0..n {
        for i in 0..k {
            put(i, j, -r[(i, j)] / lengths[j]);
        }
        put(k + j, j, -1.0);
        put(k + n + j, j, 1.0);
    }
    for i in 0..k {
        put(i, n + i, 1.0);
    }
    let constraints = CscMatrix::new_from_triplets(k + 2 * n, n + k, row, column, value);
    let on_y: Vec<usize> = (n..n + k).collect();
    let cost = CscMatrix::new_from_triplets(n + k, n + k, on_y.clone(), on_y, vec![1.0; k]);
    let linear = vec![0.0; n + k];
    let upper = lengths.iter().map(|c| c / size);
    let bounds: Vec<f64> = d
        .iter()
        .map(|x| -x / size)
        .chain(std::iter::repeat_n(0.0, n))
        .chain(upper)
        .collect();
    let settings = DefaultSettingsBuilder::default()
        .verbose(false)
        .max_threads(1)
        .tol_gap_abs(1e-12)
        .tol_gap_rel(1e-12)
        .build()
        .map_err(|e| QuadraticError::Refused(e.to_string()))?;
    let cones = [ZeroConeT(k), NonnegativeConeT(2 * n)];
    let mut solver = DefaultSolver::new(&cost, &linear, &constraints, &bounds, &cones, settings)
        .map_err(|e| QuadraticError::Refused(e.to_string()))?;
    solver.solve();
    let found = &solver.solution;
    let status = found.status.to_string();
    let mut x = DVector::from_fn(n, |j, _| found.x[j] * size / lengths[j]);
    if x.iter().any(|x| !x.is_finite()) {
        return Err(QuadraticError::NotSolved {
            status,
            gap: f64::INFINITY,
            allowed: GAP_ALLOWED,
        });
    }
    // A bound holds where its multiplier outweighs the distance to it.
    let places = (0..n)
        .map(|j| match (found.z[k + j], found.z[k + n + j]) {
            (z, _) if found.s[k + j] < z => Place::Lower,
            (_, z) if found.s[k + n + j] < z => Place::Upper,
            _ => Place::Free,
        })
        .collect();
    x.apply(|x| *x = x.clamp(0.0, 1.0));
    Ok((x, places, status, found.iterations))
}

/// Bounded-variable least squares from a given start. Stops at a point where all optimality conditions hold to
/// rounding, or when its budget is spent; the objective never rises from the start's.
fn refine(
    r: &DMatrix<f64>,
    d: &DVector<f64>,
    start: DVector<f64>,
    mut places: Vec<Place>,
) -> Result<(DVector<f64>, usize), QuadraticError> {
    let (k, n) = r.shape();
    let lengths: Vec<f64> = r.column_iter().map(|c| c.norm()).collect();
    let rounding = 4.0 * (k + n) as f64 * f64::EPSILON;
    let objective = |x: &DVector<f64>| (r * x - d).norm();
    let mut x = DVector::from_fn(n, |j, _| match places[j] {
        Place::Free => start[j],
        Place::Lower => 0.0,
        Place::Upper => 1.0,
    });
    let allowed = ((REFINEMENT_BUDGET / (25.0 * (n as f64).powi(3))) as usize).min(3 * n + 10);
    let mut released = None;
    let mut banned = vec![false; n];
    let mut steps = 0;
    while steps < allowed {
        steps += 1;
        let free: Vec<usize> = (0..n)
            .filter(|&j| places[j] == Place::Free && lengths[j] > 0.0)
            .collect();
        let mut stride = 1.0;
        let mut blocked = None;
        if !free.is_empty() {
            let towards =
                least_squares(&r.select_columns(&free), &(d - r * &x), Tolerance::Auto)?.solution;
            for (&j, &step) in free.iter().zip(towards.iter()) {
                let room = if step < 0.0 {
                    x[j] / -step
                } else {
                    (1.0 - x[j]) / step
                };
                if step != 0.0 && room < stride {
                    stride = room;
                    blocked = Some((
                        j,
                        if step < 0.0 {
                            Place::Lower
                        } else {
                            Place::Upper
                        },
                    ));
                }
            }
            for (&j, &step) in free.iter().zip(towards.iter()) {
                x[j] = (x[j] + stride * step).clamp(0.0, 1.0);
            }
        }
        if let Some((j, place)) = blocked {
            x[j] = if place == Place::Lower { 0.0 } else { 1.0 };
            places[j] = place;
            if stride > 0.0 {
                banned.fill(false);
            }
            banned[j] |= released == Some(j) && stride == 0.0;
            released = None;
            continue;
        }
        if released.is_some() {
            banned.fill(false);
        }
        let residual = r * &x - d;
        let gradient = r.transpose() * &residual;
        let unit = d.norm() + residual.norm();
        released = (0..n)
            .filter(|&j| !banned[j] && lengths[j] > 0.0)
            .map(|j| match places[j] {
                Place::Lower => (j, -gradient[j] / lengths[j]),
                Place::Upper => (j, gradient[j] / lengths[j]),
                Place::Free => (j, 0.0),
            })
            .filter(|&(_, pull)| pull > rounding * unit)
            .max_by(|a, b| a.1.total_cmp(&b.1))
            .map(|(j, _)| j);
        match released {
            Some(j) => places[j] = Place::Free,
            None => break,
        }
    }
    if objective(&x) <= objective(&start) * (1.0 + f64::EPSILON) + rounding * d.norm() {
        Ok((x, steps))
    } else {
        Ok((start, steps))
    }
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
    fn refinement_reaches_the_optimum_from_a_bad_start() {
        let r = DMatrix::from_fn(12, 8, |i, j| (((i * 31 + j * 17) % 13) as f64 - 6.0) / 6.0);
        let d = DVector::from_fn(12, |i, _| ((i * 7) % 5) as f64 - 1.0);
        let reference = box_least_squares(&r, &d).unwrap();
        for place in [Place::Free, Place::Lower, Place::Upper] {
            let (x, _) = refine(&r, &d, DVector::from_element(8, 0.5), vec![place; 8]).unwrap();
            assert!((&x - &reference.solution).amax() < 1e-12);
            assert!(duality_gap(&r, &(&r * &x - &d), &x) < 1e-12);
        }
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
