//! Shadow rays, gathered and cast together.

use crate::geometry::{Blockers, Bvh, Ray, ShapeId};

/// Segments between which the same shapes may stand, each with its place in a row and the shapes at its ends.
#[derive(Debug, Default)]
pub(super) struct Shadows<'a> {
    blockers: Option<&'a Blockers>,
    places: Vec<usize>,
    segments: Vec<Ray>,
    ends: Vec<[Option<ShapeId>; 2]>,
}

impl<'a> Shadows<'a> {
    /// Asks whether anything among `blockers` stands on the segment; if so, its place in the row becomes 0, now or when the rest is
    /// answered.
    pub(super) fn ask(
        &mut self,
        bvh: &Bvh,
        blockers: &'a Blockers,
        (place, segment, ends): (usize, Ray, [Option<ShapeId>; 2]),
        row: &mut [f64],
    ) {
        if self.blockers.is_some_and(|b| b != blockers) {
            self.answer(bvh, row);
        }
        self.blockers = Some(blockers);
        self.places.push(place);
        self.segments.push(segment);
        self.ends.push(ends);
    }

    /// Sets to 0 what has been asked for and is blocked.
    pub(super) fn answer(&mut self, bvh: &Bvh, row: &mut [f64]) {
        let Some(blockers) = self.blockers.take() else {
            return;
        };
        let blocked = bvh.blocked_many(blockers, &self.segments, &self.ends);
        for (place, _) in self.places.iter().zip(blocked).filter(|(_, b)| *b) {
            row[*place] = 0.0;
        }
        self.places.clear();
        self.segments.clear();
        self.ends.clear();
    }
}
