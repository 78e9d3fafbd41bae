//! How far one variable can go in a box and an ellipsoid at once, of many variables: an
//! interior-point method on dense matrices.

mod equations;
mod state;

use nalgebra::{DMatrix, DVector};

use super::Bounds;
use equations::Equations;
use state::{Direction, Products, State, over};

/// Steps towards the centre and towards an end.
const MOST_STEPS: u32 = 30;
/// An end is proved within this share of the room between the bounds.
const GAP: f64 = 1e-4;

/// How the steps towards an end are taken.
#[derive(Clone, Copy)]
struct Manner {
    /// Share of the way to the nearest edge that is gone.
    step: f64,
    /// The least share of the products that a step aims at.
    least_aim: f64,
    /// Whether what the predicted step adds to the products is taken off.
    corrected: bool,
}

/// Bold steps end at the edge of the ellipsoid: of 273 ends of a picture of 24 × 24 elements 12
/// with (0.99, 1e-9), 3 with the first of these, none with the second after it.
const MANNERS: [Manner; 3] = [
    Manner {
        step: 0.9,
        least_aim: 0.03,
        corrected: true,
    },
    Manner {
        step: 0.9,
        least_aim: 0.2,
        corrected: false,
    },
    Manner {
        step: 0.5,
        least_aim: 0.1,
        corrected: true,
    },
];

/// { l ≤ x ≤ u, ‖R x − d‖ ≤ radius }, of which `best` is one, its residual R x − d.
pub(super) struct Region<'a> {
    pub(super) r: &'a DMatrix<f64>,
    pub(super) bounds: &'a Bounds,
    pub(super) best: &'a DVector<f64>,
    pub(super) residual: DVector<f64>,
    pub(super) radius: f64,
}

/// The point of the region that is farthest from all its edges, from which the way to each end is
/// short: the largest Σ ln (x − l) + Σ ln (u − x) + ln ½(radius² − ‖R x − d‖²).
pub(super) struct Centre {
    state: State,
    equations: Equations,
}

/// What is known of an end.
pub(super) enum End {
    /// A point of the region is at the variable's bound.
    Bound,
    /// The multipliers of R x − d that prove where it is.
    Proved(DVector<f64>),
}

/// How far along `by` all stay positive, at most 1.
fn room(x: &DVector<f64>, by: &DVector<f64>, sign: f64) -> f64 {
    let each = x.iter().zip(by.iter()).map(|(x, d)| (x, sign * d));
    let towards = each.filter(|(_, d)| *d < 0.0);
    towards.map(|(x, d)| -x / d).fold(1.0, f64::min)
}

impl Region<'_> {
    /// What multipliers z of R x − d prove of the least towardsᵀ(x − x̂).
    pub(super) fn proves(&self, towards: &DVector<f64>, z: &DVector<f64>) -> f64 {
        let Bounds { lower, upper } = self.bounds;
        let h = self.r.tr_mul(z) + towards;
        let each = h.iter().enumerate().map(|(i, h)| match *h {
            0.0 => 0.0,
            h => (h * (lower[i] - self.best[i])).min(h * (upper[i] - self.best[i])),
        });
        each.sum::<f64>() + z.dot(&self.residual) - self.radius * z.norm()
    }

    /// None where there is no room between the bounds or about the best point.
    pub(super) fn centre(&self) -> Option<Centre> {
        let nowhere = DVector::zeros(self.best.len());
        let mut state = self.start()?;
        for _ in 0..MOST_STEPS {
            let mean = state.mean();
            let off = self.off(&state, &nowhere);
            let equations = Equations::new(self, &state)?;
            if off.component_mul(&state.y).amax() < 1e-3 * mean {
                return Some(Centre { state, equations });
            }
            let by = self.towards(&state, &equations, &off, &state.aim(mean, None));
            state = self.moved(&state, &by, MANNERS[0].step)?;
        }
        None
    }

    /// A little way from the best point into the box, the multipliers those of the barrier.
    fn start(&self) -> Option<State> {
        let Bounds { lower, upper } = self.bounds;
        let n = lower.len();
        let size = self.best.amax().max(f64::MIN_POSITIVE);
        let middle = DVector::from_fn(n, |j, _| match upper[j] - lower[j] {
            room if room.is_finite() => lower[j] + 0.5 * room,
            _ => self.best[j].max(lower[j]) + size,
        });
        let way = middle - self.best;
        let along = self.r * &way;
        // Half of the slack that the best point has.
        let slack = 0.5 * (self.radius * self.radius - self.residual.norm_squared());
        let share = reach(&self.residual, &along, slack).min(0.9);
        let mut state = self.at(self.best + way * share)?;
        let unit = 1.0 / state.pairs();
        state.z = state.y.map(|y| unit / y);
        state.w = state.s.map(|s| over(unit, s));
        state.m = unit / state.g;
        Some(state)
    }

    /// The state at x, without multipliers; none where x is not inside.
    fn at(&self, x: DVector<f64>) -> Option<State> {
        let (y, s) = (&x - &self.bounds.lower, &self.bounds.upper - &x);
        let e = &self.residual + self.r * (&x - self.best);
        let g = 0.5 * (self.radius * self.radius - e.norm_squared());
        let inside = y.iter().chain(s.iter()).all(|x| *x > 0.0) && g > 0.0;
        inside.then(|| State {
            z: DVector::zeros(0),
            w: DVector::zeros(0),
            m: 0.0,
            x,
            y,
            s,
            e,
            g,
        })
    }

    /// The end at which sign · x_j is least, `proves` what multipliers prove of sign · (x_j −
    /// x̂_j); where the method ends before it comes near, what proves most till then.
    pub(super) fn end(
        &self,
        centre: &Centre,
        (j, sign): (usize, f64),
        proves: impl Fn(&DVector<f64>) -> f64,
    ) -> End {
        let Bounds { lower, upper } = self.bounds;
        let bound = if sign > 0.0 { lower[j] } else { upper[j] };
        let room = upper[j] - lower[j];
        let size = if room.is_finite() {
            room
        } else {
            self.best.amax()
        };
        let mut towards = DVector::zeros(self.best.len());
        towards[j] = 1.0;
        if bound.is_finite() && self.holds_at(centre, &towards, (j, bound)) {
            return End::Bound;
        }
        towards[j] = sign;
        let mut most = (f64::NEG_INFINITY, DVector::zeros(self.r.nrows()));
        for manner in MANNERS {
            let mut state = Some(centre.state.clone());
            for _ in 0..MOST_STEPS {
                let Some(now) = state else { break };
                let moved = &now.e + self.r.column(j) * (bound - now.x[j]);
                if bound.is_finite() && moved.norm() <= self.radius {
                    return End::Bound;
                }
                let multipliers = &now.e * now.m;
                let proved = proves(&multipliers);
                if proved > most.0 {
                    most = (proved, multipliers);
                }
                if sign * (now.x[j] - self.best[j]) - most.0 <= GAP * size {
                    return End::Proved(most.1);
                }
                state = self.next(&now, &towards, manner);
            }
        }
        End::Proved(most.1)
    }

    /// Whether the region has a point with x_j = `bound` on the way that changes the others least,
    /// in the metric of the centre's barrier.
    fn holds_at(&self, centre: &Centre, axis: &DVector<f64>, (j, bound): (usize, f64)) -> bool {
        let Centre { state, equations } = centre;
        let way = equations.solve(self.r, axis);
        let length = (bound - state.x[j]) / way[j];
        let Bounds { lower, upper } = self.bounds;
        let x = DVector::from_fn(way.len(), |i, _| {
            (state.x[i] + length * way[i]).clamp(lower[i], upper[i])
        });
        let e = &self.residual + self.r * (x - self.best);
        length.is_finite() && e.norm() <= self.radius
    }

    /// One predictor and corrector; none where no progress is possible.
    fn next(&self, state: &State, towards: &DVector<f64>, manner: Manner) -> Option<State> {
        let equations = Equations::new(self, state)?;
        let off = self.off(state, towards);
        let guess = self.towards(state, &equations, &off, &state.aim(0.0, None));
        let (primal, dual) = self.rooms(state, &guess);
        let mean = state.mean();
        let ahead = state.ahead(self.radius, &guess, (primal, dual));
        let aim = mean * (ahead / mean).powi(3).clamp(manner.least_aim, 1.0);
        let predicted = Some(&guess).filter(|_| manner.corrected);
        let by = self.towards(state, &equations, &off, &state.aim(aim, predicted));
        self.moved(state, &by, manner.step)
    }

    /// c − z + w + m Rᵀ e.
    fn off(&self, state: &State, towards: &DVector<f64>) -> DVector<f64> {
        towards - &state.z + &state.w + self.r.tr_mul(&state.e) * state.m
    }

    fn towards(
        &self,
        state: &State,
        equations: &Equations,
        off: &DVector<f64>,
        c: &Products,
    ) -> Direction {
        let State { y, s, z, w, .. } = state;
        let bent = self.r.tr_mul(&state.e) * (c.gm / state.g);
        let b = DVector::from_fn(y.len(), |j, _| {
            c.yz[j] / y[j] - over(c.sw[j], s[j]) - off[j] - bent[j]
        });
        let x = equations.solve(self.r, &b);
        let e = self.r * &x;
        Direction {
            z: DVector::from_fn(y.len(), |j, _| (c.yz[j] - z[j] * x[j]) / y[j]),
            w: DVector::from_fn(y.len(), |j, _| over(c.sw[j] + w[j] * x[j], s[j])),
            m: (c.gm + state.m * state.e.dot(&e)) / state.g,
            x,
            e,
        }
    }

    /// How far the point and the multipliers can go, at most 1.
    fn rooms(&self, state: &State, by: &Direction) -> (f64, f64) {
        let primal = room(&state.y, &by.x, 1.0)
            .min(room(&state.s, &by.x, -1.0))
            .min(reach(&state.e, &by.e, 2.0 * state.g));
        let of_m = if by.m < 0.0 { -state.m / by.m } else { 1.0 };
        let dual = room(&state.z, &by.z, 1.0)
            .min(room(&state.w, &by.w, 1.0))
            .min(of_m);
        (primal, dual)
    }

    fn moved(&self, state: &State, by: &Direction, step: f64) -> Option<State> {
        let (primal, dual) = self.rooms(state, by);
        let (primal, dual) = (step * primal, step * dual);
        let mut next = self.at(&state.x + &by.x * primal)?;
        next.z = &state.z + &by.z * dual;
        next.w = &state.w + &by.w * dual;
        next.m = state.m + by.m * dual;
        let finite = next.z.iter().chain(next.w.iter()).all(|x| x.is_finite());
        (finite && primal.max(dual) > 1e-8).then_some(next)
    }
}

/// The largest t with ‖e + t v‖² ≤ ‖e‖² + slack.
fn reach(e: &DVector<f64>, v: &DVector<f64>, slack: f64) -> f64 {
    let (a, b) = (v.norm_squared(), e.dot(v));
    let root = (b * b + a * slack).sqrt();
    // Of the two forms the one without a difference of like numbers.
    let t = if b > 0.0 {
        slack / (b + root)
    } else {
        (root - b) / a
    };
    if t.is_nan() { f64::INFINITY } else { t }
}
