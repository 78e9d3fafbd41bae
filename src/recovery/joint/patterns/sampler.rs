//! Patterns that are listed, and patterns that are drawn.

use std::collections::BTreeMap;

use rayon::prelude::*;

use super::levels::ALL;
use super::pattern_lattice::{Cell, nearest, pattern};
use super::pattern_likelihood::{PatternLikelihood, Weighed};
use crate::num::quadrature::Rule;
use crate::num::stream::{Key, Sampling, Stream};
use crate::num::summation::log_sum_exp;
use crate::recovery::RecoveryError;

/// Draws from a coarse cell, to find the likely ones.
const PILOT: usize = 48;
/// Cells whose patterns are together less likely than others by e to this are left out, and so are
/// single patterns by the second.
const UNLIKELY: f64 = 14.0;
const NEGLIGIBLE: f64 = 40.0;
/// Draws of one stream, and from a cell at least.
const BATCH: usize = 64;
const LEAST: f64 = 8.0;

/// A pattern outside of the list, by the cell that it was drawn from.
pub(super) struct Met {
    pub(super) light: Vec<bool>,
    /// Over the levels of the cell.
    pub(super) weighed: Weighed,
    /// ln of w/q over the number of draws from the cell.
    pub(super) log: f64,
    cell: usize,
}

/// Weights over all levels.
pub(super) type List = BTreeMap<Vec<bool>, Weighed>;

/// The lattices of one weight.
pub(super) struct Side {
    pub(super) cells: Vec<Cell>,
    pub(super) number: u32,
}

/// (Σ w)²/Σ w² of what was met.
pub(super) fn effective(met: &[Met]) -> f64 {
    let top = met
        .iter()
        .map(|met| met.log)
        .fold(f64::NEG_INFINITY, f64::max);
    let weights = met.iter().map(|met| libm::exp(met.log - top));
    let (first, second) = weights.fold((0.0, 0.0), |(a, b), w| (a + w, b + w * w));
    if second > 0.0 {
        first * first / second
    } else {
        0.0
    }
}

/// So many draws in all, for each cell as √E (w/q)² of the first draws (Neyman 1934).
pub(super) fn counts(first: &[Met], cells: usize, draws: f64) -> Vec<usize> {
    let top = first
        .iter()
        .map(|met| met.log)
        .fold(f64::NEG_INFINITY, f64::max);
    let mut squares = vec![0.0; cells];
    for met in first {
        squares[met.cell] += libm::exp(2.0 * (met.log - top));
    }
    let all: f64 = squares.iter().map(|s| s.sqrt()).sum();
    let share = |square: &f64| {
        if all > 0.0 {
            square.sqrt() / all
        } else {
            1.0 / cells as f64
        }
    };
    let count = |square: &f64| (share(square) * draws).ceil().max(LEAST);
    squares
        .iter()
        .map(|square| count(square) as usize)
        .collect()
}

/// The sums' two parts.
pub(super) struct Sampler<'a> {
    pub(super) likelihood: &'a PatternLikelihood<'a>,
    pub(super) list: List,
    pub(super) quadrature: &'a Rule,
}

impl Sampler<'_> {
    /// Lists patterns with their weights over all levels, but for those that are not likely.
    pub(super) fn list(&mut self, patterns: &[Vec<bool>]) {
        let new = patterns
            .iter()
            .filter(|light| !self.list.contains_key(*light));
        let new: Vec<&Vec<bool>> = new.collect();
        let weigh = |light: &&Vec<bool>| self.likelihood.weigh(light, self.quadrature, ALL);
        let weighed: Vec<Option<Weighed>> = new.par_iter().map(weigh).collect();
        let both = new.into_iter().zip(weighed);
        let both = both.filter_map(|(light, weighed)| Some((light.clone(), weighed?)));
        self.list.extend(both);
        let least = self.top() - NEGLIGIBLE;
        self.list.retain(|_, weighed| weighed.log > least);
    }

    /// To which degree neighbours are alike in the likeliest pattern that is listed; 0 where every
    /// pattern is as likely beforehand.
    pub(super) fn degree(&self) -> f64 {
        let listed = self
            .list
            .iter()
            .map(|(light, weighed)| (light, weighed.log));
        self.likelihood
            .alike
            .map_or(0.0, |prior| prior.degree(listed))
    }

    /// The pattern of the largest weight that is listed.
    pub(super) fn likeliest(&self) -> Option<&Vec<bool>> {
        let order =
            |a: &(&Vec<bool>, &Weighed), b: &(&Vec<bool>, &Weighed)| a.1.log.total_cmp(&b.1.log);
        self.list.iter().max_by(order).map(|(light, _)| light)
    }

    /// ln of the largest weight that is listed.
    fn top(&self) -> f64 {
        let logs = self.list.values().map(|weighed| weighed.log);
        logs.fold(f64::NEG_INFINITY, f64::max)
    }

    /// Lists the patterns near the targets of both sides; the share of the listed weight that both
    /// are likely to have missed, from what one has found and the other not: (1 − M/A)(1 − M/B), A
    /// and B the weights that they found and M that of both (Lincoln and Petersen).
    pub(super) fn list_near(&mut self, sides: &[Side; 2]) -> f64 {
        let near = sides.each_ref().map(|side| nearest(&side.cells));
        near.iter().for_each(|near| self.list(near));
        let top = self.top();
        let (mut found, mut both) = ([0.0; 2], 0.0);
        for (light, weighed) in &self.list {
            let weight = libm::exp(weighed.log - top);
            let by = |side: &Vec<Vec<bool>>| side.binary_search(light).is_ok();
            let own = near.each_ref().map(by);
            for (found, own) in found.iter_mut().zip(own) {
                *found += weight * f64::from(u8::from(own));
            }
            both += weight * f64::from(u8::from(own == [true; 2]));
        }
        let beside = |own: f64| if own > 0.0 { 1.0 - both / own } else { 1.0 };
        beside(found[0]) * beside(found[1])
    }

    /// So many draws from each cell; `stage` sets the random numbers apart.
    pub(super) fn draw(
        &self,
        side: &Side,
        counts: &[usize],
        stage: u32,
    ) -> Result<Vec<Met>, RecoveryError> {
        let batches: Vec<(usize, usize, usize)> = counts
            .iter()
            .enumerate()
            .flat_map(|(cell, count)| {
                let starts = (0..*count).step_by(BATCH);
                starts.map(move |start| (cell, start, BATCH.min(count - start)))
            })
            .collect();
        let met: Result<Vec<Vec<Met>>, RecoveryError> = batches
            .into_par_iter()
            .map(|(cell, start, count)| {
                self.likelihood.control.check()?;
                let key = Key {
                    seed: u64::from(stage),
                    spot: side.number,
                    pixel: cell as u32,
                    block: start as u32,
                };
                let random = &mut Stream::new(Sampling::Pcg, key);
                let share = libm::log(counts[cell] as f64);
                let one = |_| self.one(&side.cells, cell, random, share);
                Ok((0..count).filter_map(one).collect())
            })
            .collect();
        Ok(met?.into_iter().flatten().collect())
    }

    /// One draw; none where it is no pattern, or is listed.
    fn one(&self, cells: &[Cell], cell: usize, random: &mut Stream, share: f64) -> Option<Met> {
        let drawn = cells[cell].lattice.draw(random);
        let light = pattern(&drawn.point).filter(|light| !self.list.contains_key(light))?;
        // Patterns of one level are listed, or are not likely.
        let both = light.contains(&true) && light.contains(&false);
        let contrasts = cells[cell].contrasts;
        let weighed = both.then(|| self.likelihood.weigh(&light, self.quadrature, contrasts))??;
        Some(Met {
            log: weighed.log - drawn.log_probability - share,
            light,
            weighed,
            cell,
        })
    }

    /// The first and the last cell that is likely.
    pub(super) fn likely(&self, coarse: &[Side; 2]) -> Result<[usize; 2], RecoveryError> {
        let cells = &coarse[0].cells;
        let mut logs: Vec<Vec<f64>> = vec![Vec::new(); cells.len()];
        for side in coarse {
            for met in self.draw(side, &vec![PILOT; cells.len()], 0)? {
                logs[met.cell].push(met.log);
            }
        }
        for weighed in self.list.values() {
            let own = cells
                .iter()
                .position(|cell| weighed.contrast() < cell.contrasts[1]);
            logs[own.unwrap_or(0)].push(weighed.log);
        }
        let sums: Vec<f64> = logs.iter().map(|logs| log_sum_exp(logs)).collect();
        let top = sums.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let likely = |sum: &f64| *sum >= top - UNLIKELY;
        let first = sums.iter().position(likely).unwrap_or(0);
        let last = sums.iter().rposition(likely).unwrap_or(cells.len() - 1);
        Ok([first, last])
    }
}
