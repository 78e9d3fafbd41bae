//! Lattices {B z : z ∈ Zⁿ}: reduced bases, the points nearest to a target, and points of chance
//! about it.
//!
//! A reduced basis (Lenstra, Lenstra and Lovász 1982) is of short vectors that are nearly at right
//! angles,
//!
//! > B U = Q T,   |T_ik| ≤ ½ |T_ii|,   δ T_ii² ≤ T_i,i+1² + T_i+1,i+1²,
//!
//! U of integers with determinant ±1, T upper triangular. In its coordinates ζ = U⁻¹z
//!
//! > ‖B z − t‖² = Σ_i T_ii² (ζ_i − c_i)² + rest,   c_i = (y_i − Σ_k>i T_ik ζ_k)/T_ii,   y = Qᵀt,
//!
//! and one coordinate after the other, last first, tells which points are near.

use nalgebra::{DMatrix, DVector};

use super::linalg::{LinalgError, triangle};
use super::stream::Stream;

/// δ of the reduction.
const DELTA: f64 = 0.99;
/// Sizes of T_ik above this fraction of T_ii are reduced; more than ½, or rounding would never end.
const SIZE: f64 = 0.5 + 1e-6;
/// Exchanges in a reduction, at most, for each pair of vectors.
const MOST: usize = 400;
/// ln of a determinant that is not kept to this is beyond double precision.
const KEPT: f64 = 1e-6;
/// A coordinate that is less likely than the likeliest by e to this is not drawn.
const NEGLIGIBLE: f64 = 38.0;
/// Probabilities are multiplied down to this, and then kept by their logarithm.
const LEAST: f64 = 1e-200;
/// −½ T² below which neighbours are weighed by themselves: what they are multiplied by is large.
const STEEP: f64 = -20.0;

/// A lattice by a reduced basis, and a target.
#[derive(Debug, Clone)]
pub struct Lattice {
    u: DMatrix<f64>,
    t: DMatrix<f64>,
    y: DVector<f64>,
    /// T_ii² and e^−½T_ii².
    steep: Vec<Steep>,
}

/// T² and e^−½T².
type Steep = [f64; 2];

/// Of T_ii.
fn steep(own: f64) -> Steep {
    [own * own, libm::exp(-0.5 * own * own)]
}

/// A point that was drawn.
#[derive(Debug, Clone)]
pub struct Drawn {
    /// z, n integers.
    pub point: Vec<f64>,
    /// ln of the probability with which it is drawn.
    pub log_probability: f64,
}

impl Lattice {
    /// Reduces `basis` (m × n, m ≥ n, of full rank) for a target of m entries, from the reduced
    /// basis of a lattice `near` it where one is known. `None` where the reduction is beyond double
    /// precision.
    ///
    /// # Errors
    /// Empty or non-finite input, sides that do not fit.
    pub fn new(
        basis: &DMatrix<f64>,
        target: &DVector<f64>,
        near: Option<&Self>,
    ) -> Result<Option<Self>, LinalgError> {
        let n = basis.ncols();
        let first = triangle(basis, target)?;
        let start = near.filter(|near| near.u.nrows() == n);
        let u = start.map_or_else(|| DMatrix::identity(n, n), |near| near.u.clone());
        let volume = log_volume(&first.r);
        let mut found = Self {
            u,
            t: first.r.clone(),
            y: first.d.clone(),
            steep: Vec::new(),
        };
        let mut changed = start.is_some();
        loop {
            if changed {
                // T anew from the integers, without what rounding has gathered.
                let again = triangle(&(&first.r * &found.u), &first.d)?;
                (found.t, found.y) = (again.r, again.d);
            }
            let kept = (log_volume(&found.t) - volume).abs() < KEPT * (1.0 + volume.abs());
            if !kept {
                return Ok(None);
            }
            match found.reduce() {
                None => return Ok(None),
                Some(0) => {
                    found.steep = found.t.diagonal().iter().map(|own| steep(*own)).collect();
                    return Ok(Some(found));
                }
                Some(_) => changed = true,
            }
        }
    }

    /// n.
    pub fn dimension(&self) -> usize {
        self.t.ncols()
    }

    /// Reduces T and U together; how many pairs were exchanged, `None` if it does not end.
    fn reduce(&mut self) -> Option<usize> {
        let n = self.t.ncols();
        let mut exchanged = 0;
        let mut k = 1;
        while k < n {
            self.shorten(k, k - 1);
            let [a, b, c] = [(k - 1, k - 1), (k - 1, k), (k, k)].map(|at| self.t[at]);
            if DELTA * a * a > b * b + c * c {
                self.exchange(k);
                exchanged += 1;
                if exchanged > MOST * n * n {
                    return None;
                }
                k = (k - 1).max(1);
            } else {
                (0..k - 1).rev().for_each(|i| self.shorten(k, i));
                k += 1;
            }
        }
        Some(exchanged)
    }

    /// Takes the nearest multiple of vector i from vector k.
    fn shorten(&mut self, k: usize, i: usize) {
        let ratio = self.t[(i, k)] / self.t[(i, i)];
        if ratio.abs() <= SIZE {
            return;
        }
        let times = ratio.round();
        for matrix in [&mut self.t, &mut self.u] {
            let (left, right) = matrix.columns_range_pair_mut(i, k..k + 1);
            let mut right = right;
            right.column_mut(0).axpy(-times, &left, 1.0);
        }
    }

    /// Exchanges vectors k − 1 and k and makes T triangular again by a rotation.
    fn exchange(&mut self, k: usize) {
        self.u.swap_columns(k - 1, k);
        self.t.swap_columns(k - 1, k);
        let (a, b) = (self.t[(k - 1, k - 1)], self.t[(k, k - 1)]);
        let length = a.hypot(b);
        let (cosine, sine) = (a / length, b / length);
        let turned = |x: f64, y: f64| (cosine * x + sine * y, cosine * y - sine * x);
        for column in k - 1..self.t.ncols() {
            let (x, y) = turned(self.t[(k - 1, column)], self.t[(k, column)]);
            (self.t[(k - 1, column)], self.t[(k, column)]) = (x, y);
        }
        self.t[(k, k - 1)] = 0.0;
        (self.y[k - 1], self.y[k]) = turned(self.y[k - 1], self.y[k]);
    }

    /// z of ζ.
    fn point(&self, coordinates: &[f64]) -> Vec<f64> {
        let mut z = DVector::zeros(coordinates.len());
        for (column, times) in self.u.column_iter().zip(coordinates) {
            if *times != 0.0 {
                z.axpy(*times, &column, 1.0);
            }
        }
        z.iter().map(|z| z.round()).collect()
    }

    /// Points near the target, z, nearest first. Coordinates are chosen from the last to the first,
    /// and after each the `keep` nearest choices stay (the M-algorithm of Anderson and Mohan 1984).
    /// The first is the nearest of all unless more than `keep` seemed nearer on the way.
    pub fn nearest(&self, keep: usize) -> Vec<Vec<f64>> {
        let n = self.t.ncols();
        // Distances², what is left of y in the rows that are open, and what was chosen of which
        // point.
        let mut distances = vec![0.0];
        let mut left: Vec<f64> = self.y.as_slice().to_vec();
        let mut chosen: Vec<Vec<(usize, f64)>> = Vec::with_capacity(n);
        for k in (0..n).rev() {
            let own = self.t[(k, k)];
            let mut next: Vec<(f64, usize, f64)> = Vec::with_capacity(distances.len() * CHILDREN);
            for (parent, distance) in distances.iter().enumerate() {
                let centre = left[parent * (k + 1) + k] / own;
                next.extend(around(centre).take(CHILDREN).map(|z| {
                    let off = own * (z - centre);
                    (distance + off * off, parent, z)
                }));
            }
            // Ties by the order of the points.
            let before = |a: &(f64, usize, f64), b: &(f64, usize, f64)| {
                let first = a.0.total_cmp(&b.0).then(a.1.cmp(&b.1));
                first.then(a.2.total_cmp(&b.2))
            };
            if next.len() > keep {
                next.select_nth_unstable_by(keep, before);
                next.truncate(keep);
            }
            // In between the order does not matter.
            if k == 0 {
                next.sort_unstable_by(before);
            }
            let column = &self.t.column(k).data.into_slice()[..k];
            let mut rest = Vec::with_capacity(next.len() * k);
            for (_, parent, z) in &next {
                let old = &left[parent * (k + 1)..][..k];
                rest.extend(old.iter().zip(column).map(|(old, t)| old - z * t));
            }
            left = rest;
            distances = next.iter().map(|(distance, _, _)| *distance).collect();
            chosen.push(next.into_iter().map(|(_, parent, z)| (parent, z)).collect());
        }
        let mut zeta = vec![0.0; n];
        let points = (0..distances.len()).map(|mut point| {
            for (zeta, all) in zeta.iter_mut().zip(chosen.iter().rev()) {
                (point, *zeta) = all[point];
            }
            self.point(&zeta)
        });
        points.collect()
    }

    /// A point of chance: coordinate after coordinate, last first, each with the probability
    /// ∝ exp(−½ T_ii² (ζ_i − c_i)²) (Klein 2000). Nearly ∝ exp(−½ ‖B z − t‖²), the more the less
    /// |T_ii| exceeds 1; the probability itself is told.
    pub fn draw(&self, random: &mut Stream) -> Drawn {
        let n = self.t.ncols();
        let mut left = self.y.clone();
        let mut coordinates = vec![0.0; n];
        let mut choices: Vec<(f64, f64)> = Vec::new();
        let (mut log_probability, mut probability) = (0.0, 1.0);
        for k in (0..n).rev() {
            let own = self.t[(k, k)];
            let centre = left[k] / own;
            weigh(&mut choices, self.steep[k], centre);
            let all: f64 = choices.iter().map(|c| c.1).sum();
            let mut rest = random.uniform() * all;
            let chosen = choices.iter().find(|(_, weight)| {
                rest -= weight;
                rest < 0.0
            });
            let (z, weight) = *chosen.unwrap_or(&choices[0]);
            probability *= weight / all;
            // One logarithm for many coordinates: each is above e to −NEGLIGIBLE.
            if probability < LEAST {
                log_probability += libm::log(probability);
                probability = 1.0;
            }
            left.rows_mut(0, k)
                .axpy(-z, &self.t.column(k).rows(0, k), 1.0);
            coordinates[k] = z;
        }
        Drawn {
            point: self.point(&coordinates),
            log_probability: log_probability + libm::log(probability),
        }
    }
}

/// Integers that are tried for a coordinate of each kept point.
const CHILDREN: usize = 5;

/// The integers, nearest to `centre` first.
fn around(centre: f64) -> impl Iterator<Item = f64> {
    let first = centre.round();
    let side = if centre >= first { 1.0 } else { -1.0 };
    (0..).map(move |k: u32| {
        let step = f64::from(k.div_ceil(2));
        first
            + if k % 2 == 1 {
                side * step
            } else {
                -side * step
            }
    })
}

/// The integers z [`around`] a centre c with exp −½T²((z − c)² − (z₀ − c)²), z₀ the nearest, down
/// to e to −[`NEGLIGIBLE`]: with k = |z − z₀| and f = |z₀ − c| it is bᵏ·ᵏ·a^±ᵏ, b = e^−½T², a =
/// e^(T² f).
fn weigh(choices: &mut Vec<(f64, f64)>, [square, b]: Steep, centre: f64) {
    let (half, f) = (-0.5 * square, (centre - centre.round()).abs());
    choices.clear();
    choices.push((centre.round(), 1.0));
    let log = |k: f64, along: f64| half * k * (k - 2.0 * along);
    if log(1.0, f) <= -NEGLIGIBLE {
        return;
    }
    let a = libm::exp(square * f);
    // bᵏ·ᵏ, b²ᵏ⁺¹ and aᵏ.
    let (mut power, mut next, mut slope) = (1.0, b, 1.0);
    for (j, z) in (1u32..).zip(around(centre).skip(1)) {
        let k = f64::from(j.div_ceil(2));
        let is_towards = j % 2 == 1;
        let log = log(k, if is_towards { f } else { -f });
        if log <= -NEGLIGIBLE {
            return;
        }
        if is_towards {
            power *= next;
            next *= b * b;
            slope *= a;
        }
        let weight = match (half < STEEP, is_towards) {
            (true, _) => libm::exp(log),
            (_, true) => power * slope,
            (_, false) => power / slope,
        };
        choices.push((z, weight));
    }
}

/// Σ ln |T_ii|.
fn log_volume(t: &DMatrix<f64>) -> f64 {
    t.diagonal().iter().map(|x| libm::log(x.abs())).sum()
}

#[cfg(test)]
mod tests;
