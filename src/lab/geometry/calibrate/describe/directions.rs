//! Combinations of unknowns, in words.

use super::LISTED;
use crate::lab::finding::listed;
use crate::lab::geometry::calibrate::Direction;
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
