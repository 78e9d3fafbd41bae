use proptest::prelude::*;

use super::*;
use crate::geometry::{Facing, Sphere};

/// On a coarse grid, so that planes, edges and corners are met exactly, or anywhere.
fn coordinate() -> impl Strategy<Value = f64> {
    prop_oneof![(-4..=4_i32).prop_map(|i| f64::from(i) * 0.5), -2.0..2.0]
}

fn point() -> impl Strategy<Value = DVec3> {
    [coordinate(), coordinate(), coordinate()].prop_map(DVec3::from_array)
}

/// Patches, some with another back to back, with balls between them or without.
fn shapes() -> impl Strategy<Value = Vec<Shape>> {
    let patch = (point(), point(), point(), any::<bool>());
    let balls = prop_oneof![Just(0_usize), Just(2)];
    (prop::collection::vec(patch, 1..14), balls).prop_map(|(patches, balls)| {
        let mut shapes = Vec::new();
        for (corner, u, v, both) in patches {
            let patch = Parallelogram::new(corner, u, v);
            let back = patch.filter(|_| both).map(Parallelogram::turned);
            shapes.extend(patch.into_iter().chain(back).map(Shape::Parallelogram));
        }
        for i in 0..balls {
            let centre = DVec3::splat(i as f64 - 0.7);
            shapes.extend(Sphere::new(centre, 0.6, Facing::Outside).map(Shape::Sphere));
        }
        shapes
    })
}

/// The two ends, each a free point, perhaps named as one of a shape, or a place on it.
type Line = [(DVec3, Option<(u32, Option<[f64; 2]>)>); 2];

fn lines() -> impl Strategy<Value = Vec<Line>> {
    let end = || {
        (
            point(),
            prop::option::of((any::<u32>(), prop::option::of([0.0..=1.0, 0.0..=1.0]))),
        )
    };
    prop::collection::vec([end(), end()], 1..30)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    /// Eight at a time or one by one: the same bits, wherever the rays start and end.
    #[test]
    fn batches_answer_as_single_rays_do(shapes in shapes(), lines in lines()) {
        prop_assume!(!shapes.is_empty());
        let count = shapes.len() as u32;
        let bvh = Bvh::new(shapes).unwrap();
        let (mut segments, mut ends) = (Vec::new(), Vec::new());
        for line in lines {
            let [a, b] = line.map(|(free, named)| match named.map(|(id, uv)| (id % count, uv)) {
                Some((id, Some(uv))) => (bvh.shapes()[id as usize].at(uv).position, Some(id)),
                named => (free, named.map(|(id, _)| id)),
            });
            if let Some(ray) = Ray::between(a.0, b.0) {
                segments.push(ray);
                ends.push([a.1, b.1]);
            }
        }
        let half_lines: Vec<Ray> = segments.iter().map(|s| Ray::new(s.origin, s.direction)).collect();
        let from: Vec<_> = ends.iter().map(|e| e[0]).collect();
        let some = Blockers::Among((0..count).step_by(2).collect());
        let bits = |hit: Option<Hit>| hit.map(|h| (h.shape, h.t.to_bits()));
        for rays in [&segments, &half_lines] {
            for (i, hit) in bvh.closest_many(rays, &from).into_iter().enumerate() {
                prop_assert_eq!(bits(hit), bits(bvh.closest(&rays[i], from[i])), "ray {}", i);
            }
            for blockers in [&Blockers::Any, &some] {
                for (i, blocked) in bvh.blocked_many(blockers, rays, &ends).into_iter().enumerate() {
                    let alone = bvh.blocked_by(blockers, &rays[i], ends[i]);
                    prop_assert_eq!(blocked, alone, "segment {}", i);
                }
            }
        }
    }
}
