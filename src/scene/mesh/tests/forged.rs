use super::*;

fn samples() -> Vec<(&'static str, Vec<u8>)> {
    let node = r#"{"mesh": 0, "scale": [1, 1, 1]}"#;
    vec![
        ("a.ply", ply_text().into_bytes()),
        ("a.ply", ply_bytes("binary_little_endian", |_| ())),
        ("a.ply", ply_bytes("binary_big_endian", |n| n.reverse())),
        ("a.ply", to_ply(&rectangle(2, 2), FaceValues::default())),
        ("a.obj", obj_text().into_bytes()),
        (
            "a.obj",
            b"v 0 0 0\nv 1 0 0\nv 0 1 0\nfo 1 2 3\nsurf 0 1 0 1 1 2 3\ncall b.obj\n".to_vec(),
        ),
        ("a.gltf", gltf_text(&inline_buffer(), node).into_bytes()),
        ("a.gltf", moved_gltf().into_bytes()),
        ("a.glb", glb(&gltf_text("", node), &gltf_buffer(&cube()))),
    ]
}

/// A target whose weight is 0, and the name of an extension.
fn moved_gltf() -> String {
    let node = r#"{"mesh": 0, "weights": [0]}"#;
    let targets = r#""indices": 1, "targets": [{"POSITION": 0}]}], "weights": [1]}"#;
    gltf_text(&inline_buffer(), node)
        .replace(r#""indices": 1}]}"#, targets)
        .replace(
            r#""scene": 0"#,
            r#""extensionsUsed": ["KHR_lights_punctual"], "scene": 0"#,
        )
}

/// Whatever comes of it, it comes without a panic and can be judged and mended.
fn survives(name: &str, bytes: &[u8]) {
    let read = read(name, bytes, &mut |_| Err(String::from("not there")));
    match read {
        Ok(mesh) => {
            let (mended, _) = mesh.mended();
            let count = mended.positions.len();
            assert!(
                mended
                    .triangles
                    .iter()
                    .flatten()
                    .all(|c| (*c as usize) < count)
            );
        }
        Err(error) => assert!(error.to_string().contains(": "), "no cure: {error}"),
    }
}

#[test]
fn cut_at_any_byte() {
    for (name, bytes) in samples() {
        for length in 0..bytes.len() {
            survives(name, &bytes[..length]);
        }
    }
}

#[test]
fn any_byte_wrong() {
    for (name, bytes) in samples() {
        for at in 0..bytes.len() {
            for value in [
                0,
                b' ',
                b'-',
                b'0',
                b'9',
                0x7f,
                0xff,
                bytes[at] ^ 1,
                bytes[at] ^ 0x80,
            ] {
                let mut wrong = bytes.clone();
                wrong[at] = value;
                survives(name, &wrong);
            }
        }
    }
}

#[test]
fn more_faces_than_bytes() {
    for format in ["ascii", "binary_little_endian", "binary_big_endian"] {
        for count in ["4294967296", "18446744073709551615"] {
            let text = format!(
                "ply\nformat {format} 1.0\nelement face {count}\nproperty list uchar int vertex_indices\nend_header\n3 0 1 2\n"
            );
            let error = alone("a.ply", text.as_bytes()).unwrap_err();
            assert!(
                matches!(error, MeshFileError::CutShort { left: 8, .. }),
                "{error}"
            );
            // Elements that take no bytes could be counted for hours.
            let text = format!("ply\nformat {format} 1.0\nelement nothing {count}\nend_header\n");
            let error = alone("a.ply", text.as_bytes()).unwrap_err();
            assert!(matches!(error, MeshFileError::Malformed { .. }), "{error}");
        }
        // A list that claims 2³² − 1 members.
        let mut bytes = format!(
            "ply\nformat {format} 1.0\nelement face 1\nproperty list uint int vertex_indices\nend_header\n"
        )
        .into_bytes();
        match format {
            "ascii" => bytes.extend(b"4294967295 0 1 2\n"),
            _ => bytes.extend([0xff; 16]),
        }
        let error = alone("a.ply", &bytes).unwrap_err();
        assert!(matches!(error, MeshFileError::Malformed { .. }), "{error}");
    }
}

#[test]
fn a_ply_name_given_twice() {
    for twice in [
        "element vertex 1\nproperty int x\nproperty int y\nproperty int z\nproperty int x\n",
        "element vertex 1\nproperty int x\nproperty int y\nproperty int z\nelement vertex 1\nproperty int x\n",
    ] {
        let text = format!("ply\nformat ascii 1.0\n{twice}end_header\n0 0 0 0\n");
        let error = alone("a.ply", text.as_bytes()).unwrap_err();
        assert!(error.to_string().contains("twice"), "{error}");
    }
}

#[test]
fn faces_that_name_no_vertex() {
    let ply = |face: &str| {
        format!(
            "ply\nformat ascii 1.0\nelement vertex 3\nproperty int x\nproperty int y\nproperty int z\nelement face 1\n\
             property list char int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n{face}\n"
        )
    };
    let obj = |face: &str| format!("v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf {face}\n");
    for (name, text) in [
        ("a.ply", ply("3 0 1 3")),
        ("a.ply", ply("3 0 -1 2")),
        ("a.obj", obj("1 2 4")),
        ("a.obj", obj("0 1 2")),
        ("a.obj", obj("1 2 -4")),
        ("a.obj", obj("1 2 9999999999")),
        ("a.obj", obj("1/1 2/2 3/1")),
        ("a.obj", obj("1/1 2/-2 3/1")),
        ("a.obj", obj("1/1 2/-9223372036854775808 3/1")),
    ] {
        let error = alone(name, text.as_bytes()).unwrap_err();
        assert!(
            matches!(error, MeshFileError::NoVertex { .. }),
            "{text}: {error}"
        );
    }
    let error = alone("a.obj", obj("1 2 0").as_bytes()).unwrap_err();
    assert_eq!(
        error.to_string(),
        "line 5 names vertex 0 of 3: export the mesh again"
    );
    for (name, text) in [
        ("a.ply", ply("2 0 1")),
        ("a.ply", ply("-1")),
        ("a.obj", obj("1 2")),
        ("a.obj", obj("1 2 x")),
        ("a.obj", obj("")),
    ] {
        let error = alone(name, text.as_bytes()).unwrap_err();
        assert!(
            matches!(error, MeshFileError::Malformed { .. }),
            "{text}: {error}"
        );
    }
}

#[test]
fn vertices_that_are_no_numbers_are_a_defect() {
    let mut mesh = cube();
    mesh.positions[7].y = f64::NAN;
    let bytes = to_ply(&mesh, FaceValues::default());
    let obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv nan 0 0\nf 1 2 3\nf 2 3 4\n";
    for (mesh, faces, lost) in [
        (alone("a.ply", &bytes).unwrap(), 12, 6),
        (alone("a.obj", obj.as_bytes()).unwrap(), 2, 1),
    ] {
        let (mended, found) = mesh.mended();
        assert_eq!((found.faces, found.not_finite), (faces, lost));
        assert_eq!(mended.triangles.len(), faces - lost);
        assert!(mended.positions.iter().all(|p| p.is_finite()));
    }
}

proptest::proptest! {
    #[test]
    fn any_bytes(name in 0..4_usize, body in proptest::collection::vec(proptest::num::u8::ANY, 0..200)) {
        let names = ["a.ply", "a.obj", "a.gltf", "a.glb"];
        let starts: [&[u8]; 4] = [b"ply\nformat binary_little_endian 1.0\nelement face 3\nproperty list uint int vertex_index\nend_header\n",
            b"f ", b"{", b"glTF\x02\0\0\0"];
        survives(names[name], &[starts[name], &body[..]].concat());
    }
}
