//! Where light between the walls comes from: a guess by which surfaces are sampled.
//!
//! ```text
//! I(y) = Σ_p G(x_p, y)·V · Σ_l G(y, s_l)·V
//! ```
//!
//! over some points x_p that pixels see and some lit points s_l. It only steers where points are
//! drawn: their density is known whatever it is, so that no guess makes an estimate wrong.

use super::vertex::{Vertex, geometry_term};
use crate::geometry::{Interaction, ShapeId};
use crate::scene::Scene;

/// Points that are asked of each kind, at most.
const MOST: usize = 16;

/// Some points that pixels see, and some that are lit.
#[derive(Debug)]
pub(super) struct Importance<'a> {
    scene: &'a Scene,
    seen: Vec<Vertex>,
    lit: Vec<Vertex>,
}

impl<'a> Importance<'a> {
    /// Of all vertices that pixels see, and all lit points, evenly chosen.
    pub(super) fn new(scene: &'a Scene, seen: &[Vertex], lit: &[Vertex]) -> Self {
        let some = |all: &[Vertex]| {
            let count = all.len().min(MOST);
            let places = (0..count).map(|i| (2 * i + 1) * all.len() / (2 * count));
            places.map(|k| all[k]).collect()
        };
        Self {
            scene,
            seen: some(seen),
            lit: some(lit),
        }
    }

    /// The mean of I over a part of `shape`: (u, v) from `corner`, `width` wide.
    ///
    /// Its points are those of the R2 sequence (Roberts, *The unreasonable effectiveness of
    /// quasirandom sequences*, 2018), each seen from one x_p and lit by one s_l.
    pub(super) fn mean(&self, shape: ShapeId, corner: [f64; 2], width: [f64; 2]) -> f64 {
        /// 1/φ₂ and 1/φ₂², φ₂³ = φ₂ + 1.
        const STEP: [f64; 2] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_2];
        let surface = &self.scene.surfaces[shape as usize].shape;
        let sum = |ends: &[Vertex]| -> f64 {
            let term = |(k, end): (usize, &Vertex)| {
                let place = |d: usize| {
                    let x = (0.5 + (k + 1) as f64 * STEP[d]).fract();
                    corner[d] + width[d] * x
                };
                let point = surface.at([place(0), place(1)]);
                self.term(shape, &point, end)
            };
            ends.iter().enumerate().map(term).sum()
        };
        sum(&self.seen) * sum(&self.lit)
    }

    /// G·V between a point of `shape` and an end of the path.
    fn term(&self, shape: ShapeId, point: &Interaction, end: &Vertex) -> f64 {
        let y = (point.position, point.normal);
        let Some((term, ray)) = geometry_term(y, end.oriented()) else {
            return 0.0;
        };
        let ends = [Some(shape), Some(end.shape)];
        if self.scene.bvh().blocked(&ray, ends) {
            0.0
        } else {
            term
        }
    }
}
