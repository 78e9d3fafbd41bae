use super::*;
use crate::geometry::{Bvh, Opaque, Parallelogram, Pieces, Polygon, Shape, ShapeId};

/// A rigid motion by each parameter: v, ω.
const MOTIONS: [(DVec3, DVec3); AT_ONCE] = [
    (DVec3::X, DVec3::ZERO),
    (DVec3::new(0.2, -0.7, 0.4), DVec3::ZERO),
    (DVec3::ZERO, DVec3::new(0.3, 0.5, -0.8)),
    (DVec3::new(0.0, 0.1, 0.9), DVec3::new(-0.4, 0.2, 0.6)),
];

fn velocity(lane: usize, x: DVec3) -> DVec3 {
    MOTIONS[lane].0 + MOTIONS[lane].1.cross(x)
}

fn at(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

/// Plates of which some cover others in part.
fn plates() -> [[DVec3; 3]; 3] {
    [
        [at(0.2, 0.5, 1.0), at(0.3, 0.1, 0.2), at(0.0, 0.4, -0.1)],
        [at(0.1, 0.6, 2.0), at(0.2, 0.0, 0.5), at(0.0, 0.1, 0.9)],
        [at(0.4, 0.3, 0.7), at(0.3, -0.1, 0.1), at(0.1, 0.3, 0.2)],
    ]
}

fn square() -> Polygon {
    [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]
        .map(|[x, y]| at(x, y, 0.0))
        .to_vec()
}

/// Area, and moment about the origin, of what stays in sight with every plate moved by `step`
/// of one parameter, exactly.
fn seen(lane: usize, step: f64, from: DVec3) -> [f64; 4] {
    let (v, w) = MOTIONS[lane];
    let turn = glam::DQuat::from_scaled_axis(w * step);
    // exp of the twist, of a translation along the turn to the third order.
    let carried = |x: DVec3| {
        let (first, second) = (v, w.cross(v));
        turn * x
            + first * step
            + second * (step * step / 2.0)
            + w.cross(second) * (step.powi(3) / 6.0)
    };
    let plate = |[c, u, v]: [DVec3; 3]| {
        let corner = carried(c);
        Parallelogram::new(corner, carried(c + u) - corner, carried(c + v) - corner).unwrap()
    };
    let shapes = plates().map(|p| Shape::Parallelogram(plate(p)));
    let bvh = Bvh::new(shapes.to_vec()).unwrap();
    let hidden = Opaque::new(&bvh, |_| true).from(from, None, &bvh);
    let (mut pieces, square) = (Pieces::default(), square());
    pieces.past([&*square], &square, &hidden.shadows);
    pieces.iter().fold([0.0; 4], |sum, piece| {
        let (area, middle) = crate::geometry::area_and_middle(piece);
        let moment = middle * area;
        [
            sum[0] + area,
            sum[1] + moment.x,
            sum[2] + moment.y,
            sum[3] + moment.z,
        ]
    })
}

/// Rates of area and moment are those of the pieces of plates that were moved.
#[test]
fn pieces_in_sight_grow_as_those_of_displaced_plates() {
    let from = at(0.3, 0.9, 3.0);
    let shape = |[c, u, v]: [DVec3; 3]| Shape::Parallelogram(Parallelogram::new(c, u, v).unwrap());
    let bvh = Bvh::new(plates().map(shape).to_vec()).unwrap();
    let opaque = Opaque::new(&bvh, |_| true);
    assert!(opaque.is_flat());
    let all = |_: ShapeId, x: DVec3| std::array::from_fn(|lane| velocity(lane, x));
    let shadows = opaque.moving_from(from, None, &bvh, all);
    let square = square();
    let still: Vec<Moving> = square.iter().copied().map(Moving::still).collect();
    let mut pieces = Pieces::default();
    assert!(pieces.past([&*still], &square, &shadows));
    for lane in 0..AT_ONCE {
        let mut found = [0.0; 4];
        for piece in pieces.iter() {
            let (area, middle, grown) = Moving::area_and_middle(piece);
            let moment = middle.at * grown[lane] + middle.rate[lane] * area;
            let own = [grown[lane], moment.x, moment.y, moment.z];
            found.iter_mut().zip(own).for_each(|(sum, x)| *sum += x);
        }
        let h = 1e-3;
        let [a, b, c, d] = [h, -h, 2.0 * h, -2.0 * h].map(|step| seen(lane, step, from));
        for k in 0..4 {
            let want = (8.0 * (a[k] - b[k]) - (c[k] - d[k])) / (12.0 * h);
            let off = (found[k] - want).abs();
            assert!(off < 1e-9, "{lane} {k}: {} for {want}", found[k]);
        }
        assert!(found[0].abs() > 1e-3, "{lane}: nothing moves");
    }
}
