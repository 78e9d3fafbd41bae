//! Photographs or pixels that no picture explains together with the others.

use super::{Known, Residuals, fit};
use crate::lab::comparison::evidence::FIT_LEVEL;
use crate::lab::uncertainty::certainty::Errors;
use crate::matrix::Matrix;
use crate::num::statistics::{chi_square_sf, sidak_p};
use crate::recovery::{Method, Options, Problem, Recovered, recover};

/// Lines that are left out at most, and of how many one may be.
const MOST: usize = 3;
const OF: usize = 4;
/// Times the mean χ² of a line below which one is no exception.
const EXCEPTION: f64 = 3.0;
/// Share of χ² that is most of it.
const SHARE: f64 = 0.5;

/// Columns (spots) or rows (pixels) without which a picture explains all others.
#[derive(Clone, Debug, PartialEq)]
pub struct Apart {
    /// Whether they are columns.
    pub are_spots: bool,
    /// Their indices, in order.
    pub which: Vec<usize>,
    /// Their share of χ², held against the picture of the others.
    pub share: f64,
    /// χ²/dof of the others.
    pub rest: f64,
}

impl Apart {
    /// Looked for where `found`, the best picture of all entries, is refuted. The line with the
    /// largest χ² is left out and the best picture of the others found, until that fits or [`MOST`]
    /// lines are left out. Each of these must be refuted by the picture of the others: the least P
    /// of its χ² among as many lines as there are, by the level of a fit. Errors that entries share
    /// tell no lines apart.
    pub(super) fn of(
        problem: &Problem<'_>,
        noise: Known<'_>,
        found: &Recovered,
        options: &Options,
    ) -> Option<Self> {
        if noise.certainty.errors != Errors::Independent {
            return None;
        }
        let of = |are_spots| lines(problem, noise, (found, are_spots), options);
        of(true).or_else(|| of(false))
    }
}

fn lines(
    problem: &Problem<'_>,
    noise: Known<'_>,
    (found, are_spots): (&Recovered, bool),
    options: &Options,
) -> Option<Apart> {
    let (pixels, spots) = problem.photographed().shape();
    let count = if are_spots { spots } else { pixels };
    let counted = problem.counted(Matrix::from_element(pixels, spots, 1.0));
    let of_line = |at: usize, line: usize| {
        let (pixel, spot) = (at % pixels, at / pixels);
        line == if are_spots { spot } else { pixel }
    };
    let chi2 = |found: &Recovered| {
        let mut residuals = Residuals::default();
        let stderr = problem.counted(noise.stderr.clone());
        let seen = found.photographs(problem);
        residuals.add(problem.photographed(), &seen, &stderr, noise.certainty);
        if are_spots {
            residuals.columns
        } else {
            residuals.sums
        }
    };
    let mut which: Vec<usize> = Vec::new();
    let mut each = chi2(found);
    while which.len() < MOST && OF * (which.len() + 1) <= count {
        let others = |line: &usize| !which.contains(line);
        let mean = (0..count).filter(others).map(|k| each[k]).sum::<f64>();
        let mean = mean / (count - which.len()) as f64;
        let worst = (0..count).filter(others);
        let worst = worst.max_by(|a, b| each[*a].total_cmp(&each[*b]))?;
        if each[worst] < EXCEPTION * mean {
            return None;
        }
        which.push(worst);
        let mut flags = counted.map(|x| 1.0 - x);
        for (at, flag) in flags.iter_mut().enumerate() {
            if which.iter().any(|line| of_line(at, *line)) {
                *flag = 1.0;
            }
        }
        let rest = problem.leaving_out(&flags);
        let picture = recover(Method::Joint, &rest, options).ok()?;
        each = chi2(&picture);
        let own = fit(&rest, noise, &picture)?;
        if own.fits {
            let entries = |line: usize| {
                let all = counted.iter().enumerate();
                all.filter(|(at, x)| **x > 0.0 && of_line(*at, line))
                    .count() as f64
            };
            let by_chance = |line: &usize| {
                let p = chi_square_sf(each[*line], entries(*line));
                sidak_p(p, count as u64) >= FIT_LEVEL
            };
            let share = which.iter().map(|k| each[*k]).sum::<f64>() / each.iter().sum::<f64>();
            let is_most = share > SHARE && !which.iter().any(by_chance);
            which.sort_unstable();
            return is_most.then_some(Apart {
                are_spots,
                which,
                share,
                rest: own.chi2_per_dof,
            });
        }
    }
    None
}
