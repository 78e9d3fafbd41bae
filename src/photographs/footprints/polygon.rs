//! Polygons of the photograph.

/// The part of a polygon between two values of coordinate `axis` (Sutherland and Hodgman, *CACM*
/// 17, 1974).
pub(super) fn between(polygon: &[[f64; 2]], axis: usize, [low, high]: [f64; 2]) -> Vec<[f64; 2]> {
    let above = cut(polygon, axis, low, 1.0);
    cut(&above, axis, high, -1.0)
}

/// The part of a polygon where sign·(coordinate − bound) ≥ 0.
fn cut(polygon: &[[f64; 2]], axis: usize, bound: f64, sign: f64) -> Vec<[f64; 2]> {
    let inside = |p: &[f64; 2]| sign * (p[axis] - bound) >= 0.0;
    let mut kept = Vec::with_capacity(polygon.len() + 2);
    for (k, to) in polygon.iter().enumerate() {
        let from = polygon[(k + polygon.len() - 1) % polygon.len()];
        if inside(&from) != inside(to) {
            let t = (bound - from[axis]) / (to[axis] - from[axis]);
            let mut crossing = [0, 1].map(|i| from[i] + t * (to[i] - from[i]));
            crossing[axis] = bound;
            kept.push(crossing);
        }
        if inside(to) {
            kept.push(*to);
        }
    }
    kept
}

/// Area of a polygon, whichever way round, and its centroid.
pub(super) fn area_and_centroid(polygon: &[[f64; 2]]) -> (f64, [f64; 2]) {
    let Some(origin) = polygon.first() else {
        return (0.0, [0.0; 2]);
    };
    let mut twice = 0.0;
    let mut moment = [0.0; 2];
    for pair in polygon.windows(2).skip(1) {
        let [p, q] = [pair[0], pair[1]].map(|x| [x[0] - origin[0], x[1] - origin[1]]);
        let cross = p[0] * q[1] - p[1] * q[0];
        twice += cross;
        moment = [0, 1].map(|i| moment[i] + cross * (p[i] + q[i]));
    }
    if twice == 0.0 {
        return (0.0, *origin);
    }
    let centroid = [0, 1].map(|i| origin[i] + moment[i] / (3.0 * twice));
    (0.5 * twice.abs(), centroid)
}
