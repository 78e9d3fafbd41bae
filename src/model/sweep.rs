//! How the light past flat figures changes as they move, wall, hidden surfaces, camera and spots
//! at rest.
//!
//! > ċ_p = Σ_k d/dθ (f_r3 G E)(piece k),   ḋ_l = Σ_k d/dθ (f_r1 G Φ dA/π)(piece k)
//!
//! over the pieces that [`Obstructed`] takes at their centroids: corners, areas and centroids are
//! followed ([`Moving`]), so that the rates are those of its own sums, but where a shadow begins or
//! ends to meet a piece.

use super::cells::HiddenCell;
use super::kernel::{HiddenPoint, Kernel};
use super::occlusion::Obstructed;
use super::patch::Patch;
use super::tangent::{self, HiddenRate, WallRate};
use super::wall_point::{self, WallPoint};
use crate::geometry::{
    AT_ONCE, DVec3, Moving, Pieces, PlaneRate, Shadow, ShapeId, area_and_middle,
};
use crate::scene::{Role, Scene, Surface, Twist, Velocity};

/// Rates per unit of each parameter.
pub(super) type Rates = [f64; AT_ONCE];

/// Whether a parameter moves nothing but surfaces that are neither wall nor hidden.
pub(super) fn moves_figures_alone(scene: &Scene, velocity: &Velocity) -> bool {
    let Velocity {
        surfaces,
        spots,
        view,
        view_growth,
        camera,
        laser,
    } = velocity;
    let stands = |(surface, twist): (&Surface, &Twist)| {
        *twist == Twist::default() || !matches!(surface.role, Role::Relay | Role::Hidden)
    };
    *view == [0.0; 2]
        && *view_growth == 0.0
        && *camera == DVec3::ZERO
        && *laser == DVec3::ZERO
        && spots.iter().all(|s| *s == [0.0; 2])
        && scene.surfaces.iter().zip(surfaces).all(stands)
}

/// A scene past figures that move with up to [`AT_ONCE`] parameters.
pub(super) struct Sweep<'a> {
    past: &'a Obstructed<'a>,
    velocities: &'a [&'a Velocity],
    /// What the camera sees of each part of each pixel's footprint.
    seen: Vec<Vec<Vec<Vec<Moving>>>>,
}

impl<'a> Sweep<'a> {
    /// `past` has flat figures and flat walls alone ([`Obstructed::is_flat`]).
    pub(super) fn new(past: &'a Obstructed<'a>, velocities: &'a [&'a Velocity]) -> Self {
        let mut found = Self {
            past,
            velocities,
            seen: Vec::new(),
        };
        let shadows = found.shadows(past.scene.camera.position, None);
        let mut pieces = Pieces::default();
        let mut of = |patch: &Patch| -> Vec<Vec<Moving>> {
            let Some(corners) = &patch.corners else {
                return Vec::new();
            };
            let whole: Vec<Moving> = corners.iter().copied().map(Moving::still).collect();
            pieces.past([&*whole], corners, &shadows);
            pieces.iter().map(<[Moving]>::to_vec).collect()
        };
        found.seen = past
            .pixels
            .iter()
            .map(|patches| patches.iter().map(&mut of).collect())
            .collect();
        found
    }

    fn shadows(&self, from: DVec3, own: Option<ShapeId>) -> Vec<Shadow<PlaneRate>> {
        let velocity = |id: ShapeId, x: DVec3| {
            std::array::from_fn(|k| {
                let velocity = self.velocities.get(k);
                velocity.map_or(DVec3::ZERO, |v| v.surfaces[id as usize].at(x))
            })
        };
        let bvh = self.past.scene.bvh();
        self.past.opaque.moving_from(from, own, bvh, velocity)
    }

    /// ∂ of [`Obstructed::camera`], past what is.
    pub(super) fn camera(&self, cell: &HiddenCell) -> Vec<Rates> {
        let mut found = vec![[0.0; AT_ONCE]; self.past.pixels()];
        let shadows = self.shadows(cell.viewpoint, Some(cell.surface));
        let mut pieces = Pieces::default();
        let hidden = self.past.hidden_from(cell);
        self.past.blocks.visit(&hidden, &mut |p, met| {
            let Some(met) = met else { return };
            for (patch, seen) in self.past.pixels[p].iter().zip(&self.seen[p]) {
                let (Some(wall), Some(corners)) = (patch.whole.surface, &patch.corners) else {
                    continue;
                };
                let figures = seen.iter().map(Vec::as_slice);
                let met = met.iter().map(|s| &shadows[*s]);
                if pieces.past(figures, corners, met) || !patch.open {
                    for piece in pieces.iter() {
                        add(&mut found[p], &self.seen_rate(piece, wall, cell));
                    }
                }
            }
        });
        found
    }

    /// Of what a piece of a wall sends to a cell.
    fn seen_rate(&self, piece: &[Moving], wall: ShapeId, cell: &HiddenCell) -> Rates {
        let scene = self.past.scene;
        let (area, middle, grown) = Moving::area_and_middle(piece);
        if area == 0.0 {
            return [0.0; AT_ONCE];
        }
        let point = wall_point::seen_piece(scene, wall, middle.at, area);
        std::array::from_fn(|k| {
            let rate = tangent::piece(scene, &point, middle.rate[k], grown[k] / area);
            point.towards_rate(scene, &rate, (&cell.point, &HiddenRate::default()))
        })
    }

    /// ∂ of [`Obstructed::laser`], past what is.
    pub(super) fn laser(&self, spot: usize, cells: &[HiddenCell]) -> Vec<Rates> {
        let mut found = vec![[0.0; AT_ONCE]; cells.len()];
        if self.past.scene.laser.is_shining() {
            return found;
        }
        let mut pieces = Pieces::default();
        for (wall, free) in &self.past.lit[spot] {
            if !free {
                continue;
            }
            let shadows = self.shadows(wall.position, wall.surface);
            for (rates, cell) in found.iter_mut().zip(cells) {
                let Some(corners) = &cell.corners else {
                    continue;
                };
                let whole: Vec<Moving> = corners.iter().copied().map(Moving::still).collect();
                if pieces.past([&*whole], corners, &shadows) {
                    let (whole, _) = area_and_middle(corners);
                    for piece in pieces.iter() {
                        add(rates, &self.lit_rate(piece, wall, cell, whole));
                    }
                }
            }
        }
        found
    }

    /// Of what arrives on a piece of a cell, which is `whole` large.
    fn lit_rate(&self, piece: &[Moving], wall: &WallPoint, cell: &HiddenCell, whole: f64) -> Rates {
        let scene = self.past.scene;
        let (area, middle, grown) = Moving::area_and_middle(piece);
        let point = HiddenPoint {
            position: middle.at,
            ..cell.point
        };
        let light = wall.towards(scene, Kernel::Physical, &point);
        std::array::from_fn(|k| {
            let twist = Twist {
                angular: DVec3::ZERO,
                linear: middle.rate[k],
            };
            let moved = wall.towards_rate(
                scene,
                &WallRate::default(),
                (&point, &HiddenRate::new(&point, &twist)),
            );
            (moved * area + light * grown[k]) * cell.area / whole
        })
    }
}

fn add(sum: &mut Rates, more: &Rates) {
    sum.iter_mut().zip(more).for_each(|(x, y)| *x += y);
}

#[cfg(test)]
mod tests;
