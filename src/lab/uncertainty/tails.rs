//! How many standard errors of Φcam cannot be trusted, and where.

use serde::{Deserialize, Serialize};

use crate::matrix::Matrix;
use crate::num::digits::figure;
use crate::transport::tails::{FEW_LIT, LARGEST, NEIGHBOURS, SKEWED, UNLIT, WORDS};

/// Entries of which fewer do not show by each other what paths are rare: where one in a hundred has
/// met such a path, a smaller matrix is likely to have met none.
const FEW: usize = 100;

/// Counts of flagged entries; an entry may be flagged for more than one reason.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tails {
    /// Entries in all.
    pub entries: usize,
    /// Entries that are flagged.
    pub flagged: usize,
    /// One block has most of the scatter.
    pub largest: usize,
    /// Blocks are too skewed.
    pub skewed: usize,
    /// Few blocks have light.
    pub few_lit: usize,
    /// No light was met.
    pub unlit: usize,
    /// Only the neighbours are flagged.
    pub neighbours: usize,
    /// The spot with most flagged entries, the first of several; absent where none is flagged.
    pub worst_spot: Option<usize>,
    /// Flagged entries there.
    pub worst_spot_flagged: usize,
}

impl Tails {
    /// Counts the codes of pixels × spots.
    pub fn of(tails: &Matrix) -> Self {
        let has = |bit: u32| tails.iter().filter(|code| **code as u32 & bit != 0).count();
        let flagged = |column: usize| tails.column(column).iter().filter(|c| **c != 0.0).count();
        let by_spot: Vec<usize> = (0..tails.ncols()).map(flagged).collect();
        let most = by_spot.iter().copied().max().unwrap_or(0);
        Self {
            entries: tails.len(),
            flagged: by_spot.iter().sum(),
            largest: has(LARGEST),
            skewed: has(SKEWED),
            few_lit: has(FEW_LIT),
            unlit: has(UNLIT),
            neighbours: has(NEIGHBOURS),
            worst_spot: by_spot.iter().position(|n| *n == most && most > 0),
            worst_spot_flagged: most,
        }
    }

    /// How many, why, where most, what helps, and what so few could not show.
    pub fn sentence(&self) -> String {
        let Self {
            entries, flagged, ..
        } = self;
        let unseen = if *entries < FEW {
            format!(
                "; fewer than {FEW} entries may all have missed a path that is rare and bright: compare another --seed"
            )
        } else {
            String::new()
        };
        let Some(spot) = self.worst_spot else {
            return format!("can be trusted at all {entries} entries{unseen}");
        };
        let share = figure(100.0 * *flagged as f64 / *entries as f64, 2);
        let counts = WORDS.map(|(bit, words)| (self.of_bit(bit), words));
        let reasons = counts.into_iter().filter(|(count, _)| *count > 0);
        let reasons: Vec<String> = reasons.map(|(n, words)| format!("{n} {words}")).collect();
        format!(
            "not to be trusted at {flagged} of {entries} entries ({share}\u{a0}%): {}; most at spot {spot} ({}); more samples help{unseen}",
            reasons.join(", "),
            self.worst_spot_flagged
        )
    }

    fn of_bit(&self, bit: u32) -> usize {
        match bit {
            LARGEST => self.largest,
            SKEWED => self.skewed,
            FEW_LIT => self.few_lit,
            UNLIT => self.unlit,
            _ => self.neighbours,
        }
    }
}

/// What a render of so few entries may all have missed, where they are few.
pub(in crate::lab) fn missed(entries: usize) -> Option<String> {
    (entries < FEW).then(|| {
        format!(
            "a path that is rare and bright, which fewer than {FEW} entries may all have missed (compare another \
             --seed)"
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lab::comparison::score::Score;
    use crate::lab::finding::Describe;
    use crate::lab::sample::run;

    #[test]
    fn every_reason_is_counted_and_said() {
        let codes = [0, 0, 3, 4, 16, 0, 8, 16, 2];
        let tails = Tails::of(&Matrix::from_iterator(3, 3, codes.map(f64::from)));
        assert_eq!((tails.flagged, tails.largest, tails.skewed), (6, 1, 2));
        assert_eq!((tails.few_lit, tails.unlit, tails.neighbours), (1, 1, 2));
        assert_eq!((tails.worst_spot, tails.worst_spot_flagged), (Some(2), 3));
        let said = tails.sentence();
        for words in [
            "6 of 9 entries (67",
            "1 no light met yet",
            "most at spot 2 (3)",
        ] {
            assert!(said.contains(words), "{said}");
        }
        let all = Tails::of(&Matrix::zeros(2, 3));
        assert_eq!(all.worst_spot, None);
        let of_few = "can be trusted at all 6 entries; fewer than 100 entries may";
        assert!(all.sentence().starts_with(of_few), "{}", all.sentence());
        let of_many = Tails::of(&Matrix::zeros(10, 10)).sentence();
        assert_eq!(of_many, "can be trusted at all 100 entries");
    }

    /// The verdict on a render repeats it, of all entries that were rendered.
    #[test]
    fn a_verdict_on_few_entries_says_what_they_may_have_missed() {
        let mut agreement = run("bench").agreement.unwrap();
        for (entries, left_out, is_rendered, told) in [
            (99, 0, true, true),
            (98, 1, true, true),
            (99, 1, true, false),
            (100, 0, true, false),
            (9, 0, false, false),
        ] {
            (agreement.entries, agreement.left_out) = (entries, left_out);
            agreement.is_rendered = is_rendered;
            for score in [None, Some(Score::default())] {
                agreement.score = score;
                let said = format!("{:?}", agreement.describe());
                let of_few = "fewer than 100 entries may all have missed (compare another --seed)";
                assert_eq!(said.contains(of_few), told, "{entries} {left_out}: {said}");
            }
        }
    }
}
