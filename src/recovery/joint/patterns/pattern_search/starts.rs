//! Patterns to start from: near the data in lattices, and of a relaxation.

use nalgebra::DVector;
use rayon::prelude::*;

use super::{Levels, Pattern, Search};
use crate::recovery::RecoveryError;
use crate::recovery::joint::patterns::neighbours;
use crate::recovery::joint::patterns::pattern_lattice::{Dark, MOST, PatternLattice};

/// Thresholds that the relaxation is cut at, and near patterns that are descended from.
const STARTS: usize = 12;
/// Degrees to which neighbours are taken to be alike, and patterns that are kept of each.
const ALIKE: [f64; 2] = [0.3, 0.8];
const KEPT: usize = 400;
/// The largest contrast where the scale is free, in units of which a grey of ½ fits best.
const BRIGHTEST: f64 = 3.0;
/// Share of the contrast on either side of a lattice's.
const SHARE: f64 = 0.15;

impl Search<'_> {
    /// The best of the patterns that are near in the lattices of all contrasts.
    pub(super) fn near(&self) -> Result<Vec<Vec<bool>>, RecoveryError> {
        if self.r.ncols() > MOST {
            return Ok(Vec::new());
        }
        let mut found = self.points(&[], 0.0)?;
        found.sort_by(|a, b| a.misfit.total_cmp(&b.misfit));
        found.truncate(STARTS);
        Ok(found.into_iter().map(|pattern| pattern.light).collect())
    }

    /// Patterns that are likely where neighbours on the grids are alike, those of the least
    /// ½ χ² − β Σ s_i s_j.
    pub(in crate::recovery::joint) fn alike(
        &self,
        grids: &[[usize; 2]],
    ) -> Result<Vec<Vec<bool>>, RecoveryError> {
        let pairs = neighbours::pairs(grids);
        let mut kept = Vec::new();
        for beta in ALIKE.into_iter().filter(|_| !pairs.is_empty()) {
            let energy = |pattern: &Pattern| {
                0.5 * pattern.misfit - beta * neighbours::alike(&pairs, &pattern.light) as f64
            };
            let found = self.points(&pairs, beta)?.into_iter();
            let mut found: Vec<(f64, Pattern)> = found.map(|p| (energy(&p), p)).collect();
            found.sort_by(|a, b| a.0.total_cmp(&b.0));
            found.truncate(KEPT);
            kept.extend(found.into_iter().map(|(_, pattern)| pattern.light));
        }
        Ok(kept)
    }

    /// The patterns that are near in the lattices of all contrasts, neighbours being alike to a
    /// degree.
    fn points(&self, pairs: &[[usize; 2]], beta: f64) -> Result<Vec<Pattern>, RecoveryError> {
        let (dark, top) = match self.levels {
            Levels::Given([dark, _]) => (Dark::Given(dark), 1.0),
            Levels::Ratio([dark, light]) => (Dark::Times(dark / (light - dark)), BRIGHTEST),
            Levels::Within(top) => (Dark::Free, top.min(BRIGHTEST)),
        };
        let lattice = PatternLattice {
            r: self.r,
            d: self.d,
            dark,
            alike: (pairs, beta),
            control: self.control,
        };
        let (contrasts, share) = match self.levels {
            Levels::Given([dark, light]) => (vec![light - dark], 0.0),
            _ => (lattice.contrasts(top, SHARE), SHARE),
        };
        let near = lattice.near(&contrasts, share)?;
        Ok(near.into_par_iter().map(|light| self.fit(light)).collect())
    }
}

/// Patterns of a relaxation: light where it exceeds a threshold, thresholds between neighbouring
/// values, spread over the values' ranks.
pub(super) fn thresholds(relaxed: &DVector<f64>) -> Vec<Vec<bool>> {
    let mut values: Vec<f64> = relaxed.iter().copied().collect();
    values.sort_by(f64::total_cmp);
    values.dedup();
    let middles: Vec<f64> = values.windows(2).map(|w| 0.5 * (w[0] + w[1])).collect();
    let half = 0.5 * (values[0] + values[values.len() - 1]);
    let chosen = (0..STARTS).filter_map(|k| middles.get(k * middles.len() / STARTS).copied());
    let mut starts: Vec<Vec<bool>> = Vec::new();
    for threshold in chosen.chain([half]) {
        let start: Vec<bool> = relaxed.iter().map(|x| *x > threshold).collect();
        if !starts.contains(&start) {
            starts.push(start);
        }
    }
    starts
}
