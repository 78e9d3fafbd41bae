//! An independent reference for Φcam of the bench: product Gauss–Legendre quadrature over every
//! check of the board and every pixel's footprint, in the test's own code. Nothing here comes from
//! the crate.

use std::f64::consts::PI;

/// What the reference needs to know of a bench with a wall at z = 0 and a board hinged at y = 15.5
/// at 45°.
#[derive(Clone)]
pub(crate) struct Bench {
    pub(crate) power: f64,
    pub wall_albedo: f64,
    /// Checks a side; check (0, 0), at x = 3, d = 5.86764, is dark (0), the others alternate (1).
    pub(crate) checks: usize,
    pub(crate) camera: [f64; 3],
    pub(crate) aperture: f64,
    pub(crate) view: [[f64; 2]; 2],
    pub(crate) pixels: [usize; 2],
    pub(crate) spots: Vec<[f64; 2]>,
}

impl Bench {
    /// The bench of the design with 4 × 30 staggered spots on a square of half-width `half`.
    pub(crate) fn new(half: f64, checks: usize) -> Self {
        let (cx, cy) = (5.0, 15.5 - 7.86764 * 2f64.sqrt());
        let n = 30;
        let at = |k: usize| -half + 2.0 * half * k as f64 / (n - 1) as f64;
        let o = |k: usize| [-1.0, 1.0, 0.0][k % 3];
        let mut spots = Vec::new();
        for k in 0..n {
            spots.push([cx + at(k), cy - half + o(k)]);
        }
        for k in 0..n {
            spots.push([cx + half + o(k), cy + at(k)]);
        }
        for k in 0..n {
            spots.push([cx - at(k), cy + half + o(k)]);
        }
        for k in 0..n {
            spots.push([cx - half + o(k), cy - at(k)]);
        }
        Self {
            power: 5e-3,
            wall_albedo: 0.8,
            checks,
            camera: [-20.0, 10.0, 15.0],
            aperture: 0.05,
            view: [[3.25, 6.5], [2.75, 6.0]],
            pixels: [16, 16],
            spots,
        }
    }

    /// Φcam\[pixel\]\[spot\] in W with `n` nodes a side on each check and `m` on each footprint.
    pub(crate) fn phi(&self, n: usize, m: usize) -> Vec<Vec<f64>> {
        let mut board = Vec::new();
        let side = 4.0 / self.checks as f64;
        for j in 0..self.checks {
            for i in 0..self.checks {
                if (i + j) % 2 == 0 {
                    continue;
                }
                for (a, wa) in gauss(n) {
                    for (b, wb) in gauss(n) {
                        let place = [(i as f64 + a) * side, (j as f64 + b) * side];
                        board.push((place, wa * wb * side * side));
                    }
                }
            }
        }
        self.phi_of(&board, m)
    }

    /// The same of points of the board, counted along x and d from its corner, with their weights:
    /// area times albedo.
    pub(crate) fn phi_of(&self, board: &[([f64; 2], f64)], m: usize) -> Vec<Vec<f64>> {
        // The normal of S2 is (0, −h, −h).
        let h = 0.5f64.sqrt();
        let place = |([x, d], w): &([f64; 2], f64)| {
            let d = 5.86764 + d;
            ([3.0 + x, 15.5 - d * h, d * h], *w)
        };
        let board: Vec<([f64; 3], f64)> = board.iter().map(place).collect();
        // cosθ_wall cosθ_board / R² between a wall point and a board point.
        let kernel = |wall: [f64; 2], p: [f64; 3]| {
            let r = [p[0] - wall[0], p[1] - wall[1], p[2]];
            let r2 = r[0] * r[0] + r[1] * r[1] + r[2] * r[2];
            let cos_wall = r[2] / r2.sqrt();
            let cos_board = h * (r[1] + r[2]) / r2.sqrt();
            cos_wall.max(0.0) * cos_board.max(0.0) / r2
        };
        let lit: Vec<Vec<f64>> = board
            .iter()
            .map(|(p, w)| {
                let scale = w / PI * self.power * self.wall_albedo / PI;
                self.spots.iter().map(|s| scale * kernel(*s, *p)).collect()
            })
            .collect();
        let [x, y] = self.view;
        let [columns, rows] = self.pixels;
        let (dx, dy) = ((x[1] - x[0]) / columns as f64, (y[1] - y[0]) / rows as f64);
        let mut phi = Vec::new();
        for pixel in 0..columns * rows {
            let mut seen = vec![0.0; board.len()];
            for (a, wa) in gauss(m) {
                for (b, wb) in gauss(m) {
                    let w = [
                        x[0] + ((pixel % columns) as f64 + a) * dx,
                        y[0] + ((pixel / columns) as f64 + b) * dy,
                    ];
                    let to = [self.camera[0] - w[0], self.camera[1] - w[1], self.camera[2]];
                    let d2: f64 = to.iter().map(|c| c * c).sum();
                    // A_lens cosθ_cam dΩ, dΩ = cosθ dA/d²; both cosines are z/d.
                    let etendue = self.aperture * to[2] * to[2] / (d2 * d2) * wa * wb * dx * dy;
                    for (s, (p, _)) in seen.iter_mut().zip(&board) {
                        *s += etendue * self.wall_albedo / PI * kernel(w, *p);
                    }
                }
            }
            let mut row = vec![0.0; self.spots.len()];
            for (s, l) in seen.iter().zip(&lit) {
                for (r, x) in row.iter_mut().zip(l) {
                    *r += s * x;
                }
            }
            phi.push(row);
        }
        phi
    }

    /// Φcam converged to 1e-12: more nodes change it by less.
    pub(crate) fn converged(&self) -> Vec<Vec<f64>> {
        let n = if self.checks >= 8 { 6 } else { 14 };
        let (coarse, fine) = (self.phi(n, 3), self.phi(n + 2, 4));
        let change = relative_difference(&coarse, &fine);
        assert!(
            change < 1e-12,
            "the reference has not converged: {change:e}"
        );
        fine
    }
}

/// ‖a − b‖/‖b‖ in the Frobenius norm.
pub(crate) fn relative_difference(a: &[Vec<f64>], b: &[Vec<f64>]) -> f64 {
    let (mut difference, mut norm) = (0.0, 0.0);
    for (x, y) in a.iter().flatten().zip(b.iter().flatten()) {
        difference += (x - y) * (x - y);
        norm += y * y;
    }
    (difference / norm).sqrt()
}

/// Gauss–Legendre nodes and weights on [0, 1], by bisection of P_n between the interlacing roots of
/// P_{n−1}: slow and unlike the crate's Newton iteration.
pub(crate) fn gauss(n: usize) -> Vec<(f64, f64)> {
    fn p(n: usize, x: f64) -> f64 {
        let (mut a, mut b) = (1.0, x);
        if n == 0 {
            return 1.0;
        }
        for k in 2..=n {
            let k = k as f64;
            (a, b) = (b, ((2.0 * k - 1.0) * x * b - (k - 1.0) * a) / k);
        }
        b
    }
    let mut roots: Vec<f64> = vec![];
    for m in 1..=n {
        let mut fence = vec![-1.0];
        fence.extend(&roots);
        fence.push(1.0);
        roots = fence
            .windows(2)
            .map(|w| {
                let (mut lo, mut hi) = (w[0], w[1]);
                let sign = p(m, lo).signum();
                for _ in 0..200 {
                    let mid = 0.5 * (lo + hi);
                    if p(m, mid).signum() == sign {
                        lo = mid;
                    } else {
                        hi = mid;
                    }
                }
                0.5 * (lo + hi)
            })
            .collect();
    }
    roots
        .into_iter()
        .map(|x| {
            // w = 2(1 − x²)/(n·P_{n−1}(x))², halved for [0, 1].
            let q = n as f64 * p(n - 1, x);
            (0.5 * (1.0 + x), (1.0 - x * x) / (q * q))
        })
        .collect()
}
