//! Scenes, buffers and forgeries of glTF.

use super::*;

fn with_nodes(nodes: &str) -> Result<Triangles, MeshFileError> {
    alone("a.gltf", gltf_text(&inline_buffer(), nodes).as_bytes())
}

fn with_buffer(uri: &str) -> Result<Triangles, MeshFileError> {
    let buffer = format!(r#""uri": "{uri}","#);
    alone("a.gltf", gltf_text(&buffer, r#"{"mesh": 0}"#).as_bytes())
}

#[test]
fn nodes_place_their_meshes() {
    // Scale, then rotation by 90° about z, then translation: (x, y, z) → (−2y + 1, 3x, 4z); below
    // it (x, y, z) → (x + 1, y, z).
    let nodes = r#"{"translation": [1, 0, 0], "rotation": [0, 0, 0.70710678, 0.70710678], "scale": [3, 2, 4], "children": [1]},
        {"matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 1,0,0,1], "mesh": 0}"#;
    let mesh = with_nodes(nodes).unwrap();
    let lower = mesh.positions.iter().copied().reduce(DVec3::min).unwrap();
    let upper = mesh.positions.iter().copied().reduce(DVec3::max).unwrap();
    assert!(lower.distance(DVec3::new(-1.0, 3.0, 0.0)) < 1e-6, "{lower}");
    assert!(upper.distance(DVec3::new(1.0, 6.0, 4.0)) < 1e-6, "{upper}");
    let found = Defects::of(&mesh);
    assert!(found.is_closed() && (found.signed_volume - 24.0).abs() < 1e-5);
    // A mirror keeps the fronts outside.
    is_unit_cube(&with_nodes(r#"{"scale": [-1, 1, 1], "mesh": 0}"#).unwrap());
}

#[test]
fn nodes_in_a_circle() {
    for nodes in [
        r#"{"children": [0], "mesh": 0}"#,
        r#"{"children": [1]}, {"children": [2]}, {"children": [1]}"#,
        r#"{"children": [1, 1]}, {"mesh": 0}"#,
        r#"{"children": [7]}"#,
        r#"{"mesh": 4}"#,
        r#"{"mesh": 0, "rotation": [0, 0, 0, 0]}"#,
    ] {
        let error = with_nodes(nodes).unwrap_err();
        assert!(matches!(error, MeshFileError::Malformed { .. }), "{error}");
    }
    let chain: Vec<String> = (1..20_000)
        .map(|i| format!(r#"{{"children": [{i}]}}"#))
        .collect();
    let nodes = format!(r#"{}, {{"mesh": 0}}"#, chain.join(","));
    is_unit_cube(&with_nodes(&nodes).unwrap());
}

#[test]
fn small_files_stay_small() {
    // 9000 nodes that share a mesh of 1998 vertices: 1.8·10⁷ vertices, or 430 MB, from 170 kB.
    let children: Vec<String> = (1..=9000).map(|i| i.to_string()).collect();
    let nodes = format!(
        r#"{{"children": [{}]}}, {}"#,
        children.join(","),
        vec![r#"{"mesh": 0}"#; 9000].join(",")
    );
    let text = format!(
        r#"{{"asset": {{"version": "2.0"}}, "scenes": [{{"nodes": [0]}}], "nodes": [{nodes}],
"meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}}}]}}], "buffers": [{{"uri": "a.bin", "byteLength": 24000}}],
"bufferViews": [{{"buffer": 0, "byteLength": 24000}}],
"accessors": [{{"bufferView": 0, "componentType": 5126, "count": 1998, "type": "VEC3"}}]}}"#
    );
    let error = read("a.gltf", text.as_bytes(), &mut |_| Ok(vec![0; 24000])).unwrap_err();
    assert!(
        matches!(error, MeshFileError::TooMany { most, .. } if most == 1 << 22),
        "{error}"
    );
}

#[test]
fn buffers_beside_the_mesh() {
    let text = gltf_text(r#""uri": "parts/the%20cube.bin","#, r#"{"mesh": 0}"#);
    let mesh = read("a.gltf", text.as_bytes(), &mut |uri| {
        assert_eq!(uri, "parts/the cube.bin");
        Ok(gltf_buffer(&cube()))
    });
    is_unit_cube(&mesh.unwrap());
    let error = read("a.gltf", text.as_bytes(), &mut |_| {
        Err(String::from("no such file"))
    });
    assert!(error.unwrap_err().to_string().contains("no such file"));
    let error = read("a.gltf", text.as_bytes(), &mut |_| Ok(vec![0; 100])).unwrap_err();
    assert!(
        matches!(error, MeshFileError::CutShort { left: 100, .. }),
        "{error}"
    );
}

#[test]
fn buffers_outside_the_folder() {
    for uri in [
        "../../etc/passwd",
        "/etc/passwd",
        "file:///etc/passwd",
        "http://localhost/cube.bin",
        "//localhost/cube.bin",
        "parts/../../cube.bin",
        "%2e%2e/cube.bin",
        "..%2Fcube.bin",
        "%2Fetc/passwd",
        "..\\\\cube.bin",
        "C:/cube.bin",
        "~/cube.bin",
        "..",
        "",
    ] {
        let error = with_buffer(uri).unwrap_err();
        assert!(
            matches!(error, MeshFileError::Outside { .. }),
            "{uri}: {error}"
        );
    }
    for uri in [
        "data:text/plain,cube",
        "data:;base64,!!",
        "%zz",
        "%ff",
        "%4",
    ] {
        let error = with_buffer(uri).unwrap_err();
        assert!(
            matches!(error, MeshFileError::Buffer { .. }),
            "{uri}: {error}"
        );
    }
}

#[test]
fn accessors_that_reach_too_far() {
    let text = gltf_text(&inline_buffer(), r#"{"mesh": 0}"#);
    let with = |from: &str, to: &str| {
        assert!(text.contains(from));
        alone("a.gltf", text.replace(from, to).as_bytes()).unwrap_err()
    };
    for (from, to) in [
        (r#""count": 8"#, r#""count": 9"#),
        (r#""count": 8"#, r#""count": 18446744073709551615"#),
        (r#""count": 36"#, r#""count": 4294967296"#),
        (
            r#""count": 8"#,
            r#""count": 8, "byteOffset": 18446744073709551615"#,
        ),
        (r#""byteLength": 96"#, r#""byteLength": 169"#),
        (
            r#""byteLength": 168"#,
            r#""byteLength": 18446744073709551615"#,
        ),
        (r#""byteOffset": 96"#, r#""byteOffset": 97"#),
        (
            r#""byteOffset": 96"#,
            r#""byteOffset": 18446744073709551615"#,
        ),
        (
            r#""byteLength": 96"#,
            r#""byteLength": 96, "byteStride": 252"#,
        ),
    ] {
        let error = with(from, to);
        assert!(
            matches!(error, MeshFileError::CutShort { .. }),
            "{to}: {error}"
        );
    }
    for (from, to) in [
        (
            r#""byteLength": 96"#,
            r#""byteLength": 96, "byteStride": 0"#,
        ),
        (r#""bufferView": 1"#, r#""bufferView": 9"#),
        (r#""indices": 1"#, r#""indices": 2"#),
        (r#""indices": 1"#, r#""indices": 0"#),
        (r#""POSITION": 0"#, r#""POSITION": 1"#),
        (r#""count": 36"#, r#""count": 35"#),
        ("5123", "5122"),
        ("5123", "77"),
    ] {
        let error = with(from, to);
        assert!(
            matches!(error, MeshFileError::Malformed { .. }),
            "{to}: {error}"
        );
    }
    for (from, to) in [
        (r#""version": "2.0""#, r#""version": "1.0""#),
        (
            r#""scene": 0"#,
            r#""extensionsRequired": ["KHR_draco_mesh_compression"], "scene": 0"#,
        ),
    ] {
        let error = with(from, to);
        assert!(
            matches!(error, MeshFileError::Unsupported { .. }),
            "{to}: {error}"
        );
    }
    let short = text.replace(r#""count": 8"#, r#""count": 7"#);
    let error = alone("a.gltf", short.as_bytes()).unwrap_err();
    assert!(
        matches!(
            error,
            MeshFileError::NoVertex {
                index: 7,
                count: 7,
                ..
            }
        ),
        "{error}"
    );
}

/// The cube whose positions are those of buffer view 0, which has 96 bytes, but for those that a
/// sparse accessor puts in their place: `view` names the former if there are any.
fn sparse(
    base: &[u8],
    view: &str,
    indices: &[u8],
    values: &[u8],
) -> Result<Triangles, MeshFileError> {
    let count = indices.len();
    let text = gltf_text(r#""uri": "a.bin","#, r#"{"mesh": 0}"#)
        .replace(r#""byteLength": 168"#, &format!(r#""byteLength": {}"#, 168 + 13 * count))
        .replace(
            r#""byteOffset": 96, "byteLength": 72}"#,
            &format!(
                r#""byteOffset": 96, "byteLength": 72}},
{{"buffer": 0, "byteOffset": 168, "byteLength": {count}}}, {{"buffer": 0, "byteOffset": {}, "byteLength": {}}}"#,
                168 + count,
                12 * count
            ),
        )
        .replace(
            r#"{"bufferView": 0, "componentType": 5126, "count": 8"#,
            &format!(
                r#"{{{view} "sparse": {{"count": {count}, "indices": {{"bufferView": 2, "componentType": 5121}}, "values": {{"bufferView": 3}}}}, "componentType": 5126, "count": 8"#
            ),
        );
    let bytes = [base, &gltf_buffer(&cube())[96..], indices, values].concat();
    read("a.gltf", text.as_bytes(), &mut |_| Ok(bytes.clone()))
}

#[test]
fn sparse_accessors_replace_single_elements() {
    let right = &gltf_buffer(&cube())[..96];
    let of = |k: usize| &right[12 * k..12 * (k + 1)];
    let mut wrong = right.to_vec();
    wrong[24..36].copy_from_slice(of(7));
    wrong[60..72].copy_from_slice(of(0));
    let (view, values) = (r#""bufferView": 0,"#, [of(2), of(5)].concat());
    is_unit_cube(&sparse(&wrong, view, &[2, 5], &values).unwrap());
    // Those that are not named are 0 where there is no other view: so is the cube's first vertex.
    assert_eq!(of(0), [0; 12]);
    let all: Vec<u8> = (1..8).collect();
    is_unit_cube(&sparse(&wrong, "", &all, &right[12..]).unwrap());
    for indices in [[5, 2], [2, 2], [2, 8]] {
        let error = sparse(&wrong, view, &indices, &values)
            .unwrap_err()
            .to_string();
        assert!(
            error.starts_with("accessor 0: its sparse indices do not grow"),
            "{error}"
        );
    }
    // Zeros have no bytes in the file that would bound them.
    let text = gltf_text(&inline_buffer(), r#"{"mesh": 0}"#).replace(
        r#"{"bufferView": 0, "componentType": 5126, "count": 8"#,
        r#"{"sparse": {"count": 0, "indices": {"bufferView": 1, "componentType": 5121}, "values": {"bufferView": 0}}, "componentType": 5126, "count": 9000000000"#,
    );
    let error = alone("a.gltf", text.as_bytes()).unwrap_err();
    assert!(matches!(error, MeshFileError::TooMany { .. }), "{error}");
}

#[test]
fn colours_that_are_not_read_are_told() {
    let paint = |name: &str, text: &str| alone(name, text.as_bytes()).unwrap().paint;
    let told = |what: &str| Some(String::from(what));
    assert_eq!(paint("a.obj", &obj_text()), told("materials in `none.mtl`"));
    let spaced = "v 0 0 0\nv 1 0 0\nv 0 1 0\n  mtllib my body.mtl # library\r\nf 1 2 3\n";
    assert_eq!(paint("a.obj", spaced), told("materials in `my body.mtl`"));
    assert_eq!(paint("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), None);
    assert_eq!(paint("a.ply", &ply_text()), told("colours"));
    assert_eq!(paint("a.ply", &ply_text().replace("red", "heat")), None);
    let plain = gltf_text(&inline_buffer(), r#"{"mesh": 0}"#);
    let painted = plain.replace(r#""indices": 1}"#, r#""indices": 1, "material": 0}"#);
    assert_eq!(paint("a.gltf", &painted), told("materials"));
    assert_eq!(paint("a.gltf", &plain), None);
}

#[test]
fn containers_that_lie_about_their_lengths() {
    let bytes = glb(&gltf_text("", r#"{"mesh": 0}"#), &gltf_buffer(&cube()));
    let chunk = bytes.len() - 168 - 8;
    for (at, values) in [
        (
            8,
            &[0, 11, 12, 19, 20, 27, bytes.len() as u32 + 1, u32::MAX][..],
        ),
        (12, &[u32::MAX, 1 << 31]),
        (chunk, &[169, u32::MAX]),
    ] {
        for value in values {
            let mut wrong = bytes.clone();
            wrong[at..at + 4].copy_from_slice(&value.to_le_bytes());
            let error = alone("a.glb", &wrong).unwrap_err();
            assert!(
                matches!(
                    error,
                    MeshFileError::CutShort { .. } | MeshFileError::Malformed { .. }
                ),
                "{at} {value}: {error}"
            );
        }
    }
    let mut wrong = bytes.clone();
    wrong[8] += 1;
    let error = alone("a.glb", &wrong).unwrap_err();
    let cut = matches!(error, MeshFileError::CutShort { left, .. } if left == bytes.len());
    assert!(cut, "{error}");
    let mut wrong = bytes.clone();
    wrong[4] = 1;
    let error = alone("a.glb", &wrong).unwrap_err();
    assert!(
        matches!(error, MeshFileError::Unsupported { .. }),
        "{error}"
    );
}

#[test]
fn texture_coordinates_are_turned_up() {
    // One triangle as a strip and as a fan; u and v as normalised bytes.
    for (mode, expected) in [(5, [0, 1, 2]), (6, [1, 2, 0])] {
        let text = format!(
            r#"{{"asset": {{"version": "2.0"}}, "scenes": [{{"nodes": [0]}}], "nodes": [{{"mesh": 0}}],
"meshes": [{{"primitives": [{{"mode": {mode}, "attributes": {{"POSITION": 0, "TEXCOORD_0": 1}}}}, {{"mode": 1, "attributes": {{"POSITION": 0}}}}]}}],
"buffers": [{{"uri": "a.bin", "byteLength": 48}}],
"bufferViews": [{{"buffer": 0, "byteLength": 36}}, {{"buffer": 0, "byteOffset": 36, "byteLength": 12, "byteStride": 4}}],
"accessors": [{{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}},
{{"bufferView": 1, "componentType": 5121, "normalized": true, "count": 3, "type": "VEC2"}}]}}"#
        );
        let floats = [0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
        let mut bytes: Vec<u8> = floats.iter().flat_map(|x| x.to_le_bytes()).collect();
        bytes.extend([0, 255, 9, 9, 255, 51, 9, 9, 0, 0, 9, 9]);
        let mesh = read("a.gltf", text.as_bytes(), &mut |_| Ok(bytes.clone())).unwrap();
        assert_eq!(mesh.triangles, [expected]);
        let uv = [[0.0, 0.0], [1.0, 0.8], [0.0, 1.0]];
        assert_eq!(mesh.uv, Some(vec![expected.map(|c| uv[c as usize])]));
    }
}
