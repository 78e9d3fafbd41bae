//! The laser's side: what spots send to cells.

use super::{Rates, Sweep, add};
use crate::geometry::{AT_ONCE, DVec3, Moving, Pieces, area_and_middle};
use crate::model::beam::Lit;
use crate::model::cells::HiddenCell;
use crate::model::kernel::{HiddenPoint, Kernel};
use crate::model::tangent::{HiddenRate, WallRate};
use crate::model::wall_point::WallPoint;

impl Sweep<'_> {
    /// ∂ of [`Obstructed::laser`](crate::model::occlusion::Obstructed::laser), past what is.
    pub(in crate::model) fn laser(&self, spot: usize, cells: &[HiddenCell]) -> Vec<Rates> {
        let mut found = vec![[0.0; AT_ONCE]; cells.len()];
        let scene = self.past.scene;
        if scene.laser.is_shining() {
            return found;
        }
        self.across(spot, cells, &mut found);
        let mut pieces = Pieces::default();
        for (Lit { left: wall, .. }, rates) in self.past.lit[spot].iter().zip(&self.lit[spot]) {
            if wall.weight == 0.0 {
                continue;
            }
            let carried = rates.map(|rate| rate.position);
            let shadows = self.shadows((wall.position, carried), wall.surface);
            for (sum, cell) in found.iter_mut().zip(cells) {
                let Some(corners) = &cell.corners else {
                    continue;
                };
                let moving = |at: &DVec3| Moving {
                    at: *at,
                    rate: self.of(|k| self.twist(k, cell).at(*at) - carried[k]),
                };
                let whole: Vec<Moving> = corners.iter().map(moving).collect();
                if pieces.past([&*whole], corners, &shadows) {
                    let (whole, _) = area_and_middle(corners);
                    for piece in pieces.iter() {
                        add(sum, &self.lit_rate(piece, (wall, rates), cell, whole));
                    }
                } else if !self.is_still {
                    let moves = self.moves(cell);
                    let rate = |k: usize| {
                        let to = (&cell.point, &moves[k]);
                        wall.towards_rate(scene, &rates[k], to) * cell.area
                    };
                    add(sum, &self.of(rate));
                }
            }
        }
        found
    }

    /// Of what arrives on a piece of a cell, which is `whole` large, in the frame of where it comes
    /// from.
    fn lit_rate(
        &self,
        piece: &[Moving],
        (wall, rates): (&WallPoint, &[WallRate<'_>; AT_ONCE]),
        cell: &HiddenCell,
        whole: f64,
    ) -> Rates {
        let scene = self.past.scene;
        let (area, middle, grown) = Moving::area_and_middle(piece);
        let point = HiddenPoint {
            position: middle.at,
            ..cell.point
        };
        let light = wall.towards(scene, Kernel::Physical, &point);
        self.of(|k| {
            let moves = HiddenRate {
                position: middle.rate[k] + rates[k].position,
                ..HiddenRate::new(&point, self.twist(k, cell))
            };
            let moved = wall.towards_rate(scene, &rates[k], (&point, &moves));
            (moved * area + light * grown[k]) * cell.area / whole
        })
    }
}
