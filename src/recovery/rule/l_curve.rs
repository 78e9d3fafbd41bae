//! The corner of the L-curve (Hansen and O'Leary 1993).
//!
//! Over log ‖residual‖ the curve log ‖solution‖ is steep where noise is amplified and flat where
//! signal is lost; the parameter at the corner between is taken. It needs no noise model.
//!
//! * damping: the point of largest curvature κ = (a′b″ − a″b′)/(a′² + b′²)^{3/2}, a = ½ log ‖Φ P −
//!   Φ‖² and b = ½ log ‖X‖² as functions of t = log λ between the smallest and the largest singular
//!   value, with the derivatives in closed form from f = σ²/(σ² + λ²), df/dt = −2 f (1 − f);
//! * truncation, whose curve is a row of points P_k: the vertex of the sharpest triangle (P_j, P_k,
//!   P_n), j < k < n, n the last point (Castellanos, Gómez and Guerra 2002).
//!
//! Every curve has a point of largest curvature. A corner is one where such a triangle, its vertex
//! there, turns the way of an L by more than π/8; of the damped curve its corners are looked for at
//! the singular values. Without one the rule has no answer.

use std::f64::consts::PI;

use super::Data;
use crate::num::search;
use crate::recovery::Choice;

/// The least turn of a corner, rad.
const LEAST_TURN: f64 = PI / 8.0;

impl Data<'_> {
    fn l_curve(&self, filter: &[f64], turn: f64) -> Choice {
        Choice::LCurve {
            residual: self.residual(filter).sqrt(),
            penalty: self.penalty(filter).sqrt(),
            turn,
        }
    }

    /// κ at λ.
    fn curvature(&self, lambda: f64) -> f64 {
        let filter = self.spectrum.damped(lambda);
        let free = self.spectrum.free;
        let (mut r1, mut r2, mut x1, mut x2) = (0.0, 0.0, 0.0, 0.0);
        for ((&z, &f), &s) in self.along[free..]
            .iter()
            .zip(&filter[free..])
            .zip(self.spectrum.filtered())
        {
            let (g, y) = (1.0 - f, z / s / s);
            r1 += 4.0 * f * g * g * z;
            r2 -= 8.0 * f * g * g * (1.0 - 3.0 * f) * z;
            x1 -= 4.0 * f * f * g * y;
            x2 += 8.0 * f * f * g * (2.0 - 3.0 * f) * y;
        }
        let log = |square: f64, first: f64, second: f64| {
            let slope = first / square;
            (0.5 * slope, 0.5 * (second / square - slope * slope))
        };
        let (a1, a2) = log(self.residual(&filter), r1, r2);
        let (b1, b2) = log(self.penalty(&filter), x1, x2);
        let speed = a1 * a1 + b1 * b1;
        (a1 * b2 - a2 * b1) / (speed * speed.sqrt())
    }

    /// ½ log of residual and penalty.
    fn point(&self, filter: &[f64]) -> [f64; 2] {
        let half_log = |square: f64| 0.5 * libm::log(square);
        [
            half_log(self.residual(filter)),
            half_log(self.penalty(filter)),
        ]
    }

    /// The damping λ of largest curvature; `None` where the curve does not turn there as an L does.
    pub(in crate::recovery) fn damped_by_l_curve(&self) -> Option<(f64, Choice)> {
        let sigma = self.spectrum.filtered();
        let (low, high) = (*sigma.last()?, *sigma.first()?);
        let (lambda, _) = search::largest(low, high, |x| self.curvature(x));
        let point = |lambda: f64| self.point(&self.spectrum.damped(lambda));
        let (vertex, last) = (point(lambda), point(low));
        let before = sigma.iter().filter(|s| **s > lambda);
        let turns = before.map(|s| turn([point(*s), vertex, last]));
        let turn = turns.fold(0.0, f64::max);
        let filter = self.spectrum.damped(lambda);
        (turn > LEAST_TURN).then(|| (lambda, self.l_curve(&filter, turn)))
    }

    /// The truncation at the corner; `None` where there is none. As many directions as spots leave
    /// no residual and so no point.
    pub(in crate::recovery) fn kept_by_l_curve(&self) -> Option<(usize, Choice)> {
        let most = self.spectrum.len().min(self.spots as usize - 1);
        let points = (1..=most).map(|kept| self.point(&self.spectrum.truncated(kept)));
        let (at, turn) = corner(&points.collect::<Vec<_>>())?;
        let kept = at + 1;
        Some((kept, self.l_curve(&self.spectrum.truncated(kept), turn)))
    }
}

/// By how much a path over three points turns at the middle one, rad: positive from left to up.
fn turn([a, b, c]: [[f64; 2]; 3]) -> f64 {
    let along = |from: [f64; 2], to: [f64; 2]| [to[0] - from[0], to[1] - from[1]];
    let ([ax, ay], [bx, by]) = (along(a, b), along(b, c));
    -libm::atan2(ax * by - ay * bx, ax * bx + ay * by)
}

/// The corner of a row of points that runs to the left and up, and by how much it turns there
/// (rad).
fn corner(points: &[[f64; 2]]) -> Option<(usize, f64)> {
    let whole = |p: &[f64; 2]| p.iter().all(|x| x.is_finite());
    let last = points.iter().rposition(whole)?;
    let mut best = None;
    for k in (1..last).filter(|&k| whole(&points[k])) {
        for j in (0..k).filter(|&j| whole(&points[j])) {
            let turn = turn([points[j], points[k], points[last]]);
            if turn > LEAST_TURN && best.is_none_or(|(_, most)| turn > most) {
                best = Some((k, turn));
            }
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::num::linalg::svd;
    use crate::recovery::bench::{Bench, relative_noise};
    use crate::recovery::{
        Method, Options, Parameter, Problem, RecoveryError, Rule, Spectrum, recover,
    };

    #[test]
    fn the_curvature_is_that_of_the_drawn_curve() {
        let bench = Bench::new(3.0, 8, 8);
        let (phi, _) = relative_noise(&bench.phi(&bench.board(2)), 1e-3, 3);
        let problem = Problem::new(&phi, &bench.c, &bench.d, None).unwrap();
        let laser = svd(&bench.d).unwrap();
        let spectrum = Spectrum::of(&laser, 20);
        let data = Data::new(&problem, &spectrum);
        // The curve by solving the damped normal equations, (DDᵀ + λ²) X = DΦᵀ; curvature by
        // differences of its points.
        let point = |t: f64| {
            let filter = spectrum.damped(libm::exp(t));
            let (data, solution) = spectrum.factors(&filter);
            let x = &phi * data.transpose() * solution;
            let residual = (&x * &bench.d - &phi).norm();
            [libm::log(residual), libm::log(x.norm())]
        };
        let h = 1e-3;
        for t in [-14.0, -11.0, -8.5, -7.0, -5.0] {
            let [before, here, after] = [t - h, t, t + h].map(point);
            let first = |i: usize| (after[i] - before[i]) / (2.0 * h);
            let second = |i: usize| (after[i] - 2.0 * here[i] + before[i]) / (h * h);
            let speed = first(0).powi(2) + first(1).powi(2);
            let drawn = (first(0) * second(1) - second(0) * first(1)) / (speed * speed.sqrt());
            let found = data.curvature(libm::exp(t));
            assert!(
                (found - drawn).abs() < 1e-3 * (1.0 + drawn.abs()),
                "{t}: {found} {drawn}"
            );
        }
    }

    #[test]
    fn the_sharpest_point_is_chosen() {
        let bench = Bench::new(3.0, 8, 8);
        let (phi, _) = relative_noise(&bench.phi(&bench.board(2)), 1e-3, 3);
        let problem = Problem::new(&phi, &bench.c, &bench.d, None).unwrap();
        let options = Options {
            rule: Rule::LCurve,
            ..Options::default()
        };
        let found = recover(Method::Tikhonov, &problem, &options).unwrap();
        let (Parameter::Damping(damping), Choice::LCurve { turn, .. }) =
            (found.parameter, found.choice)
        else {
            panic!("{:?}", found.choice)
        };
        let laser = svd(&bench.d).unwrap();
        let spectrum = Spectrum::of(&laser, found.rank);
        let data = Data::new(&problem, &spectrum);
        let first = laser.sigma[0];
        let (low, high) = (libm::log(laser.sigma[found.rank - 1]), libm::log(first));
        let brute = (0..=5000)
            .map(|k| data.curvature(libm::exp(low + (high - low) * f64::from(k) / 5000.0)))
            .fold(0.0, f64::max);
        let sharpest = data.curvature(damping * first);
        assert!(sharpest >= brute * (1.0 - 1e-6), "{sharpest} {brute}");
        // The corner of an L turns by a right angle.
        assert!((turn - PI / 2.0).abs() < 0.2, "{turn}");
    }

    /// Of noise of a tenth the curve of differences only bends a little, and most where 2e8 is
    /// recovered; without noise the norm of the solution has nothing to rise with. Neither is a
    /// corner.
    #[test]
    fn a_bend_is_no_corner() {
        let bench = Bench::new(6.0, 8, 8);
        let exact = bench.phi(&bench.board(2));
        let grids = [[8, 8]];
        for (noise, method) in [
            (0.1, Method::TikhonovGradient),
            (0.3, Method::TikhonovGradient),
            (0.0, Method::TikhonovGradient),
            (0.0, Method::Tikhonov),
        ] {
            let (phi, _) = relative_noise(&exact, noise, 3);
            let problem = Problem::new(&phi, &bench.c, &bench.d, None).unwrap();
            let problem = problem.with_grids(&grids).unwrap();
            let options = Options {
                rule: Rule::LCurve,
                ..Options::default()
            };
            let error = recover(method, &problem, &options).unwrap_err();
            let told = error.to_string();
            let whole = ["no corner", "gcv", "damping"]
                .iter()
                .all(|w| told.contains(w));
            assert!(
                matches!(error, RecoveryError::Undecided { .. }) && whole,
                "{told}"
            );
        }
    }

    #[test]
    fn the_corner_of_an_l_is_its_corner() {
        // Leftwards, then up; a dent of less than π/8 before it.
        let drawn = [
            [9.0, 0.0],
            [7.0, 0.1],
            [5.0, 0.15],
            [3.0, 0.5],
            [1.0, 0.8],
            [0.8, 4.0],
            [0.7, 9.0],
        ];
        assert_eq!(corner(&drawn).unwrap().0, 4);
        // The other way round it is no L: up, then left.
        let dome = [[9.0, 0.0], [8.9, 5.0], [8.8, 9.0], [4.0, 9.1], [0.0, 9.2]];
        assert_eq!(corner(&dome), None);
        let straight = [[3.0, 0.0], [2.0, 1.0], [1.0, 2.0]];
        assert_eq!((corner(&straight), corner(&straight[..2])), (None, None));
        assert_eq!(corner(&[]), None);
    }

    #[test]
    fn a_curve_without_corner_is_refused() {
        // A single direction has one point and no curve.
        let c = nalgebra::DMatrix::from_element(2, 1, 1.0);
        let d = nalgebra::DMatrix::from_row_slice(1, 3, &[1.0, 2.0, 3.0]);
        let phi = &c * &d;
        let problem = Problem::new(&phi, &c, &d, None).unwrap();
        let options = Options {
            rule: Rule::LCurve,
            ..Options::default()
        };
        let error = recover(Method::Tsvd, &problem, &options).unwrap_err();
        assert!(
            matches!(error, RecoveryError::Undecided { .. }) && error.to_string().contains("rank"),
            "{error}"
        );
    }
}
