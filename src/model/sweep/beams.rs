//! Beams that figures cut in part: as an edge moves across a spot, light comes and goes.
//!
//! > d/dθ ∫_free f dA = ∫_free ∂f/∂θ dA + ∫_edge f v·n ds,
//!
//! f the light of a point of the spot on a cell, v the edge's velocity over the spot as it moves
//! itself. The second term is that of squares of the wall about the spot, by how their free part
//! grows.

use super::{Rates, Sweep, add};
use crate::geometry::{AT_ONCE, Basis, Moving, Pieces};
use crate::model::cells::HiddenCell;
use crate::model::tangent;
use crate::model::wall_point::{self, WallPoint};
use crate::scene::Profile;

/// Squares a side about a spot, and parts a side of one, each with its own profile.
const SIDE: usize = 32;
const PARTS: usize = 8;
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
        let at = |k: f64| reach * (2.0 * k / (SIDE * PARTS) as f64 - 1.0);
        let lit = |[x, y]: [f64; 2], share: f64| {
            let offset = basis.to_world([at(x), at(y), 0.0]);
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
        let mut found = Vec::new();
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
                let density = density(laser.profile, middle.map(at));
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

/// Share of the laser's power per area at a place of a spot.
fn density(profile: Profile, [x, y]: [f64; 2]) -> f64 {
    let r2 = x * x + y * y;
    let per = |radius: f64| std::f64::consts::FRAC_1_PI / (radius * radius);
    match profile {
        Profile::Disc { radius } if r2 <= radius * radius => per(radius),
        Profile::Gaussian { radius } => {
            2.0 * per(radius) * libm::exp(-2.0 * r2 / (radius * radius))
        }
        Profile::Disc { .. } | Profile::Ideal | Profile::Shining { .. } => 0.0,
    }
}
