//! Photographs of a few spots, for a page without script.

use std::collections::BTreeSet;

use super::super::colour::Scale;
use super::super::figure::{Entries, MOST, Reduction, figure, legend, note, reduced};
use super::super::panel::Panel;
use crate::lab::RunResults;
use crate::num::digits::significant;

/// The photographs of the first, the middle and the last spot.
pub(super) fn frames(results: &RunResults) -> String {
    let (camera, phi) = (&results.scene.camera, &results.phi);
    let (p, l) = phi.shape();
    if l == 0 || p == 0 {
        return String::new();
    }
    let size = [camera.columns, camera.rows];
    let spots: BTreeSet<usize> = [0, l / 2, l - 1].into();
    let mut said = None;
    let panels: Vec<Panel> = spots
        .into_iter()
        .map(|spot| {
            let place = results
                .scene
                .laser
                .spots
                .get(spot)
                .map_or(String::new(), |s| {
                    let at = s.target.position;
                    format!(" at ({}, {})", significant(at.x, 3), significant(at.y, 3))
                });
            let value = |i: usize, j: usize| {
                phi.get((i + j * size[0], spot))
                    .copied()
                    .unwrap_or(f64::NAN)
            };
            let title = format!("spot {spot}{place}");
            let (panel, note) = reduced(
                title,
                ["column, +x", "row, +y"],
                size,
                MOST,
                Reduction::Mean,
                value,
            );
            said = note;
            panel
        })
        .collect();
    let scale = Scale::sequential(panels.iter().flat_map(|p| &p.values));
    let ends = size.map(|n| n.saturating_sub(1));
    let figures: String = panels
        .iter()
        .map(|p| figure(p, ends, Entries::Square, &scale, ""))
        .collect();
    format!(
        "<p>What the camera records for the first, the middle and the last laser spot: flux into each \
         pixel. One scale for all, from the smallest to the largest value shown.</p>\n\
         <div class=\"row\">\n{figures}</div>\n{}{}",
        legend(&scale, "W", &panels),
        note(said)
    )
}
