//! Parts of a pixel's footprint.

use super::{Ball, FAR, MOST_FOOTPRINT_CUTS, MOST_FOOTPRINT_PARTS, nodes_a_side, plane_nodes};
use crate::scene::{Scene, Surface};

/// A part of a footprint: corner and side in its coordinates, the ball around what is seen there,
/// and its distance from the hidden surfaces in radii.
pub(in crate::model) struct FootprintPart {
    pub from: [f64; 2],
    pub side: f64,
    pub ball: Ball,
    distance: f64,
}

impl FootprintPart {
    /// All of a footprint by its middle.
    pub(in crate::model) fn centre(scene: &Scene, pixel: usize) -> Self {
        let middle = scene.camera.footprint(pixel).at([0.5; 2]);
        Self {
            from: [0.0; 2],
            side: 1.0,
            ball: Ball {
                middle,
                radius: 0.0,
            },
            distance: f64::INFINITY,
        }
    }

    /// Coordinates in the footprint with shares of it.
    pub(in crate::model) fn nodes(&self, level: usize) -> impl Iterator<Item = ([f64; 2], f64)> {
        // The étendue varies over it too, and so may the wall's BRDF.
        let n = match self.ball.radius {
            0.0 => 1,
            _ => nodes_a_side(self.distance, level).max(level + 1),
        };
        let ([u, v], side) = (self.from, self.side);
        plane_nodes(n).map(move |([a, b], w)| ([u + side * a, v + side * b], w * side * side))
    }
}

/// Parts of a footprint, far for their size from every hidden surface.
pub(in crate::model) fn footprint_parts(scene: &Scene, pixel: usize) -> Vec<FootprintPart> {
    let footprint = scene.camera.footprint(pixel);
    let part = |from @ [a, b]: [f64; 2], side: f64| {
        let middle = footprint.at([a + 0.5 * side, b + 0.5 * side]);
        let radius = 0.5 * side * (footprint.u.length() + footprint.v.length());
        let from_surface = |(_, surface): (usize, &Surface)| {
            (surface.shape.at_position(middle).position - middle).length() / radius
        };
        FootprintPart {
            from,
            side,
            ball: Ball { middle, radius },
            distance: scene
                .hidden()
                .map(from_surface)
                .fold(f64::INFINITY, f64::min),
        }
    };
    let (mut done, mut open) = (Vec::new(), vec![part([0.0; 2], 1.0)]);
    for cuts in 0..=MOST_FOOTPRINT_CUTS {
        let mut next = Vec::new();
        for own in open {
            let full = done.len() + next.len() + 4 > MOST_FOOTPRINT_PARTS;
            if cuts == MOST_FOOTPRINT_CUTS || full || own.distance >= FAR {
                done.push(own);
            } else {
                let ([a, b], half) = (own.from, 0.5 * own.side);
                let corners = [[a, b], [a + half, b], [a, b + half], [a + half, b + half]];
                next.extend(corners.map(|from| part(from, half)));
            }
        }
        open = next;
    }
    done
}
