//! Meshes as PLY files.

use super::Triangles;

/// Values that a PLY file may hold for each face.
#[derive(Clone, Copy, Debug, Default)]
pub struct FaceValues<'a> {
    /// Red, green and blue (`red`, `green`, `blue`).
    pub colours: Option<&'a [[u8; 3]]>,
    /// Numbers under the name `reflectance`.
    pub reflectances: Option<&'a [f64]>,
}

/// A binary little-endian PLY file: positions as `double`, and by face the vertices as `uint`,
/// texture coordinates by corner in the list `texcoord` as MeshLab reads them, and the values
/// given. [`read`](super::read) gives back the same mesh, but for the rounding of texture
/// coordinates to f32.
///
/// # Panics
/// If there are values and not one for each triangle.
pub fn to_ply(mesh: &Triangles, values: FaceValues<'_>) -> Vec<u8> {
    let faces = mesh.triangles.len();
    let fits = |count: Option<usize>| count.is_none_or(|c| c == faces);
    assert!(
        fits(values.colours.map(<[_]>::len))
            && fits(values.reflectances.map(<[_]>::len))
            && fits(mesh.uv.as_ref().map(Vec::len)),
        "one value for each of {faces} triangles"
    );
    let mut header = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty double x\nproperty double y\nproperty double z\n\
         element face {faces}\nproperty list uchar uint vertex_indices\n",
        mesh.positions.len()
    );
    if mesh.uv.is_some() {
        header += "property list uchar float texcoord\n";
    }
    if values.colours.is_some() {
        header += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
    }
    if values.reflectances.is_some() {
        header += "property double reflectance\n";
    }
    header += "end_header\n";
    let mut bytes = Vec::with_capacity(header.len() + 24 * mesh.positions.len() + 49 * faces);
    bytes.extend(header.as_bytes());
    for position in &mesh.positions {
        bytes.extend(position.to_array().iter().flat_map(|x| x.to_le_bytes()));
    }
    for (i, triangle) in mesh.triangles.iter().enumerate() {
        bytes.push(3);
        bytes.extend(triangle.iter().flat_map(|c| c.to_le_bytes()));
        if let Some(uv) = &mesh.uv {
            bytes.push(6);
            bytes.extend(
                uv[i]
                    .iter()
                    .flatten()
                    .flat_map(|x| (*x as f32).to_le_bytes()),
            );
        }
        if let Some(colours) = values.colours {
            bytes.extend(colours[i]);
        }
        if let Some(reflectances) = values.reflectances {
            bytes.extend(reflectances[i].to_le_bytes());
        }
    }
    bytes
}
