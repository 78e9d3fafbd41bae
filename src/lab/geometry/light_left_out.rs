//! Light that a model leaves out and that would explain what is left over.

use std::ops::Range;

use nalgebra::DVector;
use serde::Serialize;

use crate::lab::comparison::evidence::FIT_LEVEL;
use crate::lab::uncertainty::certainty::correlated;
use crate::matrix::Matrix;
use crate::num::digits::figure;
use crate::num::linalg::{Cholesky, tr_product};

/// What of a pattern must be left by other light, picture and geometry, over all of it.
const LEFT: f64 = 1e-6;
/// More than this share of a misfit is most of it.
const MOST: f64 = 0.5;

/// The patterns of [`over_view`](crate::lab::comparison::over_view), of the light that is found.
const KINDS: [(&str, &str, Range<usize>); 2] = [
    (
        "light that all frames share (even, or a slope over the view)",
        "estimate it (--background, --frame-polynomial), or take dark frames",
        0..3,
    ),
    (
        "a falloff of the camera over its view",
        "divide by a flat field",
        3..6,
    ),
];

/// Of patterns S and what is left over, z, of each frame: Σ (S, z)ᵀ(S, z) over its pixels, and over
/// pixels side by side.
pub(super) struct Neighbours {
    own: Matrix,
    beside: Matrix,
    /// Σ s² z² of each pattern.
    squares: Vec<f64>,
    entries: f64,
}

impl Neighbours {
    /// Of so many patterns and entries.
    pub(super) fn new(patterns: usize, entries: f64) -> Self {
        let none = Matrix::zeros(patterns + 1, patterns + 1);
        Self {
            own: none.clone(),
            beside: none,
            squares: vec![0.0; patterns],
            entries,
        }
    }

    /// A frame more.
    pub(super) fn add(&mut self, patterns: &Matrix, left: &Matrix) {
        let mut both = patterns.clone().insert_column(patterns.ncols(), 0.0);
        both.set_column(patterns.ncols(), &left.column(0));
        let z = left.column(0).map(|z| z * z);
        for (sum, s) in self.squares.iter_mut().zip(patterns.column_iter()) {
            *sum += s.map(|s| s * s).dot(&z);
        }
        let pairs = both.nrows().saturating_sub(1);
        let [before, behind] = [0, 1].map(|first| both.rows(first.min(pairs), pairs).into_owned());
        self.own += tr_product(&both, &both);
        self.beside += tr_product(&before, &behind);
    }

    /// The variance of what noise of no stated size says of the patterns, over that of noise of one
    /// size of each pixel alone: ((1 + r)/(1 − r))² by the correlation r of neighbours beside the
    /// patterns, and the largest Σ s² z²/(Σ s² · mean of z²) above 1, where it is larger in the
    /// light, say.
    pub(super) fn inflation(&self) -> f64 {
        let r = self.correlation().unwrap_or(0.0);
        let n = self.own.ncols() - 1;
        let mean = self.own[(n, n)] / self.entries;
        let own = self.squares.iter().enumerate();
        let own = own.map(|(k, square)| square / (self.own[(k, k)] * mean));
        own.fold(1.0, f64::max) * ((1.0 + r) / (1.0 - r)).powi(2)
    }

    /// The correlation r of what is left of neighbours beside the patterns, where it is more than
    /// chance.
    pub(super) fn correlation(&self) -> Option<f64> {
        let n = self.own.ncols() - 1;
        let patterns = self.own.view((0, 0), (n, n)).into_owned();
        let along = self.own.column(n).rows(0, n).into_owned();
        let taken = Cholesky::new(&patterns).map(|own| own.solve(&along));
        let mut rest = DVector::from_element(n + 1, 1.0);
        rest.rows_mut(0, n)
            .copy_from(&-taken.unwrap_or_else(|| DVector::zeros(n)));
        let [squares, beside] = [&self.own, &self.beside].map(|of| rest.dot(&(of * &rest)));
        correlated(beside, squares, self.entries)
    }
}

/// Patterns that would explain what is left over.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct LightLeftOut {
    /// What they are.
    pub what: &'static str,
    /// What helps against it.
    #[serde(skip)]
    pub cure: &'static str,
    /// gᵀF⁻¹g.
    pub chi2: f64,
    /// How many of them the photographs tell from picture and geometry.
    pub directions: usize,
    /// Probability of as large a sum by noise alone.
    pub p: f64,
}

impl LightLeftOut {
    /// Of each kind, by F and g of the patterns, in units of the noise, the squares of the patterns
    /// before anything took a part of them, and the probability of χ² of so many directions.
    pub(super) fn of(
        (f, score, whole): (&Matrix, &Matrix, &[f64]),
        by_noise: impl Fn(f64, f64) -> f64,
    ) -> Vec<Self> {
        let of = |(what, cure, kind): &(&'static str, &'static str, Range<usize>)| {
            let told = kind.clone().filter(|k| f[(*k, *k)] > LEFT * whole[*k]);
            let told: Vec<usize> = told.collect();
            let own = f.select_rows(&told).select_columns(&told);
            let factor = Cholesky::new(&own).filter(|_| !told.is_empty())?;
            let chi2 = factor.forward(score.select_rows(&told)).norm_squared();
            let directions = told.len();
            Some(Self {
                what,
                cure,
                chi2,
                directions,
                p: by_noise(chi2, directions as f64),
            })
        };
        KINDS.iter().filter_map(of).collect()
    }

    /// Of kinds that explain much the likeliest and what is hardly less so, and only what explains
    /// most of a `misfit`, χ² beyond that of noise: anything explains a little of one.
    pub(super) fn likely(all: &[Self], misfit: f64) -> impl Iterator<Item = &Self> {
        let most = all.iter().map(|light| light.chi2).fold(misfit, f64::max);
        all.iter()
            .filter(move |light| light.p < FIT_LEVEL && light.chi2 > MOST * most)
    }

    /// What is said of it where `found` was found without.
    pub(super) fn beware(&self, found: &str) -> String {
        format!(
            "Beware: {} would explain what is left over better than the {found} that was found does (χ² {} of {} \
             directions, P {}): the {found} takes it up, and may be OFF BY MANY OF ITS ERRORS. If there may be \
             such light, {}; else something is wrong that is not free.",
            self.what,
            figure(self.chi2, 3),
            self.directions,
            figure(self.p, 1),
            self.cure
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lab::comparison::misplaced::normal;

    /// 40 frames of 32 × 32 pixels: what is even over them is known to 1 of noise of each pixel
    /// alone, ((1 + r)/(1 − r))² of what hangs together by r from column to column and row to row,
    /// and, of noise that goes with the pattern 1 … 3 evenly, Σ s⁴/(Σ s²)² · n times; light that
    /// the pattern itself takes counts for nothing. Variances of sums over 40 frames scatter by
    /// 0.22.
    #[test]
    fn what_noise_says_of_patterns_varies_as_stated() {
        let side = 32;
        let pattern = Matrix::from_fn(side * side, 1, |p, _| {
            1.0 + 2.0 * (p % side) as f64 / (side - 1) as f64
        });
        let mut draw = normal(11);
        let mut ratio = |r: f64, goes: bool, light: f64| {
            let mut told = Neighbours::new(1, (40 * side * side) as f64);
            let (mut sum, mut whole, mut squares) = (0.0, 0.0, 0.0);
            for _ in 0..40 {
                let mut field = Matrix::from_fn(side, side, |_, _| draw()[0]);
                let fresh = (1.0 - r * r).sqrt();
                for k in 1..side {
                    let before = field.column(k - 1).into_owned();
                    let own = field.column(k) * fresh + before * r;
                    field.set_column(k, &own);
                }
                for k in 1..side {
                    let before = field.row(k - 1).into_owned();
                    let own = field.row(k) * fresh + before * r;
                    field.set_row(k, &own);
                }
                let mut noise = Matrix::from_column_slice(side * side, 1, field.as_slice());
                if goes {
                    noise.component_mul_assign(&pattern);
                }
                sum += tr_product(&pattern, &noise)[(0, 0)].powi(2);
                whole += pattern.norm_squared();
                squares += noise.norm_squared();
                told.add(&pattern, &(noise + &pattern * light));
            }
            let mean = squares / (40 * side * side) as f64;
            (told.inflation(), sum / (whole * mean))
        };
        for (r, goes) in [(0.0, false), (0.6, false), (0.0, true)] {
            let (told, varies) = ratio(r, goes, 0.0);
            assert!(
                libm::log(told / varies).abs() < 0.7,
                "{r} {goes}: {told} {varies}"
            );
        }
        assert!((ratio(0.0, false, 0.0).0 - 1.0).abs() < 0.2);
        assert!(ratio(0.0, false, 0.1).0 < 1.2 && ratio(0.6, false, 0.0).0 > 8.0);
    }
}
