//! Which unknowns a sentence names: of many single spots few.

use super::LISTED;
use crate::lab::finding::listed;
use crate::lab::geometry::calibrate::{Calibrated, Calibration};

/// A single spot is named in the first sentence if it is off by more than so many of its errors.
const NOTABLE_SPOT: f64 = 3.0;

/// What is named first: hidden surfaces and others by name, the view, the rest, single spots.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Rank {
    Surface,
    View,
    Other,
    SingleSpot,
}

fn rank(of: &Calibrated) -> Rank {
    let (what, which) = of.name.split_once('.').unwrap_or((&of.name, ""));
    match what {
        "spots" if which.starts_with(|c: char| c.is_ascii_digit()) => Rank::SingleSpot,
        "view" => Rank::View,
        "spots" | "camera" | "laser" | "wall" | "occluders" => Rank::Other,
        _ => Rank::Surface,
    }
}

/// Unknowns in the order in which they are named, single spots of the largest `size` first.
fn ordered<'a>(
    all: impl IntoIterator<Item = &'a Calibrated>,
    size: impl Fn(&Calibrated) -> f64,
) -> Vec<&'a Calibrated> {
    let mut all: Vec<&Calibrated> = all.into_iter().collect();
    all.sort_by(|a, b| {
        let by_size = || match rank(a) {
            Rank::SingleSpot => size(b).total_cmp(&size(a)),
            _ => std::cmp::Ordering::Equal,
        };
        rank(a).cmp(&rank(b)).then_with(by_size)
    });
    all
}

/// `said` of the first of them in that order, and how many more there are.
pub(super) fn few<'a>(
    all: impl IntoIterator<Item = &'a Calibrated>,
    size: impl Fn(&Calibrated) -> f64,
    said: impl Fn(&Calibrated) -> String,
) -> Vec<String> {
    let all = ordered(all, size);
    let mut few: Vec<String> = all.iter().take(LISTED).map(|f| said(f)).collect();
    if all.len() > LISTED {
        few.push(format!("{} more", all.len() - LISTED));
    }
    few
}

impl Calibration {
    /// Geometric parameters, single spots last.
    pub(super) fn in_order(&self) -> Vec<&Calibrated> {
        ordered(self.geometry(), |_| 0.0)
    }

    /// `said` of those that the first sentence names: all of few, else not the single spots that
    /// are within their errors where the scene has them, of which it tells how many they are.
    pub(super) fn first(&self, said: impl Fn(&Calibrated) -> String) -> String {
        let off = |f: &Calibrated| f.value.abs() / f.stderr;
        let is_few = self.geometry().count() <= LISTED;
        let is_near =
            |f: &&Calibrated| !is_few && rank(f) == Rank::SingleSpot && off(f) <= NOTABLE_SPOT;
        let near = self.geometry().filter(is_near).count();
        let mut named = few(self.geometry().filter(|f| !is_near(f)), off, said);
        if near > 0 {
            named.push(format!(
                "{near} of single spots within {NOTABLE_SPOT} of their errors"
            ));
        }
        listed(&named)
    }
}
