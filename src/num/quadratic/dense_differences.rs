//! Large problems with a penalty on differences: an interior-point method on dense matrices.

use nalgebra::{DMatrix, DVector};

use super::Bounds;
use super::dense::{STEP, conjugate, multipliers, over, room, times};
use crate::num::linalg::{Cholesky, gram_product};

/// Iterations, and the gap, relative to ½‖R‖² + ½‖d − R l‖², at which they end.
const MOST_ITERATIONS: u32 = 80;
const GAP: f64 = 1e-14;
/// Differences begin at this share of the room between the bounds.
const OPEN: f64 = 0.1;

/// Where the method ended.
pub(super) struct Found {
    pub(super) x: DVector<f64>,
    /// Multipliers of the differences, within ±λ.
    pub(super) pull: DVector<f64>,
    pub(super) iterations: u32,
    /// Whether the gap closed.
    pub(super) closed: bool,
}

/// What is to be minimised: ½‖R x − d‖² + λ Σ_(a,b) |x_a − x_b|, l ≤ x ≤ u.
pub(super) struct Penalised<'a> {
    pub(super) r: &'a DMatrix<f64>,
    pub(super) d: &'a DVector<f64>,
    pub(super) bounds: &'a Bounds,
    pub(super) pairs: &'a [[usize; 2]],
    pub(super) lambda: f64,
}

impl Penalised<'_> {
    /// T x.
    pub(super) fn differences(&self, x: &DVector<f64>) -> DVector<f64> {
        DVector::from_fn(self.pairs.len(), |i, _| {
            let [a, b] = self.pairs[i];
            x[a] - x[b]
        })
    }

    /// Tᵀ v.
    pub(super) fn gathered(&self, v: &DVector<f64>) -> DVector<f64> {
        let mut sum = DVector::zeros(self.r.ncols());
        for (&[a, b], v) in self.pairs.iter().zip(v.iter()) {
            sum[a] += v;
            sum[b] -= v;
        }
        sum
    }
}

/// Solves it by Mehrotra's predictor and corrector (Nocedal and Wright 2006, algorithm 16.4). With
/// T x = p − q, p and q ≥ 0, ν the multiplier of T x, |ν| ≤ λ, and z, w those of the bounds,
/// distances y = x − l and s = u − x, each step solves
///
/// > (RᵀR + Θ + Tᵀ D T) Δx = b,   Θ = z/y + w/s,   D = 1/(p/(λ − ν) + q/(λ + ν)),
///
/// n³/3 multiplications. `None` where it cannot begin: λ is 0.
pub(super) fn solve(problem: &Penalised<'_>) -> Option<Found> {
    let mut state = State::new(problem)?;
    let lower = &problem.bounds.lower;
    let size = problem.r.norm_squared() + (problem.d - problem.r * lower).norm_squared();
    let aim = GAP * 0.5 * size;
    let mut iterations = 0;
    while iterations < MOST_ITERATIONS && state.gap() > aim {
        iterations += 1;
        if !state.step() {
            break;
        }
    }
    let x = DVector::from_fn(lower.len(), |j, _| {
        (lower[j] + state.y[j]).clamp(lower[j], problem.bounds.upper[j])
    });
    let most = problem.lambda;
    x.iter().all(|x| x.is_finite()).then(|| Found {
        pull: state.pull().map(|w| w.clamp(-most, most)),
        closed: state.gap() <= aim,
        x,
        iterations,
    })
}

/// Where the iteration stands: all positive but for an s that is infinite, with a w of 0.
struct State<'a> {
    problem: &'a Penalised<'a>,
    gram: DMatrix<f64>,
    y: DVector<f64>,
    s: DVector<f64>,
    z: DVector<f64>,
    w: DVector<f64>,
    p: DVector<f64>,
    q: DVector<f64>,
    /// λ − ν and λ + ν.
    a: DVector<f64>,
    b: DVector<f64>,
}

/// A step of all of them; that of b is −a.
struct Direction {
    y: DVector<f64>,
    z: DVector<f64>,
    w: DVector<f64>,
    p: DVector<f64>,
    q: DVector<f64>,
    a: DVector<f64>,
}

/// What the products y z, s w, p a and q b are to change by, negated.
struct Products {
    yz: DVector<f64>,
    sw: DVector<f64>,
    pa: DVector<f64>,
    qb: DVector<f64>,
}

impl<'a> State<'a> {
    /// Begins in the middle of the box, the multipliers as large as the gradient.
    fn new(problem: &'a Penalised<'a>) -> Option<Self> {
        let Penalised {
            r,
            d,
            bounds,
            pairs,
            lambda,
        } = *problem;
        let n = r.ncols();
        if lambda <= 0.0 {
            return None;
        }
        let mut gram = DMatrix::zeros(n, n);
        gram_product(&mut gram, r);
        gram.fill_upper_triangle_with_lower_triangle();
        // Without an upper bound: as far as the data reach.
        let white = r.column_sum();
        let reach = (white.dot(d) / white.norm_squared()).abs();
        let reach = if reach.is_finite() && reach > 0.0 {
            reach
        } else {
            1.0
        };
        let room = |j: usize| match bounds.upper[j] - bounds.lower[j] {
            room if room.is_finite() => room.max(1e-12),
            _ => 2.0 * reach,
        };
        let y = DVector::from_fn(n, |j, _| 0.5 * room(j));
        let s = DVector::from_fn(n, |j, _| {
            if bounds.upper[j].is_finite() {
                y[j]
            } else {
                f64::INFINITY
            }
        });
        let gradient = r.tr_mul(&(r * (&bounds.lower + &y) - d));
        let mean = gradient.lp_norm(1) / n as f64 + f64::MIN_POSITIVE;
        let [z, w] = multipliers(&gradient, &s, mean);
        let apart = |[i, j]: [usize; 2]| bounds.lower[i] + y[i] - bounds.lower[j] - y[j];
        let open = |sign: f64| {
            DVector::from_iterator(
                pairs.len(),
                pairs
                    .iter()
                    .map(|pair| (sign * apart(*pair)).max(0.0) + OPEN * room(pair[0])),
            )
        };
        Some(Self {
            problem,
            gram,
            p: open(1.0),
            q: open(-1.0),
            a: DVector::from_element(pairs.len(), lambda),
            b: DVector::from_element(pairs.len(), lambda),
            y,
            s,
            z,
            w,
        })
    }

    fn x(&self) -> DVector<f64> {
        &self.problem.bounds.lower + &self.y
    }

    /// ν, the smaller of λ ± ν being the better known.
    fn pull(&self) -> DVector<f64> {
        let lambda = self.problem.lambda;
        self.a
            .zip_map(&self.b, |a, b| if a < b { lambda - a } else { b - lambda })
    }

    /// Rᵀ(R x − d) − z + w + Tᵀ ν.
    fn off(&self) -> DVector<f64> {
        let Penalised { r, d, .. } = *self.problem;
        r.tr_mul(&(r * self.x() - d)) - &self.z + &self.w + self.problem.gathered(&self.pull())
    }

    fn products(&self) -> Products {
        Products {
            yz: self.y.component_mul(&self.z),
            sw: self.s.zip_map(&self.w, times),
            pa: self.p.component_mul(&self.a),
            qb: self.q.component_mul(&self.b),
        }
    }

    /// The sum of the products, and what the conditions are off by in units of the gap.
    fn gap(&self) -> f64 {
        self.products().sum() + self.off().abs().dot(&self.y)
    }

    fn moved(&self, by: &Direction, length: f64) -> Self {
        let on = |x: &DVector<f64>, dx: &DVector<f64>, sign: f64| x + dx * (sign * length);
        Self {
            problem: self.problem,
            gram: DMatrix::zeros(0, 0),
            y: on(&self.y, &by.y, 1.0),
            s: on(&self.s, &by.y, -1.0),
            z: on(&self.z, &by.z, 1.0),
            w: on(&self.w, &by.w, 1.0),
            p: on(&self.p, &by.p, 1.0),
            q: on(&self.q, &by.q, 1.0),
            a: on(&self.a, &by.a, 1.0),
            b: on(&self.b, &by.a, -1.0),
        }
    }

    /// How far along `by` all stay positive, at most 1.
    fn room(&self, by: &Direction) -> f64 {
        [
            room(&self.y, &by.y, 1.0),
            room(&self.s, &by.y, -1.0),
            room(&self.z, &by.z, 1.0),
            room(&self.w, &by.w, 1.0),
            room(&self.p, &by.p, 1.0),
            room(&self.q, &by.q, 1.0),
            room(&self.a, &by.a, 1.0),
            room(&self.b, &by.a, -1.0),
        ]
        .into_iter()
        .fold(1.0, f64::min)
    }

    /// One predictor and corrector; `false` where no progress is possible.
    fn step(&mut self) -> bool {
        let n = self.y.len();
        let theta = DVector::from_fn(n, |j, _| self.z[j] / self.y[j] + over(self.w[j], self.s[j]));
        let stiff = DVector::from_fn(self.p.len(), |i, _| {
            1.0 / (self.p[i] / self.a[i] + self.q[i] / self.b[i])
        });
        let mut whole = self.gram.clone();
        for j in 0..n {
            whole[(j, j)] += theta[j];
        }
        for (&[i, j], d) in self.problem.pairs.iter().zip(stiff.iter()) {
            whole[(i, i)] += d;
            whole[(j, j)] += d;
            whole[(i.max(j), i.min(j))] -= d;
        }
        let Some(inner) = Cholesky::new(&whole) else {
            return false;
        };
        let times = |v: &DVector<f64>| {
            let held = self.problem.differences(v).component_mul(&stiff);
            &self.gram * v + theta.component_mul(v) + self.problem.gathered(&held)
        };
        let (off, lost) = (
            self.off(),
            self.problem.differences(&self.x()) - &self.p + &self.q,
        );
        let towards = |c: &Products| {
            let apart = DVector::from_fn(self.p.len(), |i, _| {
                c.pa[i] / self.a[i] - c.qb[i] / self.b[i] + lost[i]
            });
            let bounds = DVector::from_fn(n, |j, _| {
                over(c.sw[j], self.s[j]) - c.yz[j] / self.y[j] - off[j]
            });
            let right = bounds - self.problem.gathered(&apart.component_mul(&stiff));
            let y = conjugate(&right, times, |b| inner.solve(b));
            let pull = (self.problem.differences(&y) + apart).component_mul(&stiff);
            Direction {
                z: DVector::from_fn(n, |j, _| -(c.yz[j] + self.z[j] * y[j]) / self.y[j]),
                w: DVector::from_fn(n, |j, _| over(self.w[j] * y[j] - c.sw[j], self.s[j])),
                p: DVector::from_fn(pull.len(), |i, _| {
                    (self.p[i] * pull[i] - c.pa[i]) / self.a[i]
                }),
                q: DVector::from_fn(pull.len(), |i, _| {
                    -(self.q[i] * pull[i] + c.qb[i]) / self.b[i]
                }),
                a: -pull,
                y,
            }
        };
        let now = self.products();
        let guess = towards(&now);
        let count = now.count(&self.s);
        let mu = now.sum() / count;
        let ahead = self.moved(&guess, self.room(&guess)).products().sum() / count;
        let centre = mu * (ahead / mu).powi(3);
        let by = towards(&now.corrected(&guess, &self.s, centre));
        let length = STEP * self.room(&by);
        if !(length > 1e-10 && by.y.iter().all(|x| x.is_finite())) {
            return false;
        }
        let gram = std::mem::replace(&mut self.gram, DMatrix::zeros(0, 0));
        let next = self.moved(&by, length);
        *self = Self { gram, ..next };
        true
    }
}

impl Products {
    fn sum(&self) -> f64 {
        self.yz.sum() + self.sw.sum() + self.pa.sum() + self.qb.sum()
    }

    /// How many there are, those of infinite s not.
    fn count(&self, s: &DVector<f64>) -> f64 {
        let closed = s.iter().filter(|s| s.is_finite()).count();
        (self.yz.len() + closed + self.pa.len() + self.qb.len()) as f64
    }

    /// The same with what the products of the predicted steps add, towards `centre`.
    fn corrected(mut self, by: &Direction, s: &DVector<f64>, centre: f64) -> Self {
        self.yz += by.y.component_mul(&by.z);
        self.sw -= by.y.component_mul(&by.w);
        self.pa += by.p.component_mul(&by.a);
        self.qb -= by.q.component_mul(&by.a);
        for c in [&mut self.yz, &mut self.pa, &mut self.qb] {
            c.add_scalar_mut(-centre);
        }
        for (c, s) in self.sw.iter_mut().zip(s.iter()) {
            *c = if s.is_finite() { *c - centre } else { 0.0 };
        }
        self
    }
}
