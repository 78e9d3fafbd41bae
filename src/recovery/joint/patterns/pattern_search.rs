//! The pattern of two values that fits best, as far as it can be found.
//!
//! A combinatorial problem. Patterns to start from are points near the data in a lattice
//! ([`super::pattern_lattice`]), for contrasts of all sizes where the levels are not given, and the
//! minimiser over all 0 ≤ x ≤ 1, cut at several thresholds. From each the change of one or two
//! elements that lowers ‖R x − d‖ most is made until none lowers it, with the levels that are best
//! for the pattern (least squares in [0, 1]). With given levels branch and bound
//! ([`super::branch`]) ends with a proof, or after a fixed number of relaxations; with others all
//! patterns of up to 16 elements are tried. Misfits are norms
//! of R x − d itself, never differences of Gram products, which would lose what little noise
//! leaves.

mod exhaustion;
mod starts;

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::branch;
use super::levels::best_within;
use crate::num::control::Control;
use crate::num::linalg::gram_product;
use crate::num::quadratic::{Bounds, box_least_squares};
use crate::recovery::RecoveryError;
use starts::thresholds;

/// Factor by which a contrast may differ from that about which a problem is linear.
const NEAR: f64 = 2.0;
/// Above this many elements pairs are not tried.
const MOST_PAIRED: usize = 2048;
/// A change must lower ‖R x − d‖² by more than this fraction, or rounding would go round in
/// circles.
const WORTH: f64 = 1e-10;

/// What the two levels can be.
#[derive(Clone, Copy)]
pub(super) enum Levels {
    /// As given.
    Given([f64; 2]),
    /// A common factor of the given ones, 0 or more, is free.
    Ratio([f64; 2]),
    /// Both free from 0 to this.
    Within(f64),
}

/// A pattern with its levels.
#[derive(Clone)]
pub(super) struct Pattern {
    pub(super) light: Vec<bool>,
    levels: [f64; 2],
    /// ‖R ρ − d‖².
    pub(super) misfit: f64,
}

impl Pattern {
    /// Its reflectances, times the scale.
    pub(super) fn values(&self) -> DVector<f64> {
        let [dark, light] = self.levels;
        DVector::from_fn(
            self.light.len(),
            |j, _| if self.light[j] { light } else { dark },
        )
    }
}

pub(super) struct Search<'a> {
    r: &'a DMatrix<f64>,
    d: &'a DVector<f64>,
    /// RᵀR.
    gram: DMatrix<f64>,
    levels: Levels,
    /// Contrasts that are possible.
    contrasts: [f64; 2],
    control: Control<'a>,
}

/// What a search has found.
pub(super) struct Found {
    pub(super) best: Pattern,
    /// No pattern has a smaller ½‖R x − d‖².
    pub(super) bound: f64,
    pub(super) iterations: u32,
    pub(super) changes: usize,
}

impl<'a> Search<'a> {
    pub(super) fn new(r: &'a DMatrix<f64>, d: &'a DVector<f64>, levels: Levels) -> Self {
        let mut gram = DMatrix::zeros(r.ncols(), r.ncols());
        gram_product(&mut gram, r);
        Search {
            r,
            d,
            gram,
            levels,
            contrasts: [0.0, f64::INFINITY],
            control: Control::none(),
        }
    }

    /// The same until it is told to stop.
    pub(super) fn under(self, control: Control<'a>) -> Self {
        Self { control, ..self }
    }

    /// The same among patterns of nearly this contrast, where the problem is linear about one.
    pub(super) fn about(self, contrast: Option<f64>) -> Self {
        let contrasts = match contrast {
            Some(contrast) => [contrast / NEAR, contrast * NEAR],
            None => self.contrasts,
        };
        Self { contrasts, ..self }
    }

    /// Whether its contrast is possible.
    pub(super) fn can(&self, pattern: &Pattern) -> bool {
        let [dark, light] = pattern.levels;
        let [low, high] = self.contrasts;
        (low..=high).contains(&(light - dark))
    }

    /// The best pattern that is found.
    pub(super) fn best(&self) -> Result<Found, RecoveryError> {
        let n = self.r.ncols();
        let (given, top) = match self.levels {
            Levels::Given(levels) => (Some(levels), 1.0),
            Levels::Ratio(_) => (None, f64::INFINITY),
            Levels::Within(top) => (None, top),
        };
        if let (None, Some(best)) = (given, self.best_of_all()) {
            return Ok(Found {
                bound: 0.5 * best.misfit,
                best,
                iterations: 0,
                changes: 0,
            });
        }
        let bounds = match given {
            Some([dark, light]) => Bounds::all(n, dark, light),
            None => Bounds::all(n, 0.0, top),
        };
        let relaxed = box_least_squares(self.r, self.d, &bounds)?;
        let mut starts = thresholds(&relaxed.solution);
        for start in self.near()? {
            if !starts.contains(&start) {
                starts.push(start);
            }
        }
        let mut descents: Vec<(Pattern, usize)> = starts
            .into_par_iter()
            .map(|start| {
                let mut changes = 0;
                (self.descend(start, &mut changes), changes)
            })
            .collect();
        let mut changes = descents.iter().map(|(_, changes)| changes).sum();
        // Possible ones first.
        let rank = |pattern: &Pattern| !self.can(pattern);
        descents.sort_by(|(a, _), (b, _)| {
            let first = rank(a).cmp(&rank(b));
            first.then(a.misfit.total_cmp(&b.misfit))
        });
        let Some((mut best, _)) = descents.first().cloned() else {
            return Err(RecoveryError::NO_DIRECTION);
        };
        let mut bound = relaxed.objective - relaxed.gap;
        if let Some(levels) = given {
            let known = 0.5 * best.misfit;
            let searched = branch::search(self.r, self.d, levels, &relaxed.solution, known)?;
            bound = bound.max(searched.bound);
            if let Some(light) = searched.light {
                let found = self.descend(light, &mut changes);
                if found.misfit < best.misfit * (1.0 - WORTH) {
                    best = found;
                }
            }
        }
        Ok(Found {
            best,
            bound,
            iterations: relaxed.iterations,
            changes,
        })
    }

    /// The pattern with its best levels, the lighter one as the light one.
    pub(super) fn fit(&self, mut light: Vec<bool>) -> Pattern {
        let of = |which: bool| {
            let set = DVector::from_fn(light.len(), |j, _| f64::from(u8::from(light[j] == which)));
            self.r * set
        };
        let columns = [of(false), of(true)];
        let levels = match self.levels {
            Levels::Given(levels) => levels,
            Levels::Ratio([a, b]) => {
                let one = &columns[0] * a + &columns[1] * b;
                let factor = (one.dot(self.d) / one.norm_squared()).max(0.0);
                [factor * a, factor * b]
            }
            Levels::Within(top) => best_within(self.d, &columns, top),
        };
        let misfit = (&columns[0] * levels[0] + &columns[1] * levels[1] - self.d).norm_squared();
        let [mut dark, mut bright] = levels;
        if dark > bright {
            (dark, bright) = (bright, dark);
            light.iter_mut().for_each(|light| *light = !*light);
        }
        Pattern {
            light,
            levels: [dark, bright],
            misfit,
        }
    }

    /// Changes and levels in turn until neither lowers the misfit.
    pub(super) fn descend(&self, start: Vec<bool>, changes: &mut usize) -> Pattern {
        let mut best = self.fit(start);
        loop {
            let before = best.misfit;
            let mut light = best.light.clone();
            *changes += self.change(&mut light, best.levels);
            let found = self.fit(light);
            if found.misfit < before * (1.0 - WORTH) {
                best = found;
            } else {
                return best;
            }
        }
    }

    /// Makes the best change of one or two elements until none is worth it; how many were made.
    /// With x_j changed by t, ‖R x − d‖² changes by −2 t g_j + t² G_jj, g = Rᵀ(d − R x), G = RᵀR.
    fn change(&self, light: &mut [bool], [dark, bright]: [f64; 2]) -> usize {
        let n = light.len();
        let mut made = 0;
        loop {
            let values = DVector::from_fn(n, |j, _| if light[j] { bright } else { dark });
            let residual = self.d - self.r * values;
            let slope = self.r.tr_mul(&residual);
            let step = |j: usize| {
                if light[j] {
                    dark - bright
                } else {
                    bright - dark
                }
            };
            let single: Vec<f64> = (0..n)
                .map(|j| step(j) * (step(j) * self.gram[(j, j)] - 2.0 * slope[j]))
                .collect();
            let (mut least, mut which) = (-WORTH * residual.norm_squared(), None);
            for i in 0..n {
                if single[i] < least {
                    (least, which) = (single[i], Some((i, None)));
                }
                let others = if n <= MOST_PAIRED { i + 1..n } else { n..n };
                let column = self.gram.column(i);
                for j in others {
                    let change = single[i] + single[j] + 2.0 * step(i) * step(j) * column[j];
                    if change < least {
                        (least, which) = (change, Some((i, Some(j))));
                    }
                }
            }
            let Some((i, j)) = which else { return made };
            for at in std::iter::once(i).chain(j) {
                light[at] = !light[at];
            }
            // Measured: what little noise leaves is not told by differences.
            let values = DVector::from_fn(n, |j, _| if light[j] { bright } else { dark });
            let found = (self.d - self.r * values).norm_squared();
            if found >= residual.norm_squared() * (1.0 - WORTH) {
                for at in std::iter::once(i).chain(j) {
                    light[at] = !light[at];
                }
                return made;
            }
            made += 1;
        }
    }
}
