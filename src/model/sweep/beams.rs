//! Beams that figures cut in part: as an edge moves across a spot, light comes and goes.
//!
//! > d/dθ ∫_free f dA = ∫_free ∂f/∂θ dA + ∫_edge f v·n ds,
//!
//! f the light of a point of the spot on a cell, v the edge's velocity over the spot as it moves
//! itself. The second term is that of squares of the wall about the spot, by how their free part
//! grows. The end of a wall is such an edge too, and stays where the wall is.

use super::{Rates, Sweep, add};
use crate::geometry::{AT_ONCE, Basis, DVec3, Moving, Pieces, Shadow};
use crate::model::cells::HiddenCell;
use crate::model::overhang::ends;
use crate::model::spot::density;
use crate::model::tangent;
use crate::model::wall_point::{self, WallPoint};
use crate::scene::Profile;

/// Squares a side about a spot, and parts a side of one, each with its own profile.
const SIDE: usize = 32;
const PARTS: usize = 8;
/// The squares are turned by so many radians: an edge along their sides, as of a plate through the
/// middle of a spot, would cut none of them.
const TURN: f64 = 0.4;
/// Nodes of the rule along an end of the wall, as those from a spot's middle to its rim.
const END_NODES: usize = 8;
/// Radii of a Gaussian spot beyond which e⁻⁸ of its light is left out.
const EDGE_REACH: f64 = 2.0;

impl Sweep<'_> {
    /// Where edges cut the beam of a spot: what all of the laser's power would light there, and how
    /// the share that does grows. Nothing of a spot without a size, or on a wall that is not flat.
    pub(super) fn edges(&self, spot: usize) -> Vec<(WallPoint, Rates)> {
        let (scene, laser) = (self.past.scene, &self.past.scene.laser);
        let reach = match laser.profile {
            Profile::Ideal | Profile::Shining { .. } => 0.0,
            Profile::Disc { radius } => radius,
            Profile::Gaussian { radius } => EDGE_REACH * radius,
        };
        let own = &laser.spots[spot];
        let is_flat = scene.surfaces[own.surface as usize].shape.is_flat();
        if reach == 0.0 || !is_flat {
            return Vec::new();
        }
        let carried = self.of(|k| self.velocities[k].laser);
        let shadows = self.shadows((laser.position, carried), Some(own.surface));
        let basis = Basis::around(own.target.normal);
        let (sin, cos) = libm::sincos(TURN);
        let at = |k: f64| reach * (2.0 * k / (SIDE * PARTS) as f64 - 1.0);
        let lit = |[x, y]: [f64; 2], share: f64| {
            let (x, y) = (at(x), at(y));
            let offset = basis.to_world([cos * x - sin * y, sin * x + cos * y, 0.0]);
            wall_point::lit(scene, spot, offset, share)
        };
        // In the frame of the laser.
        let corner = |place: [f64; 2]| {
            let point = lit(place, 1.0);
            let rate = |k: usize| {
                tangent::lit(scene, self.velocities[k], spot, &point).position - carried[k]
            };
            Moving {
                at: point.position,
                rate: self.of(rate),
            }
        };
        let mut pieces = Pieces::default();
        // How the free part of a square grows, beside what the whole of it grows by.
        let mut growth = |[i, j]: [usize; 2], side: usize| {
            let ends = [[0, 0], [side, 0], [side, side], [0, side]];
            let places = ends.map(|[a, b]| [i + a, j + b].map(|k| k as f64));
            let hull = places.map(|place| lit(place, 1.0).position);
            if shadows.iter().all(|shadow| shadow.misses(&hull)) {
                return None;
            }
            let whole = places.map(corner);
            pieces.past([&whole[..]], &hull, &shadows);
            let (all, _, all_grown) = Moving::area_and_middle(&whole);
            let (mut area, mut grown) = (0.0, [0.0; AT_ONCE]);
            for piece in pieces.iter() {
                let (own, _, rate) = Moving::area_and_middle(piece);
                area += own;
                add(&mut grown, &rate);
            }
            add(&mut grown, &all_grown.map(|rate| -rate * area / all));
            (area > 0.0 && area < all).then_some(grown)
        };
        let mut found: Vec<(WallPoint, Rates)> = Vec::new();
        if !self.is_still {
            let ends = ends(scene, spot, laser.profile, END_NODES).into_iter();
            let is_lit = |w: &WallPoint| {
                let dark = |s: &Shadow<_>| s.covers_box(w.position, DVec3::ZERO);
                !shadows.iter().any(dark)
            };
            let lost = ends.filter(|(w, _)| is_lit(w)).map(|(w, out)| {
                let against = |k: usize| tangent::against_wall(scene, self.velocities[k], spot, &w);
                (w, self.of(|k| -against(k).dot(out)))
            });
            found.extend(lost);
        }
        if growth([0; 2], SIDE * PARTS).is_none() {
            return found;
        }
        for square in (0..SIDE * SIDE).map(|k| [k % SIDE, k / SIDE]) {
            let first = square.map(|k| k * PARTS);
            if growth(first, PARTS).is_none() {
                continue;
            }
            let mut grown = [0.0; AT_ONCE];
            let (mut sum, mut moment) = (0.0, [0.0; 2]);
            for part in (0..PARTS * PARTS).map(|k| [k % PARTS, k / PARTS]) {
                let part = [first[0] + part[0], first[1] + part[1]];
                let middle = part.map(|k| k as f64 + 0.5);
                let [x, y] = middle.map(at);
                let density = density(laser.profile, libm::hypot(x, y));
                if let (true, Some(own)) = (density > 0.0, growth(part, 1)) {
                    add(&mut grown, &own.map(|rate| rate * density));
                    sum += density;
                    (0..2).for_each(|axis| moment[axis] += density * middle[axis]);
                }
            }
            if sum > 0.0 {
                found.push((lit(moment.map(|m| m / sum), 1.0), grown));
            }
        }
        found
    }

    /// What the edges across a spot change of its light on each cell.
    pub(super) fn across(&self, spot: usize, cells: &[HiddenCell], found: &mut [Rates]) {
        for (point, grown) in &self.edges[spot] {
            let light = self.past.lit_by(point, cells);
            for (sum, light) in found.iter_mut().zip(light) {
                add(sum, &grown.map(|rate| rate * light));
            }
        }
    }
}
