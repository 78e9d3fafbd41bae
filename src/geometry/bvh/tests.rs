use super::*;
use crate::geometry::{DVec3, Facing, Parallelogram, Sphere};
use crate::num::stream::{Key, Sampling, Stream};

fn numbers() -> impl FnMut() -> f64 {
    let key = Key {
        seed: 5,
        spot: 0,
        pixel: 0,
        block: 0,
    };
    let mut stream = Stream::new(Sampling::Pcg, key);
    move || stream.uniform()
}

/// Patches of all sizes (some flat along an axis), a cavity around them and a few balls.
fn clutter(scale: f64) -> Vec<Shape> {
    let mut x = numbers();
    let mut shapes: Vec<Shape> = (0..60)
        .map(|i| {
            let mut v = |s: f64| DVec3::new(x() - 0.5, x() - 0.5, x() - 0.5) * s * scale;
            let (corner, mut u, w) = (v(10.0), v(3.0), v(3.0));
            if i % 3 == 0 {
                u = DVec3::new(u.x, 0.0, 0.0);
            }
            let w = if i % 3 == 0 {
                DVec3::new(0.0, w.y, 0.0)
            } else {
                w
            };
            Shape::Parallelogram(Parallelogram::new(corner, u, w).unwrap())
        })
        .collect();
    for i in 0..4 {
        let centre = DVec3::splat(f64::from(i) - 2.0) * scale;
        shapes.push(Shape::Sphere(
            Sphere::new(centre, 0.4 * scale, Facing::Outside).unwrap(),
        ));
    }
    shapes.push(Shape::Sphere(
        Sphere::new(DVec3::ZERO, 12.0 * scale, Facing::Inside).unwrap(),
    ));
    shapes
}

/// The tree must agree with the list on every ray: from surfaces, along axes, from far away, at
/// three scales.
#[test]
fn the_tree_answers_as_the_list_does() {
    for scale in [1e-3, 1.0, 1e4] {
        let shapes = clutter(scale);
        let list = Bvh {
            shapes: shapes.clone(),
            tree: None,
        };
        let tree = Bvh::new(shapes).unwrap();
        assert!(tree.tree.is_some());
        let mut x = numbers();
        for i in 0..40_000 {
            let from = (x() * 65.0) as u32;
            let start = list.shapes[from as usize].at([x(), x()]).position;
            let mut d = DVec3::new(x() - 0.5, x() - 0.5, x() - 0.5);
            if i % 5 == 0 {
                d.x = 0.0;
                d.y = if i % 10 == 0 { 1e-9 } else { 0.0 };
            }
            let d = d.normalize();
            let ray = Ray::new(start, d);
            assert_eq!(
                list.closest(&ray, Some(from)),
                tree.closest(&ray, Some(from))
            );
            let away = Ray::new(start - d * 300.0 * scale, d);
            assert_eq!(list.closest(&away, None), tree.closest(&away, None));
            let to = (x() * 65.0) as u32;
            let end = list.shapes[to as usize].at([x(), x()]).position;
            let Some(segment) = Ray::between(start, end) else {
                continue;
            };
            let ends = [Some(from), Some(to)];
            assert_eq!(list.blocked(&segment, ends), tree.blocked(&segment, ends));
        }
    }
}

/// Every ray from the middle of a closed box of six patches meets a wall, its edges and diagonals
/// included.
#[test]
fn a_closed_box_does_not_leak() {
    let e = [DVec3::X, DVec3::Y, DVec3::Z];
    let mut shapes = Vec::new();
    for i in 0..3 {
        for corner in [DVec3::ZERO, e[i]] {
            let patch = Parallelogram::new(corner, e[(i + 1) % 3], e[(i + 2) % 3]).unwrap();
            shapes.push(Shape::Parallelogram(patch));
        }
    }
    let bvh = Bvh::new(shapes).unwrap();
    let mut x = numbers();
    let centre = DVec3::splat(0.5);
    for i in 0..200_000 {
        // A third of the rays each at a diagonal, at an edge, anywhere.
        let (a, b) = (x(), x());
        let target = DVec3::new(a, [a, 1.0, b][i % 3], 1.0);
        let ray = Ray::new(centre, (target - centre).normalize());
        assert!(bvh.closest(&ray, None).is_some(), "leak towards {target}");
    }
}

#[test]
fn hits_nearer_than_the_tree_can_see_are_found() {
    let mut shapes = clutter(1.0);
    let patch = Parallelogram::new(DVec3::new(20.0, 0.0, 1e-7), DVec3::X, DVec3::Y).unwrap();
    shapes.push(Shape::Parallelogram(patch));
    let bvh = Bvh::new(shapes).unwrap();
    let hit = bvh
        .closest(&Ray::new(DVec3::new(20.5, 0.5, 0.0), DVec3::Z), None)
        .unwrap();
    assert_eq!(hit.t, 1e-7);
}

#[test]
fn unbounded_shapes_are_refused() {
    let far = Parallelogram::new(DVec3::splat(1e13), DVec3::X, DVec3::Y).unwrap();
    assert!(matches!(
        Bvh::new(vec![Shape::Parallelogram(far)]),
        Err(GeometryError::Unbounded { index: 0, .. })
    ));
}
