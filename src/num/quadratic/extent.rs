//! How far one variable can go while the fit stays good.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettingsBuilder, NonnegativeConeT, SecondOrderConeT, ZeroConeT};
use nalgebra::{DMatrix, DVector};

use super::certificate::Lift;
use super::program::Program;
use super::region::{Centre, End, Region};
use super::{Bounds, QuadraticError};

/// Entries of R from which on the ends are looked for from the middle of the region
/// ([`super::region`]); of fewer, and where that has none, by the conic solver.
const LARGE: usize = 1 << 12;

/// The least and the largest of each variable among all l ≤ x ≤ u with ‖R x − d‖² ≤
/// ‖R x̂ − d‖² + slack, x̂ = `best` being one of them.
///
/// Two convex problems each. What is returned is not the solver's x_j but what its multipliers z
/// prove: with e = R x̂ − d, radius² = ‖e‖² + slack, and h = ±e_j + Rᵀz,
///
/// > ±(x_j − x̂_j) ≥ Σ_i min over l_i ≤ x_i ≤ u_i of h_i (x_i − x̂_i) + zᵀe − radius ‖z‖   for every z,
///
/// so the true extent is never wider than the returned one, whatever the accuracy of the solver;
/// the bounds hold besides. Of large problems it is narrower by at most 1e-4 of the room between
/// the bounds wherever the method ends well, which it did at all ends measured.
pub struct Extents<'a> {
    region: Region<'a>,
    centre: Option<Centre>,
    lifts: Vec<Lift>,
}

impl<'a> Extents<'a> {
    /// What all variables share.
    ///
    /// # Errors
    /// [`QuadraticError`]. Shapes are the caller's, as of a finished
    /// [`box_least_squares`](super::box_least_squares).
    pub fn new(
        r: &'a DMatrix<f64>,
        d: &DVector<f64>,
        bounds: &'a Bounds,
        best: &'a DVector<f64>,
        slack: f64,
    ) -> Result<Self, QuadraticError> {
        let residual = r * best - d;
        let lifts = if bounds.upper.iter().all(|u| u.is_finite()) {
            Vec::new()
        } else {
            Lift::all(r, &bounds.upper)?
        };
        let region = Region {
            radius: (residual.norm_squared() + slack).sqrt(),
            residual,
            r,
            bounds,
            best,
        };
        let centre = (r.len() >= LARGE).then(|| region.centre()).flatten();
        Ok(Self {
            region,
            centre,
            lifts,
        })
    }

    /// \[least, largest\] of x_j.
    ///
    /// # Errors
    /// [`QuadraticError::Refused`].
    pub fn of(&self, j: usize) -> Result<[f64; 2], QuadraticError> {
        let Bounds { lower, upper } = self.region.bounds;
        let from = self.region.best[j];
        let at_least = self
            .distance(j, 1.0)?
            .map_or(lower[j], |way| lower[j].max(from + way));
        let at_most = self
            .distance(j, -1.0)?
            .map_or(upper[j], |way| upper[j].min(from - way));
        Ok([at_least, at_most])
    }

    /// What is proved of the least sign · (x_j − x̂_j); none where x_j reaches its bound.
    fn distance(&self, j: usize, sign: f64) -> Result<Option<f64>, QuadraticError> {
        let Region { r, best, .. } = self.region;
        let mut towards = DVector::zeros(best.len());
        towards[j] = sign;
        let proves = |z: &DVector<f64>| {
            let lifted = self.lifts.iter().map(|lift| lift.apply(r, &towards, z));
            let moved = lifted.map(|z| self.region.proves(&towards, &z));
            moved.fold(self.region.proves(&towards, z), f64::max)
        };
        let z = match &self.centre {
            Some(centre) => match self.region.end(centre, (j, sign), proves) {
                End::Bound => return Ok(None),
                End::Proved(z) => z,
            },
            None => multipliers(&self.region, (j, sign))?,
        };
        Ok(Some(proves(&z)))
    }
}

/// z of the problem that minimises sign · x_j.
fn multipliers(
    region: &Region<'_>,
    (j, sign): (usize, f64),
) -> Result<DVector<f64>, QuadraticError> {
    let Region {
        r,
        bounds,
        best,
        residual,
        radius,
    } = region;
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
            let all = Extents::new(&r, &d, &bounds, &best, 3.84).unwrap();
            let [lower, upper] = all.of(j).unwrap();
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
        let all = Extents::new(&r, &d, &bounds, &best, 2.0).unwrap();
        for j in 0..2 {
            let [lower, upper] = all.of(j).unwrap();
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

    /// From the middle of the region as by the conic solver, to what the first leaves open: some
    /// ends at bounds, some between them, with and without upper bounds.
    #[test]
    fn many_variables_end_where_the_conic_solver_ends() {
        let mut state = 11u64;
        let mut next = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (state >> 33) as f64 / (1u64 << 31) as f64
        };
        let r = DMatrix::from_fn(12, 20, |i, j| {
            (0.2 + next()) * 30.0 * libm::exp(-0.4 * ((i + 2 * j) % 9) as f64)
        });
        let x = DVector::from_fn(20, |_, _| (1.4 * next() - 0.2).clamp(0.0, 1.0));
        let d = &r * x + DVector::from_fn(12, |_, _| 2.0 * next() - 1.0);
        let (mut at_bounds, mut between) = (0, 0);
        for top in [1.0, f64::INFINITY] {
            let bounds = Bounds::all(20, 0.0, top);
            let best = box_least_squares(&r, &d, &bounds).unwrap().solution;
            let unit = if top == 1.0 { 1.0 } else { best.amax() };
            let mut extents = Extents::new(&r, &d, &bounds, &best, 15.0).unwrap();
            let conic: Vec<[f64; 2]> = (0..20).map(|j| extents.of(j).unwrap()).collect();
            extents.centre = extents.region.centre();
            assert!(extents.centre.is_some());
            for (j, [lower, upper]) in conic.into_iter().enumerate() {
                for (sign, conic) in [(1.0, lower), (-1.0, upper)] {
                    let own = extents.distance(j, sign).unwrap();
                    let own = own.map_or(if sign > 0.0 { 0.0 } else { top }, |way| {
                        (best[j] + sign * way).clamp(0.0, top)
                    });
                    let wider = sign * (conic - own);
                    assert!(
                        (-1e-6..1.1e-4).contains(&(wider / unit)),
                        "{j} {own} {conic}"
                    );
                    if own == 0.0 || own == top {
                        at_bounds += 1;
                    } else {
                        between += 1;
                    }
                }
            }
        }
        assert!(at_bounds > 9 && between > 20, "{at_bounds} {between}");
    }
}
