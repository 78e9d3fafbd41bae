//! The problem as the conic solver wants it.

use clarabel::solver::{DefaultSettingsBuilder, NonnegativeConeT, ZeroConeT};
use nalgebra::{DMatrix, DVector};

use super::program::{Program, half_square};
use super::{Place, QuadraticError, not_solved};

/// Where the interior-point solver ended.
pub(super) struct Interior {
    /// x, clipped to the box.
    pub(super) x: DVector<f64>,
    /// Which bounds hold.
    pub(super) places: Vec<Place>,
    /// Its residual variables y, a dual certificate.
    pub(super) y: DVector<f64>,
    /// Its own word on the result.
    pub(super) status: String,
    pub(super) iterations: u32,
}

/// Solves min ½yᵀy, y = R x − d, 0 ≤ x ≤ u to the solver's own tolerance; an infinite u_j is no
/// constraint.
pub(super) fn solve(
    r: &DMatrix<f64>,
    d: &DVector<f64>,
    upper: &DVector<f64>,
) -> Result<Interior, QuadraticError> {
    let (k, n) = r.shape();
    let program = Program::new(r, upper.as_slice());
    let (lengths, closed) = (program.lengths.clone(), program.closed.clone());
    let size = d.norm().max(lengths.iter().copied().fold(0.0, f64::max));
    // Variables (x_j·length_j/size, y/size); rows: y − R x = −d, then −x ≤ 0, then x ≤
    // u·length/size where u is finite.
    let linear = vec![0.0; n + k];
    let ceilings = closed.iter().map(|&j| upper[j] * lengths[j] / size);
    let bounds: Vec<f64> = d
        .iter()
        .map(|x| -x / size)
        .chain(std::iter::repeat_n(0.0, n))
        .chain(ceilings)
        .collect();
    let cones = [ZeroConeT(k), NonnegativeConeT(n + closed.len())];
    let mut settings = DefaultSettingsBuilder::default();
    let settings = settings.tol_gap_abs(1e-12).tol_gap_rel(1e-12);
    let solver = program.solve(&half_square(n, k, 0), &linear, &bounds, &cones, settings)?;
    let found = &solver.solution;
    let status = found.status.to_string();
    let mut x = DVector::from_fn(n, |j, _| found.x[j] * size / lengths[j]);
    if x.iter().any(|x| !x.is_finite()) {
        return Err(not_solved(status, f64::INFINITY));
    }
    // A bound holds where its multiplier outweighs the distance to it.
    let holds = |row: usize| found.s[row] < found.z[row];
    let mut places: Vec<Place> = (0..n)
        .map(|j| {
            if holds(k + j) {
                Place::Lower
            } else {
                Place::Free
            }
        })
        .collect();
    for (i, &j) in closed.iter().enumerate() {
        if places[j] == Place::Free && holds(k + n + i) {
            places[j] = Place::Upper;
        }
    }
    for (x, &u) in x.iter_mut().zip(upper.iter()) {
        *x = x.clamp(0.0, u);
    }
    let y = DVector::from_fn(k, |i, _| found.x[n + i] * size);
    Ok(Interior {
        x,
        places,
        y,
        status,
        iterations: found.iterations,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_stands_near_the_minimum_and_knows_the_bounds() {
        // min (100 x₁ + 2x₂ − 1)² + (100 x₁ + 1)² + (x₃ − 3)² + (x₄ − ½)²: x = (0, ½, 1, ½), see
        // the module above.
        let mut r = DMatrix::zeros(4, 4);
        for (i, j, v) in [
            (0, 0, 100.0),
            (0, 1, 2.0),
            (1, 0, 100.0),
            (2, 2, 1.0),
            (3, 3, 1.0),
        ] {
            r[(i, j)] = v;
        }
        let d = DVector::from_row_slice(&[1.0, -1.0, 3.0, 0.5]);
        let found = solve(&r, &d, &DVector::from_element(4, 1.0)).unwrap();
        let exact = DVector::from_row_slice(&[0.0, 0.5, 1.0, 0.5]);
        // Its gap of 1e-12 of the data lets x stray by some 1e-6.
        assert!((&found.x - &exact).amax() < 1e-5, "{}", found.x);
        assert!((&found.y - (&r * &exact - &d)).amax() < 1e-4, "{}", found.y);
        assert_eq!(
            found.places,
            [Place::Lower, Place::Free, Place::Upper, Place::Free]
        );
    }
}
