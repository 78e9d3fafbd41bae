//! Combinations of unknowns, in words.

use super::LISTED;
use crate::lab::finding::listed;
use crate::lab::geometry::calibrate::{Calibration, Direction};
use crate::scene::Parameter;

/// Why some combinations of unknowns cannot be estimated.
pub(in crate::lab::geometry::calibrate) fn untold(
    directions: &[&Direction],
    parameters: &[Parameter],
) -> String {
    let name = |k: usize| parameters.get(k).map(|p| p.name.clone());
    let mut all: Vec<String> = directions.iter().map(|d| d.names(name)).collect();
    all.sort();
    all.dedup();
    let mut parts = directions.iter().flat_map(|d| &d.parts);
    let of_gains = parts.any(|(k, _)| *k >= parameters.len());
    let gains = if of_gains {
        "; of gains, a smaller --frame-gain, no --free-scale, or other light of a lower degree"
    } else {
        ""
    };
    format!(
        "at their noise the photographs do not tell {}; what moves with such a combination changes nothing that the picture or the rest could not. Leave one of each out, or say how well it is known (--free NAME=SIGMA, or [uncertainty] in the scene){gains}",
        listed(&all)
    )
}

impl Calibration {
    /// What is said of combinations that the photographs do not tell.
    pub(super) fn held_by_what_was_known(&self) -> Option<String> {
        let name = |k: usize| self.found.get(k).map(|f| f.name.clone());
        let all = self.untold.iter().take(LISTED);
        let mut few: Vec<String> = all.map(|direction| direction.names(name)).collect();
        if self.untold.len() > LISTED {
            few.push(format!("{} more", self.untold.len() - LISTED));
        }
        (!few.is_empty()).then(|| {
            format!(
                "The photographs do not tell {}: what was known beforehand holds that.",
                listed(&few)
            )
        })
    }
}

impl Direction {
    pub(super) fn names(&self, name: impl Fn(usize) -> Option<String>) -> String {
        let of = |(k, part): &(usize, f64)| {
            let sign = if *part < 0.0 { "−" } else { "+" };
            name(*k).map(|name| format!("{sign}{name}"))
        };
        let mut few: Vec<String> = self.parts.iter().filter_map(of).take(LISTED).collect();
        if self.parts.iter().any(|(k, _)| name(*k).is_none()) {
            few.push("gains of frames".to_owned());
        }
        few.join(" ")
    }
}
