//! Pieces are shares of their triangle, and lie in their cells.

use super::*;

/// Shares add up to 1 and their middles to the triangle's; a right triangle over a 2 × 2 grid
/// covers two cells of it by half a cell, one whole, one not at all.
#[test]
fn shares_of_a_triangle_are_its_parts() {
    let shares = |uv: [[f64; 2]; 3], count: [usize; 2], wrap: Wrap| -> Vec<(usize, f64, DVec3)> {
        let pieces = Grid { count, wrap }.cut(whole(uv)).into_iter();
        let each = pieces.map(|p| (p.cell, share_and_moment(&p.corners)));
        each.map(|(cell, (share, moment))| (cell, share, moment))
            .collect()
    };
    let half = shares([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]], [2, 2], Wrap::Clamp);
    let share = |cell| half.iter().find(|s| s.0 == cell).map_or(0.0, |s| s.1);
    for (cell, part) in [(0, 0.5), (1, 0.25), (2, 0.25), (3, 0.0)] {
        assert!(
            (share(cell) - part).abs() < 1e-15,
            "{cell}: {}",
            share(cell)
        );
    }
    for grid in [[1, 1], [3, 2], [7, 5], [64, 64]] {
        for wrap in [Wrap::Clamp, Wrap::Repeat] {
            for uv in [
                [[0.1, 0.2], [0.9, 0.3], [0.4, 0.95]],
                [[0.0, 0.0], [1.0, 1.0], [1.0, 0.0]],
                [[1.2, 3.1], [1.7, 3.4], [1.3, 3.9]],
                [[-0.7, -2.1], [1.7, 0.4], [0.3, 1.9]],
                // Along a line, and in one point.
                [[0.1, 0.2], [0.3, 0.6], [0.4, 0.8]],
                [[0.5, 0.5]; 3],
            ] {
                let parts = shares(uv, grid, wrap);
                let total: f64 = parts.iter().map(|p| p.1).sum();
                let middle: DVec3 = parts.iter().map(|p| p.2).sum();
                assert!((total - 1.0).abs() < 1e-12, "{grid:?} {uv:?}: {total}");
                assert!((middle - DVec3::splat(1.0 / 3.0)).length() < 1e-12);
                assert!(parts.iter().all(|p| p.0 < grid[0] * grid[1]));
            }
        }
    }
}

/// A row of three tiles, the middle of the last at u = 2.5: the half of it above ⅔ belongs to
/// cell 2 of 3; held to the border everything beyond 1 belongs to the last.
#[test]
fn cells_beyond_the_picture_repeat_or_are_the_border() {
    let uv = [[0.0, 0.0], [3.0, 0.0], [3.0, 1.0]];
    let grid = |wrap| Grid {
        count: [3, 1],
        wrap,
    };
    let sums = |wrap| {
        let mut sums = [0.0; 3];
        for piece in grid(wrap).cut(whole(uv)) {
            sums[piece.cell] += share_and_moment(&piece.corners).0;
        }
        sums
    };
    // Up to u the triangle has (u/3)² of its area.
    let upto = |u: f64| u * u / 9.0;
    let between = |a: f64, b: f64| upto(b) - upto(a);
    let third =
        |k: f64| [0.0, 1.0, 2.0].map(|tile| between(tile + k / 3.0, tile + (k + 1.0) / 3.0));
    for (cell, sum) in sums(Wrap::Repeat).into_iter().enumerate() {
        let expected: f64 = third(cell as f64).iter().sum();
        assert!((sum - expected).abs() < 1e-14, "{cell}: {sum}, {expected}");
    }
    let [a, b, c] = sums(Wrap::Clamp);
    let expected = [
        upto(1.0 / 3.0),
        between(1.0 / 3.0, 2.0 / 3.0),
        between(2.0 / 3.0, 3.0),
    ];
    for (sum, expected) in [a, b, c].into_iter().zip(expected) {
        assert!((sum - expected).abs() < 1e-14, "{sum}, {expected}");
    }
}

/// A box shows the whole picture on each of its six sides: every cell has its share of the
/// area, the equal-area map takes the cells one after the other, and every point returns.
#[test]
fn facets_of_a_box_lie_in_their_cells() {
    let bench = crate::scene::Scene::load("bench").unwrap().text;
    let own = "[[surface]]\nname = \"box\"\nrole = \"occluder\"\n\
        material = { lambertian = { checkerboard = [7, 6], dark = 0.1, light = 0.5 } }\n\
        mesh = { generate = \"box\", scale = 2, translate = [20, 3, 1] }\n";
    let scene = crate::scene::Scene::from_toml("box", &(bench + own)).unwrap();
    let surface = &scene.surfaces[2];
    let crate::geometry::Shape::Instance(body) = &surface.shape else {
        panic!("a box is a mesh")
    };
    let facets = body.facets().unwrap();
    let edges = facets.edges();
    assert_eq!((facets.cells().len(), edges.len()), (42, 43));
    let share: f64 = facets
        .all()
        .iter()
        .map(|f| {
            let [a, b, c] = body.facet_corners(f);
            0.5 * (b - a).cross(c - a).length()
        })
        .sum();
    assert!((share - 24.0).abs() < 1e-12, "{share}");
    for (k, pair) in edges.windows(2).enumerate() {
        assert!((pair[1] - pair[0] - 1.0 / 42.0).abs() < 1e-14);
        for i in 0..40 {
            let at = |step: f64| (0.4637 + f64::from(i) * step).fract();
            let place = [pair[0] + (pair[1] - pair[0]) * at(0.618_034), at(0.754_878)];
            let point = body.at(place);
            let cell = [7.0, 6.0]
                .iter()
                .zip(point.uv)
                .map(|(n, x)| (n * x) as usize);
            let cell: Vec<usize> = cell.collect();
            assert_eq!(cell[0] + 7 * cell[1], facets.cells()[k] as usize);
            let ray = crate::geometry::Ray::new(point.position + point.normal, -point.normal);
            let hit = body.intersect(&ray).unwrap();
            let back = body.parameters(hit.triangle, point.position);
            let apart = [0, 1].map(|d| (back[d] - place[d]).abs());
            assert!(apart[0].max(apart[1]) < 1e-9, "{place:?}, {back:?}");
        }
    }
    let checks = |cell: usize| {
        if (cell % 7 + cell / 7).is_multiple_of(2) {
            0.1
        } else {
            0.5
        }
    };
    for k in 0..42 {
        assert_eq!(surface.cell_weight(k), checks(facets.cells()[k] as usize));
    }
    assert!((surface.mean_albedo() - 0.3).abs() < 1e-14);
}
