use super::*;

mod bodies;
mod defective;
mod forged;
mod formats;
mod lost;
mod scenes;

/// The unit cube's corners, x fastest.
fn corners() -> Vec<DVec3> {
    let bit = |i: u32, k: u32| f64::from(i >> k & 1);
    (0..8)
        .map(|i| DVec3::new(bit(i, 0), bit(i, 1), bit(i, 2)))
        .collect()
}

/// Its faces, counterclockwise from outside.
const QUADS: [[u32; 4]; 6] = [
    [0, 2, 3, 1],
    [4, 5, 7, 6],
    [0, 1, 5, 4],
    [2, 6, 7, 3],
    [0, 4, 6, 2],
    [1, 3, 7, 5],
];

fn cube() -> Triangles {
    let halves = |[a, b, c, d]: [u32; 4]| [[a, b, c], [a, c, d]];
    Triangles {
        positions: corners(),
        triangles: QUADS.into_iter().flat_map(halves).collect(),
        uv: None,
        bare: None,
        paint: None,
    }
}

fn area(mesh: &Triangles) -> f64 {
    let corners = |t: &[u32; 3]| t.map(|c| mesh.positions[c as usize]);
    mesh.triangles
        .iter()
        .map(corners)
        .map(|[a, b, c]| 0.5 * (b - a).cross(c - a).length())
        .sum()
}

/// A file that names nothing beside it.
fn alone(name: &str, bytes: &[u8]) -> Result<Triangles, MeshFileError> {
    read(name, bytes, &mut |uri| panic!("asks for {uri}"))
}

fn is_unit_cube(mesh: &Triangles) {
    assert_eq!(mesh.triangles.len(), 12);
    let found = Defects::of(mesh);
    assert!(found.is_closed() && found.is_empty(), "{found:?}");
    assert!((area(mesh) - 6.0).abs() < 1e-6, "area {}", area(mesh));
    let volume = found.signed_volume;
    assert!((volume - 1.0).abs() < 1e-6, "volume {volume}");
}

/// The cube as PLY text, with properties and an element that do not matter.
fn ply_text() -> String {
    let mut text = String::from(
        "ply\nformat ascii 1.0\ncomment element vertex 3\nelement camera 1\nproperty float a\nproperty list uchar int b\n\
         element vertex 8\nproperty float x\nproperty uchar red\nproperty double y\nproperty int z\n\
         element face 6\nproperty list uchar int vertex_indices\nproperty float quality\nend_header\n0.5 2 7 8\n",
    );
    for p in corners() {
        text += &format!("{} 200 {} {}\n", p.x, p.y, p.z);
    }
    for [a, b, c, d] in QUADS {
        text += &format!("4 {a} {b} {c} {d} 1.5\n");
    }
    text
}

/// The cube as binary PLY; `order` turns the bytes of a number from little endian into the file's
/// order.
fn ply_bytes(format: &str, order: fn(&mut [u8])) -> Vec<u8> {
    let mut bytes = format!(
        "ply\r\nformat {format} 1.0\r\nelement vertex 8\r\nproperty double x\r\nproperty float y\r\nproperty short z\r\n\
         element face 6\r\nproperty list ushort uint vertex_index\r\nend_header\r\n"
    )
    .into_bytes();
    let mut put = |number: &mut [u8]| {
        order(number);
        bytes.extend_from_slice(number);
    };
    for p in corners() {
        put(&mut p.x.to_le_bytes());
        put(&mut (p.y as f32).to_le_bytes());
        put(&mut (p.z as i16).to_le_bytes());
    }
    for quad in QUADS {
        put(&mut 4_u16.to_le_bytes());
        for corner in quad {
            put(&mut corner.to_le_bytes());
        }
    }
    bytes
}

/// The cube as OBJ, with groups, materials and a line that goes on.
fn obj_text() -> String {
    let mut text = String::from("# cube\nmtllib none.mtl\no cube\n");
    for p in corners() {
        text += &format!("v {} {:e} {}\n", p.x, p.y, p.z);
    }
    text += "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1 0\nvn 0 0 1\nusemtl red\r\n";
    for (i, quad) in QUADS.iter().enumerate() {
        let [a, b, c, d] = quad.map(|c| match i % 2 {
            0 => i64::from(c) + 1,
            _ => i64::from(c) - 8,
        });
        text += &format!("s off\nf {a}/1/1 {b}/-3 \\\n {c}/3/-1 {d}/4\n");
    }
    text
}

/// Positions as 4-byte floats, then triangles as 2-byte indices.
fn gltf_buffer(mesh: &Triangles) -> Vec<u8> {
    let floats = mesh.positions.iter().flat_map(|p| p.to_array());
    let mut bytes: Vec<u8> = floats.flat_map(|x| (x as f32).to_le_bytes()).collect();
    let indices = mesh.triangles.iter().flatten();
    bytes.extend(indices.flat_map(|i| (*i as u16).to_le_bytes()));
    bytes
}

/// A glTF document about the cube in [`gltf_buffer`], 96 + 72 bytes, with the given buffer, nodes
/// and scenes.
fn gltf_text(buffer: &str, nodes: &str) -> String {
    format!(
        r#"{{"asset": {{"version": "2.0"}}, "scene": 0, "scenes": [{{"nodes": [0]}}], "nodes": [{nodes}],
"meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}, "indices": 1}}]}}],
"buffers": [{{{buffer} "byteLength": 168}}],
"bufferViews": [{{"buffer": 0, "byteLength": 96}}, {{"buffer": 0, "byteOffset": 96, "byteLength": 72}}],
"accessors": [{{"bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC3"}},
{{"bufferView": 1, "componentType": 5123, "count": 36, "type": "SCALAR"}}]}}"#
    )
}

fn inline_buffer() -> String {
    use base64::prelude::{BASE64_STANDARD, Engine};
    let text = BASE64_STANDARD.encode(gltf_buffer(&cube()));
    format!(r#""uri": "data:application/octet-stream;base64,{text}","#)
}

fn glb(json: &str, chunk: &[u8]) -> Vec<u8> {
    let mut json = json.as_bytes().to_vec();
    json.resize(json.len().next_multiple_of(4), b' ');
    let length = 12 + 8 + json.len() + 8 + chunk.len();
    let mut bytes = b"glTF".to_vec();
    bytes.extend(2_u32.to_le_bytes());
    bytes.extend((length as u32).to_le_bytes());
    for (kind, content) in [(b"JSON", &json[..]), (b"BIN\0", chunk)] {
        bytes.extend((content.len() as u32).to_le_bytes());
        bytes.extend(kind);
        bytes.extend(content);
    }
    bytes
}
