//! Meshes with fewer triangles, for display.
//!
//! Vertices are clustered (Rossignac and Borrel, 1993): a grid of cubic cells lies over the mesh,
//! all vertices of a cell become one at their mean, and triangles whose corners no longer lie in
//! three cells are dropped. Among grids the finest is taken that leaves no more triangles than
//! asked for. The outcome depends on the mesh alone.

use std::collections::BTreeSet;

use crate::geometry::{DVec3, Mesh};

/// The grid is at most so fine along the longest side of the box; numbers of cells fit into 21 bits
/// each.
const FINEST: u64 = 1 << 20;

/// A mesh for display.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Display {
    /// The vertices, in the mesh's own space.
    pub positions: Vec<DVec3>,
    /// Three vertices each.
    pub triangles: Vec<[u32; 3]>,
    /// Texture coordinates by triangle and corner, those of the triangle that is shown.
    pub uv: Option<Vec<[[f64; 2]; 3]>>,
    /// How many triangles the mesh itself has.
    pub whole: usize,
}

impl Display {
    /// The mesh with at most `most` triangles: itself where it has no more.
    pub(super) fn of(mesh: &Mesh, most: usize) -> Self {
        let triangles = mesh.triangles();
        let whole = triangles.len();
        if whole <= most {
            return Self {
                positions: mesh.positions().to_vec(),
                triangles: triangles.to_vec(),
                uv: mesh.uv().map(<[_]>::to_vec),
                whole,
            };
        }
        // The number of cells a side that leaves `most` triangles or fewer: bisection, for a finer
        // grid leaves more.
        let (mut coarse, mut fine) = (1, FINEST);
        while fine - coarse > 1 {
            let middle = coarse.midpoint(fine);
            if survivors(triangles, &cells(mesh, middle)).count() <= most {
                coarse = middle;
            } else {
                fine = middle;
            }
        }
        let cells = cells(mesh, coarse);
        let kept: Vec<usize> = distinct(triangles, &cells);
        let used: BTreeSet<u64> = kept
            .iter()
            .flat_map(|&t| triangles[t].map(|v| cells[v as usize]))
            .collect();
        let numbered: Vec<u64> = used.into_iter().collect();
        let number = |cell: u64| numbered.binary_search(&cell).ok();
        let mut sums = vec![(DVec3::ZERO, 0.0); numbered.len()];
        for (p, cell) in mesh.positions().iter().zip(&cells) {
            if let Some(i) = number(*cell) {
                sums[i].0 += *p;
                sums[i].1 += 1.0;
            }
        }
        let corner = |v: u32| number(cells[v as usize]).unwrap_or(0) as u32;
        Self {
            positions: sums.into_iter().map(|(sum, n)| sum / n).collect(),
            triangles: kept.iter().map(|&t| triangles[t].map(corner)).collect(),
            uv: mesh.uv().map(|uv| kept.iter().map(|&t| uv[t]).collect()),
            whole,
        }
    }
}

/// The cell of every vertex where n of them span the longest side of the box.
fn cells(mesh: &Mesh, n: u64) -> Vec<u64> {
    let (low, high) = mesh.bounds();
    let per_length = n as f64 / (high - low).max_element();
    let cell = |p: &DVec3| {
        let [x, y, z] = ((*p - low) * per_length)
            .to_array()
            .map(|x| (x as u64).min(n - 1));
        x << 42 | y << 21 | z
    };
    mesh.positions().iter().map(cell).collect()
}

/// The triangles whose corners lie in three cells.
fn survivors<'a>(
    triangles: &'a [[u32; 3]],
    cells: &'a [u64],
) -> impl Iterator<Item = (usize, [u64; 3])> + 'a {
    let placed = triangles
        .iter()
        .map(|t| t.map(|v| cells[v as usize]))
        .enumerate();
    placed.filter(|(_, [a, b, c])| a != b && b != c && c != a)
}

/// The survivors, the first of those alone that lie in the same cells with the same front.
fn distinct(triangles: &[[u32; 3]], cells: &[u64]) -> Vec<usize> {
    let mut told = BTreeSet::new();
    let fresh = |(_, [a, b, c]): &(usize, [u64; 3])| {
        let least = (*a).min(*b).min(*c);
        told.insert(match least {
            l if l == *a => [*a, *b, *c],
            l if l == *b => [*b, *c, *a],
            _ => [*c, *a, *b],
        })
    };
    survivors(triangles, cells)
        .filter(fresh)
        .map(|(t, _)| t)
        .collect()
}

/// How many triangles each mesh may show so that all together have at most `most`: small ones all
/// of theirs, the large ones even shares of what is left.
pub(super) fn shares(counts: &[usize], most: usize) -> Vec<usize> {
    let mut order: Vec<usize> = (0..counts.len()).collect();
    order.sort_by_key(|&i| (counts[i], i));
    let mut shares = vec![0; counts.len()];
    let mut left = most;
    for (done, &i) in order.iter().enumerate() {
        shares[i] = counts[i].min(left / (counts.len() - done));
        left -= shares[i];
    }
    shares
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sphere of radius 1 as a grid of 2·n² triangles.
    fn ball(n: u32) -> Mesh {
        let at = |i: u32, j: u32| {
            let (theta, phi) = (
                std::f64::consts::PI * f64::from(i) / f64::from(n),
                2.0 * std::f64::consts::PI * f64::from(j % n) / f64::from(n),
            );
            let ((s, c), (sin, cos)) = (libm::sincos(theta), libm::sincos(phi));
            DVec3::new(s * cos, s * sin, c)
        };
        let positions = (0..=n).flat_map(|i| (0..n).map(move |j| at(i, j)));
        let quads = (0..n).flat_map(|i| {
            (0..n).flat_map(move |j| {
                let [a, b] = [i * n + j, i * n + (j + 1) % n];
                [[a, a + n, b], [b, a + n, b + n]]
            })
        });
        Mesh::new(positions.collect(), quads.collect()).unwrap()
    }

    #[test]
    fn a_small_mesh_is_shown_as_it_is() {
        let mesh = ball(8);
        let shown = Display::of(&mesh, 128);
        assert_eq!(shown.positions, mesh.positions());
        assert_eq!(shown.triangles, mesh.triangles());
    }

    /// Every mean of points of a cell of side h lies within h·√3 of them, so the clustered sphere
    /// stays that near to radius 1; its area and the volume that its triangles enclose (by the
    /// divergence theorem: a check of their orientation) come near 4π and 4π/3.
    #[test]
    fn a_clustered_sphere_is_still_that_sphere() {
        let mesh = ball(200);
        let shown = Display::of(&mesh, 4000);
        assert!(
            (2000..=4000).contains(&shown.triangles.len()),
            "{}",
            shown.triangles.len()
        );
        assert_eq!(shown.whole, 80_000);
        assert_eq!(shown, Display::of(&mesh, 4000));
        let [mut area, mut volume] = [0.0; 2];
        for t in &shown.triangles {
            let [a, b, c] = t.map(|v| shown.positions[v as usize]);
            area += 0.5 * (b - a).cross(c - a).length();
            volume += a.dot(b.cross(c)) / 6.0;
        }
        let pi = std::f64::consts::PI;
        assert!((area / (4.0 * pi) - 1.0).abs() < 0.05, "{area}");
        assert!((volume / (4.0 / 3.0 * pi) - 1.0).abs() < 0.05, "{volume}");
        for p in &shown.positions {
            assert!(p.length() < 1.0 + 1e-12 && p.length() > 0.9, "{p}");
        }
    }

    #[test]
    fn texture_coordinates_stay_with_their_triangles() {
        let mesh = ball(60);
        let triangles = mesh.triangles().len();
        let uv = (0..triangles).map(|t| [0.0, 1.0, 2.0].map(|v| [t as f64, v]));
        let plain = Display::of(&mesh, 500);
        let shown = Display::of(&mesh.with_uv(uv.collect()).unwrap(), 500);
        let kept = shown.uv.unwrap();
        assert_eq!(kept.len(), shown.triangles.len());
        assert_eq!(shown.triangles, plain.triangles);
        assert!(kept.windows(2).all(|w| w[0][0][0] < w[1][0][0]));
    }

    #[test]
    fn large_meshes_share_what_small_ones_leave() {
        assert_eq!(
            shares(&[12, 1_000_000, 12, 500_000], 1000),
            [12, 488, 12, 488]
        );
        assert_eq!(shares(&[12, 30], 1000), [12, 30]);
        assert_eq!(shares(&[], 1000), [0; 0]);
    }
}
