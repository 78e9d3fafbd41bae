//! A small bench for the tests: spots on a square, a pixel grid, a leaning board, the kernel
//! cosθs·cosθd/R² (inches).

use nalgebra::{DMatrix, DVector};

use super::{Choice, Recovered};

/// The two sides of the model and the element grid.
pub(super) struct Bench {
    /// Camera side, pixels × elements.
    pub(super) c: DMatrix<f64>,
    /// Laser side, elements × 120 spots.
    pub(super) d: DMatrix<f64>,
    per_side: usize,
}

fn kernel((x1, y1): (f64, f64), (x2, y2, z2): (f64, f64, f64)) -> f64 {
    let r2 = (x2 - x1).powi(2) + (y2 - y1).powi(2) + z2 * z2;
    z2 * (15.5 - y1) / (2f64.sqrt() * r2 * r2)
}

impl Bench {
    /// 120 staggered spots at `half_width`, `elements`² elements on S2, `pixels`² pixels on the
    /// view.
    pub(super) fn new(half_width: f64, elements: usize, pixels: usize) -> Self {
        let centre = |k: usize, n: usize| (k as f64 + 0.5) / n as f64;
        let (cx, cy, h) = (5.0, 15.5 - 7.86764 * 2f64.sqrt(), half_width);
        let element = |j: usize| {
            let d = 5.86764 + 4.0 * centre(j / elements, elements);
            (
                3.0 + 4.0 * centre(j % elements, elements),
                15.5 - d / 2f64.sqrt(),
                d / 2f64.sqrt(),
            )
        };
        let spot = |l: usize| {
            let along = h * (2.0 * (l % 30) as f64 / 29.0 - 1.0);
            let offset = [-1.0, 1.0, 0.0][l % 3];
            match l / 30 {
                0 => (cx + along, cy - h + offset),
                1 => (cx + h + offset, cy + along),
                2 => (cx - along, cy + h + offset),
                _ => (cx - h + offset, cy - along),
            }
        };
        let pixel = |p: usize| {
            (
                3.25 + 3.25 * centre(p % pixels, pixels),
                2.75 + 3.25 * centre(p / pixels, pixels),
            )
        };
        Bench {
            // A power of watts and an étendue of the bench's order: entries of Φ near 1e-12 W.
            c: DMatrix::from_fn(pixels * pixels, elements * elements, |p, j| {
                1e-9 * kernel(pixel(p), element(j))
            }),
            d: DMatrix::from_fn(elements * elements, 120, |j, l| kernel(spot(l), element(j))),
            per_side: elements,
        }
    }

    /// A checkerboard of `checks`² checks, cell (0, 0) dark.
    pub(super) fn board(&self, checks: usize) -> DVector<f64> {
        let n = self.per_side;
        DVector::from_fn(n * n, |j, _| {
            f64::from(u8::from((j % n * checks / n + j / n * checks / n) % 2 == 1))
        })
    }

    /// Φ = C diag(ρ) D without noise, W, entry by entry from its definition.
    pub(super) fn phi(&self, rho: &DVector<f64>) -> DMatrix<f64> {
        DMatrix::from_fn(self.c.nrows(), self.d.ncols(), |p, l| {
            (0..rho.len())
                .map(|j| self.c[(p, j)] * rho[j] * self.d[(j, l)])
                .sum()
        })
    }
}

/// Φ with independent normal noise of standard error `level` times each entry, and those standard
/// errors.
pub(super) fn relative_noise(
    exact: &DMatrix<f64>,
    level: f64,
    seed: u64,
) -> (DMatrix<f64>, DMatrix<f64>) {
    let mut normal = normal_stream(seed);
    let stderr = exact * level;
    let phi = exact.zip_map(&stderr, |x, s| x + s * normal());
    (phi, stderr)
}

/// Modulation (W − B)/(W + B) of recovered values over the light and dark elements of a 0/1 board.
pub(super) fn modulation(found: &DVector<f64>, board: &DVector<f64>) -> f64 {
    let light = found.dot(board) / board.sum();
    let dark = (found.sum() - found.dot(board)) / (board.len() as f64 - board.sum());
    (light - dark) / (light + dark)
}

/// Standard normal numbers by SplitMix64 and Box–Muller.
pub(super) fn normal_stream(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    let mut uniform = move || {
        state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 * (0.5f64).powi(53) + (0.5f64).powi(54)
    };
    move || (-2.0 * libm::log(uniform())).sqrt() * libm::cos(std::f64::consts::TAU * uniform())
}

/// Residual, target and limit of a parameter that the discrepancy principle has chosen.
pub(super) fn discrepancy(found: &Recovered) -> [f64; 3] {
    match found.choice {
        Choice::Discrepancy {
            residual,
            target,
            limit,
        } => [residual, target, limit],
        other => panic!("{other:?} of {}", found.method),
    }
}
