use super::*;

#[test]
fn every_format_gives_the_unit_cube() {
    is_unit_cube(&cube());
    is_unit_cube(&alone("cube.ply", ply_text().as_bytes()).unwrap());
    is_unit_cube(&alone("cube.PLY", &ply_bytes("binary_little_endian", |_| ())).unwrap());
    is_unit_cube(&alone("cube.ply", &ply_bytes("binary_big_endian", |n| n.reverse())).unwrap());
    is_unit_cube(&alone("cube.obj", obj_text().as_bytes()).unwrap());
    let inline = gltf_text(&inline_buffer(), r#"{"mesh": 0}"#);
    is_unit_cube(&alone("cube.gltf", inline.as_bytes()).unwrap());
    let binary = glb(&gltf_text("", r#"{"mesh": 0}"#), &gltf_buffer(&cube()));
    is_unit_cube(&alone("cube.glb", &binary).unwrap());
}

#[test]
fn obj_corners_carry_their_texture_coordinates() {
    let mesh = alone("cube.obj", obj_text().as_bytes()).unwrap();
    // A byte order mark is no part of the first statement.
    let marked = "\u{feff}v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\n";
    assert_eq!(
        alone("a.obj", marked.as_bytes()).unwrap().positions.len(),
        4
    );
    let uv = mesh.uv.unwrap();
    let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    for pair in uv.chunks(2) {
        assert_eq!(pair, [[0, 1, 2], [0, 2, 3]].map(|t| t.map(|k| square[k])));
    }
    // One corner without: none is made up.
    let partly = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0.5 0.5\nf 1/1 2 3\n";
    assert_eq!(alone("t.obj", partly.as_bytes()).unwrap().uv, None);
    let two =
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n\nf 2 4 3\n";
    let mesh = alone("t.obj", two.as_bytes()).unwrap();
    assert_eq!((mesh.uv, mesh.bare.as_deref()), (None, Some("line 10")));
}

#[test]
fn obj_faces_may_stand_before_their_vertices() {
    let text = "f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n";
    let mesh = alone("t.obj", text.as_bytes()).unwrap();
    assert_eq!(mesh.triangles, [[0, 1, 2]]);
    let error = alone("t.obj", b"\nf 1 2 4\nv 0 0 0\nv 1 0 0\nv 0 1 0\n").unwrap_err();
    assert_eq!(
        error.to_string(),
        "line 2 names vertex 4 of 3: export the mesh again"
    );
}

/// An M, its corners counted from each in turn, and before its vertices: the same area.
#[test]
fn concave_faces_have_their_area_whatever_their_first_corner() {
    let corners = [[0, 0], [1, 0], [2, 2], [3, 0], [4, 0], [4, 4], [0, 4]];
    let vertices = |head: &str| -> String {
        let lines = corners.iter().map(|[x, y]| format!("{head}{x} {y} 3\n"));
        lines.collect()
    };
    for first in 0..7 {
        let list = |from: usize| -> String {
            let corners = (0..7).map(|k| ((first + k) % 7 + from).to_string());
            corners.collect::<Vec<_>>().join(" ")
        };
        let obj = [
            format!("{}f {}\n", vertices("v "), list(1)),
            format!("f {}\n{}", list(1), vertices("v ")),
        ];
        let ply = |elements: [String; 2]| {
            let [a, b] = elements;
            let [v, f] = [
                "element vertex 7\nproperty float x\nproperty float y\nproperty float z\n",
                "element face 1\nproperty list uchar int vertex_indices\n",
            ];
            let is_early = a.starts_with('7');
            let head = if is_early { [f, v] } else { [v, f] }.concat();
            format!("ply\nformat ascii 1.0\n{head}end_header\n{a}{b}")
        };
        let face = format!("7 {}\n", list(0));
        let ply = [ply([vertices(""), face.clone()]), ply([face, vertices("")])];
        let files = obj
            .iter()
            .map(|t| ("m.obj", t))
            .chain(ply.iter().map(|t| ("m.ply", t)));
        for (name, text) in files {
            let mesh = alone(name, text.as_bytes()).unwrap_or_else(|e| panic!("{e}: {text}"));
            // 4 × 4 less a triangle of base 2 and height 2.
            assert!(
                (area(&mesh) - 14.0).abs() < 1e-12,
                "{name} {first}: {}",
                area(&mesh)
            );
            assert_eq!(mesh.triangles.len(), 5);
        }
    }
    let crossed = "v 0 0 0\nv 2 2 0\nv 2 0 0\nv 0 3 0\n\nf 1 2 3 4\n";
    let error = alone("m.obj", crossed.as_bytes()).unwrap_err().to_string();
    assert!(
        error.starts_with("line 6: the sides of the face cross"),
        "{error}"
    );
}

#[test]
fn strips_of_a_ply_are_named() {
    let strips = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
        element tristrips 1\nproperty list int int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    let error = alone("m.ply", strips.as_bytes()).unwrap_err().to_string();
    assert!(
        error.contains("strips") && error.contains("export the mesh as faces"),
        "{error}"
    );
}

#[test]
fn ply_vertices_may_carry_texture_coordinates() {
    for [u, v] in [["s", "t"], ["u", "v"], ["texture_u", "texture_v"]] {
        let text = format!(
            "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
             property float {u}\nproperty float {v}\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n\
             0 0 0 0.25 0.5\n1 0 0 1 0\n0 1 0 0 1\n3 0 1 2"
        );
        let mesh = alone("t.ply", text.as_bytes()).unwrap();
        assert_eq!(mesh.uv, Some(vec![[[0.25, 0.5], [1.0, 0.0], [0.0, 1.0]]]));
    }
}

#[test]
fn what_is_written_is_read_back() {
    let mut mesh = sphere(200);
    mesh.positions[3] = DVec3::new(0.1, -1e300, std::f64::consts::PI);
    let colours: Vec<[u8; 3]> = (0..mesh.triangles.len())
        .map(|i| [i as u8, 10, 255])
        .collect();
    let reflectances: Vec<f64> = (0..mesh.triangles.len()).map(|i| i as f64 / 3.0).collect();
    let full = FaceValues {
        colours: Some(&colours),
        reflectances: Some(&reflectances),
    };
    for corner in mesh.uv.iter_mut().flatten().flatten() {
        *corner = corner.map(|x| f64::from(x as f32));
    }
    for values in [FaceValues::default(), full] {
        mesh.paint = values.colours.map(|_| String::from("colours"));
        assert_eq!(alone("t.ply", &to_ply(&mesh, values)).unwrap(), mesh);
    }
    mesh.uv = None;
    assert_eq!(alone("t.ply", &to_ply(&mesh, full)).unwrap(), mesh);
}

#[test]
fn written_faces_hold_their_values_where_the_header_says() {
    let mut mesh = cube();
    mesh.triangles.truncate(1);
    let values = FaceValues {
        colours: Some(&[[1, 2, 3]]),
        reflectances: Some(&[0.75]),
    };
    let bytes = to_ply(&mesh, values);
    let (_, tail) = bytes.split_at(bytes.len() - 24);
    let mut expected = vec![3, 0, 0, 0, 0, 2, 0, 0, 0, 3, 0, 0, 0, 1, 2, 3];
    expected.extend(0.75_f64.to_le_bytes());
    assert_eq!(tail, expected);
}

#[test]
fn names_and_contents_must_agree() {
    for name in ["cube", "cube.stl", "ply"] {
        let error = alone(name, b"ply\n").unwrap_err();
        assert!(
            matches!(error, MeshFileError::UnknownFormat { .. }),
            "{error}"
        );
    }
    for name in ["a.ply", "a.obj", "a.gltf", "a.glb"] {
        let error = alone(name, b"\0stl solid").unwrap_err();
        assert!(
            matches!(error, MeshFileError::NotTheFormat { .. }),
            "{error}"
        );
    }
    for (name, text) in [
        ("a.obj", "v 0 0 0\nl 1 1\n"),
        (
            "a.ply",
            "ply\nformat ascii 1.0\nelement vertex 1\nproperty int x\nproperty int y\nproperty int z\nend_header\n0 0 0\n",
        ),
        (
            "a.gltf",
            r#"{"asset": {"version": "2.0"}, "scenes": [{"nodes": []}]}"#,
        ),
    ] {
        assert_eq!(alone(name, text.as_bytes()), Err(MeshFileError::NoFaces));
    }
}
