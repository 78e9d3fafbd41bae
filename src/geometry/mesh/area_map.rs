//! The equal-area map of the unit square to a mesh.

use crate::geometry::DVec3;
use crate::num::warp;

/// Triangles, or pieces of them, one after the other along u, each as wide as its share of the
/// area, ordered so that those near each other in u are near each other in space: by the Morton
/// code of their middles (Morton 1966), 21 bits a coordinate.
#[derive(Clone, Debug)]
pub(super) struct AreaMap {
    /// Triangles in order.
    pub(super) order: Vec<u32>,
    /// By triangle: its place in the order.
    place: Vec<u32>,
    /// By place: the area of all up to there, itself included.
    pub(super) sums: Vec<f64>,
}

impl AreaMap {
    /// For triangles of given area, and thrice their middles less the lower corner of the box
    /// around them, over its largest side.
    pub(super) fn new(areas: &[f64], middle: impl Fn(u32) -> DVec3) -> Self {
        Self::in_cells(areas, |i| (0, middle(i)))
    }

    /// The same, cell after cell: `place` gives the cell of each, and where it is.
    pub(super) fn in_cells(areas: &[f64], place: impl Fn(u32) -> (u32, DVec3)) -> Self {
        let code = |i: u32| {
            let (cell, middle) = place(i);
            let grid = (middle * (f64::from(1 << 21) / 3.0)).as_u64vec3();
            let [x, y, z] = grid.to_array().map(|c| spread(c.min((1 << 21) - 1)));
            (cell, x | y << 1 | z << 2)
        };
        let mut coded: Vec<((u32, u64), u32)> =
            (0..areas.len() as u32).map(|i| (code(i), i)).collect();
        coded.sort_unstable();
        let mut map = Self {
            order: Vec::with_capacity(areas.len()),
            place: vec![0; areas.len()],
            sums: Vec::with_capacity(areas.len()),
        };
        let mut sum = 0.0;
        for (place, (_, triangle)) in (0..).zip(coded) {
            sum += areas[triangle as usize];
            map.order.push(triangle);
            map.place[triangle as usize] = place;
            map.sums.push(sum);
        }
        map
    }

    /// Of all triangles.
    pub(super) fn area(&self) -> f64 {
        self.sums[self.sums.len() - 1]
    }

    pub(super) fn before(&self, place: usize) -> f64 {
        place.checked_sub(1).map_or(0.0, |k| self.sums[k])
    }

    /// The place in the order at u, and how much of its triangle is before it.
    fn at(&self, u: f64) -> (usize, f64) {
        let target = u.clamp(0.0, 1.0 - f64::EPSILON) * self.area();
        let place = self.sums.partition_point(|a| *a <= target);
        let place = place.min(self.sums.len() - 1);
        let before = self.before(place);
        let own = self.sums[place] - before;
        (place, ((target - before) / own).clamp(0.0, 1.0))
    }

    /// The triangle at u, v, and the weights of its second and third corner.
    pub(super) fn point(&self, [u, v]: [f64; 2]) -> (u32, [f64; 2]) {
        let (place, rest) = self.at(u);
        (self.order[place], warp::triangle([rest, v]))
    }

    /// Where the map takes the point of a triangle with these weights from.
    pub(super) fn inverse(&self, triangle: u32, weights: [f64; 2]) -> [f64; 2] {
        let place = self.place[triangle as usize] as usize;
        let before = self.before(place);
        let [rest, along] = warp::triangle_inverse(weights);
        let own = self.sums[place] - before;
        [(before + rest * own) / self.area(), along]
    }

    /// Edges of parts along u: each triangle in about `parts` times its share of the area, and in
    /// at least `least`.
    pub(super) fn edges(&self, parts: usize, least: usize) -> Vec<f64> {
        let (all, mut edges) = (self.area(), vec![0.0]);
        for (place, sum) in self.sums.iter().enumerate() {
            let before = self.before(place);
            let own = sum - before;
            if own > 0.0 {
                let count = ((own / all * parts as f64).ceil() as usize).max(least);
                let edge = |k: usize| (before + own * k as f64 / count as f64) / all;
                edges.extend((1..=count).map(edge));
            }
        }
        edges
    }

    /// Points whose convex hull holds what lies between `low` and `high`: triangles, with the
    /// weights of their second and third corner.
    pub(super) fn hull(
        &self,
        low: [f64; 2],
        high: [f64; 2],
    ) -> impl Iterator<Item = (u32, [f64; 2])> {
        let [(first, from), (last, to)] = [low[0], high[0]].map(|u| self.at(u));
        (first..=last).flat_map(move |place| {
            let rest = [
                if place == first { from } else { 0.0 },
                if place == last { to } else { 1.0 },
            ];
            let triangle = self.order[place];
            let corners = rest.map(|r| [low[1], high[1]].map(|v| warp::triangle([r, v])));
            corners.into_iter().flatten().map(move |w| (triangle, w))
        })
    }
}

/// The 21 lowest bits, two zeros after each.
fn spread(x: u64) -> u64 {
    let steps = [
        (32, 0x001f_0000_0000_ffff),
        (16, 0x001f_0000_ff00_00ff),
        (8, 0x100f_00f0_0f00_f00f),
        (4, 0x10c3_0c30_c30c_30c3),
        (2, 0x1249_2492_4924_9249),
    ];
    let join = |x: u64, (by, mask): (u32, u64)| (x | x << by) & mask;
    steps.into_iter().fold(x, join)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_are_spread() {
        for k in 0..21 {
            assert_eq!(spread(1 << k), 1 << (3 * k));
        }
        assert_eq!(spread((1 << 21) - 1).count_ones(), 21);
    }

    /// A row of triangles given in a mixed order comes out in order, and every point returns.
    #[test]
    fn neighbours_in_space_are_neighbours_along_u() {
        let shuffled = [5, 2, 7, 0, 3, 6, 1, 4];
        let areas = shuffled.map(|k| 1.0 + f64::from(k));
        let middle = |i: u32| DVec3::X * 3.0 * (f64::from(shuffled[i as usize]) + 0.5) / 8.0;
        let map = AreaMap::new(&areas, middle);
        let n = 1000;
        let mut last = 0;
        for k in 0..n {
            let uv = [(f64::from(k) + 0.5) / f64::from(n), 0.3];
            let (triangle, weights) = map.point(uv);
            let now = shuffled[triangle as usize];
            assert!(now >= last);
            last = now;
            let back = map.inverse(triangle, weights);
            assert!((back[0] - uv[0]).abs() < 1e-12 && (back[1] - uv[1]).abs() < 1e-12);
        }
        assert_eq!(map.area(), 36.0);
    }
}
