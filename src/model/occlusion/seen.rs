//! The camera's side.

use super::{Both, Obstructed, free_share};
use crate::geometry::{Blockers, DVec3, Hidden, Pieces, area_and_middle};
use crate::matrix::Matrix;
use crate::model::cells::{HiddenCell, middles};
use crate::model::kernel::HiddenPoints;
use crate::model::patch::Patch;
use crate::model::wall_point::{self, WallPoint};

impl Obstructed<'_> {
    /// What each cell sends to each pixel, by its middle, past what hides the wall from its
    /// viewpoint: c_p.
    pub(in crate::model) fn camera(&self, cells: &[HiddenCell]) -> Vec<Vec<Both>> {
        let all = self.unobstructed(cells);
        let each = cells.iter().zip(all.row_iter());
        each.map(|(cell, all)| self.past(cell, all.iter().map(|all| [*all; 2]).collect()))
            .collect()
    }

    /// Takes what is hidden from `found`, all that a cell sends to each pixel.
    fn past(&self, cell: &HiddenCell, mut found: Vec<Both>) -> Vec<Both> {
        let hidden = self.hidden_from(cell);
        let mut pieces = Pieces::default();
        self.blocks.visit(&hidden, &mut |p, met| {
            found[p][1] = match met {
                None => 0.0,
                Some(met) => {
                    let each = self.pixels[p].iter();
                    each.map(|patch| self.seen_past(patch, (cell, &hidden), met, &mut pieces))
                        .sum()
                }
            }
        });
        found
    }

    /// What each cell sends to each pixel with nothing in the way, to the middles of its parts,
    /// cells × pixels.
    pub(in crate::model) fn unobstructed(&self, cells: &[HiddenCell]) -> Matrix {
        let middles = middles(cells);
        let parts = self.pixels.iter();
        let parts = parts.map(|patches| patches.iter().map(|patch| &patch.whole));
        let points = HiddenPoints::new(&middles);
        wall_point::sides((self.scene, self.kernel), &points, parts)
    }

    /// What hides the wall from the viewpoint of a cell.
    pub(in crate::model) fn hidden_from(&self, cell: &HiddenCell) -> Hidden {
        let own = Some(cell.surface);
        self.opaque.from(cell.viewpoint, own, self.scene.bvh())
    }

    /// What a patch of the wall sends past everything.
    fn seen_past(
        &self,
        patch: &Patch,
        (cell, hidden): (&HiddenCell, &Hidden),
        met: &[usize],
        pieces: &mut Pieces,
    ) -> f64 {
        let towards = |w: &WallPoint| w.towards(self.scene, self.kernel, &cell.point);
        let whole = towards(&patch.whole);
        let (Some(wall), true) = (patch.whole.surface, whole != 0.0) else {
            return 0.0;
        };
        let to = (cell.surface, cell.viewpoint);
        let Some(corners) = &patch.corners else {
            let open = patch.open && self.is_free(patch.whole.position, to, wall, &Blockers::Any);
            return if open { whole } else { 0.0 };
        };
        let asked = hidden.asked(corners, patch.unasked);
        let seen = patch.seen.iter().map(Vec::as_slice);
        let shadows = met.iter().map(|s| &hidden.shadows[*s]);
        if !pieces.past(seen, corners, shadows) && patch.open && asked.none() {
            return whole;
        }
        let light = |(area, middle): (f64, DVec3)| {
            if area > 0.0 {
                towards(&wall_point::seen_piece(
                    self.scene,
                    &patch.whole,
                    middle,
                    area,
                ))
            } else {
                0.0
            }
        };
        let on_wall = |middle| wall_point::on_wall(self.scene, &patch.whole, middle);
        let free = |middle| self.is_free(on_wall(middle), to, wall, &asked);
        let over = |piece| light(area_and_middle(piece)) * free_share(piece, &asked, light, free);
        pieces.iter().map(over).sum()
    }
}
