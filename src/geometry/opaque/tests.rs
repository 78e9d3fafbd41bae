use super::*;
use crate::geometry::{Disc, Parallelogram, Pieces, Ray, area_and_middle};

/// The share of a unit square at z = 0 that stays in sight is that of rays.
#[test]
fn pieces_in_sight_are_what_rays_see() {
    let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let square: Polygon = square
        .iter()
        .map(|[x, y]| DVec3::new(*x, *y, 0.0))
        .collect();
    let from = DVec3::new(0.3, 0.9, 3.0);
    let at = |x, y, z| DVec3::new(x, y, z);
    let plate =
        |c: DVec3, u: DVec3, v: DVec3| Shape::Parallelogram(Parallelogram::new(c, u, v).unwrap());
    let shapes = vec![
        plate(at(0.2, 0.5, 1.0), at(0.3, 0.1, 0.2), at(0.0, 0.4, -0.1)),
        plate(at(0.1, 0.6, 2.0), at(0.2, 0.0, 0.5), at(0.0, 0.1, 0.9)),
        Shape::Sphere(Sphere::new(at(0.6, 0.3, 0.8), 0.2, Facing::Outside).unwrap()),
        Shape::Disc(Disc::new(at(0.7, 0.8, 0.5), at(0.1, 0.3, 1.0), 0.15).unwrap()),
    ];
    for which in [vec![0], vec![1], vec![2], vec![3], vec![0, 1, 2, 3]] {
        let bvh = Bvh::new(shapes.clone()).unwrap();
        let opaque = Opaque::new(&bvh, |id| which.contains(&id));
        let hidden = opaque.from(from, None, &bvh);
        let mut left = Pieces::default();
        left.past([&*square], &square, &hidden.shadows);
        let area: f64 = left.iter().map(|p| area_and_middle(p).0).sum();
        let n = 1000;
        let free = |i: usize| {
            let to = at((i % n) as f64 + 0.5, (i / n) as f64 + 0.5, 0.0) / n as f64;
            let blockers = Blockers::Among(which.clone());
            !bvh.blocked_by(&blockers, &Ray::between(from, to).unwrap(), [None; 2])
        };
        let seen = (0..n * n).filter(|i| free(*i)).count() as f64 / (n * n) as f64;
        assert!((area - seen).abs() < 2e-3, "{which:?}: {area} for {seen}");
    }
}
