//! A recovered reflectance on the surface that it belongs to: as a texture, and as a coloured mesh.

use super::encode::{PictureError, grey16};
use crate::geometry::{DAffine3, DVec3, Shape};
use crate::image::Transfer;
use crate::scene::Surface;
use crate::scene::mesh::{FaceValues, Triangles, to_ply};

/// Reflectances of elements iu + iv·nu as a 16-bit grey PNG of nu × nv pixels that a scene takes as
/// a texture with `transfer = "linear"`: the row of the largest v is at the top. What is below 0 or
/// above 1 no albedo can be, and is stored as 0 or 1.
///
/// # Errors
/// [`PictureError`].
pub fn texture_png([nu, nv]: [usize; 2], values: &[f64]) -> Result<Vec<u8>, PictureError> {
    let rows = values.chunks(nu).rev();
    let code = |x: &f64| (65535.0 * Transfer::Linear.encode(x.clamp(0.0, 1.0))).round() as u16;
    let pixels: Vec<u16> = rows.flatten().map(code).collect();
    grey16([nu, nv], &pixels)
}

/// The surface as a PLY mesh, each triangle with the reflectance of its element: as it is under the
/// name `reflectance`, and as a grey between 0 and 1, by the transfer of sRGB, for the eye. A flat
/// or round surface becomes two triangles for each element. `to_file` leads from the scene's
/// coordinates to those of the mesh ([`Scene::to_file`](crate::scene::Scene::to_file)).
pub fn recovered_ply(
    surface: &Surface,
    elements: [usize; 2],
    values: &[f64],
    to_file: &DAffine3,
) -> Vec<u8> {
    let (mut mesh, cells) = match &surface.shape {
        Shape::Instance(body) => {
            let place = |p: &DVec3| body.placement().transform_point3(*p);
            let mesh = Triangles {
                positions: body.mesh().positions().iter().map(place).collect(),
                triangles: body.mesh().triangles().to_vec(),
                uv: body.mesh().uv().map(<[_]>::to_vec),
                bare: None,
                paint: None,
            };
            (mesh, surface.elements_of_triangles(elements))
        }
        _ => net(surface, elements),
    };
    for p in &mut mesh.positions {
        *p = to_file.transform_point3(*p);
    }
    let reflectances: Vec<f64> = cells.iter().map(|c| values[*c]).collect();
    let grey = |x: &f64| (255.0 * Transfer::Srgb.encode(x.clamp(0.0, 1.0))).round() as u8;
    let colours: Vec<[u8; 3]> = reflectances.iter().map(|x| [grey(x); 3]).collect();
    let values = FaceValues {
        colours: Some(&colours),
        reflectances: Some(&reflectances),
    };
    to_ply(&mesh, values)
}

/// The corners of the elements, joined by two triangles each, and the element of each triangle.
fn net(surface: &Surface, [nu, nv]: [usize; 2]) -> (Triangles, Vec<usize>) {
    let corner = |i: usize, j: usize| [i as f64 / nu as f64, j as f64 / nv as f64];
    let mut mesh = Triangles::default();
    let mut cells = Vec::with_capacity(2 * nu * nv);
    let mut uvs = Vec::with_capacity(2 * nu * nv);
    for j in 0..=nv {
        let row = (0..=nu).map(|i| surface.shape.at(corner(i, j)).position);
        mesh.positions.extend(row);
    }
    for cell in 0..nu * nv {
        let (i, j) = (cell % nu, cell / nu);
        let square = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)];
        for corners in [[0, 1, 2], [0, 2, 3]] {
            let corners = corners.map(|k: usize| square[k]);
            let vertices = corners.map(|(i, j)| (j * (nu + 1) + i) as u32);
            mesh.triangles.push(vertices);
            uvs.push(corners.map(|(i, j)| corner(i, j)));
            cells.push(cell);
        }
    }
    mesh.uv = Some(uvs);
    (mesh, cells)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::{Channel, decode};
    use crate::scene::mesh::read;
    use crate::scene::{Role, Scene};

    fn hidden(text: &str) -> Surface {
        let scene = Scene::from_toml("own", text).unwrap();
        let found = scene.surfaces.iter().find(|s| s.role == Role::Hidden);
        found.unwrap().clone()
    }

    /// The picture, laid back on the surface, has every element where it was.
    #[test]
    fn a_texture_is_upright() {
        let values = [0.0, 0.25, 0.5, 0.75, 1.0, 1.25];
        let image = decode("t.png", &texture_png([3, 2], &values).unwrap()).unwrap();
        assert_eq!([image.width, image.height], [3, 2]);
        let read: Vec<f32> = image.channel(Channel::Grey).unwrap().collect();
        let want = [0.75, 1.0, 1.0, 0.0, 0.25, 0.5];
        assert!(
            read.iter().zip(want).all(|(a, b)| (a - b).abs() < 1e-5),
            "{read:?}"
        );
    }

    /// The mesh of a rectangle has its area, and each element a share of it with its own
    /// reflectance; that of a meshed rectangle too.
    #[test]
    fn a_coloured_mesh_covers_the_surface() {
        let bench = Scene::load("bench")
            .unwrap()
            .text
            .replace("elements = [8, 8]", "elements = [3, 2]");
        let line = bench.lines().find(|l| l.contains("corner = [3,")).unwrap();
        let mesh = "mesh = { generate = \"rectangle\", faces = 700, scale = [4, 4.000001, 1], \
            rotate = [{ axis = [1, 0, 0], angle = 135 }], translate = [3, 11.35, 4.15] }";
        let values = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6];
        for text in [bench.clone(), bench.replace(line, mesh)] {
            let surface = hidden(&text);
            let bytes = recovered_ply(&surface, [3, 2], &values, &DAffine3::IDENTITY);
            let mesh = read("own.ply", &bytes, &mut |_| Err(String::new())).unwrap();
            let header = String::from_utf8_lossy(&bytes[..400]).into_owned();
            assert!(header.contains("property double reflectance") && header.contains("uchar red"));
            let end = header.find("end_header\n").unwrap() + 11 + 24 * mesh.positions.len();
            let stride = (bytes.len() - end) / mesh.triangles.len();
            let mut areas = [0.0; 6];
            for (t, triangle) in mesh.triangles.iter().enumerate() {
                let [a, b, c] = triangle.map(|i| mesh.positions[i as usize]);
                let row = &bytes[end + t * stride..end + (t + 1) * stride];
                let value = f64::from_le_bytes(row[stride - 8..].try_into().unwrap());
                let element = values.iter().position(|v| *v == value).unwrap();
                areas[element] += 0.5 * (b - a).cross(c - a).length();
            }
            // 16 in.² in six parts; the triangles of the mesh straddle their borders.
            assert!(
                areas.iter().all(|a| (a - 16.0 / 6.0).abs() < 0.3),
                "{areas:?}"
            );
            assert!((areas.iter().sum::<f64>() - 16.0).abs() < 1e-4);
        }
    }
}
