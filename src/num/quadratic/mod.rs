//! Least squares between bounds: the one door to the convex solver `clarabel`.

mod active_set;
mod certificate;
mod dense;
mod dense_differences;
mod differences;
mod extent;
mod interior_point;
mod program;
mod region;

pub use differences::{Fused, fused_least_squares};
pub use extent::Extents;

use nalgebra::{DMatrix, DVector};

use super::linalg::{LinalgError, same_length, times_two_to};
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
    /// Upper bound on how far the objective lies above its minimum, from the optimality conditions
    /// at x and so independent of either solver. Where columns without an upper bound cancel it is
    /// over the x of at most 1000 times the size; see the module `certificate`.
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
        "bounded least squares is not proved to be at its minimum: the objective may lie {gap:.1e} above it (relative to the data; \
         allowed {allowed:.1e}; the solver says of itself: {status}); scale the problem, or recover without bounds"
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

fn not_solved(status: String, gap: f64) -> QuadraticError {
    QuadraticError::NotSolved {
        status,
        gap,
        allowed: GAP_ALLOWED,
    }
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
/// The condition of R is never squared: the interior-point solver works on the residuals as
/// variables,
///
/// > min ½ yᵀy   subject to   y = R x − d,   l ≤ x ≤ u,
///
/// with R's columns scaled to unit length. Its answer tells which bounds hold; an active-set
/// refinement (Stark and Parker's bounded-variable least squares, started there) then solves for
/// the rest by QR to full precision, never raising the objective. A variable whose column is 0
/// stays at its lower bound. The returned gap is the least that three dual points prove by weak
/// duality: the residual R x − d, its part orthogonal to the columns of the variables between their
/// bounds (which rounding of a large d disturbs least), and the solver's own y.
///
/// # Errors
/// Empty or non-finite input, shapes that do not fit, bounds that no number keeps, or a gap above
/// 1e-9 · ½(‖d − R l‖² + ‖R‖²).
pub fn box_least_squares(
    r: &DMatrix<f64>,
    d: &DVector<f64>,
    bounds: &Bounds,
) -> Result<BoxSolution, QuadraticError> {
    let scaled = Scaled::new(r, d, bounds)?;
    let method = if r.len() < dense::LARGE {
        interior_point::solve
    } else {
        dense::solve
    };
    let start = method(&scaled.r, &scaled.d, &scaled.width)?;
    scaled.finish(bounds, start)
}

/// The same from a point near the minimum, by active sets alone; from anew where their gap is above
/// 1e-6 of the objective.
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
    same_length(
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

/// The variables whose column is 0.
fn unseen(r: &DMatrix<f64>) -> Vec<usize> {
    let each = r.column_iter().enumerate();
    let dark = each.filter(|(_, column)| column.iter().all(|x| *x == 0.0));
    dark.map(|(j, _)| j).collect()
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
        same_length("entries of d against rows of R", k, d.len())?;
        same_length("lower bounds against columns of R", n, bounds.lower.len())?;
        same_length("upper bounds against columns of R", n, bounds.upper.len())?;
        if let Some(at) = r.iter().chain(d.iter()).position(|x| !x.is_finite()) {
            let value = if at < k * n { r[at] } else { d[at - k * n] };
            return Err(LinalgError::NotFinite {
                row: at % k,
                column: at / k,
                value,
            }
            .into());
        }
        let mut width = &bounds.upper - &bounds.lower;
        if let Some(variable) =
            (0..n).find(|&j| !bounds.lower[j].is_finite() || width[j].is_nan() || width[j] < 0.0)
        {
            return Err(QuadraticError::Bounds {
                variable,
                lower: bounds.lower[variable],
                upper: bounds.upper[variable],
            });
        }
        // What R does not see stays at its lower bound, however far it might go.
        for j in unseen(r) {
            width[j] = width[j].min(1.0);
        }
        let d = d - r * &bounds.lower;
        let scale = r.amax().max(d.amax());
        let exponent = if scale > 0.0 { libm::ilogb(scale) } else { 0 };
        let down = times_two_to(-exponent);
        Ok(Scaled {
            r: r.map(down),
            d: d.map(down),
            width,
            exponent,
        })
    }

    /// Refines and certifies.
    fn finish(&self, bounds: &Bounds, mut start: Interior) -> Result<BoxSolution, QuadraticError> {
        let Scaled { r, d, width, .. } = self;
        let n = r.ncols();
        for j in unseen(r) {
            (start.x[j], start.places[j]) = (0.0, Place::Lower);
        }
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
            return Err(not_solved(start.status, gap / unit));
        }
        let up = times_two_to(2 * self.exponent);
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
mod tests;
