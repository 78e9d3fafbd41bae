//! Triangles cut into pieces along a grid in their texture coordinates.
//!
//! Texture coordinates are affine over a triangle, so that an edge of the grid cuts it along a
//! straight line, and a piece's share of the area is the same in the picture and in space.

use super::texture::{Texture, Wrap};
use crate::geometry::{DVec3, Facet, Instance};

/// A corner of a piece: its place in the picture, and its weights in the triangle.
pub(super) type Corner = ([f64; 2], DVec3);

/// What a triangle has in one cell of a grid: a convex polygon.
pub(super) struct Piece {
    /// Cell iu + iv·nu.
    pub cell: usize,
    /// How often the picture was repeated up to there, along u and v; 0 where it does not repeat.
    pub tile: [i64; 2],
    pub corners: Vec<Corner>,
}

/// A grid of cells on \[0, 1\]², and what lies outside: its repetition, or its border's cells.
#[derive(Clone, Copy)]
pub(super) struct Grid {
    pub count: [usize; 2],
    pub wrap: Wrap,
}

impl Grid {
    /// The cells within which a texture is smooth.
    pub(super) fn of_texture(texture: &Texture) -> Self {
        Self {
            count: texture.smooth_cells(),
            wrap: texture.wrap(),
        }
    }

    /// Columns (0) or rows (1) that numbers from `low` to `high` cover. Without repetition −1 and n
    /// are what lies outside. On an edge the higher one counts.
    fn covered(&self, d: usize, low: f64, high: f64) -> [i64; 2] {
        let n = self.count[d] as f64;
        let (first, last) = ((low * n).floor(), (high * n).ceil() - 1.0);
        let (first, last) = match self.wrap {
            Wrap::Repeat => (first, last),
            Wrap::Clamp => (first.clamp(-1.0, n), last.clamp(-1.0, n)),
        };
        [first as i64, last.max(first) as i64]
    }

    /// About how many pieces a polygon of these places is cut into, at most.
    pub(super) fn pieces(&self, places: &[[f64; 2]]) -> f64 {
        let count = |d: usize| {
            let [first, last] = self.range(d, places.iter().copied());
            (last - first + 1) as f64
        };
        count(0) * count(1)
    }

    fn range(&self, d: usize, places: impl Iterator<Item = [f64; 2]>) -> [i64; 2] {
        let ends = (f64::INFINITY, f64::NEG_INFINITY);
        let (low, high) = places.fold(ends, |(l, h), p| (l.min(p[d]), h.max(p[d])));
        self.covered(d, low, high)
    }

    /// A convex polygon in pieces, row by row.
    pub(super) fn cut(&self, polygon: Vec<Corner>) -> Vec<Piece> {
        let mut found = Vec::new();
        for (row, strip) in self.strips(1, polygon) {
            for (column, corners) in self.strips(0, strip) {
                let ([i, s], [j, t]) = (self.place(0, column), self.place(1, row));
                let cell = i as usize + j as usize * self.count[0];
                let tile = [s, t];
                found.push(Piece {
                    cell,
                    tile,
                    corners,
                });
            }
        }
        found
    }

    /// A polygon divided into columns (0) or rows (1).
    fn strips(&self, d: usize, mut rest: Vec<Corner>) -> Vec<(i64, Vec<Corner>)> {
        let [first, last] = self.range(d, rest.iter().map(|c| c.0));
        let mut found = Vec::new();
        for k in first..last {
            let (below, above) = split(&rest, d, (k + 1) as f64 / self.count[d] as f64);
            found.push((k, below));
            rest = above;
        }
        found.push((last, rest));
        found.retain(|(_, strip)| strip.len() > 2);
        found
    }

    /// The cell of a column or a row, and its tile.
    fn place(&self, d: usize, k: i64) -> [i64; 2] {
        let n = self.count[d] as i64;
        match self.wrap {
            Wrap::Repeat => [k.rem_euclid(n), k.div_euclid(n)],
            Wrap::Clamp => [k.clamp(0, n - 1), 0],
        }
    }
}

/// All of a triangle with these texture coordinates.
pub(super) fn whole(uv: [[f64; 2]; 3]) -> Vec<Corner> {
    let weights = [DVec3::X, DVec3::Y, DVec3::Z];
    uv.into_iter().zip(weights).collect()
}

/// The parts of a convex polygon where x_d ≤ at and where x_d ≥ at (Sutherland and Hodgman, 1974).
fn split(polygon: &[Corner], d: usize, at: f64) -> (Vec<Corner>, Vec<Corner>) {
    let (mut below, mut above) = (Vec::new(), Vec::new());
    for (i, from) in polygon.iter().enumerate() {
        let to = &polygon[(i + 1) % polygon.len()];
        let (a, b) = (from.0[d] - at, to.0[d] - at);
        if a <= 0.0 {
            below.push(*from);
        }
        if a >= 0.0 {
            above.push(*from);
        }
        if (a > 0.0 && b < 0.0) || (a < 0.0 && b > 0.0) {
            let t = a / (a - b);
            let mut place = [0, 1].map(|k| from.0[k] + (to.0[k] - from.0[k]) * t);
            place[d] = at;
            let corner = (place, from.1 + (to.1 - from.1) * t);
            below.push(corner);
            above.push(corner);
        }
    }
    (below, above)
}

/// The triangles of a convex polygon, from its first corner.
pub(super) fn fan(polygon: &[Corner]) -> impl Iterator<Item = [Corner; 3]> {
    let pairs = polygon.get(1..).unwrap_or_default().windows(2);
    pairs.map(|pair| [polygon[0], pair[0], pair[1]])
}

/// Which share of its triangle's area three corners enclose: twice the area of their weights.
pub(super) fn share([a, b, c]: &[Corner; 3]) -> f64 {
    let [p, q] = [b.1 - a.1, c.1 - a.1];
    (p.y * q.z - p.z * q.y).abs()
}

/// A polygon's share of its triangle's area, and the weights of its centroid times that.
pub(super) fn share_and_moment(polygon: &[Corner]) -> (f64, DVec3) {
    fan(polygon).fold((0.0, DVec3::ZERO), |(all, moment), part| {
        let share = share(&part);
        let middle = (part[0].1 + part[1].1 + part[2].1) / 3.0;
        (all + share, moment + middle * share)
    })
}

/// A polygon's area in the picture.
pub(super) fn extent(polygon: &[Corner]) -> f64 {
    let area = |[a, b, c]: [Corner; 3]| {
        let [p, q] = [b, c].map(|x| [x.0[0] - a.0[0], x.0[1] - a.0[1]]);
        0.5 * (p[0] * q[1] - p[1] * q[0]).abs()
    };
    fan(polygon).map(area).sum()
}

/// ∫ρ over a polygon, in units of its triangle's area: exact. In each smooth cell ρ is constant or
/// of second order at most, for which the middles of the sides of a triangle are enough.
pub(super) fn albedo(texture: &Texture, polygon: Vec<Corner>) -> f64 {
    if let Texture::Constant(rho) = texture {
        return rho * share_and_moment(&polygon).0;
    }
    let pieces = Grid::of_texture(texture).cut(polygon);
    pieces.iter().map(|piece| of_piece(texture, piece)).sum()
}

fn of_piece(texture: &Texture, piece: &Piece) -> f64 {
    match texture {
        Texture::Constant(_) | Texture::Cells(_) | Texture::Tiles(_) => {
            texture.cell_mean(piece.cell) * share_and_moment(&piece.corners).0
        }
        Texture::Ramp(_) | Texture::Bilinear(_) => {
            let middle =
                |p: Corner, q: Corner| texture.albedo([0, 1].map(|k| 0.5 * (p.0[k] + q.0[k])));
            let parts = fan(&piece.corners);
            let parts = parts.map(|part| {
                let [a, b, c] = part;
                share(&part) * (middle(a, b) + middle(b, c) + middle(c, a)) / 3.0
            });
            parts.sum()
        }
    }
}

/// Facets of one mesh; one that would have more is not cut.
const MOST_FACETS: usize = 1 << 20;

/// Bytes that a facet takes while a mesh is cut into facets, upper bound.
const FACET: f64 = 256.0;

/// Bytes that cutting a mesh into [`facets`] takes at most.
pub(super) fn facets_need(body: &Instance, texture: &Texture) -> f64 {
    let Some(uv) = body.mesh().uv().filter(|uv| uv.len() <= MOST_FACETS) else {
        return 0.0;
    };
    if matches!(texture, Texture::Constant(_)) || body.is_exact_patch() {
        return 0.0;
    }
    let grid = Grid::of_texture(texture);
    let pieces: f64 = uv.iter().map(|uv| 2.0 * grid.pieces(uv)).sum();
    FACET * pieces.min(2.0 * MOST_FACETS as f64)
}

/// A mesh's triangles cut along the edges of its texture, so that each part is smooth; `None` where
/// nothing is cut and all is one cell, where the mesh is a patch with cells of its own, or where
/// there would be too many.
pub(super) fn facets(body: &Instance, texture: &Texture) -> Option<Vec<Facet>> {
    let uv = body.mesh().uv()?;
    let is_smooth = matches!(texture, Texture::Constant(_));
    if is_smooth || body.is_exact_patch() || uv.len() > MOST_FACETS {
        return None;
    }
    let grid = Grid::of_texture(texture);
    let mut found = Vec::with_capacity(uv.len());
    for (t, uv) in uv.iter().enumerate() {
        if found.len() as f64 + grid.pieces(uv) > 2.0 * MOST_FACETS as f64 {
            return None;
        }
        for piece in grid.cut(whole(*uv)) {
            let parts = fan(&piece.corners).filter(|part| share(part) > 0.0);
            found.extend(parts.map(|part| Facet {
                triangle: t as u32,
                corners: part.map(|(_, weights)| [weights.y, weights.z]),
                cell: piece.cell as u32,
            }));
        }
        if found.len() > MOST_FACETS {
            return None;
        }
    }
    let is_one = found.len() == uv.len() && found.iter().all(|f| f.cell == found[0].cell);
    (!is_one).then_some(found)
}

/// Whether each triangle of a mesh lies in one cell of its texture.
pub(super) fn are_whole(body: &Instance, texture: &Texture) -> bool {
    let grid = Grid::of_texture(texture);
    let uv = body.mesh().uv().unwrap_or_default();
    uv.iter().all(|uv| grid.pieces(uv) <= 1.0)
}

/// The mean albedo over the area of a mesh.
pub(super) fn mean_albedo(body: &Instance, texture: &Texture) -> f64 {
    let Some(uv) = body.mesh().uv() else {
        return texture.albedo([0.0; 2]);
    };
    let light = |(t, uv): (usize, &[[f64; 2]; 3])| {
        body.triangle_area(t as u32) * albedo(texture, whole(*uv))
    };
    uv.iter().enumerate().map(light).sum::<f64>() / body.area()
}

#[cfg(test)]
mod tests;
