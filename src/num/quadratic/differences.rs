//! Least squares between bounds with a penalty on differences (fused least squares).

use clarabel::solver::{DefaultSettingsBuilder, NonnegativeConeT, ZeroConeT};
use nalgebra::{DMatrix, DVector};

use super::dense_differences::{self, Penalised};
use super::program::{Program, half_square};
use super::{
    Bounds, BoxSolution, GAP_ALLOWED, QuadraticError, active_set, box_least_squares_from,
    certificate, not_solved,
};
use crate::num::linalg::{Tolerance, least_squares};

/// Values nearer than this fraction of the solution's size count as one, and as their bound, before
/// the rest is solved for anew.
const ONE: f64 = 1e-6;
/// Variables from which on the problem is solved by dense matrices.
const LARGE: usize = 200;

/// The minimiser, and what it consists of.
#[derive(Debug, Clone, PartialEq)]
pub struct Fused {
    /// x; the objective and its gap include the penalty.
    pub found: BoxSolution,
    /// Connected sets of pairwise equal variables that lie strictly between their bounds: the
    /// degrees of freedom (Tibshirani and Taylor 2012).
    pub free_sets: usize,
    /// Connected sets of pairwise equal variables in all.
    pub sets: usize,
    /// Singular values of R on the sets between the bounds: what the data say of their values.
    pub sigma: DVector<f64>,
}

/// min ½‖R x − d‖² + λ Σ_(a,b) |x_a − x_b| over l ≤ x ≤ u, the sum over `pairs`; λ ≥ 0 in the unit
/// of the objective.
///
/// A quadratic program, solved for x − x₀ and R(x − x₀) (x₀ = `start`, best the solution without
/// penalty, so that the size of d does not blur small misfits). The sets of equal values that it
/// finds are then solved for by QR, and that is taken where it lowers the objective. The gap is
/// proved by weak duality: for |w| ≤ λ and any ν, g = Rᵀν + Tᵀw,
///
/// > f(x) − f* ≤ ½‖R x − d − ν‖² + Σ_pairs (λ|T x| − w T x) + Σ_j max(g_j (x_j − l_j), −g_j (u_j − x_j)).
///
/// # Errors
/// [`QuadraticError`], or a gap above 1e-9 · ½(‖d − R l‖² + ‖R‖²). Shapes are the caller's, as of a
/// finished [`box_least_squares`](super::box_least_squares).
pub fn fused_least_squares(
    r: &DMatrix<f64>,
    d: &DVector<f64>,
    bounds: &Bounds,
    pairs: &[[usize; 2]],
    lambda: f64,
    start: &DVector<f64>,
) -> Result<Fused, QuadraticError> {
    let problem = Penalised {
        r,
        d,
        bounds,
        pairs,
        lambda,
    };
    let interior = if lambda == 0.0 {
        problem.unpenalised(start)?
    } else {
        match problem.dense() {
            Some(found) => found,
            None => problem.interior(start)?,
        }
    };
    let mut x = interior.x;
    let (polished, sigma) = problem.polish(&x)?;
    let mut free_sets = sigma.len();
    if lambda > 0.0 && problem.objective(&polished) <= problem.objective(&x) {
        x = polished;
        free_sets = problem
            .sets(&x)
            .1
            .iter()
            .filter(|s| s.free)
            .count()
            .max(usize::from(free_sets > 0));
    }
    let sets = problem.sets(&x).1.len();
    let differences = problem.differences(&x);
    let penalty: f64 = differences.iter().map(|t| lambda * t.abs()).sum();
    let pull = problem.gathered(&interior.w);
    let residual = r * &x - d;
    let proved = certificate::gap(
        r,
        &residual,
        &pull,
        [&residual, &interior.y, &interior.y],
        &(&bounds.upper - &bounds.lower),
        &(&x - &bounds.lower),
    )?;
    let gap = proved + (penalty - interior.w.dot(&differences)).max(0.0);
    let unit = 0.5 * (r.norm_squared() + (d - r * &bounds.lower).norm_squared());
    if gap.is_nan() || gap > GAP_ALLOWED * unit {
        return Err(not_solved(interior.status, gap / unit));
    }
    Ok(Fused {
        found: BoxSolution {
            objective: problem.objective(&x),
            solution: x,
            status: interior.status,
            iterations: interior.iterations,
            refinements: 1,
            gap,
        },
        free_sets,
        sets,
        sigma,
    })
}

struct Interior {
    x: DVector<f64>,
    /// Multipliers of the differences, within ±λ.
    w: DVector<f64>,
    /// Residuals; without a penalty their part that no variable between its bounds can change.
    y: DVector<f64>,
    status: String,
    iterations: u32,
}

/// Variables of one value.
struct Set {
    members: Vec<usize>,
    value: f64,
    /// Strictly between all its bounds.
    free: bool,
}

impl Penalised<'_> {
    fn objective(&self, x: &DVector<f64>) -> f64 {
        let penalty: f64 = self.pairs.iter().map(|&[a, b]| (x[a] - x[b]).abs()).sum();
        0.5 * (self.r * x - self.d).norm_squared() + self.lambda * penalty
    }

    /// Without a penalty, from near its minimum.
    fn unpenalised(&self, start: &DVector<f64>) -> Result<Interior, QuadraticError> {
        let found = box_least_squares_from(self.r, self.d, self.bounds, start)?;
        let room = &self.bounds.upper - &self.bounds.lower;
        let above = &found.solution - &self.bounds.lower;
        let residual = self.r * &found.solution - self.d;
        Ok(Interior {
            y: active_set::orthogonal_to_free(self.r, &residual, &room, &above)?,
            x: found.solution,
            w: DVector::zeros(self.pairs.len()),
            status: found.status,
            iterations: found.iterations,
        })
    }

    /// By dense matrices, where there are many variables.
    fn dense(&self) -> Option<Interior> {
        if self.r.ncols() < LARGE {
            return None;
        }
        let found = dense_differences::solve(self)?;
        found.closed.then(|| Interior {
            y: self.r * &found.x - self.d,
            x: found.x,
            w: found.pull,
            status: "Solved".to_owned(),
            iterations: found.iterations,
        })
    }

    fn interior(&self, start: &DVector<f64>) -> Result<Interior, QuadraticError> {
        let (r, pairs) = (self.r, self.pairs);
        let (k, n) = r.shape();
        let m = pairs.len();
        let mut program = Program::new(r, self.bounds.upper.as_slice());
        let (lengths, closed) = (program.lengths.clone(), program.closed.clone());
        let e = r * start - self.d;
        let largest = lengths.iter().copied().fold(0.0, f64::max);
        let unit = [e.norm(), self.lambda.sqrt(), f64::EPSILON * largest]
            .into_iter()
            .fold(f64::MIN_POSITIVE, f64::max);
        // Variables v = (x − x₀)·length/unit, y = R(x − x₀)/unit, t ≥ |T x|. Rows: y − R v = 0;
        // bounds; ±T v − t ≤ ∓T x₀.
        let first = k + n + closed.len();
        for (i, &[a, b]) in pairs.iter().enumerate() {
            for (at, sign) in [(first + i, 1.0), (first + m + i, -1.0)] {
                program.put(at, a, sign * unit / lengths[a]);
                program.put(at, b, -sign * unit / lengths[b]);
                program.put(at, n + k + i, -1.0);
            }
        }
        let linear: Vec<f64> = std::iter::repeat_n(0.0, n)
            .chain(e.iter().map(|e| e / unit))
            .chain(std::iter::repeat_n(self.lambda / (unit * unit), m))
            .collect();
        let room = |j: usize, room: f64| room.max(0.0) * lengths[j] / unit;
        let right: Vec<f64> = std::iter::repeat_n(0.0, k)
            .chain((0..n).map(|j| room(j, start[j] - self.bounds.lower[j])))
            .chain(
                closed
                    .iter()
                    .map(|&j| room(j, self.bounds.upper[j] - start[j])),
            )
            .chain(pairs.iter().map(|&[a, b]| start[b] - start[a]))
            .chain(pairs.iter().map(|&[a, b]| start[a] - start[b]))
            .collect();
        let cones = [ZeroConeT(k), NonnegativeConeT(n + closed.len() + 2 * m)];
        let mut settings = DefaultSettingsBuilder::default();
        let settings = settings.tol_gap_abs(1e-11).tol_gap_rel(1e-11);
        let solver = program.solve(&half_square(n, k, m), &linear, &right, &cones, settings)?;
        let found = &solver.solution;
        let status = found.status.to_string();
        let mut x = DVector::from_fn(n, |j, _| start[j] + found.x[j] * unit / lengths[j]);
        if x.iter().any(|x| !x.is_finite()) {
            return Err(not_solved(status, f64::INFINITY));
        }
        for (j, x) in x.iter_mut().enumerate() {
            *x = x.clamp(self.bounds.lower[j], self.bounds.upper[j]);
        }
        let w = DVector::from_fn(m, |i, _| {
            let pull = (found.z[first + i] - found.z[first + m + i]) * unit * unit;
            pull.clamp(-self.lambda, self.lambda)
        });
        let y = DVector::from_fn(k, |i, _| e[i] + found.x[n + i] * unit);
        Ok(Interior {
            x,
            w,
            y,
            status,
            iterations: found.iterations,
        })
    }

    /// The set of each variable, and the sets.
    fn sets(&self, x: &DVector<f64>) -> (Vec<usize>, Vec<Set>) {
        let near = ONE * x.amax();
        let n = x.len();
        let mut root: Vec<usize> = (0..n).collect();
        fn find(root: &mut [usize], mut j: usize) -> usize {
            while root[j] != j {
                root[j] = root[root[j]];
                j = root[j];
            }
            j
        }
        for &[a, b] in self.pairs {
            if (x[a] - x[b]).abs() <= near {
                let (a, b) = (find(&mut root, a), find(&mut root, b));
                root[a.max(b)] = a.min(b);
            }
        }
        let (mut of, mut sets) = (vec![0; n], Vec::<Set>::new());
        let mut number = vec![usize::MAX; n];
        for j in 0..n {
            let top = find(&mut root, j);
            if number[top] == usize::MAX {
                number[top] = sets.len();
                sets.push(Set {
                    members: Vec::new(),
                    value: 0.0,
                    free: true,
                });
            }
            of[j] = number[top];
            sets[of[j]].members.push(j);
        }
        for set in &mut sets {
            set.value = set.members.iter().map(|&j| x[j]).sum::<f64>() / set.members.len() as f64;
            for &j in &set.members {
                for bound in [self.bounds.lower[j], self.bounds.upper[j]] {
                    if (x[j] - bound).abs() <= near {
                        (set.value, set.free) = (bound, false);
                    }
                }
            }
        }
        (of, sets)
    }

    /// The values of the free sets solved for with the sets and the order of neighbours held, and
    /// the singular values of R on the free sets.
    fn polish(&self, x: &DVector<f64>) -> Result<(DVector<f64>, DVector<f64>), QuadraticError> {
        let (of, sets) = self.sets(x);
        let free: Vec<usize> = (0..sets.len()).filter(|&s| sets[s].free).collect();
        let mut values: Vec<f64> = sets.iter().map(|s| s.value).collect();
        let mut sigma = DVector::zeros(0);
        if !free.is_empty() {
            let columns: Vec<DVector<f64>> = free
                .iter()
                .map(|&s| self.r.select_columns(&sets[s].members).column_sum())
                .collect();
            let held = DVector::from_fn(x.len(), |j, _| {
                if sets[of[j]].free {
                    0.0
                } else {
                    sets[of[j]].value
                }
            });
            let mut pull = vec![0.0; sets.len()];
            for &[a, b] in self.pairs.iter().filter(|[a, b]| of[*a] != of[*b]) {
                let sign = (x[a] - x[b]).signum();
                pull[of[a]] += sign;
                pull[of[b]] -= sign;
            }
            let pull = DVector::from_fn(free.len(), |i, _| pull[free[i]]);
            let fit = least_squares(
                &DMatrix::from_columns(&columns),
                &(self.d - self.r * held),
                Tolerance::Auto,
            )?;
            let solved = &fit.solution - fit.covariance() * pull * self.lambda;
            for (&s, &value) in free.iter().zip(solved.iter()) {
                values[s] = value;
            }
            sigma = fit.sigma.resize_vertically(free.len(), 0.0);
        }
        let polished = DVector::from_fn(x.len(), |j, _| {
            values[of[j]].clamp(self.bounds.lower[j], self.bounds.upper[j])
        });
        Ok((polished, sigma))
    }
}

#[cfg(test)]
mod tests;
