//! Walls of meshes, of which the camera sees parts of pixels.

use super::*;
use phicam::num::quadrature::Rule;

/// The pinhole, and the middles of two spots.
const CAMERA: DVec3 = DVec3::new(-20.0, 10.0, 15.0);
const SPOTS: [[f64; 2]; 2] = [[1.0, 1.5], [-2.0, 3.0]];
/// Corner and sides of the card.
const CARD: [DVec3; 3] = [
    DVec3::new(3.0, 11.0, 4.0),
    DVec3::new(4.0, 0.0, 0.0),
    DVec3::new(0.0, -3.0, 3.0),
];

/// A wall of `count` strips between these ends in x, each of `rows` pairs of triangles, at the
/// heights of `z`, as a mesh.
fn wall([from, to]: [f64; 2], [count, rows]: [usize; 2], z: impl Fn(f64) -> f64) -> String {
    let mut obj = String::new();
    for (i, j) in (0..=count).flat_map(|i| (0..=rows).map(move |j| (i, j))) {
        let x = from + (to - from) * i as f64 / count as f64;
        let y = -30.0 + 60.0 * j as f64 / rows as f64;
        obj += &format!("v {x} {y} {}\n", z(x));
    }
    for (i, j) in (0..count).flat_map(|i| (0..rows).map(move |j| (i, j))) {
        let at = |i: usize, j: usize| i * (rows + 1) + j + 1;
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        obj += &format!("f {a} {b} {c}\nf {a} {c} {d}\n");
    }
    obj
}

fn scene(obj: &str, more: &str) -> Scene {
    let [corner, u, v] = CARD.map(|p| p.to_array());
    let text = format!(
        "name = \"walls\"\nunit = \"in\"\nmax_bounces = 3\n\
        [laser]\npower = 0.005\nwavelength = 632.8e-9\nposition = [-20, 10, 15]\n\
        [laser.spots]\nlayout = \"list\"\npoints = {SPOTS:?}\n\
        [camera]\nposition = [-20, 10, 15]\naperture_area = 0.05\npixels = [4, 4]\n\
        view = {{ x = [2.25, 5.5], y = [2.75, 6.0] }}\n\
        [[surface]]\nname = \"wall\"\nrole = \"relay\"\nmaterial = {{ lambertian = 0.8 }}\n\
        mesh = {{ file = \"wall.obj\" }}\n\
        [[surface]]\nname = \"card\"\nrole = \"hidden\"\nelements = [2, 2]\n\
        rectangle = {{ corner = {corner:?}, u = {u:?}, v = {v:?} }}\n\
        material = {{ lambertian = 0.7 }}\n{more}"
    );
    beside("wall.obj", obj, &text).unwrap()
}

/// The model of a wall whose pieces between lines of constant x in the view are each seen at the
/// height and with the normal of `piece`, against product rules over each: within `near` of it, and
/// within its bound.
fn assert_right(
    scene: &Scene,
    ends: &[f64],
    piece: impl Fn(usize, DVec3) -> Option<[DVec3; 2]>,
    near: f64,
) {
    let found = converged(scene, Kernel::Physical, Extent::FULL).unwrap();
    let pi = std::f64::consts::PI;
    let [corner, u, v] = CARD;
    let facing = u.cross(v).normalize();
    let g = |[wall, normal]: [DVec3; 2], hidden: DVec3| {
        let r = hidden - wall;
        r.dot(normal).max(0.0) * (-r.dot(facing)).max(0.0) / r.length_squared().powi(2)
    };
    let rule = Rule::gauss_legendre(12);
    for p in 0..16 {
        let [x0, y0] = [p % 4, p / 4].map(|k| 0.8125 * k as f64);
        let ([x0, y0], [x1, y1]) = ([2.25 + x0, 2.75 + y0], [3.0625 + x0, 3.5625 + y0]);
        let mut seen = Vec::new();
        for (k, pair) in ends.windows(2).enumerate() {
            let [from, to] = [pair[0].clamp(x0, x1), pair[1].clamp(x0, x1)];
            for (y, wy) in rule.on(y0, y1) {
                for (x, wx) in rule.on(from, to).filter(|_| from < to) {
                    let line = DVec3::new(x, y, 0.0) - CAMERA;
                    let share = 0.05 * line.z * line.z / line.length_squared().powi(2) * wx * wy;
                    seen.extend(piece(k, line).map(|at| (at, share)));
                }
            }
        }
        for (l, [x, y]) in SPOTS.into_iter().enumerate() {
            let mut sum = 0.0;
            for (a, wa) in rule.on(0.0, 1.0) {
                for (b, wb) in rule.on(0.0, 1.0) {
                    let at = corner + u * a + v * b;
                    let to: f64 = seen.iter().map(|(wall, share)| share * g(*wall, at)).sum();
                    let from = g([DVec3::new(x, y, 0.0), DVec3::Z], at);
                    sum += wa * wb * u.cross(v).length() * from * to;
                }
            }
            let truth = 0.005 * sum * (0.8 / pi) * (0.8 / pi) * (0.7 / pi);
            let (phi, bound) = (found.phi[(p, l)], found.bound[(p, l)]);
            let error = (phi - truth).abs();
            assert!(error <= near * truth, "{p}, {l}: {phi:e} for {truth:e}");
            assert!(
                error <= bound + 1e-9 * truth && bound <= 10.0 * near * truth,
                "{p}, {l}: {error:e} beyond {bound:e}"
            );
        }
    }
}

/// A mesh that slopes down by ½ beyond x = 4, where pixels of the third column see both slopes, in
/// strips of few and many triangles: no edge but that bends what is seen.
#[test]
fn a_fold_of_a_mesh_parts_what_is_seen() {
    let down = |x: f64| if x > 4.0 { -0.5 * (x - 4.0) } else { 0.0 };
    let normal = DVec3::new(0.5, 0.0, 1.0).normalize();
    for parts in [[16, 1], [64, 4]] {
        let scene = scene(&wall([-28.0, 36.0], parts, down), "");
        let piece = |k: usize, line: DVec3| match k {
            0 => Some([CAMERA + line, DVec3::Z]),
            // ½ (x − 4) + z = 0.
            _ => {
                let plane = DVec3::new(0.5, 0.0, 1.0);
                let t = (2.0 - plane.dot(CAMERA)) / plane.dot(line);
                Some([CAMERA + line * t, normal])
            }
        };
        assert_right(&scene, &[2.25, 4.0, 5.5], piece, 1e-6);
    }
}

/// A blind that takes the camera's sight of what lies beyond x = 70/13 of a mesh, and of no pixel's
/// middle: its edge at (−9, 8.5), 11 from the camera, lies on 15 − 15·11/(x + 20) = 8.5.
#[test]
fn a_mesh_is_seen_past_an_edge_by_parts() {
    let blind = "[[surface]]\nname = \"blind\"\nrole = \"occluder\"\nsides = \"two\"\n\
        rectangle = { corner = [-9, -30, 8.5], u = [0, 60, 0], v = [0, 0, 60] }\n\
        material = { lambertian = 0.0 }\n";
    for parts in [[1, 1], [40, 30]] {
        let scene = scene(&wall([-30.0, 30.0], parts, |_| 0.0), blind);
        let piece = |k: usize, line: DVec3| (k == 0).then(|| [CAMERA + line, DVec3::Z]);
        assert_right(&scene, &[2.25, 70.0 / 13.0, 5.5], piece, 1e-3);
    }
}
