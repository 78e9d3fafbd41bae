use proptest::prelude::*;

use super::*;
use crate::geometry::{Facing, Sphere};

fn vector(range: f64) -> impl Strategy<Value = DVec3> {
    prop::array::uniform3(-range..range).prop_map(DVec3::from_array)
}

fn patch(reach: f64, size: f64) -> impl Strategy<Value = Shape> {
    (vector(reach), vector(size), vector(size)).prop_filter_map("no area", |(corner, u, v)| {
        Parallelogram::new(corner, u, v).map(Shape::Parallelogram)
    })
}

fn shape() -> impl Strategy<Value = Shape> {
    let ball = (vector(3.0), 0.05..1.5).prop_filter_map("no ball", |(centre, radius)| {
        Sphere::new(centre, radius, Facing::Outside).map(Shape::Sphere)
    });
    prop_oneof![3 => patch(3.0, 2.0), 1 => ball]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    /// What is called free is free: no segment between random points of the two ends is ever
    /// blocked, and the short list of blockers gives the answer of all shapes.
    #[test]
    fn nothing_that_blocks_is_left_out(
        ends in (patch(3.0, 2.0), patch(3.0, 2.0)),
        others in prop::collection::vec(shape(), 1..4),
        places in prop::collection::vec(prop::array::uniform4(0.0..1.0f64), 64),
    ) {
        let shapes: Vec<Shape> = [ends.0, ends.1].into_iter().chain(others).collect();
        let bvh = Bvh::new(shapes.clone()).unwrap();
        let (a, b) = (Region::around(&shapes[0]), Region::around(&shapes[1]));
        let ids = [Some(0), Some(1)];
        let blockers = bvh.blockers(&a, &b, ids);
        for [i, j, k, l] in places {
            let (p, q) = (shapes[0].at([i, j]).position, shapes[1].at([k, l]).position);
            let Some(ray) = Ray::between(p, q) else { continue };
            prop_assert_eq!(bvh.blocked_by(&blockers, &ray, ids), bvh.blocked(&ray, ids));
        }
    }
}

/// The bench: nothing can stand between wall and object, a screen between them can, one behind the
/// wall, behind the object or beside both cannot.
#[test]
fn the_bench_is_free_and_a_screen_is_found() {
    let patch = |corner, u, v| {
        let v3 = DVec3::from_array;
        Shape::Parallelogram(Parallelogram::new(v3(corner), v3(u), v3(v)).unwrap())
    };
    let wall = patch([0.0, 0.0, 0.0], [11.5, 0.0, 0.0], [0.0, 15.5, 0.0]);
    let object = patch(
        [3.0, 11.351, 4.149],
        [4.0, 0.0, 0.0],
        [0.0, -2.8284, 2.8284],
    );
    let others = [
        (
            patch([4.0, 6.0, 1.0], [2.0, 0.0, 0.0], [0.0, 0.0, 1.0]),
            true,
        ),
        (
            patch([4.0, 6.0, -1.0], [2.0, 0.0, 0.0], [0.0, 1.0, -1.0]),
            false,
        ),
        (
            patch([3.0, 12.5, 5.0], [4.0, 0.0, 0.0], [0.0, -2.8, 2.8]),
            false,
        ),
        (
            patch([12.0, 3.0, 0.5], [0.0, 8.0, 0.0], [0.0, 0.0, 8.0]),
            false,
        ),
        (
            Shape::Sphere(Sphere::new(DVec3::new(5.0, 8.0, 2.0), 0.5, Facing::Outside).unwrap()),
            true,
        ),
        (
            Shape::Sphere(Sphere::new(DVec3::new(5.0, 15.0, 7.5), 0.5, Facing::Outside).unwrap()),
            false,
        ),
    ];
    for (other, stands_between) in others {
        let bvh = Bvh::new(vec![wall.clone(), object.clone(), other.clone()]).unwrap();
        let (a, b) = (Region::around(&wall), Region::around(&object));
        let found = bvh.blockers(&a, &b, [Some(0), Some(1)]);
        let expected = if stands_between { vec![2] } else { vec![] };
        assert_eq!(found, Blockers::Among(expected), "{other:?}");
        assert_eq!(found.none(), !stands_between);
    }
}

/// From one point of the wall the shaft is narrow: a screen that stands between other points does
/// not disturb.
#[test]
fn a_point_sees_past_a_screen_that_others_do_not() {
    let patch = |corner, u, v| {
        let v3 = DVec3::from_array;
        Shape::Parallelogram(Parallelogram::new(v3(corner), v3(u), v3(v)).unwrap())
    };
    let object = patch([0.0, 0.0, 4.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
    let screen = patch([5.0, 0.0, 2.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
    let bvh = Bvh::new(vec![object.clone(), screen]).unwrap();
    let to = Region::around(&object);
    let from = |x: f64| {
        bvh.blockers(
            &Region::point(DVec3::new(x, 0.5, 0.0)),
            &to,
            [None, Some(0)],
        )
    };
    assert!(from(0.5).none());
    assert_eq!(from(10.5), Blockers::Among(vec![1]));
}
