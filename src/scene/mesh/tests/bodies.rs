use super::*;
use std::f64::consts::PI;

fn is_sound(mesh: &Triangles, faces: usize) -> Defects {
    let count = mesh.triangles.len();
    assert!(
        (faces..=faces + faces / 4 + 20).contains(&count),
        "{count} for {faces}"
    );
    let found = Defects::of(mesh);
    assert!(found.is_empty(), "{found}");
    let uv = mesh.uv.as_ref().unwrap();
    assert_eq!(uv.len(), count);
    let inside = |x: &f64| (0.0..=1.0).contains(x);
    assert!(uv.iter().flatten().flatten().all(inside));
    // No triangle reaches over the seam.
    let width = |t: &[[f64; 2]; 3]| {
        let u = t.map(|c| c[0]);
        u.iter().copied().fold(0.0, f64::max) - u.iter().copied().fold(1.0, f64::min)
    };
    assert!(uv.iter().map(width).fold(0.0, f64::max) < 0.4);
    found
}

#[test]
fn a_bust_is_a_closed_body() {
    for faces in [0, 100, 5_000, 200_000] {
        let mesh = bust(faces);
        let found = is_sound(&mesh, faces);
        assert!(found.is_closed() && found.signed_volume > 0.0, "{found:?}");
        let heights = mesh.positions.iter().map(|p| p.z);
        assert_eq!(heights.clone().fold(1.0, f64::min), 0.0);
        assert_eq!(heights.fold(0.0, f64::max), 1.0);
    }
    assert_eq!(bust(3000), bust(3000));
}

#[test]
fn a_bust_looks_ahead() {
    let mesh = bust(200_000);
    let reach = |low: f64, high: f64, by: fn(&DVec3) -> f64| {
        let slice = mesh.positions.iter().filter(|p| (low..high).contains(&p.z));
        slice.map(by).fold(f64::NEG_INFINITY, f64::max)
    };
    let shoulders = reach(0.2, 0.35, |p| p.x.abs());
    let neck = reach(0.47, 0.53, |p| p.x.abs());
    let head = reach(0.6, 0.95, |p| p.x.abs());
    assert!(
        shoulders > 2.0 * head && head > 1.4 * neck,
        "{shoulders} {head} {neck}"
    );
    // The nose stands out to the front, nothing like it to the back or the sides of it.
    let nose = reach(0.66, 0.72, |p| -p.y);
    let cheek = reach(0.66, 0.72, |p| if p.x.abs() > 0.04 { -p.y } else { 0.0 });
    assert!(nose > cheek + 0.03, "{nose} {cheek}");
}

#[test]
fn a_sphere_has_its_area_and_volume() {
    let mesh = sphere(100_000);
    let found = is_sound(&mesh, 100_000);
    assert!(found.is_closed());
    let farthest = mesh.positions.iter().map(|p| (p.length() - 1.0).abs());
    assert!(farthest.fold(0.0, f64::max) < 1e-15 * 2.0);
    // A polyhedron with its corners on the sphere has less of both, by about its edges' length
    // squared.
    let (area, volume) = (
        area(&mesh) / (4.0 * PI),
        found.signed_volume / (4.0 / 3.0 * PI),
    );
    assert!(
        (0.999..1.0).contains(&area) && (0.999..1.0).contains(&volume),
        "{area} {volume}"
    );
}

#[test]
fn texture_coordinates_of_a_sphere_are_its_angles() {
    let mesh = sphere(2000);
    for (t, uv) in mesh.triangles.iter().zip(mesh.uv.as_ref().unwrap()) {
        for (c, [u, v]) in t.iter().zip(uv) {
            let p = mesh.positions[*c as usize];
            assert!((p.z + (PI * v).cos()).abs() < 1e-6);
            if p.z.abs() < 0.999_999 {
                let angle = 2.0 * PI * u;
                let direction = DVec3::new(angle.sin(), -angle.cos(), 0.0);
                let flat = DVec3::new(p.x, p.y, 0.0).normalize();
                assert!(flat.distance(direction) < 1e-5, "{p} {u}");
            }
        }
    }
}

#[test]
fn a_rectangle_is_the_unit_square() {
    let mesh = rectangle(7, 5);
    assert_eq!(mesh.triangles.len(), 70);
    assert!((area(&mesh) - 1.0).abs() < 1e-12);
    let found = Defects::of(&mesh);
    assert_eq!(
        (found.open_edges, found.turned_edges, found.crowded_edges),
        (24, 0, 0)
    );
    for (t, uv) in mesh.triangles.iter().zip(mesh.uv.as_ref().unwrap()) {
        let [a, b, c] = t.map(|c| mesh.positions[c as usize]);
        assert!((b - a).cross(c - a).z > 0.0);
        assert_eq!(uv[2], [c.x, c.y]);
    }
}
