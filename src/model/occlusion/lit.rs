//! The laser's side.

use super::{Both, Obstructed, free_share};
use crate::geometry::{Blockers, DVec3, Hidden, Pieces, area_and_middle};
use crate::model::beam::Lit;
use crate::model::cells::HiddenCell;
use crate::model::cut::exitance;
use crate::model::kernel::HiddenPoint;
use crate::model::wall_point::WallPoint;

impl Obstructed<'_> {
    /// What arrives of spot `spot` on each of the cells: d_l times the cell's area/π.
    pub(in crate::model) fn laser(&self, spot: usize, cells: &[HiddenCell]) -> Vec<Both> {
        let each = self.laser_and_viewpoints(spot, cells).into_iter();
        each.map(|[all, left, _]| [all, left]).collect()
    }

    /// The same, and what arrived if each lit point saw all of a cell or nothing, as it sees its
    /// viewpoint.
    pub(in crate::model) fn laser_and_viewpoints(
        &self,
        spot: usize,
        cells: &[HiddenCell],
    ) -> Vec<[f64; 3]> {
        if self.scene.laser.is_shining() {
            let shines = |c: &HiddenCell| exitance(self.scene, spot, c.point.position);
            let light = |c: &HiddenCell| [shines(c).unwrap_or(0.0) * c.area; 3];
            return cells.iter().map(light).collect();
        }
        let mut found = vec![[0.0; 3]; cells.len()];
        for lit in &self.lit[spot] {
            self.add_lit(lit, cells, &mut found);
        }
        found
    }

    /// Adds to these what a part of a spot sends to each of the cells.
    fn add_lit(&self, lit: &Lit, cells: &[HiddenCell], found: &mut [[f64; 3]]) {
        let mut pieces = Pieces::default();
        let bvh = self.scene.bvh();
        let Lit { whole, left } = lit;
        let is_whole = whole == left;
        let hidden = self.opaque.from(left.position, left.surface, bvh);
        for (sums, cell) in found.iter_mut().zip(cells) {
            let sent = |w: &WallPoint| w.towards(self.scene, self.kernel, &cell.point) * cell.area;
            let all = sent(whole);
            sums[0] += all;
            let arriving = if is_whole { all } else { sent(left) };
            if arriving != 0.0 {
                let [past, at_viewpoint] =
                    self.lit_past(left, &hidden, cell, arriving, &mut pieces);
                sums[1] += past;
                sums[2] += at_viewpoint;
            }
        }
    }

    /// What a point of the wall, if it is lit, sends to each of the cells past everything.
    pub(in crate::model) fn lit_by(&self, wall: &WallPoint, cells: &[HiddenCell]) -> Vec<f64> {
        let mut found = vec![[0.0; 3]; cells.len()];
        self.add_lit(&Lit::free(*wall), cells, &mut found);
        found.iter().map(|[_, left, _]| *left).collect()
    }

    /// What of `all` arrives on a cell past everything, and what did if its viewpoint stood for it.
    fn lit_past(
        &self,
        wall: &WallPoint,
        hidden: &Hidden,
        cell: &HiddenCell,
        all: f64,
        pieces: &mut Pieces,
    ) -> [f64; 2] {
        let Some(id) = wall.surface else {
            return [0.0; 2];
        };
        let is_free =
            |to, blockers: &Blockers| self.is_free(wall.position, (cell.surface, to), id, blockers);
        let Some(corners) = &cell.corners else {
            let free = is_free(cell.point.position, &Blockers::Any);
            return if free { [all; 2] } else { [0.0; 2] };
        };
        let asked = hidden.asked(corners, None);
        if !pieces.past([&**corners], corners, &hidden.shadows) && asked.none() {
            return [all; 2];
        }
        let (whole, _) = area_and_middle(corners);
        let light = |(area, middle): (f64, DVec3)| {
            let point = HiddenPoint {
                position: middle,
                ..cell.point
            };
            wall.towards(self.scene, self.kernel, &point) * cell.area * (area / whole)
        };
        let free = |middle| is_free(middle, &asked);
        let over = |piece| light(area_and_middle(piece)) * free_share(piece, &asked, light, free);
        let left = pieces.iter().map(over).sum();
        let mut shadows = hidden.shadows.iter();
        let dark = shadows.any(|s| s.covers_box(cell.viewpoint, DVec3::ZERO));
        let at_viewpoint = if dark || !free(cell.viewpoint) {
            0.0
        } else {
            all
        };
        [left, at_viewpoint]
    }
}
