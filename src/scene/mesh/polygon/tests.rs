use super::*;

fn lifted(outline: &[Point], tilt: DVec3) -> Vec<DVec3> {
    let basis = crate::geometry::Basis::around(tilt.normalize());
    let place = |p: &Point| DVec3::new(3.0, -7.0, 11.0) + basis.to_world([p[0], p[1], 0.0]);
    outline.iter().map(place).collect()
}

fn divided(outline: &[Point], tilt: DVec3) -> Result<Vec<[usize; 3]>, MeshFileError> {
    triangles(&lifted(outline, tilt), || "line 7".to_owned())
}

/// Every point of a net that is off all sides lies in as many triangles as the even-odd rule says:
/// one inside, none outside; and the areas add up to the shoelace formula's.
fn assert_covers(outline: &[Point]) {
    let n = outline.len();
    for first in 0..n {
        let mut turned = outline.to_vec();
        turned.rotate_left(first);
        for tilt in [DVec3::Z, -DVec3::Z, DVec3::X, DVec3::new(1.0, -2.0, 0.4)] {
            let found = divided(&turned, tilt).unwrap_or_else(|e| panic!("{e}"));
            assert_eq!(found.len(), n - 2);
            let corners = |t: &[usize; 3]| t.map(|k| turned[k]);
            let area: f64 = found
                .iter()
                .map(corners)
                .map(|[a, b, c]| turn(a, b, c))
                .sum();
            let sides = (0..n).map(|i| (turned[i], turned[(i + 1) % n]));
            let shoelace: f64 = sides.map(|(p, q)| p[0] * q[1] - p[1] * q[0]).sum();
            assert!((area - shoelace).abs() < 1e-9, "{area}, {shoelace}");
            for k in 0..900 {
                let at = |i: i32, off: f64| (f64::from(i) + off) / 6.0 - 0.5;
                let p = [at(k % 30, 0.4142), at(k / 30, 0.5773)];
                let crossed = |i: &usize| {
                    let (a, b) = (turned[*i], turned[(*i + 1) % n]);
                    (a[1] > p[1]) != (b[1] > p[1])
                        && p[0] < a[0] + (p[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0])
                };
                let inside = (0..n).filter(crossed).count() % 2;
                let holds = |[a, b, c]: &[Point; 3]| {
                    turn(*a, *b, p) > 0.0 && turn(*b, *c, p) > 0.0 && turn(*c, *a, p) > 0.0
                };
                let held = found.iter().map(corners).filter(holds).count();
                assert_eq!(held, inside, "{p:?} from corner {first}");
            }
        }
    }
}

const M: [Point; 7] = [
    [0.0, 0.0],
    [1.0, 0.0],
    [2.0, 2.0],
    [3.0, 0.0],
    [4.0, 0.0],
    [4.0, 4.0],
    [0.0, 4.0],
];

#[test]
fn concave_faces_are_covered_once_whatever_the_first_corner() {
    assert_covers(&M);
    // An arrow, a comb, a spiral.
    assert_covers(&[[0.0, 0.0], [4.0, 2.0], [0.0, 4.0], [1.0, 2.0]]);
    assert_covers(&[
        [0.0, 0.0],
        [4.0, 0.0],
        [4.0, 4.0],
        [3.5, 4.0],
        [3.5, 1.0],
        [2.5, 1.0],
        [2.5, 4.0],
        [1.5, 4.0],
        [1.5, 1.0],
        [0.5, 1.0],
        [0.5, 4.0],
        [0.0, 4.0],
    ]);
    assert_covers(&[
        [0.0, 0.0],
        [4.0, 0.0],
        [4.0, 4.0],
        [1.0, 4.0],
        [1.0, 2.0],
        [2.0, 2.0],
        [2.0, 3.0],
        [3.0, 3.0],
        [3.0, 1.0],
        [0.0, 1.0],
    ]);
    // Corners in the middle of sides.
    assert_covers(&[
        [0.0, 0.0],
        [2.0, 0.0],
        [4.0, 0.0],
        [4.0, 2.0],
        [4.0, 4.0],
        [2.0, 4.0],
        [0.0, 4.0],
        [0.0, 2.0],
    ]);
    // A square with a square hole that a cut leads to.
    assert_covers(&[
        [0.0, 0.0],
        [4.0, 0.0],
        [4.0, 4.0],
        [0.0, 4.0],
        [0.0, 0.0],
        [1.0, 1.0],
        [1.0, 3.0],
        [3.0, 3.0],
        [3.0, 1.0],
        [1.0, 1.0],
    ]);
}

#[test]
fn convex_faces_are_fans() {
    let hexagon: Vec<Point> = (0..6)
        .map(|k| libm::sincos(f64::from(k)))
        .map(|(sin, cos)| [2.0 + 2.0 * cos, 2.0 + 2.0 * sin])
        .collect();
    assert_covers(&hexagon);
    let found = divided(&hexagon, DVec3::Z).unwrap();
    assert_eq!(found, [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]]);
}

#[test]
fn what_is_no_face_is_refused_with_its_place() {
    let bow = [[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 2.0]];
    let lopsided = [[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 3.0]];
    // A pentagram turns left at every corner.
    let star: Vec<Point> = (0..5)
        .map(|k| libm::sincos(f64::from(2 * k) * std::f64::consts::TAU / 5.0))
        .map(|(sin, cos)| [cos, sin])
        .collect();
    for outline in [&bow[..], &lopsided, &star] {
        let error = divided(outline, DVec3::new(0.3, 0.2, 1.0))
            .unwrap_err()
            .to_string();
        assert!(
            error.starts_with("line 7: the sides of the face cross each other"),
            "{error}"
        );
    }
    let mut bent = lifted(&M, DVec3::Y);
    bent[5] += DVec3::Y * 0.1;
    let error = triangles(&bent, || "line 7".to_owned())
        .unwrap_err()
        .to_string();
    assert!(error.starts_with("line 7: the face is not flat"), "{error}");
    // Within rounding of single precision it is flat.
    let rounded: Vec<DVec3> = lifted(&M, DVec3::new(1.0, 2.0, 3.0))
        .iter()
        .map(|p| p.as_vec3().as_dvec3())
        .collect();
    assert!(triangles(&rounded, || "line 7".to_owned()).is_ok());
}
