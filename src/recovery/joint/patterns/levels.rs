//! The two levels of a pattern: their least squares, and how likely the pattern is whatever they
//! are.

use nalgebra::DVector;

use crate::num::quadrature::Rule;

/// Nodes of the quadrature over the dark level.
const NODES: usize = 40;
/// Standard deviations on either side of its likeliest value.
const REACH: f64 = 9.0;

/// All contrasts b − a.
pub(super) const ALL: [f64; 2] = [0.0, 1.0];

/// χ²(a, b) = ‖d − a u − b w‖² of the levels a, b of elements whose light is u (dark) and w
/// (light), in standard deviations: a parabola about its minimum.
pub(super) struct LevelFit {
    /// \[a, b\] of the minimum over the plane.
    pub(super) best: [f64; 2],
    /// ½ ∂²χ²: uᵀu, uᵀw, wᵀw.
    curvature: [f64; 3],
    /// The minimum.
    pub(super) chi2: f64,
}

/// A pattern's weight, all levels 0 ≤ a < b ≤ 1 being equally likely beforehand.
pub(super) struct Weight {
    /// ln of 2 ∫∫ exp(−½ χ²) da db.
    pub(super) log: f64,
    /// Means of a and b under it, and of their squares.
    pub(super) moments: [[f64; 2]; 2],
}

/// Whether these can be levels.
pub(super) fn possible([a, b]: [f64; 2]) -> bool {
    0.0 <= a && a < b && b <= 1.0
}

/// Φ(y) − Φ(x) of a normal distribution, x ≤ y, without cancellation in either tail.
fn between(x: f64, y: f64) -> f64 {
    let upper = |z: f64| 0.5 * libm::erfc(z * std::f64::consts::FRAC_1_SQRT_2);
    if x > 0.0 {
        upper(x) - upper(y)
    } else {
        upper(-y) - upper(-x)
    }
}

impl LevelFit {
    /// None where light of one level does not tell from the other's.
    pub(super) fn new(d: &DVector<f64>, u: &DVector<f64>, w: &DVector<f64>) -> Option<Self> {
        let (uu, uw, ww) = (u.norm_squared(), u.dot(w), w.norm_squared());
        // The part of w beside u: no cancellation between products.
        let beside = w - u * (uw / uu);
        let own = beside.norm_squared();
        if uu.is_nan() || uu <= 0.0 || own.is_nan() || own <= 1e-20 * ww {
            return None;
        }
        let b = beside.dot(d) / own;
        let a = (u.dot(d) - uw * b) / uu;
        let left = d - u * a - w * b;
        Some(Self {
            best: [a, b],
            curvature: [uu, uw, ww],
            chi2: left.norm_squared(),
        })
    }

    fn determinant(&self) -> f64 {
        let [uu, uw, ww] = self.curvature;
        (uu * ww - uw * uw).max(f64::MIN_POSITIVE)
    }

    /// Levels of density ∝ exp(−½ χ²) over the plane, from two standard normal numbers.
    pub(super) fn draw(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [_, uw, ww] = self.curvature;
        let a = x * (ww / self.determinant()).sqrt();
        let b = -a * uw / ww + y / ww.sqrt();
        [self.best[0] + a, self.best[1] + b]
    }

    /// The weight over 0 ≤ a < b ≤ 1 with b − a between two contrasts: closed in b, Gauss–Legendre
    /// in a. At a contrast Δ the likeliest a is that of the parabola along b = a + Δ.
    pub(super) fn weight(&self, rule: &Rule, [least, most]: [f64; 2]) -> Option<Weight> {
        let [uu, uw, ww] = self.curvature;
        let (sa, sb) = ((ww / self.determinant()).sqrt(), ww.sqrt().recip());
        let log_all = libm::log(sb * (2.0 * std::f64::consts::PI).sqrt());
        // ln ∫ exp(−½ χ²) db at a, and the moments of b there.
        let at = |a: f64| {
            let middle = self.best[1] - uw / ww * (a - self.best[0]);
            let [x, y] = [a + least, (a + most).min(1.0)].map(|b| (b - middle) / sb);
            if x >= y {
                return None;
            }
            let z = (a - self.best[0]) / sa;
            let own = -0.5 * (self.chi2 + z * z) + log_all;
            // All of it, to rounding.
            if x < -REACH && y > REACH {
                return Some((own, middle, middle * middle + sb * sb));
            }
            let share = between(x, y);
            if share <= 0.0 {
                return None;
            }
            let log = own + libm::log(share);
            let density = |z: f64| libm::exp(-0.5 * z * z) / (2.0 * std::f64::consts::PI).sqrt();
            let (dx, dy) = (density(x), density(y));
            let mean = middle + sb * (dx - dy) / share;
            let spread = 1.0 + (x * dx - y * dy) / share - ((dx - dy) / share).powi(2);
            Some((log, mean, mean * mean + sb * sb * spread.max(0.0)))
        };
        // Where b = 1 pulls a, it is likeliest on the line b = 1.
        let on_line = self.best[0] - (1.0 - self.best[1]) * uw / self.curvature[0];
        let middle = if self.best[1] > 1.0 {
            on_line
        } else {
            self.best[0]
        };
        let middle = middle.clamp(0.0, 1.0);
        let both = uu + 2.0 * uw + ww;
        let off = self.best[1] - self.best[0];
        let along = [least, most].map(|c| self.best[0] - (uw + ww) / both * (c - off));
        let (first, last) = (along[0].min(along[1]), along[0].max(along[1]));
        let reach = REACH / both.sqrt();
        let low = (middle - REACH * sa).max(first - reach).max(0.0);
        let high = (middle + REACH * sa).min(last + reach).min(1.0 - least);
        if low >= high {
            return None;
        }
        let values: Vec<(f64, f64, (f64, f64, f64))> = rule
            .on(low, high)
            .filter_map(|(a, weight)| Some((a, weight, at(a)?)))
            .collect();
        let top = values
            .iter()
            .map(|v| v.2.0)
            .fold(f64::NEG_INFINITY, f64::max);
        if !top.is_finite() {
            return None;
        }
        let (mut sum, mut moments) = (0.0, [[0.0; 2]; 2]);
        for (a, weight, (log, b, b2)) in values {
            let own = weight * libm::exp(log - top);
            sum += own;
            moments[0][0] += own * a;
            moments[0][1] += own * a * a;
            moments[1][0] += own * b;
            moments[1][1] += own * b2;
        }
        Some(Weight {
            log: top + libm::log(2.0 * sum),
            moments: moments.map(|m| m.map(|x| x / sum)),
        })
    }
}

/// The rule of [`LevelFit::weight`].
pub(super) fn rule() -> Rule {
    Rule::gauss_legendre(NODES)
}

/// The levels a, b from 0 to `top` of the least ‖d − a u − b w‖: that of the plane, or on one of
/// the sides. Not by iteration, whose tolerance is wide along the scale where that is nearly free.
pub(super) fn best_within(d: &DVector<f64>, [u, w]: &[DVector<f64>; 2], top: f64) -> [f64; 2] {
    let inside = |x: &f64| (0.0..=top).contains(x);
    if let Some(best) = LevelFit::new(d, u, w).map(|fit| fit.best)
        && best.iter().all(inside)
    {
        return best;
    }
    // The best of one level at the other.
    let other = |own: &DVector<f64>, left: &DVector<f64>| {
        let square = own.norm_squared();
        if square > 0.0 {
            (own.dot(left) / square).clamp(0.0, top)
        } else {
            0.0
        }
    };
    let ends = [0.0, top].into_iter().filter(|end| end.is_finite());
    let sides = ends.flat_map(|end| {
        [
            [end, other(w, &(d - u * end))],
            [other(u, &(d - w * end)), end],
        ]
    });
    let misfit = |[a, b]: &[f64; 2]| (u * *a + w * *b - d).norm_squared();
    let least = sides.min_by(|x, y| misfit(x).total_cmp(&misfit(y)));
    least.unwrap_or([0.0; 2])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sums over a fine grid of the triangle and of strips of it: inside it, at its corner and
    /// beyond it.
    #[test]
    fn weights_are_integrals_over_the_triangle() {
        let u = DVector::from_row_slice(&[9.0, 3.0, 1.0]);
        let w = DVector::from_row_slice(&[2.0, 5.0, 8.0]);
        for [a, b] in [[0.3, 0.7], [0.0, 1.0], [-0.2, 1.3], [0.6, 0.5], [0.9, 1.2]] {
            let d = &u * a + &w * b + DVector::from_row_slice(&[0.4, -0.2, 0.3]);
            let fit = LevelFit::new(&d, &u, &w).unwrap();
            let n = 2000;
            for contrasts in [ALL, [0.3, 0.45], [0.9, 1.0], [0.0, 0.1]] {
                let found = fit.weight(&rule(), contrasts);
                let (mut sum, mut first, mut second) = (0.0, 0.0, 0.0);
                for i in 0..n {
                    for j in i..n {
                        let [x, y] = [i, j].map(|k| (f64::from(k) + 0.5) / f64::from(n));
                        // A point on an edge counts half.
                        let edge = contrasts.map(|c| (f64::from(j - i) - c * f64::from(n)).abs());
                        let inside = (y - x - contrasts[0]).min(contrasts[1] - (y - x));
                        let half = if edge[0].min(edge[1]) < 0.5 {
                            0.5
                        } else {
                            f64::from(u8::from(inside > 0.0))
                        };
                        let own = half * libm::exp(-0.5 * (&d - &u * x - &w * y).norm_squared());
                        sum += own;
                        first += own * x;
                        second += own * y * y;
                    }
                }
                let expected = libm::log(2.0 * sum / f64::from(n * n));
                let told = format!("{a} {b} {contrasts:?} {expected}");
                let Some(found) = found else {
                    assert!(expected < -30.0, "{told}");
                    continue;
                };
                assert!((found.log - expected).abs() < 4e-3, "{told} {}", found.log);
                assert!((found.moments[0][0] - first / sum).abs() < 1e-3, "{told}");
                assert!((found.moments[1][1] - second / sum).abs() < 1e-3, "{told}");
            }
        }
        assert!(LevelFit::new(&u, &u, &(&u * 2.0)).is_none());
    }

    /// Draws over the plane have the covariance of the least squares.
    #[test]
    fn draws_by_hand() {
        let u = DVector::from_row_slice(&[2.0, 0.0, 0.0]);
        let w = DVector::from_row_slice(&[0.0, 4.0, 0.0]);
        let d = DVector::from_row_slice(&[1.0, 2.0, 3.0]);
        let fit = LevelFit::new(&d, &u, &w).unwrap();
        assert!((fit.chi2 - 9.0).abs() < 1e-12);
        let drawn = fit.draw([1.0, -1.0]);
        assert!(
            (drawn[0] - 1.0).abs() < 1e-12 && (drawn[1] - 0.25).abs() < 1e-12,
            "{drawn:?}"
        );
    }
}
