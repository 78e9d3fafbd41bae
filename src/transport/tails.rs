//! Entries of Φcam whose standard error cannot be trusted: codes, their words and the rule of
//! neighbours.
//!
//! A code is a sum of bits; 0 is an entry whose Student interval holds what it promises: of all
//! such, at most 6 % lie outside their 95 % and 0.3 % outside their 99.9 %. What an entry shows of
//! itself is judged in `spread`. It shows nothing where a rare path was not met yet. Then those
//! beside it tell, for the entries of a column (a spot) and of a row (a pixel) share most of their
//! paths: see [`flag_neighbours`].

use crate::matrix::Matrix;

/// One block has more than half of the scatter.
pub const LARGEST: u32 = 1;
/// The blocks are skewed too much for their number.
pub const SKEWED: u32 = 2;
/// More than two thirds of the blocks have no light.
pub const FEW_LIT: u32 = 4;
/// No block has light, though light may get there; the standard error is an upper bound.
pub const UNLIT: u32 = 8;
/// Nothing of its own, but too many of its column or row are flagged, or have met paths too bright
/// for its standard error.
pub const NEIGHBOURS: u32 = 16;

/// Every bit in words.
pub const WORDS: [(u32, &str); 5] = [
    (LARGEST, "one block has most of the scatter"),
    (SKEWED, "blocks too skewed"),
    (FEW_LIT, "light in few blocks"),
    (UNLIT, "no light met yet"),
    (NEIGHBOURS, "like its neighbours"),
];

/// A column or row of which more than this share is flagged is flagged whole.
const SHARE: f64 = 0.05;
/// What its neighbours have met, spread over all of them, may move an entry by this many of its
/// standard errors: at 0.3, 6 % of a normal variable lie outside its 95 %.
const SHIFT: f64 = 0.3;

/// A column or row: entries that met light, those flagged by themselves, and Σσ of these.
#[derive(Clone, Copy, Debug, Default)]
struct Line {
    entries: f64,
    flagged: f64,
    met: f64,
}

impl Line {
    fn add(&mut self, own: u32, stderr: f64) {
        if own & UNLIT != 0 {
            return;
        }
        self.entries += 1.0;
        if own != 0 {
            self.flagged += 1.0;
            self.met += stderr;
        }
    }

    fn flags(&self, stderr: f64) -> bool {
        let many = self.flagged >= 2.0 && self.flagged > SHARE * self.entries;
        many || self.met > SHIFT * stderr * self.entries
    }
}

/// Sets [`NEIGHBOURS`] for every entry that shows nothing itself, in a column or row
///
/// * of which two or more and over 5 % are flagged by themselves, or
/// * whose flagged entries have met light that, spread over all its m entries, would move this one
///   by more than 0.3 of its σ: Σσ_flagged/m > 0.3·σ. The largest block t of n moves the mean by (t
///   − t̄)/(n − 1), which is at most σ, and is σ where it alone makes the scatter.
///
/// All three matrices are pixels × spots. Entries 0 ± 0 are known to be dark and take no part, nor
/// do those that met no light: a shadow says nothing of what is beside it. The outcome depends on
/// the own codes only: it may be called again on a larger part of Φcam.
pub fn flag_neighbours(tails: &mut Matrix, flux: &Matrix, stderr: &Matrix) {
    let mut rows = vec![Line::default(); tails.nrows()];
    let mut columns = vec![Line::default(); tails.ncols()];
    let own = |code: f64| code as u32 & !NEIGHBOURS;
    let known_dark = |p, l| flux[(p, l)] == 0.0 && stderr[(p, l)] == 0.0;
    let entries: Vec<(usize, usize)> = (0..tails.ncols())
        .flat_map(|l| (0..tails.nrows()).map(move |p| (p, l)))
        .filter(|(p, l)| !known_dark(*p, *l))
        .collect();
    for &(p, l) in &entries {
        let own = own(tails[(p, l)]);
        rows[p].add(own, stderr[(p, l)]);
        columns[l].add(own, stderr[(p, l)]);
    }
    for &(p, l) in &entries {
        let own = own(tails[(p, l)]);
        let flagged = rows[p].flags(stderr[(p, l)]) || columns[l].flags(stderr[(p, l)]);
        let by_them = if own == 0 && flagged { NEIGHBOURS } else { 0 };
        tails[(p, l)] = f64::from(own | by_them);
    }
}

#[cfg(test)]
mod tests;
