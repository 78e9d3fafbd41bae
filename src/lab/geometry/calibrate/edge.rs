//! Where the scene ends: past the wall's edge a spot lights nothing.
//!
//! A step that leaves the scene is taken with the moves fixed that the scene stops, δ_k = d_k for k
//! ∈ S, and the others follow,
//!
//! > (F + Λ)_oo δ_o = −(slope + Λθ)_o − (F + Λ)_oS d_S,   o all but S,
//!
//! so that what is stopped stops nothing else (an active set: Nocedal and Wright, Numerical
//! Optimization, 16.5). Taken one after the other, every move that still gives a scene is whole,
//! and one that does not goes as far as the scene does.

use nalgebra::DVector;
use serde::Serialize;

use super::descent::{ENOUGH, Problem, State};
use super::geometry::Geometry;
use super::step::{damped, gain};
use crate::scene::SceneError;

/// Halvings of a move until it ends where the scene does.
const HALVINGS: u32 = 20;
/// An unknown that may not go on by this part of its error, all others known, is at the edge.
const AT_EDGE: f64 = 0.01;

/// An unknown that an edge of the scene holds where the photographs would have it beyond.
#[derive(Clone, Debug, Serialize)]
pub struct AtEdge {
    /// Which of all unknowns.
    pub index: usize,
    /// Why there is no scene beyond.
    pub cause: String,
}

impl Geometry<'_> {
    /// Why there is no scene with its parameters at `values`; none where there is.
    pub(super) fn refused(&self, values: &[f64]) -> Option<SceneError> {
        let own = &values[..self.parameters.len()];
        self.scene.displaced(self.parameters, own).err()
    }

    /// From `values`, which give a scene, by `step` one unknown after the other, each as far as
    /// there is one. Those that end before their move does are fixed to that; one that was fixed
    /// before and leaves the scene still does not move. Whether that fixed anything.
    pub(super) fn fix(
        &self,
        values: &[f64],
        step: &DVector<f64>,
        fixed: &mut [Option<f64>],
    ) -> bool {
        let before = fixed.to_vec();
        let mut at = values.to_vec();
        for k in 0..self.parameters.len() {
            let mut try_share = |share: f64| {
                at[k] = values[k] + share * step[k];
                self.refused(&at).is_none()
            };
            if try_share(1.0) {
                continue;
            }
            let mut inside = 0.0;
            if fixed[k].is_none() {
                for halving in 1..=HALVINGS {
                    let more = inside + 0.5f64.powi(halving.cast_signed());
                    if try_share(more) {
                        inside = more;
                    }
                }
            }
            at[k] = values[k] + inside * step[k];
            fixed[k] = Some(inside * step[k]);
        }
        fixed != before
    }
}

impl Problem<'_> {
    /// The unknowns that edges of the scene hold at the likeliest place: without edges a step would
    /// make it likelier.
    pub(super) fn held(&self, best: &State) -> Vec<AtEdge> {
        let (information, slope) = (self.information(&best.slope), self.whole_slope(best));
        let mut fixed = vec![None; self.unknowns()];
        let Some(free) = damped(&information, &slope, 0.0, &fixed) else {
            return Vec::new();
        };
        if !best.is_settled || gain(&information, &slope, &free) < ENOUGH {
            return Vec::new();
        }
        let moved = |step: &DVector<f64>| -> Vec<f64> {
            best.values.iter().zip(step).map(|(x, d)| x + d).collect()
        };
        let mut step = free.clone();
        while self.geometry.fix(&best.values, &step, &mut fixed) {
            match damped(&information, &slope, 0.0, &fixed) {
                Some(next) => step = next,
                None => break,
            }
        }
        let each = fixed.iter().enumerate();
        let at_edge = each.filter_map(|(k, own)| {
            let error = information[(k, k)].sqrt().recip();
            (own.as_ref()?.abs() < AT_EDGE * error).then_some(k)
        });
        let named = |index: usize| {
            let mut beyond = best.values.clone();
            beyond[index] -= slope[index].signum() * information[(index, index)].sqrt().recip();
            let refused = self.geometry.refused(&beyond);
            let refused = refused.or_else(|| self.geometry.refused(&moved(&free)))?;
            Some(AtEdge {
                index,
                cause: refused.cause,
            })
        };
        at_edge.filter_map(named).collect()
    }
}
