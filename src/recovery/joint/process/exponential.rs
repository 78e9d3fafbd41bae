//! How alike elements are by their distance: the exponential covariance on each surface.

use nalgebra::DMatrix;

use crate::recovery::Problem;

/// Step of the lengths, ln.
const STEP: f64 = 0.5;
/// The shortest length in distances of neighbours: elements that hardly know of one another.
const SHORTEST: f64 = 0.4;
/// The longest in extents of the surface: a slope throughout.
const LONGEST: f64 = 8.0;

/// > k_ij = exp(−|x_i − x_j|/ℓ) on one surface, 0 between surfaces,
///
/// positive definite for all places x of space: a surface that is continuous and nowhere smooth, as
/// photographs are (their spectra fall like 1/f², Field 1987).
#[derive(Debug)]
pub struct Exponential {
    /// Pairs of distances, n × n; infinite between surfaces.
    distances: DMatrix<f64>,
    nearest: f64,
    extent: f64,
}

impl Exponential {
    /// For the elements of the problem: by their places, else those of grids of unit squares, else
    /// a row of them.
    pub fn new(problem: &Problem<'_>) -> Self {
        let n = problem.elements();
        let whole = [[n, 1]];
        let grids = problem.grids.unwrap_or(&whole);
        let mut of: Vec<(usize, [f64; 3])> = Vec::with_capacity(n);
        for (surface, [nu, nv]) in grids.iter().enumerate() {
            let cell = |i: usize| [(i % nu) as f64, (i / nu) as f64, 0.0];
            of.extend((0..nu * nv).map(|i| (surface, cell(i))));
        }
        if let Some(places) = problem.places {
            of.iter_mut().zip(places).for_each(|(of, x)| of.1 = *x);
        }
        let between = |i: usize, j: usize| {
            let ((a, x), (b, y)) = (of[i], of[j]);
            if a == b {
                let apart = [x[0] - y[0], x[1] - y[1], x[2] - y[2]];
                apart.iter().map(|d| d * d).sum::<f64>().sqrt()
            } else {
                f64::INFINITY
            }
        };
        let distances = DMatrix::from_fn(n, n, between);
        let apart = |d: &f64| d.is_finite() && *d > 0.0;
        let (mut nearest, mut extent) = (f64::INFINITY, 0.0f64);
        for d in distances.iter().copied().filter(apart) {
            (nearest, extent) = (nearest.min(d), extent.max(d));
        }
        // Elements that are alone have no distances.
        if extent == 0.0 {
            (nearest, extent) = (1.0, 1.0);
        }
        Self {
            distances,
            nearest,
            extent,
        }
    }

    /// Lengths ℓ from where elements are independent to where a surface is one slope, in equal
    /// steps of ln ℓ.
    pub(super) fn lengths(&self) -> Vec<f64> {
        let (from, to) = (SHORTEST * self.nearest, LONGEST * self.extent);
        let steps = (libm::log(to / from) / STEP).ceil() as usize;
        let at = |k: usize| from * libm::exp(k as f64 * STEP);
        (0..=steps).map(at).collect()
    }

    /// k, n × n.
    pub fn matrix(&self, length: f64) -> DMatrix<f64> {
        let mut k = self.distances.clone();
        for j in 0..k.ncols() {
            for i in 0..j {
                let alike = libm::exp(-k[(i, j)] / length);
                (k[(i, j)], k[(j, i)]) = (alike, alike);
            }
            k[(j, j)] = 1.0;
        }
        k
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two surfaces, one of 2 × 3 squares and one of a single element, by hand; places in space
    /// take the place of the squares.
    #[test]
    fn distances_by_hand() {
        let ones = |rows, columns| DMatrix::from_element(rows, columns, 1.0);
        let (phi, c, d) = (ones(2, 3), ones(2, 7), ones(7, 3));
        let problem = Problem::new(&phi, &c, &d, None).unwrap();
        let problem = problem.with_grids(&[[2, 3], [1, 1]]).unwrap();
        let found = Exponential::new(&problem);
        let k = found.matrix(2.0);
        assert!((k[(0, 5)] - libm::exp(-5f64.sqrt() / 2.0)).abs() < 1e-15);
        assert_eq!((k[(0, 6)], k[(6, 6)], k[(1, 0)]), (0.0, 1.0, k[(0, 1)]));
        let lengths = found.lengths();
        assert!(
            (lengths[0] - SHORTEST).abs() < 1e-15
                && lengths[lengths.len() - 1] >= LONGEST * 5f64.sqrt()
        );
        let places: Vec<[f64; 3]> = (0..7).map(|j| [0.0, 0.0, 3.0 * f64::from(j)]).collect();
        let placed = Exponential::new(&problem.with_places(&places).unwrap());
        assert!((placed.matrix(2.0)[(1, 3)] - libm::exp(-3.0)).abs() < 1e-15);
        assert!(problem.with_places(&places[..6]).is_err());
    }
}
