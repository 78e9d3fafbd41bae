use super::*;

fn of(triangles: &[[u32; 3]]) -> Defects {
    Defects::of(&Triangles {
        positions: corners(),
        triangles: triangles.to_vec(),
        uv: None,
        bare: None,
        paint: None,
    })
}

#[test]
fn a_whole_body_has_none() {
    let found = Defects::of(&cube());
    let none = Defects {
        faces: 12,
        signed_volume: found.signed_volume,
        ..Defects::default()
    };
    assert_eq!(found, none);
    assert_eq!(found.to_string(), "");
    // The volume does not depend on where the body stands.
    let mut far = cube();
    for p in &mut far.positions {
        *p += DVec3::new(1e6 / 3.0, 1e6 / 7.0, 1e6);
    }
    assert!((Defects::of(&far).signed_volume - 1.0).abs() < 1e-9);
}

#[test]
fn a_body_inside_out() {
    let mut mesh = cube();
    for t in &mut mesh.triangles {
        t.swap(0, 1);
    }
    let found = Defects::of(&mesh);
    assert!(found.is_closed() && found.is_inside_out() && !found.is_empty());
    assert!((found.signed_volume + 1.0).abs() < 1e-12);
    assert!(found.to_string().contains("back outwards"), "{found}");
}

#[test]
fn a_missing_face_opens_three_edges() {
    let found = of(&cube().triangles[1..]);
    assert_eq!(found.open_edges, 3);
    assert!(!found.is_closed() && found.is_empty());
    assert_eq!(
        found.to_string(),
        "3 edges with one face only: the surface is open there."
    );
}

#[test]
fn a_turned_face_turns_three_edges() {
    let mut triangles = cube().triangles;
    triangles[4].swap(0, 1);
    let found = of(&triangles);
    assert_eq!((found.turned_edges, found.open_edges), (3, 0));
    assert!(!found.is_closed() && !found.is_empty());
}

#[test]
fn faces_given_twice_are_dropped_once() {
    let mut mesh = cube();
    let [a, b, c] = mesh.triangles[2];
    mesh.triangles.extend([[b, c, a], [b, a, c]]);
    mesh.uv = Some((0..14).map(|i| [[f64::from(i); 2]; 3]).collect());
    let (mended, found) = mesh.mended();
    assert_eq!((found.faces, found.duplicate, found.reverse), (14, 1, 1));
    let words = found.to_string();
    assert!(
        words.contains("1 face given before") && words.contains("the back of one"),
        "{words}"
    );
    assert!(found.is_closed());
    assert_eq!(mended.triangles, cube().triangles);
    assert_eq!(mended.uv.unwrap()[11], [[11.0; 2]; 3]);
}

#[test]
fn three_faces_at_an_edge() {
    let found = of(&[[0, 1, 2], [1, 0, 3], [0, 1, 4]]);
    assert_eq!(found.crowded_edges, 1);
    assert_eq!(found.open_edges, 6);
}

#[test]
fn faces_without_area() {
    // A corner twice; and three corners in a row, which still close the gap between their
    // neighbours.
    let found = of(&[[0, 1, 1], [0, 1, 2]]);
    assert_eq!((found.degenerate, found.open_edges), (1, 3));
    let mut mesh = cube();
    mesh.positions.push(DVec3::new(0.5, 0.0, 0.0));
    // Edge 0–1 lies in a face of the bottom and one of the front: split the latter's side.
    let at = mesh.triangles.iter().position(|t| *t == [0, 1, 5]).unwrap();
    mesh.triangles[at] = [0, 8, 5];
    mesh.triangles.extend([[8, 1, 5], [0, 1, 8]]);
    let (mended, found) = mesh.mended();
    assert_eq!(found.degenerate, 1);
    assert!(found.is_closed(), "{found:?}");
    assert_eq!(mended.triangles.len(), 13);
    assert_eq!(area(&mended), 6.0);
}

#[test]
fn vertices_repeated_along_a_seam_are_no_edge() {
    let mut mesh = Triangles::default();
    for t in cube().triangles {
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(t.map(|c| corners()[c as usize]));
        mesh.triangles.push([first, first + 1, first + 2]);
    }
    // −0 is 0.
    for p in mesh.positions.iter_mut().step_by(2) {
        *p = p.map(|x| if x == 0.0 { -0.0 } else { x });
    }
    is_unit_cube(&mesh);
}

#[test]
fn faces_with_no_vertex_are_survived() {
    let mut mesh = cube();
    mesh.triangles.push([0, 1, 8]);
    mesh.positions[7].x = f64::INFINITY;
    let (mended, found) = mesh.mended();
    // Six at the corner, each of its three sides being halved there, and one without a vertex.
    assert_eq!(found.not_finite, 7);
    assert_eq!(mended.triangles.len(), 6);
    let none = Triangles::default().mended();
    assert!(none.1.is_empty() && !none.1.is_closed());
}

#[test]
fn texture_coordinates_that_are_no_numbers() {
    for wrong in [f64::NAN, f64::INFINITY, 1e38] {
        let mut mesh = crate::scene::mesh::cube();
        if let Some(uv) = &mut mesh.uv {
            uv[5][1][0] = wrong;
        }
        let (mended, found) = mesh.mended();
        assert_eq!((found.not_finite, mended.triangles.len()), (1, 11));
        assert_eq!(mended.uv.map(|uv| uv.len()), Some(11));
    }
}
