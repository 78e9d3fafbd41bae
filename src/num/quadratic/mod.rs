//! Least squares between bounds: the one door to the convex solver `clarabel`.

mod active_set;
mod certificate;
mod differences;
mod extent;
mod interior_point;

pub use differences::{Fused, fused_least_squares};
pub use extent::extent;

use nalgebra::{DMatrix, DVector};

use super::linalg::LinalgError;
use interior_point::Interior;

/// Largest duality gap accepted, as a fraction of ½(‖d‖² + ‖R‖²).
const GAP_ALLOWED: f64 = 1e-9;

/// Largest duality gap accepted of a start near the minimum, as a fraction of the objective.
const NEAR_ALLOWED: f64 = 1e-6;

/// The bounds of the variables, l ≤ x ≤ u: l finite, u finite or infinite, l ≤ u.
#[derive(Debug, Clone, PartialEq)]
pub struct Bounds {
    /// l.
    pub lower: DVector<f64>,
    /// u.
    pub upper: DVector<f64>,
}

impl Bounds {
    /// l ≤ x ≤ u, the same for all n variables.
    pub fn all(n: usize, lower: f64, upper: f64) -> Self {
        Bounds {
            lower: DVector::from_element(n, lower),
            upper: DVector::from_element(n, upper),
        }
    }
}

/// The minimiser of ½‖R x − d‖² between bounds.
#[derive(Debug, Clone, PartialEq)]
pub struct BoxSolution {
    /// x, every entry between its bounds.
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
    /// Bounds without a number between them.
    #[error(
        "variable {variable} shall lie between {lower} and {upper}; give a finite lower bound and an upper one that is not below it"
    )]
    Bounds {
        /// Which variable, from 0.
        variable: usize,
        /// Its lower bound.
        lower: f64,
        /// Its upper bound.
        upper: f64,
    },
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

/// min ½‖R x − d‖² subject to l ≤ x ≤ u, for R of k × n.
///
/// The condition of R is never squared: the interior-point solver works on the residuals as variables,
///
/// > min ½ yᵀy   subject to   y = R x − d,   l ≤ x ≤ u,
///
/// with R's columns scaled to unit length. Its answer tells which bounds hold; an active-set refinement (Stark and
/// Parker's bounded-variable least squares, started there) then solves for the rest by QR to full precision, never
/// raising the objective. The returned gap is the least that three dual points prove by weak duality:
/// the residual R x − d, its part orthogonal to the columns of the variables between their bounds (which rounding of a
/// large d disturbs least), and the solver's own y.
///
/// # Errors
/// Empty or non-finite input, shapes that do not fit, bounds that no number keeps, or a gap above 1e-9 · ½(‖d − R l‖² + ‖R‖²).
pub fn box_least_squares(
    r: &DMatrix<f64>,
    d: &DVector<f64>,
    bounds: &Bounds,
) -> Result<BoxSolution, QuadraticError> {
    let scaled = Scaled::new(r, d, bounds)?;
    let start = interior_point::solve(&scaled.r, &scaled.d, &scaled.width)?;
    scaled.finish(bounds, start)
}

/// The same from a point near the minimum, by active sets alone; from anew where their gap is above 1e-6 of the objective.
///
/// # Errors
/// Those of [`box_least_squares`]; a `start` that has not as many entries as R has columns.
pub fn box_least_squares_from(
    r: &DMatrix<f64>,
    d: &DVector<f64>,
    bounds: &Bounds,
    start: &DVector<f64>,
) -> Result<BoxSolution, QuadraticError> {
    let scaled = Scaled::new(r, d, bounds)?;
    same(
        "entries of the start against columns of R",
        r.ncols(),
        start.len(),
    )?;
    let x = DVector::from_fn(start.len(), |j, _| {
        (start[j] - bounds.lower[j]).clamp(0.0, scaled.width[j])
    });
    let place = |j: usize| match x[j] {
        0.0 => Place::Lower,
        x if x == scaled.width[j] => Place::Upper,
        _ => Place::Free,
    };
    let near = Interior {
        places: (0..x.len()).map(place).collect(),
        y: &scaled.r * &x - &scaled.d,
        x,
        status: "started near".to_owned(),
        iterations: 0,
    };
    match scaled.finish(bounds, near) {
        Ok(found) if found.gap <= NEAR_ALLOWED * found.objective => Ok(found),
        _ => box_least_squares(r, d, bounds),
    }
}

fn same(what: &'static str, expected: usize, found: usize) -> Result<(), QuadraticError> {
    match expected == found {
        true => Ok(()),
        false => Err(LinalgError::Shape {
            what,
            expected,
            found,
        }
        .into()),
    }
}

/// The problem for x − l, its largest entry in [1, 2).
struct Scaled {
    r: DMatrix<f64>,
    d: DVector<f64>,
    /// u − l.
    width: DVector<f64>,
    exponent: i32,
}

impl Scaled {
    fn new(r: &DMatrix<f64>, d: &DVector<f64>, bounds: &Bounds) -> Result<Self, QuadraticError> {
        let (k, n) = r.shape();
        if r.is_empty() {
            return Err(LinalgError::Empty {
                rows: k,
                columns: n,
            }
            .into());
        }
        same("entries of d against rows of R", k, d.len())?;
        same("lower bounds against columns of R", n, bounds.lower.len())?;
        same("upper bounds against columns of R", n, bounds.upper.len())?;
        if let Some(at) = r.iter().chain(d.iter()).position(|x| !x.is_finite()) {
            let value = if at < k * n { r[at] } else { d[at - k * n] };
            return Err(LinalgError::NotFinite {
                row: at % k,
                column: at / k,
                value,
            }
            .into());
        }
        let width = &bounds.upper - &bounds.lower;
        if let Some(variable) =
            (0..n).find(|&j| !bounds.lower[j].is_finite() || width[j].is_nan() || width[j] < 0.0)
        {
            return Err(QuadraticError::Bounds {
                variable,
                lower: bounds.lower[variable],
                upper: bounds.upper[variable],
            });
        }
        let d = d - r * &bounds.lower;
        let scale = r.amax().max(d.amax());
        let exponent = if scale > 0.0 { libm::ilogb(scale) } else { 0 };
        let down = |x: f64| libm::scalbn(x, -exponent);
        Ok(Scaled {
            r: r.map(down),
            d: d.map(down),
            width,
            exponent,
        })
    }

    /// Refines and certifies.
    fn finish(&self, bounds: &Bounds, start: Interior) -> Result<BoxSolution, QuadraticError> {
        let Scaled { r, d, width, .. } = self;
        let n = r.ncols();
        let (x, refinements) = active_set::refine(r, d, width, start.x, start.places)?;
        let residual = r * &x - d;
        let orthogonal = active_set::orthogonal_to_free(r, &residual, width, &x)?;
        let gap = certificate::gap(
            r,
            &residual,
            &DVector::zeros(n),
            [&residual, &orthogonal, &start.y],
            width,
            &x,
        )?;
        let unit = 0.5 * (r.norm_squared() + d.norm_squared());
        if gap.is_nan() || gap > GAP_ALLOWED * unit {
            return Err(QuadraticError::NotSolved {
                status: start.status,
                gap: gap / unit,
                allowed: GAP_ALLOWED,
            });
        }
        let up = |x: f64| libm::scalbn(x, 2 * self.exponent);
        let solution = DVector::from_fn(n, |j, _| {
            (x[j] + bounds.lower[j]).clamp(bounds.lower[j], bounds.upper[j])
        });
        Ok(BoxSolution {
            solution,
            status: start.status,
            iterations: start.iterations,
            refinements,
            objective: up(0.5 * residual.norm_squared()),
            gap: up(gap),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unit(r: &DMatrix<f64>, d: &DVector<f64>) -> Result<BoxSolution, QuadraticError> {
        box_least_squares(r, d, &Bounds::all(r.ncols(), 0.0, 1.0))
    }

    #[test]
    fn a_diagonal_problem_is_the_clipped_quotient() {
        // Separable: x_j = clamp(d_j/R_jj, 0, 1).
        let r = DMatrix::from_diagonal(&DVector::from_row_slice(&[2.0, 1e-3, 5.0, 1.0]));
        let d = DVector::from_row_slice(&[1.0, 5.0, -3.0, 0.25]);
        let found = unit(&r, &d).unwrap();
        assert!((found.solution - DVector::from_row_slice(&[0.5, 1.0, 0.0, 0.25])).amax() < 1e-15);
        // What is left: 5 − 0.001 and −3 − 0.
        assert!((found.objective - 0.5 * (4.999f64.powi(2) + 9.0)).abs() < 1e-14 * found.objective);
    }

    #[test]
    fn a_coupled_problem_matches_its_hand_solution() {
        // min (x₁ + x₂ − 3)² + (x₁ − x₂)²: free minimum (1.5, 1.5), in the box (1, 1).
        // min (x₁ + 2x₂ − 1)² + (x₁ + 1)²: free x₁ = −1; with x₁ = 0 the rest gives x₂ = ½.
        let r = DMatrix::from_row_slice(2, 2, &[1.0, 1.0, 1.0, -1.0]);
        let found = unit(&r, &DVector::from_row_slice(&[3.0, 0.0])).unwrap();
        assert!((found.solution - DVector::from_row_slice(&[1.0, 1.0])).amax() < 1e-15);
        let r = DMatrix::from_row_slice(2, 2, &[1.0, 2.0, 1.0, 0.0]);
        let found = unit(&r, &DVector::from_row_slice(&[1.0, -1.0])).unwrap();
        assert!((found.solution - DVector::from_row_slice(&[0.0, 0.5])).amax() < 1e-14);
        assert!(found.gap < 1e-14);
    }

    #[test]
    fn ill_conditioned_corner_is_found_at_any_scale() {
        // Hilbert 10 × 10 (condition 1.6e13), d from a corner of the box and a point inside it.
        let r = DMatrix::from_fn(10, 10, |i, j| 1.0 / (i + j + 1) as f64);
        let corner = DVector::from_fn(10, |j, _| f64::from(u8::from(j % 3 == 0)));
        for factor in [1.0, 1e-13, 1e120] {
            let found = unit(&(&r * factor), &(&r * &corner * factor)).unwrap();
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

    /// Against a search over every set of variables at zero: n = 5, 32 sets, each solved freely.
    #[test]
    fn without_upper_bounds_it_is_the_best_of_all_sets_at_zero() {
        for seed in 0..6 {
            let r = DMatrix::from_fn(8, 5, |i, j| {
                (((i * 31 + j * 17 + seed * 7) % 13) as f64 - 6.0) / 6.0
            });
            let d = DVector::from_fn(8, |i, _| (((i + seed) * 7) % 5) as f64 * 3.0 - 5.0);
            let mut best = (0.5 * d.norm_squared(), DVector::zeros(5));
            for set in 1u32..32 {
                let free: Vec<usize> = (0..5).filter(|j| set >> j & 1 == 1).collect();
                let columns = r.select_columns(&free);
                let found =
                    super::super::linalg::least_squares(&columns, &d, Default::default()).unwrap();
                if found.solution.iter().all(|x| *x >= 0.0) && 0.5 * found.residual.powi(2) < best.0
                {
                    let mut x = DVector::zeros(5);
                    for (&j, &value) in free.iter().zip(found.solution.iter()) {
                        x[j] = value;
                    }
                    best = (0.5 * found.residual.powi(2), x);
                }
            }
            let found = box_least_squares(&r, &d, &Bounds::all(5, 0.0, f64::INFINITY)).unwrap();
            assert!(
                (&found.solution - &best.1).amax() < 1e-12,
                "{seed}: {}",
                found.solution
            );
            assert!((found.objective / best.0 - 1.0).abs() < 1e-12 && found.gap < 1e-12);
        }
    }

    #[test]
    fn bounds_can_lie_anywhere() {
        let r = DMatrix::from_diagonal(&DVector::from_row_slice(&[2.0, 1.0, 1.0]));
        let d = DVector::from_row_slice(&[7.0, -5.0, 1.0]);
        let bounds = Bounds {
            lower: DVector::from_row_slice(&[1.0, -2.0, 0.25]),
            upper: DVector::from_row_slice(&[f64::INFINITY, 4.0, 0.25]),
        };
        let found = box_least_squares(&r, &d, &bounds).unwrap();
        assert!((found.solution - DVector::from_row_slice(&[3.5, -2.0, 0.25])).amax() < 1e-14);
        for (lower, upper) in [(1.0, 0.0), (f64::NEG_INFINITY, 0.0), (0.0, f64::NAN)] {
            assert!(matches!(
                box_least_squares(&r, &d, &Bounds::all(3, lower, upper)),
                Err(QuadraticError::Bounds { variable: 0, .. })
            ));
        }
    }

    #[test]
    fn degenerate_and_bad_input() {
        let flat = unit(&DMatrix::zeros(2, 3), &DVector::from_row_slice(&[1.0, 2.0])).unwrap();
        assert!(flat.solution.iter().all(|x| (0.0..=1.0).contains(x)));
        assert_eq!((flat.gap, flat.objective), (0.0, 2.5));
        let wide = unit(
            &DMatrix::from_element(1, 3, 1.0),
            &DVector::from_element(1, 1.5),
        )
        .unwrap();
        assert!((wide.solution.sum() - 1.5).abs() < 1e-14);
        assert!(unit(&DMatrix::zeros(0, 3), &DVector::zeros(0)).is_err());
        assert!(unit(&DMatrix::zeros(2, 3), &DVector::zeros(3)).is_err());
        assert!(unit(&DMatrix::from_element(1, 1, f64::NAN), &DVector::zeros(1)).is_err());
        assert!(
            unit(
                &DMatrix::zeros(1, 1),
                &DVector::from_element(1, f64::INFINITY)
            )
            .is_err()
        );
    }
}
