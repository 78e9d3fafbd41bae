//! How far above its minimum an objective can be, proved by weak duality.
//!
//! For f(x) = ½‖R x − d‖² + cᵀx on 0 ≤ x ≤ u, any ν with g = Rᵀν + c proves
//!
//! > f(x) − f* ≤ ½‖R x − d − ν‖² + Σ_j max(g_j x_j, −g_j (u_j − x_j)).
//!
//! Where u_j is infinite that is finite only for g_j ≥ 0. A ν that fails there is moved to ν + ε h
//! with Rᵀh > 0 on those columns and ε just large enough: h = R 1 does for a matrix without
//! negative entries (RᵀR 1 is then positive), h = (R⁺)ᵀ 1 for every matrix of full column rank (Rᵀh
//! = 1). The proof holds for whatever h; a bad one only proves less.
//!
//! Where columns without an upper bound cancel, R z = 0 for some z ≥ 0, there is no such h: Rᵀν is
//! 0 along z at best, in rounding a little less, and no dual point proves anything of x far along
//! z. Along z the objective does not change, so there is a minimiser in reach; what is proved is
//! then the distance from the least objective of all x within [`REACH`] times the larger of max x
//! and ‖d‖/‖R_j‖, the most that column j takes to make d alone.

use nalgebra::{DMatrix, DVector};

use super::QuadraticError;
use crate::num::linalg::{Tolerance, least_squares};

/// How much farther than x a minimiser is looked for where columns cancel.
const REACH: f64 = 1e3;

/// The least gap that the dual points and ν = 0 prove; NaN where a point is not a number.
pub(super) fn gap(
    r: &DMatrix<f64>,
    residual: &DVector<f64>,
    linear: &DVector<f64>,
    duals: [&DVector<f64>; 3],
    upper: &DVector<f64>,
    x: &DVector<f64>,
) -> Result<f64, QuadraticError> {
    let least = |duals: &[DVector<f64>], upper: &DVector<f64>| {
        duals
            .iter()
            .map(|dual| duality_gap(r, residual, linear, dual, upper, x))
            .fold(f64::INFINITY, f64::min)
    };
    let none = DVector::zeros(r.nrows());
    let [a, b, c] = duals.map(Clone::clone);
    let duals = [a, b, c, none];
    let plain = least(&duals, upper);
    if upper.iter().all(|u| u.is_finite()) {
        return Ok(plain);
    }
    let lifts = Lift::all(r, upper)?;
    let each = lifts.iter();
    let moved: Vec<_> = each
        .flat_map(|lift| duals.iter().map(|dual| lift.apply(r, linear, dual)))
        .collect();
    if !moved.is_empty() {
        return Ok(plain.min(least(&moved, upper)));
    }
    let data = (r * x - residual).norm();
    let near = DVector::from_fn(x.len(), |j, _| {
        let reach = REACH * x.amax().max(data / r.column(j).norm());
        upper[j].min(if reach.is_finite() { reach } else { 0.0 })
    });
    Ok(plain.min(least(&duals, &near)))
}

/// A direction h with Rᵀh > 0 on all columns without an upper bound.
pub(super) struct Lift {
    h: DVector<f64>,
    open: Vec<usize>,
}

impl Lift {
    /// Those of the two that serve; columns of zero need none.
    pub(super) fn all(r: &DMatrix<f64>, upper: &DVector<f64>) -> Result<Vec<Self>, QuadraticError> {
        let n = r.ncols();
        let open: Vec<usize> = (0..n)
            .filter(|&j| upper[j] == f64::INFINITY && r.column(j).amax() > 0.0)
            .collect();
        let ones = DVector::from_element(n, 1.0);
        let directions = [
            r * &ones,
            least_squares(&r.transpose(), &ones, Tolerance::Auto)?.solution,
        ];
        let serves = |h: &DVector<f64>| open.iter().all(|&j| r.column(j).dot(h) > 0.0);
        Ok(directions
            .into_iter()
            .filter(serves)
            .map(|h| Lift {
                h,
                open: open.clone(),
            })
            .collect())
    }

    /// The dual point moved until Rᵀν + c ≥ 0 on those columns: by twice the need, so that rounding
    /// does not undo it.
    pub(super) fn apply(
        &self,
        r: &DMatrix<f64>,
        linear: &DVector<f64>,
        dual: &DVector<f64>,
    ) -> DVector<f64> {
        let need = |&j: &usize| {
            let column = r.column(j);
            -(column.dot(dual) + linear[j]) / column.dot(&self.h)
        };
        let most = self.open.iter().map(need).fold(0.0, f64::max);
        dual + &self.h * (2.0 * most)
    }
}

/// The bound on f(x) − f* that the dual point ν proves.
fn duality_gap(
    r: &DMatrix<f64>,
    residual: &DVector<f64>,
    linear: &DVector<f64>,
    dual: &DVector<f64>,
    upper: &DVector<f64>,
    x: &DVector<f64>,
) -> f64 {
    let gradient = r.transpose() * dual + linear;
    let bounds: f64 = (0..x.len())
        .map(|j| match gradient[j] {
            0.0 => 0.0,
            g => (g * x[j]).max(-g * (upper[j] - x[j])),
        })
        .sum();
    0.5 * (residual - dual).norm_squared() + bounds
}

#[cfg(test)]
mod tests {
    use super::super::{Bounds, box_least_squares};
    use super::*;

    /// Random points x and ν against the least value found: weak duality, whatever the points.
    #[test]
    fn every_dual_point_bounds_the_distance_from_the_minimum() {
        let r = DMatrix::from_fn(9, 6, |i, j| (((i * 31 + j * 17) % 13) as f64 - 6.0) / 6.0);
        let d = DVector::from_fn(9, |i, _| ((i * 7) % 5) as f64 - 1.0);
        let none = DVector::zeros(6);
        for top in [1.0, f64::INFINITY] {
            let upper = DVector::from_fn(6, |j, _| if j % 2 == 0 { top } else { 1.0 });
            let bounds = Bounds {
                lower: DVector::zeros(6),
                upper: upper.clone(),
            };
            let least = box_least_squares(&r, &d, &bounds).unwrap();
            for k in 0..50 {
                let number = |i: usize| ((k * 29 + i * 53) % 97) as f64 / 96.0;
                let x = DVector::from_fn(6, |j, _| number(j));
                let dual = DVector::from_fn(9, |i, _| 4.0 * number(i + 6) - 2.0);
                let residual = &r * &x - &d;
                let excess = 0.5 * residual.norm_squared() - least.objective;
                for dual in [&dual, &residual] {
                    let proved = gap(&r, &residual, &none, [dual; 3], &upper, &x).unwrap();
                    assert!(
                        proved.is_finite() && proved >= excess - 1e-12,
                        "{proved} {excess}"
                    );
                }
            }
            // At the minimum the residual's own bound is tight.
            let residual = &r * &least.solution - &d;
            let proved = gap(
                &r,
                &residual,
                &none,
                [&residual; 3],
                &upper,
                &least.solution,
            )
            .unwrap();
            assert!(proved < 1e-12, "{proved}");
        }
    }
}
