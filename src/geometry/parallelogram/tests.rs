use super::*;

fn patch() -> Parallelogram {
    Parallelogram::new(
        DVec3::new(3.0, 11.351, 4.149),
        DVec3::new(4.0, 0.0, 0.0),
        DVec3::new(0.0, -2.8284, 2.8284),
    )
    .unwrap()
}

#[test]
fn the_bench_object_faces_down_towards_the_wall() {
    let h = 0.5f64.sqrt();
    assert!((patch().normal() - DVec3::new(0.0, -h, -h)).length() < 1e-15);
    assert!((patch().area() - 4.0 * 2.8284 * 2f64.sqrt()).abs() < 1e-12);
    assert!(patch().skew().abs() < 1e-15);
}

#[test]
fn coordinates_invert_the_parametrisation() {
    for a in [0.0, 0.3, 1.0] {
        for b in [0.0, 0.7, 1.0] {
            let p = patch().at([a, b]).position + patch().normal() * 0.5;
            let [x, y] = patch().coordinates(p);
            assert!((x - a).abs() < 1e-14 && (y - b).abs() < 1e-14);
        }
    }
}

#[test]
fn hits_inside_and_misses_outside_and_behind() {
    let target = patch().at([0.25, 0.5]).position;
    let from = DVec3::new(5.0, 4.0, 0.0);
    let ray = Ray::between(from, target).unwrap();
    let long = Ray {
        length: 100.0,
        ..ray
    };
    let t = patch().intersect(&long).unwrap();
    assert!((t - ray.length).abs() < 1e-13);
    assert!(
        patch()
            .intersect(&Ray {
                direction: -ray.direction,
                ..long
            })
            .is_none()
    );
    assert!(
        patch()
            .intersect(&Ray {
                length: t * 0.99,
                ..long
            })
            .is_none()
    );
    let aside = patch().at([1.2, 0.5]).position;
    assert!(
        patch()
            .intersect(&Ray {
                length: 100.0,
                ..Ray::between(from, aside).unwrap()
            })
            .is_none()
    );
}

/// A wall of two tiles: a spot exactly on the seam is free from everywhere in front, however t
/// rounds.
#[test]
fn a_point_on_a_seam_is_not_blocked_by_the_neighbour() {
    let tile = |x: f64| {
        let corner = DVec3::new(x, 0.0, 0.1);
        Parallelogram::new(corner, DVec3::X * 5.0, DVec3::new(0.0, 15.5, 0.3)).unwrap()
    };
    let (left, right) = (tile(0.0), tile(5.0));
    for i in 0..2000 {
        let k = f64::from(i);
        let seam = left.at([1.0, (k * 0.618).fract()]).position;
        let from = DVec3::new(10.0 * (k * 0.31).fract(), 15.0 * (k * 0.77).fract(), 4.0);
        assert!(!right.blocks(&Ray::between(from, seam).unwrap()));
        assert!(!right.blocks(&Ray::between(seam, from).unwrap()));
        let behind = Ray::between(from, DVec3::new(7.0, 7.0, -1.0)).unwrap();
        assert!(right.blocks(&behind) || left.blocks(&behind));
    }
}

#[test]
fn overlap_is_more_than_an_edge_in_one_plane() {
    let square = |x: f64, y: f64, z: f64| {
        Parallelogram::new(DVec3::new(x, y, z), DVec3::X, DVec3::new(0.2, 1.0, 0.0)).unwrap()
    };
    let base = square(0.0, 0.0, 0.0);
    assert!(base.overlaps(&base) && base.overlaps(&base.turned()));
    assert!(base.overlaps(&square(0.9, 0.0, 0.0)) && square(0.9, 0.0, 0.0).overlaps(&base));
    assert!(
        !base.overlaps(&square(1.0, 0.0, 0.0)),
        "neighbours share an edge"
    );
    assert!(!base.overlaps(&square(0.0, 0.0, 1e-6)), "lifted");
    // The bounding boxes share [1, 1.2] × [0, 0.1], where the slanted square is not: its edge is x
    // = 1 + y/5.
    let corner = DVec3::new(1.05, 0.0, 0.0);
    let low = Parallelogram::new(corner, DVec3::X, DVec3::Y * 0.1).unwrap();
    assert!(!base.overlaps(&low) && !low.overlaps(&base));
}

#[test]
fn no_area_is_no_patch() {
    let x = DVec3::X;
    assert!(Parallelogram::new(DVec3::ZERO, x, x * 2.0).is_none());
    assert!(Parallelogram::new(DVec3::ZERO, DVec3::ZERO, x).is_none());
    assert!(Parallelogram::new(DVec3::NAN, x, DVec3::Y).is_none());
    assert!(Parallelogram::new(DVec3::ZERO, x * f64::MAX, DVec3::Y * f64::MAX).is_none());
}
