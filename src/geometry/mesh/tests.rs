use super::*;
use crate::geometry::Ray;
use crate::num::stream::{Key, Sampling, Stream};

fn numbers() -> impl FnMut() -> f64 {
    let key = Key {
        seed: 11,
        spot: 0,
        pixel: 0,
        block: 0,
    };
    let mut stream = Stream::new(Sampling::Pcg, key);
    move || stream.uniform()
}

/// A bumpy ball around the origin: a cube of 6·n² squares blown up to radius `scale`; without bumps
/// for `bump` = 0. Fronts outside.
fn ball(n: u32, bump: f64, scale: f64) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for face in 0..6 {
        let first = positions.len() as u32;
        let turned = face % 2 == 1;
        for i in 0..=n {
            for j in 0..=n {
                let at = |k: u32| 2.0 * f64::from(k) / f64::from(n) - 1.0;
                let mut p = [0.0; 3];
                p[face / 2] = if turned { -1.0 } else { 1.0 };
                (p[(face / 2 + 1) % 3], p[(face / 2 + 2) % 3]) = (at(i), at(j));
                let p = DVec3::from_array(p).normalize();
                let bumps = (9.0 * p.x).sin() * (7.0 * p.y).sin() * (8.0 * p.z).cos();
                positions.push(p * (1.0 + bump * bumps) * scale);
            }
        }
        for i in 0..n {
            for j in 0..n {
                let [a, b] = [first + i * (n + 1) + j, first + (i + 1) * (n + 1) + j];
                for [p, q, r] in [[a, b, b + 1], [a, b + 1, a + 1]] {
                    triangles.push(if turned { [p, r, q] } else { [p, q, r] });
                }
            }
        }
    }
    (positions, triangles)
}

fn direction(x: &mut impl FnMut() -> f64) -> DVec3 {
    DVec3::new(x() - 0.5, x() - 0.5, x() - 0.5).normalize()
}

/// Every distance at which the ray meets a triangle, by Cramer's rule (Möller and Trumbore, 1997),
/// with how near to an edge it passes.
fn all_hits(mesh: &Mesh, ray: &Ray) -> Vec<(f64, u32, f64)> {
    let hit = |i: u32| {
        let [a, b, c] = mesh.corners(i);
        let (e, f, o) = (b - a, c - a, ray.origin - a);
        let p = ray.direction.cross(f);
        let determinant = e.dot(p);
        let q = o.cross(e);
        let [v, w, t] = [o.dot(p), ray.direction.dot(q), f.dot(q)].map(|x| x / determinant);
        (t, i, v.min(w).min(1.0 - v - w))
    };
    let count = mesh.triangles().len() as u32;
    (0..count)
        .map(hit)
        .filter(|(t, _, edge)| *edge > -1e-9 && *t > 0.0 && *t < ray.length)
        .collect()
}

/// Tree and batch against every triangle one by one: from inside, along axes, from far away, at
/// three scales.
#[test]
fn the_tree_answers_as_the_list_does() {
    for scale in [1e-3, 1.0, 1e4] {
        let (positions, triangles) = ball(12, 0.2, scale);
        let mesh = Mesh::new(positions, triangles).unwrap();
        let mut x = numbers();
        let rays: Vec<Ray> = (0..4000)
            .map(|i| {
                let start = (DVec3::new(x(), x(), x()) - 0.5) * 2.6 * scale;
                let mut d = direction(&mut x);
                if i % 5 == 0 {
                    d = DVec3::new(0.0, if i % 10 == 0 { 1e-9 } else { 0.0 }, d.z).normalize();
                }
                let away = if i % 4 == 0 { 1e5 * scale } else { 0.0 };
                let length = if i % 3 == 0 {
                    f64::INFINITY
                } else {
                    away + 2.0 * scale * x()
                };
                Ray {
                    origin: start - d * away,
                    direction: d,
                    length,
                }
            })
            .collect();
        let (closest, blocked) = (mesh.closest_many(&rays), mesh.blocks_many(&rays));
        let mut met = 0;
        for (i, ray) in rays.iter().enumerate() {
            let hits = all_hits(&mesh, ray);
            if hits.iter().any(|(.., edge)| *edge < 1e-6) {
                continue;
            }
            let first = hits
                .into_iter()
                .reduce(|a, b| if b.0 < a.0 { b } else { a });
            let found = closest[i];
            assert_eq!(found.map(|h| h.triangle), first.map(|f| f.1), "ray {i}");
            assert_eq!(blocked[i], first.is_some(), "segment {i}");
            if let (Some(found), Some(first)) = (found, first) {
                assert!(
                    (found.t - first.0).abs() < 1e-11 * (first.0 + scale),
                    "ray {i}"
                );
                met += 1;
            }
            if i < 100 {
                assert_eq!(mesh.closest(ray), found);
                assert_eq!(mesh.blocks(ray), blocked[i]);
            }
        }
        assert!(met > 1000, "{met}");
    }
}

/// From inside a closed surface every ray meets it, those towards its vertices and the middles of
/// its edges included.
#[test]
fn a_closed_surface_does_not_leak() {
    let (positions, triangles) = ball(20, 0.1, 3.7);
    let mesh = Mesh::new(positions, triangles).unwrap();
    let mut x = numbers();
    let mut rays = Vec::new();
    for triangle in mesh.triangles() {
        let [a, b, _] = triangle.map(|c| mesh.positions()[c as usize]);
        for _ in 0..10 {
            let origin = (DVec3::new(x(), x(), x()) - 0.5) * 0.8;
            for target in [a, (a + b) * 0.5, a + (b - a) * x()] {
                rays.push(Ray::new(origin, (target - origin).normalize()));
            }
        }
    }
    let leaks = mesh
        .closest_many(&rays)
        .iter()
        .filter(|h| h.is_none())
        .count();
    assert_eq!(leaks, 0, "of {}", rays.len());
    assert!(mesh.blocks_many(&rays).iter().all(|b| *b));
}

/// Rays straight through the vertices, edges and diagonals of a grid of exact coordinates,
/// whichever way its triangles turn.
#[test]
fn what_belongs_to_two_triangles_is_met() {
    for turned in [false, true] {
        let at = |i: u32, j: u32| DVec3::new(f64::from(i), f64::from(j), 0.0) * 0.25;
        let positions = (0..81).map(|k| at(k / 9, k % 9)).collect();
        let mut triangles = Vec::new();
        for a in (0..72).filter(|k| k % 9 < 8) {
            for [p, q, r] in [[a, a + 9, a + 10], [a, a + 10, a + 1]] {
                triangles.push(if turned { [p, r, q] } else { [p, q, r] });
            }
        }
        let mesh = Mesh::new(positions, triangles).unwrap();
        let mut rays = Vec::new();
        for i in 0..=64 {
            for j in 0..=64 {
                let to = DVec3::new(f64::from(i), f64::from(j), 0.0) / 32.0;
                rays.push(Ray::new(to + DVec3::Z, -DVec3::Z));
            }
        }
        assert!(
            mesh.closest_many(&rays)
                .iter()
                .all(|hit| hit.is_some_and(|h| h.t == 1.0))
        );
        assert!(mesh.blocks_many(&rays).iter().all(|b| *b));
    }
}

/// Points of a cube's walls see each other from inside, and nothing else.
#[test]
fn ends_on_the_mesh_do_not_block() {
    let corner = |k: u32| DVec3::new(f64::from(k & 1), f64::from(k >> 1 & 1), f64::from(k >> 2));
    let quads = [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ];
    let triangles = quads
        .iter()
        .flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]);
    let mesh = Mesh::new((0..8).map(corner).collect(), triangles.collect()).unwrap();
    assert!((mesh.area() - 6.0).abs() < 1e-15);
    assert_eq!(mesh.bounds(), (DVec3::ZERO, DVec3::ONE));
    let mut x = numbers();
    for i in 0..2000 {
        let wall = |axis: usize, side: f64, [a, b]: [f64; 2]| {
            let mut p = [a; 3];
            (p[axis], p[(axis + 1) % 3]) = (side, b);
            DVec3::from_array(p)
        };
        let (from, to) = (
            wall(i % 3, 0.0, [x(), x()]),
            wall((i + i / 3) % 3, 1.0, [x(), x()]),
        );
        assert!(
            !mesh.blocks(&Ray::between(from, to).unwrap()),
            "{from} to {to}"
        );
        let beyond = to + (to - from);
        assert!(
            mesh.blocks(&Ray::between(from, beyond).unwrap()),
            "{from} to {beyond}"
        );
        let (triangle, point) = mesh.at_position(from);
        assert!((point.position - from).length() < 1e-15);
        assert_eq!(point.normal[i % 3], -1.0);
        let hit = mesh
            .closest(&Ray::new(DVec3::splat(0.5), (from - 0.5).normalize()))
            .unwrap();
        let [a, b, c] = mesh.corners(hit.triangle);
        assert_eq!((b - a).cross(c - a).normalize(), point.normal, "{triangle}");
    }
}

/// |p| − r is the distance of p from a sphere of radius r; a fine mesh of it lies below by no more than its sagitta.
#[test]
fn the_nearest_point_is_found() {
    let (positions, triangles) = ball(40, 0.0, 2.0);
    let mesh = Mesh::new(positions, triangles).unwrap();
    let mut x = numbers();
    for _ in 0..300 {
        let p = direction(&mut x) * (4.0 * x() + 0.1);
        let (triangle, point) = mesh.at_position(p);
        let distance = (point.position - p).length();
        assert!((distance - (p.length() - 2.0).abs()).abs() < 2e-3, "{p}");
        let brute = (0..mesh.triangles().len() as u32)
            .map(|i| (nearest::on_triangle(mesh.corners(i), p).0, i))
            .fold((f64::INFINITY, 0), |a, b| if b.0 < a.0 { b } else { a });
        assert_eq!(
            (brute.0, brute.1),
            (nearest::on_triangle(mesh.corners(triangle), p).0, triangle)
        );
    }
}

/// Coincident and degenerate triangles neither break the tree nor the answer: the first of the
/// proper ones counts.
#[test]
fn thousands_of_coincident_triangles_are_survived() {
    let positions = vec![
        DVec3::ZERO,
        DVec3::X,
        DVec3::Y,
        DVec3::new(50.0, 3.0, 9.0),
        DVec3::X * 0.5,
        DVec3::Y * (1.0 + 1e-9),
    ];
    let mut triangles = vec![[0, 0, 1], [0, 4, 1], [0, 1, 3]];
    for i in 0..20_000 {
        triangles.push([[0, 1, 2], [1, 2, 0], [0, 1, 5]][i % 3]);
    }
    let mesh = Mesh::new(positions, triangles).unwrap();
    let ray = Ray::new(DVec3::new(0.2, 0.3, 1.0), -DVec3::Z);
    let hit = mesh.closest(&ray).unwrap();
    assert_eq!((hit.triangle, hit.t), (3, 1.0));
    assert!(mesh.blocks(&ray));
}

#[test]
fn what_is_no_mesh_is_refused() {
    let corners = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
    let new = |positions: &[DVec3], triangles: &[[u32; 3]]| {
        Mesh::new(positions.to_vec(), triangles.to_vec()).unwrap_err()
    };
    for far in [f64::NAN, f64::INFINITY, -1e28] {
        let error = new(
            &[DVec3::ZERO, DVec3::X, DVec3::new(0.0, far, 0.0)],
            &[[0, 1, 2]],
        );
        assert!(
            matches!(error, MeshError::Unbounded { vertex: 2, .. }),
            "{error}"
        );
    }
    let error = new(&corners, &[[0, 1, 2], [0, 3, 1]]);
    assert_eq!(
        error,
        MeshError::NoVertex {
            triangle: 1,
            vertex: 3,
            count: 3
        }
    );
    assert_eq!(new(&corners, &[[0, 1, 1]]), MeshError::Empty { count: 1 });
    assert_eq!(new(&[], &[]), MeshError::Empty { count: 0 });
}
