//! Combinations of unknowns, in words.

use super::LISTED;
use crate::lab::calibrate::Direction;
use crate::lab::finding::listed;
use crate::scene::Parameter;

/// Why some combinations of unknowns cannot be estimated.
pub(in crate::lab::calibrate) fn untold(
    directions: &[&Direction],
    parameters: &[Parameter],
) -> String {
    let name = |k: usize| parameters.get(k).map(|p| p.name.clone());
    let all: Vec<String> = directions.iter().map(|d| d.names(name)).collect();
    format!(
        "at their noise the photographs do not tell {}; what moves with such a combination changes nothing that the picture or the rest could not. Leave one of each out, or say how well it is known (--free NAME=SIGMA, or [uncertainty] in the scene)",
        listed(&all)
    )
}

impl Direction {
    pub(super) fn names(&self, name: impl Fn(usize) -> Option<String>) -> String {
        let of = |(k, part): &(usize, f64)| {
            let sign = if *part < 0.0 { "−" } else { "+" };
            let name = name(*k).unwrap_or_else(|| "a gain".to_owned());
            format!("{sign}{name}")
        };
        let few: Vec<String> = self.parts.iter().take(LISTED).map(of).collect();
        few.join(" ")
    }
}
