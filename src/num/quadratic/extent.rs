//! How far one variable can go while the fit stays good.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettingsBuilder, NonnegativeConeT, SecondOrderConeT, ZeroConeT};
use nalgebra::{DMatrix, DVector};

use super::certificate::Lift;
use super::program::Program;
use super::{Bounds, QuadraticError};

/// The least and the largest x_j among all l ≤ x ≤ u with ‖R x − d‖² ≤ ‖R x̂ − d‖² + slack, x̂ =
/// `best` being one of them.
///
/// Two second-order cone problems. What is returned is not the solver's x_j but what its
/// multipliers z prove: with e = R x̂ − d, radius² = ‖e‖² + slack, and h = e_j + Rᵀz,
///
/// > x_j − x̂_j ≥ Σ_i min over l_i ≤ x_i ≤ u_i of h_i (x_i − x̂_i) + zᵀe − radius ‖z‖   for every z,
///
/// so the true extent is never wider than the returned one, whatever the accuracy of the solver;
/// the bounds hold besides.
///
/// # Errors
/// [`QuadraticError::Refused`]. Shapes are the caller's, as of a finished
/// [`box_least_squares`](super::box_least_squares).
pub fn extent(
    r: &DMatrix<f64>,
    d: &DVector<f64>,
    bounds: &Bounds,
    best: &DVector<f64>,
    slack: f64,
    j: usize,
) -> Result<[f64; 2], QuadraticError> {
    let residual = r * best - d;
    let radius = (residual.norm_squared() + slack).sqrt();
    let mut ends = [bounds.lower[j], bounds.upper[j]];
    let lifts = if bounds.upper.iter().all(|u| u.is_finite()) {
        Vec::new()
    } else {
        Lift::all(r, &bounds.upper)?
    };
    for (end, sign) in ends.iter_mut().zip([1.0, -1.0]) {
        let mut towards = DVector::zeros(best.len());
        towards[j] = sign;
        let proves = |z: &DVector<f64>| {
            let h = r.transpose() * z + &towards;
            let within: f64 = (0..best.len())
                .map(|i| match h[i] {
                    0.0 => 0.0,
                    h => (h * (bounds.lower[i] - best[i])).min(h * (bounds.upper[i] - best[i])),
                })
                .sum();
            within + z.dot(&residual) - radius * z.norm()
        };
        let z = multipliers(r, &residual, radius, bounds, best, (j, sign))?;
        let moved = lifts
            .iter()
            .map(|lift| proves(&lift.apply(r, &towards, &z)));
        let proved = best[j] + sign * moved.fold(proves(&z), f64::max);
        *end = if sign > 0.0 {
            end.max(proved)
        } else {
            end.min(proved)
        };
    }
    Ok(ends)
}

/// z of the problem that minimises sign · x_j.
fn multipliers(
    r: &DMatrix<f64>,
    residual: &DVector<f64>,
    radius: f64,
    bounds: &Bounds,
    best: &DVector<f64>,
    (j, sign): (usize, f64),
) -> Result<DVector<f64>, QuadraticError> {
    let (k, n) = r.shape();
    let mut program = Program::new(r, bounds.upper.as_slice());
    let (lengths, closed) = (program.lengths.clone(), program.closed.clone());
    // Variables v = (x − x̂)·length/radius and y = R(x − x̂)/radius. Rows: y − R v = 0; −v ≤ (x̂ −
    // l)…; v ≤ (u − x̂)…; (1, y + e/radius) in the cone.
    let cone = k + n + closed.len();
    for a in 0..k {
        program.put(cone + 1 + a, n + a, -1.0);
    }
    let scaled = |i: usize, room: f64| room * lengths[i] / radius;
    let right: Vec<f64> = std::iter::repeat_n(0.0, k)
        .chain((0..n).map(|i| scaled(i, best[i] - bounds.lower[i])))
        .chain(closed.iter().map(|&i| scaled(i, bounds.upper[i] - best[i])))
        .chain(std::iter::once(1.0))
        .chain(residual.iter().map(|e| e / radius))
        .collect();
    let mut linear = vec![0.0; n + k];
    linear[j] = sign;
    let cones = [
        ZeroConeT(k),
        NonnegativeConeT(n + closed.len()),
        SecondOrderConeT(k + 1),
    ];
    let cost = CscMatrix::zeros((n + k, n + k));
    let mut settings = DefaultSettingsBuilder::default();
    let solver = program.solve(&cost, &linear, &right, &cones, &mut settings)?;
    // Of x_j itself: v_j carries length_j/radius, the residuals 1/radius. A z that is not finite
    // proves nothing and is none.
    let z = DVector::from_fn(k, |a, _| -solver.solution.z[cone + 1 + a] / lengths[j]);
    Ok(if z.iter().all(|x| x.is_finite()) {
        z
    } else {
        DVector::zeros(k)
    })
}

#[cfg(test)]
mod tests {
    use super::super::box_least_squares;
    use super::*;

    #[test]
    fn without_active_bounds_it_is_the_ellipsoid() {
        // max x_j over ‖R(x − x̂)‖² ≤ slack is x̂_j ± √(slack (RᵀR)⁻¹_jj).
        let r = DMatrix::from_row_slice(3, 2, &[40.0, 10.0, -5.0, 30.0, 2.0, 8.0]);
        let exact = DVector::from_row_slice(&[0.4, 0.6]);
        let d = &r * &exact + DVector::from_row_slice(&[0.1, -0.2, 0.3]);
        let inverse = (r.transpose() * &r).try_inverse().unwrap();
        for (j, top) in [(0, 1.0), (1, 1.0), (0, f64::INFINITY), (1, f64::INFINITY)] {
            let bounds = Bounds::all(2, 0.0, top);
            let best = box_least_squares(&r, &d, &bounds).unwrap().solution;
            let [lower, upper] = extent(&r, &d, &bounds, &best, 3.84, j).unwrap();
            let half = (3.84 * inverse[(j, j)]).sqrt();
            assert!((lower - (best[j] - half)).abs() < 1e-7, "{lower} {half}");
            assert!((upper - (best[j] + half)).abs() < 1e-7, "{upper} {half}");
        }
    }

    /// Against a fine grid over the box: nothing feasible lies outside, something feasible lies
    /// near each end.
    #[test]
    fn with_active_bounds_it_encloses_what_a_search_finds() {
        let r = DMatrix::from_row_slice(3, 2, &[3.0, 2.5, 2.0, 2.2, 0.3, -0.4]);
        let d = DVector::from_row_slice(&[-1.0, 0.5, 1.0]);
        let bounds = Bounds::all(2, 0.0, 1.0);
        let best = box_least_squares(&r, &d, &bounds).unwrap().solution;
        assert!(best.iter().any(|x| *x == 0.0), "{best}");
        let limit = (&r * &best - &d).norm_squared() + 2.0;
        let mut seen = [[1.0f64, 0.0]; 2];
        for a in 0..=1000 {
            for b in 0..=1000 {
                let x = DVector::from_row_slice(&[f64::from(a) / 1e3, f64::from(b) / 1e3]);
                if (&r * &x - &d).norm_squared() <= limit {
                    for j in 0..2 {
                        seen[j] = [seen[j][0].min(x[j]), seen[j][1].max(x[j])];
                    }
                }
            }
        }
        for j in 0..2 {
            let [lower, upper] = extent(&r, &d, &bounds, &best, 2.0, j).unwrap();
            assert!(
                lower <= seen[j][0] && seen[j][1] <= upper,
                "{lower} {upper} {seen:?}"
            );
            assert!(
                seen[j][0] - lower < 2e-3 && upper - seen[j][1] < 2e-3,
                "{lower} {upper} {seen:?}"
            );
        }
    }
}
