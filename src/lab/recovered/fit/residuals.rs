//! Squared deviates of photographs from what a picture would photograph.

use serde::Serialize;

use super::Fit;
use crate::lab::comparison::agreement::freedom_of_rows;
use crate::lab::comparison::evidence::FIT_LEVEL;
use crate::lab::uncertainty::certainty::{Certainty, Errors, correlated};
use crate::lab::uncertainty::counted::Counted;
use crate::lab::uncertainty::with_light::WithLight;
use crate::matrix::Matrix;
use crate::num::statistics::{chi_square_sf, sidak_threshold};

/// An entry that noise does not explain, among others that it does.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Outlier {
    /// Pixel index.
    pub pixel: usize,
    /// Spot index.
    pub spot: usize,
    /// |z| of its difference from what the picture would photograph.
    pub z: f64,
    /// Such entries in all, of which this is the farthest off.
    pub count: usize,
}

/// The least |z| of an outlier: counts of few photons reach farther than normal noise (Poisson's of
/// mean 5 exceed it once in 10⁸).
const LEAST: f64 = 7.0;
/// |z| from which entries are looked at one by one, and how many at most: more are no exceptions.
const FAR: f64 = 4.0;
const MOST_FAR: usize = 1000;

/// Squared deviates, summed row after row.
#[derive(Debug, Default)]
pub struct Residuals {
    pub(super) sums: Vec<f64>,
    /// The same of columns.
    pub(super) columns: Vec<f64>,
    pub(super) entries: usize,
    pub(super) left_out: usize,
    /// Pixel, spot, |z| and square of those far off.
    far: Vec<(usize, usize, f64, f64)>,
    /// Σ κ of counts.
    excess: f64,
    /// z of the last row, and Σ z z′ over rows that follow each other: pixels side by side.
    last: Vec<f64>,
    beside: f64,
    /// How z² goes with ln of the light.
    with_light: WithLight,
}

impl Residuals {
    /// Adds rows (pixels): the photographs, what the picture would photograph, and the standard
    /// errors, W.
    pub fn add(&mut self, phi: &Matrix, seen: &Matrix, stderr: &Matrix, certainty: Certainty) {
        for p in 0..phi.nrows() {
            let mut sum = 0.0;
            self.last.resize(phi.ncols(), 0.0);
            self.columns.resize(phi.ncols(), 0.0);
            for l in 0..phi.ncols() {
                let at = (p, l);
                if stderr[at] <= 0.0 {
                    self.left_out += 1;
                    self.last[l] = 0.0;
                    continue;
                }
                self.entries += 1;
                let stderr = certainty.stderr(seen[at], stderr[at]);
                self.excess += certainty.counted.map_or(0.0, |own| own.excess_of(stderr));
                let t = (phi[at] - seen[at]) / stderr;
                let z = certainty.normal(t.abs()).copysign(t);
                let far = certainty.of_counts(z, stderr).abs();
                let square = certainty.square(t);
                let signed = square.sqrt().copysign(t);
                self.beside += signed * self.last[l];
                self.last[l] = signed;
                self.with_light.add(seen[at], square);
                sum += square;
                self.columns[l] += square;
                if far > FAR && self.far.len() <= MOST_FAR {
                    self.far.push((self.sums.len(), l, far, square));
                }
            }
            self.sums.push(sum);
        }
    }

    /// The fit of a picture that used up so many degrees of freedom; none where no entry has a
    /// standard error, and where the picture has as many unknowns as there are entries.
    pub fn fit(&self, used: f64, certainty: Certainty) -> Option<Fit> {
        let entries = self.entries as f64;
        let left = entries - used;
        if left < 0.5 {
            return None;
        }
        let squares = self.sums.iter().sum::<f64>();
        let chi2_per_dof = squares / left;
        let excess = self.excess / entries;
        let certainty = Certainty {
            counted: certainty.counted.map(|own| Counted { excess, ..own }),
            ..certainty
        };
        let dof = match certainty.errors {
            Errors::Independent => certainty.of_squares(left),
            Errors::WithinRows => freedom_of_rows(&self.sums, self.entries) * left / entries,
            Errors::Everywhere => 1.0,
        };
        let p = chi_square_sf(chi2_per_dof * dof, dof);
        let are_own = certainty.errors == Errors::Independent;
        let with_light = self.with_light.correlation().filter(|_| are_own);
        Some(Fit {
            chi2_per_dof,
            dof,
            p,
            entries: self.entries,
            left_out: self.left_out,
            level: FIT_LEVEL,
            fits: p >= FIT_LEVEL,
            within_integration: None,
            outlier: self
                .outlier(left, certainty)
                .filter(|_| are_own && with_light.is_none()),
            pooled: certainty.pooled(),
            neighbours: correlated(self.beside, squares, entries).filter(|_| are_own),
            with_light,
        })
    }
}

impl Residuals {
    /// The entry farthest off of those that chance leaves to none of all; none where the others do
    /// not fit without them.
    fn outlier(&self, left: f64, certainty: Certainty) -> Option<Outlier> {
        let limit = sidak_threshold(FIT_LEVEL, self.entries as u64).max(LEAST);
        let beyond = self.far.iter().filter(|(_, _, z, _)| *z > limit);
        let beyond: Vec<_> = beyond.collect();
        let squares: f64 = beyond.iter().map(|(_, _, _, square)| square).sum();
        let others = left - beyond.len() as f64;
        if self.far.len() > MOST_FAR || others < 0.5 {
            return None;
        }
        let rest = (self.sums.iter().sum::<f64>() - squares) / others;
        let dof = certainty.of_squares(others);
        let farthest = beyond.iter().max_by(|a, b| a.2.total_cmp(&b.2))?;
        (chi_square_sf(rest * dof, dof) >= FIT_LEVEL).then_some(Outlier {
            pixel: farthest.0,
            spot: farthest.1,
            z: farthest.2,
            count: beyond.len(),
        })
    }
}
