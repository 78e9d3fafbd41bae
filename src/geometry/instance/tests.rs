use super::*;
use crate::geometry::Ray;

fn tetrahedron() -> Arc<Mesh> {
    let corners = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    let faces = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    Arc::new(Mesh::new(corners, faces).unwrap())
}

fn placement() -> DAffine3 {
    let turn = glam::DQuat::from_axis_angle(DVec3::new(1.0, 2.0, -1.0).normalize(), 0.9);
    let to = DVec3::new(300.0, -20.0, 7.0);
    DAffine3::from_scale_rotation_translation(DVec3::splat(2.5), turn, to)
}

/// Against a mesh whose vertices are moved one by one.
#[test]
fn a_placed_mesh_is_the_mesh_of_the_placed_vertices() {
    let (mesh, place) = (tetrahedron(), placement());
    let body = Instance::new(mesh.clone(), place, Side::Outer).unwrap();
    let moved = mesh.positions().iter().map(|p| place.transform_point3(*p));
    let copy = Arc::new(Mesh::new(moved.collect(), mesh.triangles().to_vec()).unwrap());
    let copy = Instance::new(copy, DAffine3::IDENTITY, Side::Outer).unwrap();
    assert!((body.area() / copy.area() - 1.0).abs() < 1e-12);
    assert!((body.bounds().0 - copy.bounds().0).length() < 1e-12);
    let mut met = 0;
    for k in 0..400 {
        let t = f64::from(k) * 0.37;
        let (sin, cos) = libm::sincos(t);
        let from = DVec3::new(
            300.0 + 5.0 * cos,
            -20.0 + 5.0 * sin,
            7.0 + 3.0 * libm::sin(1.7 * t),
        );
        let aim = place.transform_point3(DVec3::splat(0.25) + DVec3::new(cos, sin, 0.0) * 0.3);
        let ray = Ray::new(from, (aim - from).normalize());
        let (a, b) = (body.intersect(&ray), copy.intersect(&ray));
        assert_eq!(a.map(|h| h.triangle), b.map(|h| h.triangle), "{k}");
        if let (Some(a), Some(b)) = (a, b) {
            met += 1;
            assert!((a.t - b.t).abs() < 1e-11);
            let at = from + ray.direction * a.t;
            let p = body.on_triangle(a.triangle, at);
            let q = copy.on_triangle(b.triangle, at);
            assert!((p.position - q.position).length() < 1e-11);
            assert!((p.normal - q.normal).length() < 1e-12);
            let turned = body.turned().on_triangle(a.triangle, at);
            assert!((turned.normal + p.normal).length() == 0.0);
            // What starts on a triangle does not meet it, however far the body is from the
            // origin.
            let out = Ray::new(p.position, p.normal);
            assert!(body.intersect(&out).is_none() && !body.blocks(&Ray { length: 9.0, ..out }));
        }
    }
    assert!(met > 100);
}

/// Segments around the body, along the axes and across: blocked where x, y, z ≥ 0 and x + y + z ≤ 1
/// leave some of the segment, in the coordinates of the tetrahedron.
#[test]
fn segments_are_blocked_by_what_they_pass_through() {
    let place = placement();
    let body = Instance::new(tetrahedron(), place, Side::Outer).unwrap();
    let (middle, back) = (place.transform_point3(DVec3::splat(0.2)), place.inverse());
    let passes = |from: DVec3, to: DVec3| {
        let [a, b] = [from, to].map(|p| back.transform_point3(p));
        let heights = |p: DVec3| [p.x, p.y, p.z, 1.0 - p.x - p.y - p.z];
        let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
        for (from, to) in heights(a).into_iter().zip(heights(b)) {
            let crossing = from / (from - to);
            match (from < 0.0, to < 0.0) {
                (true, true) => return false,
                (true, false) => enter = enter.max(crossing),
                (false, true) => leave = leave.min(crossing),
                (false, false) => {}
            }
        }
        enter < leave
    };
    let mut segments = Vec::new();
    for i in 0..9 {
        for j in 0..9 {
            let [a, b] = [i, j].map(|k| 0.7 * (f64::from(k) - 4.0) + 0.013);
            for axis in 0..3 {
                let mut across = [a, b, 0.0];
                across.rotate_right(axis);
                let start = middle + DVec3::from_array(across);
                let along = DVec3::AXES[(axis + 2) % 3] * 6.0;
                let slant = along + DVec3::new(0.3, -1.1, 0.7);
                for way in [along, slant, 0.4 * along] {
                    segments.push((start - way, start + way));
                    segments.push((start + way, start + 3.0 * way));
                }
            }
        }
    }
    let truth: Vec<bool> = segments.iter().map(|(a, b)| passes(*a, *b)).collect();
    let met = truth.iter().filter(|b| **b).count();
    assert!(met > 50 && 2 * met < truth.len(), "{met}");
    let rays = segments.iter().map(|(a, b)| Ray::between(*a, *b).unwrap());
    let rays: Vec<Ray> = rays.collect();
    let found: Vec<bool> = rays.iter().map(|ray| body.blocks(ray)).collect();
    assert_eq!(found, truth);
    assert_eq!(body.blocks_many(&rays), truth);
}

#[test]
fn what_is_no_similarity_is_refused() {
    let mesh = tetrahedron();
    let place = |m: glam::DMat3| Instance::new(mesh.clone(), DAffine3::from_mat3(m), Side::Outer);
    assert!(place(glam::DMat3::from_diagonal(DVec3::new(1.0, 1.0, 2.0))).is_none());
    assert!(place(glam::DMat3::from_diagonal(DVec3::new(1.0, 1.0, -1.0))).is_none());
    assert!(place(glam::DMat3::from_diagonal(DVec3::splat(f64::NAN))).is_none());
    assert!(place(glam::DMat3::from_diagonal(DVec3::splat(3.0))).is_some());
}

/// A vertical line passes the tetrahedron where x, y ≥ 0 and x + y < 1, through its floor and
/// its slanted face.
#[test]
fn points_above_a_place_are_those_of_the_faces() {
    let body = Instance::new(tetrahedron(), DAffine3::IDENTITY, Side::Outer).unwrap();
    let found = body.at_xy(0.2, 0.3);
    let z: Vec<f64> = found.iter().map(|p| p.position.z).collect();
    assert!(
        z.len() == 2 && z[0].abs() < 1e-15 && (z[1] - 0.5).abs() < 1e-15,
        "{z:?}"
    );
    assert!(body.at_xy(0.7, 0.6).is_empty());
}
