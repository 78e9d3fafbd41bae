//! Large problems: the same interior-point method on dense matrices.

use nalgebra::linalg::Cholesky;
use nalgebra::{DMatrix, DVector};

use super::interior_point::Interior;
use super::{Place, QuadraticError, not_solved};
use crate::num::linalg::{columns_over, gram_product};

/// Entries of R from which on it is used.
pub(super) const LARGE: usize = 1 << 18;
/// Iterations, and the gap, relative to ½‖d‖², at which they end.
const MOST_ITERATIONS: u32 = 60;
const GAP: f64 = 1e-12;
/// What stands for zero where a positive number is needed.
const LEAST: f64 = 1e-12;
/// Share of the way to the nearest bound that is gone.
pub(super) const STEP: f64 = 0.995;

/// Solves min ½‖R x − d‖², 0 ≤ x ≤ u, by Mehrotra's predictor and corrector (Nocedal and Wright
/// 2006, algorithm 16.4). With multipliers z of x ≥ 0 and w of s = u − x ≥ 0 each step solves
///
/// > (RᵀR + Θ) Δx = b,   Θ = z/x + w/s,   by   Δx = Θ⁻¹(b − Rᵀ(1 + R Θ⁻¹ Rᵀ)⁻¹ R Θ⁻¹ b),
///
/// k × k for R of k × n: k³/3 + k² n multiplications.
pub(super) fn solve(
    r: &DMatrix<f64>,
    d: &DVector<f64>,
    upper: &DVector<f64>,
) -> Result<Interior, QuadraticError> {
    let n = r.ncols();
    let lengths = r.column_iter().map(|c| c.norm());
    let lengths: Vec<f64> = lengths.map(|x| if x > 0.0 { x } else { 1.0 }).collect();
    let size = d.norm().max(lengths.iter().copied().fold(0.0, f64::max));
    let unit = columns_over(r.clone(), &lengths);
    let mut state = State::new(&unit, d / size, upper, &lengths, size);
    let mut iterations = 0;
    let aim = GAP * (0.5 * state.d.norm_squared()).max(LEAST);
    while iterations < MOST_ITERATIONS && state.gap() > aim {
        iterations += 1;
        if !state.step() {
            break;
        }
    }
    let State { x, z, w, s, .. } = &state;
    let found = DVector::from_fn(n, |j, _| (x[j] * size / lengths[j]).clamp(0.0, upper[j]));
    if found.iter().any(|x| !x.is_finite()) {
        return Err(not_solved("NumericalError".to_owned(), f64::INFINITY));
    }
    let place = |j: usize| match (x[j] < z[j], s[j] < w[j]) {
        (true, _) => Place::Lower,
        (false, true) => Place::Upper,
        _ => Place::Free,
    };
    Ok(Interior {
        places: (0..n).map(place).collect(),
        y: r * &found - d,
        x: found,
        status: if state.gap() <= aim {
            "Solved"
        } else {
            "AlmostSolved"
        }
        .to_owned(),
        iterations,
    })
}

/// Where the iteration stands.
struct State<'a> {
    r: &'a DMatrix<f64>,
    d: DVector<f64>,
    x: DVector<f64>,
    /// Distance to the upper bound, infinite without one.
    s: DVector<f64>,
    z: DVector<f64>,
    w: DVector<f64>,
    /// Rᵀ(R x − d).
    gradient: DVector<f64>,
}

impl<'a> State<'a> {
    /// Begins in the middle of the box, the multipliers as large as the gradient.
    fn new(
        r: &'a DMatrix<f64>,
        d: DVector<f64>,
        upper: &DVector<f64>,
        lengths: &[f64],
        size: f64,
    ) -> Self {
        let n = r.ncols();
        let u = DVector::from_fn(n, |j, _| upper[j] * lengths[j] / size);
        let open = d.norm() / (n as f64).sqrt();
        // A variable without room begins, and ends, near enough.
        let x = u.map(|u| match 0.5 * u {
            0.0 => LEAST,
            half if half.is_finite() => half,
            _ => open.max(LEAST),
        });
        let s = u.zip_map(&x, |u, x| if u.is_finite() { x } else { u });
        let gradient = r.tr_mul(&(r * &x - &d));
        let mean = (gradient.lp_norm(1) / n as f64).max(LEAST);
        let [z, w] = multipliers(&gradient, &s, mean);
        Self {
            r,
            d,
            x,
            s,
            z,
            w,
            gradient,
        }
    }

    /// Σ (x z + s w), and what the conditions on the multipliers are off by, in units of the gap.
    fn gap(&self) -> f64 {
        let off = &self.gradient - &self.z + &self.w;
        self.complementarity(&self.x, &self.z, &self.s, &self.w) + off.abs().dot(&self.x)
    }

    fn complementarity(
        &self,
        x: &DVector<f64>,
        z: &DVector<f64>,
        s: &DVector<f64>,
        w: &DVector<f64>,
    ) -> f64 {
        let upper = (0..x.len()).filter(|j| s[*j].is_finite());
        x.dot(z) + upper.map(|j| s[j] * w[j]).sum::<f64>()
    }

    fn pairs(&self) -> f64 {
        (self.x.len() + self.s.iter().filter(|s| s.is_finite()).count()) as f64
    }

    /// One predictor and corrector; `false` where no progress is possible.
    fn step(&mut self) -> bool {
        let n = self.x.len();
        let theta = DVector::from_fn(n, |j, _| self.z[j] / self.x[j] + over(self.w[j], self.s[j]));
        let scaled = columns_over(self.r.clone(), &theta.map(f64::sqrt));
        let mut inner = DMatrix::identity(self.r.nrows(), self.r.nrows());
        gram_product(&mut inner, &scaled.transpose());
        let Some(inner) = Cholesky::new(inner) else {
            return false;
        };
        let once = |b: &DVector<f64>| {
            let y = b.component_div(&theta);
            let along = inner.solve(&(self.r * &y));
            y - self.r.tr_mul(&along).component_div(&theta)
        };
        let whole = |v: &DVector<f64>| self.r.tr_mul(&(self.r * v)) + theta.component_mul(v);
        let solve = |b: &DVector<f64>| conjugate(b, whole, once);
        let off = &self.gradient - &self.z + &self.w;
        // Directions for x z + p = 0 and s w + q = 0.
        let towards = |p: &DVector<f64>, q: &DVector<f64>| {
            let b = DVector::from_fn(n, |j, _| -off[j] - p[j] / self.x[j] + over(q[j], self.s[j]));
            let dx = solve(&b);
            let dz = DVector::from_fn(n, |j, _| -(p[j] + self.z[j] * dx[j]) / self.x[j]);
            let dw = DVector::from_fn(n, |j, _| over(self.w[j] * dx[j] - q[j], self.s[j]));
            (dx, dz, dw)
        };
        let most = |(dx, dz, dw): &(DVector<f64>, DVector<f64>, DVector<f64>)| {
            let primal = room(&self.x, dx, 1.0).min(room(&self.s, dx, -1.0));
            primal
                .min(room(&self.z, dz, 1.0))
                .min(room(&self.w, dw, 1.0))
        };
        let p = self.x.component_mul(&self.z);
        let q = self.s.zip_map(&self.w, times);
        let guess = towards(&p, &q);
        let a = most(&guess);
        let mu = self.complementarity(&self.x, &self.z, &self.s, &self.w) / self.pairs();
        let ahead = self.complementarity(
            &(&self.x + &guess.0 * a),
            &(&self.z + &guess.1 * a),
            &(&self.s - &guess.0 * a),
            &(&self.w + &guess.2 * a),
        ) / self.pairs();
        let centre = mu * (ahead / mu).powi(3);
        let p = p + guess.0.component_mul(&guess.1) - DVector::from_element(n, centre);
        let q = DVector::from_fn(n, |j, _| {
            if self.s[j].is_finite() {
                q[j] - guess.0[j] * guess.2[j] - centre
            } else {
                0.0
            }
        });
        let by = towards(&p, &q);
        let a = STEP * most(&by);
        if !(a > 1e-10 && by.0.iter().all(|x| x.is_finite())) {
            return false;
        }
        self.x += &by.0 * a;
        self.s -= &by.0 * a;
        self.z += &by.1 * a;
        self.w += &by.2 * a;
        self.gradient = self.r.tr_mul(&(self.r * &self.x - &self.d));
        true
    }
}

/// a/s; 0 where s is infinite.
pub(super) fn over(a: f64, s: f64) -> f64 {
    if s.is_finite() { a / s } else { 0.0 }
}

/// s·w; 0 where s is infinite.
pub(super) fn times(s: f64, w: f64) -> f64 {
    if s.is_finite() { s * w } else { 0.0 }
}

/// Multipliers of both bounds to begin with, as large as the gradient; 0 of an upper bound that is
/// infinitely far.
pub(super) fn multipliers(
    gradient: &DVector<f64>,
    s: &DVector<f64>,
    mean: f64,
) -> [DVector<f64>; 2] {
    let upper = |g: f64, s: f64| {
        if s.is_finite() {
            (-g).max(0.0) + mean
        } else {
            0.0
        }
    };
    [
        gradient.map(|g| g.max(0.0) + mean),
        gradient.zip_map(s, upper),
    ]
}

/// How far along `sign`·dx all of x stay positive, at most 1.
pub(super) fn room(x: &DVector<f64>, dx: &DVector<f64>, sign: f64) -> f64 {
    let each = x.iter().zip(dx.iter()).map(|(x, d)| (x, sign * d));
    each.filter(|(_, d)| *d < 0.0)
        .map(|(x, d)| -x / d)
        .fold(1.0, f64::min)
}

/// x of A x = b by conjugate gradients, preconditioned by an inverse that rounding disturbs: mostly
/// a step or two.
pub(super) fn conjugate(
    b: &DVector<f64>,
    times: impl Fn(&DVector<f64>) -> DVector<f64>,
    inverse: impl Fn(&DVector<f64>) -> DVector<f64>,
) -> DVector<f64> {
    const MOST: usize = 30;
    const ENOUGH: f64 = 1e-13;
    let (mut x, mut left) = (DVector::zeros(b.len()), b.clone());
    let mut towards = inverse(&left);
    let mut size = left.dot(&towards);
    let mut direction = towards.clone();
    for _ in 0..MOST {
        let image = times(&direction);
        let length = size / direction.dot(&image);
        if !(size > 0.0 && length.is_finite()) {
            break;
        }
        x.axpy(length, &direction, 1.0);
        left.axpy(-length, &image, 1.0);
        if left.norm() <= ENOUGH * b.norm() {
            break;
        }
        towards = inverse(&left);
        let next = left.dot(&towards);
        direction = &towards + direction * (next / size);
        size = next;
    }
    x
}

#[cfg(test)]
mod tests {
    use super::super::interior_point;
    use super::*;

    /// Both methods have one minimum, between two bounds and above one.
    #[test]
    fn it_ends_where_the_other_method_ends() {
        let mut state = 7u64;
        let mut next = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (state >> 33) as f64 / (1u64 << 31) as f64 - 0.5
        };
        let r = DMatrix::from_fn(30, 40, |i, j| {
            next() * libm::exp(-0.3 * ((i + j) % 17) as f64)
        });
        let d = DVector::from_fn(30, |_, _| next());
        for top in [1.0, f64::INFINITY] {
            let upper = DVector::from_fn(40, |j, _| if j % 3 == 0 { top } else { 0.7 });
            let [a, b] = [solve, interior_point::solve].map(|f| f(&r, &d, &upper).unwrap());
            let value = |x: &DVector<f64>| 0.5 * (&r * x - &d).norm_squared();
            assert_eq!(a.status, "Solved");
            assert!((value(&a.x) - value(&b.x)).abs() < 1e-9 * d.norm_squared());
            // The fitted data are unique where the variables are not.
            assert!((&r * &a.x - &r * &b.x).norm() < 1e-4 * d.norm());
        }
        let nothing = solve(&r, &DVector::zeros(30), &DVector::from_element(40, 1.0)).unwrap();
        assert!((&r * nothing.x).norm() < 1e-6);
    }
}
