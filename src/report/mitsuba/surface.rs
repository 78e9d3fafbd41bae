//! Surfaces as Python literals.

use std::sync::Arc;

use super::super::encode::base64;
use super::{MitsubaError, material, text, triple};
use crate::geometry::{Basis, Facing, Instance, Mesh, Shape, Side};
use crate::scene::{Cells, Scene, Surface, Texture, Wrap};

/// MESHES and SURFACES: surfaces that share a mesh share its data.
pub(super) fn literals(scene: &Scene) -> Result<(String, String), MitsubaError> {
    let mut meshes: Vec<&Arc<Mesh>> = Vec::new();
    let mut surfaces = String::from("[\n");
    for (i, s) in scene.surfaces.iter().enumerate() {
        let mut shape = shape(&s.shape);
        match &s.shape {
            Shape::Instance(body) => {
                let known = meshes.iter().position(|m| Arc::ptr_eq(m, body.mesh()));
                let number = known.unwrap_or_else(|| {
                    meshes.push(body.mesh());
                    meshes.len() - 1
                });
                shape += &format!(", \"mesh\": {number}");
                if let Some((key, other)) = other_side(scene, i, body) {
                    shape += &format!(", \"{key}\": {other}");
                }
            }
            Shape::Parallelogram(_) | Shape::Disc(_) => {
                let panel = scene.surfaces.iter().any(|t| back_to_back(s, t));
                shape += if panel {
                    ", \"panel\": True"
                } else {
                    ", \"panel\": False"
                };
            }
            Shape::Sphere(_) => {}
        }
        let name = text(&s.name);
        let albedo = albedo(&s.albedo);
        let material = material::literal(&s.material, &s.name)?;
        let brdf = material::values(s);
        surfaces += &format!(
            "    {{\"name\": {name}, {shape}, \"material\": {material}, \"albedo\": {albedo}{brdf}}},\n"
        );
    }
    let varies = |m: &Arc<Mesh>| {
        scene.surfaces.iter().any(|s| {
            let constant = matches!(s.albedo, Texture::Constant(_));
            matches!(&s.shape, Shape::Instance(b) if Arc::ptr_eq(m, b.mesh())) && !constant
        })
    };
    let mesh = |m: &&Arc<Mesh>| mesh(m, m.uv().filter(|_| varies(m)));
    let meshes: String = meshes.iter().map(mesh).collect();
    Ok((format!("[\n{meshes}]"), surfaces + "]"))
}

fn shape(shape: &Shape) -> String {
    match shape {
        Shape::Parallelogram(p) => format!(
            "\"shape\": \"parallelogram\", \"corner\": {}, \"u\": {}, \"v\": {}, \"normal\": {}",
            triple(p.corner()),
            triple(p.u()),
            triple(p.v()),
            triple(p.normal())
        ),
        Shape::Sphere(p) => format!(
            "\"shape\": \"sphere\", \"centre\": {}, \"radius\": {:?}, \"face\": \"{}\"",
            triple(p.centre),
            p.radius,
            match p.facing {
                Facing::Outside => "outside",
                Facing::Inside => "inside",
            }
        ),
        Shape::Disc(d) => {
            let basis = Basis::around(d.normal());
            format!(
                "\"shape\": \"disc\", \"centre\": {}, \"normal\": {}, \"radius\": {:?}, \"s\": {}, \"t\": {}",
                triple(d.centre()),
                triple(d.normal()),
                d.radius(),
                triple(basis.s),
                triple(basis.t)
            )
        }
        Shape::Instance(b) => {
            let place = b.placement();
            let axes = [
                place.matrix3.x_axis,
                place.matrix3.y_axis,
                place.matrix3.z_axis,
            ];
            format!(
                "\"shape\": \"mesh\", \"axes\": ({}), \"translation\": {}, \"face\": \"{}\"",
                axes.map(triple).join(", "),
                triple(place.translation),
                match b.side() {
                    Side::Outer => "outer",
                    Side::Inner => "inner",
                }
            )
        }
    }
}

/// One entry of MESHES, with texture coordinates if they are given.
fn mesh(mesh: &Mesh, uv: Option<&[[[f64; 2]; 3]]>) -> String {
    let encode = |bytes: Vec<u8>| base64(&bytes);
    let positions = mesh.positions().iter().flat_map(|p| p.to_array());
    let positions = encode(positions.flat_map(f64::to_le_bytes).collect());
    let triangles = mesh.triangles().iter().flatten();
    let triangles = encode(triangles.flat_map(|k| k.to_le_bytes()).collect());
    let uv = uv.map_or(String::new(), |uv| {
        let uv = uv.iter().flatten().flatten();
        let uv = encode(uv.flat_map(|c| (*c as f32).to_le_bytes()).collect());
        format!(", \"uv\": \"{uv}\"")
    });
    format!("    {{\"positions\": \"{positions}\", \"triangles\": \"{triangles}\"{uv}}},\n")
}

/// The number of the surface whose front is the back of mesh `i`, and what that is to it.
fn other_side(scene: &Scene, i: usize, body: &Instance) -> Option<(&'static str, usize)> {
    let turned = Shape::Instance(body.turned());
    let other = scene.surfaces.iter().position(|t| t.shape == turned)?;
    Some((if i < other { "back" } else { "back_of" }, other))
}

/// Whether two flat surfaces lie in one place and face opposite ways.
fn back_to_back(a: &Surface, b: &Surface) -> bool {
    match (&a.shape, &b.shape) {
        (Shape::Parallelogram(p), Shape::Parallelogram(q)) => {
            p.normal().dot(q.normal()) < 0.0 && p.overlaps(q)
        }
        (Shape::Disc(c), Shape::Disc(d)) => c.turned().as_ref() == Some(d),
        _ => false,
    }
}

fn albedo(texture: &Texture) -> String {
    match texture {
        Texture::Constant(rho) => format!("(\"constant\", {rho:?})"),
        Texture::Ramp([a, b]) => format!("(\"ramp\", ({a:?}, {b:?}))"),
        Texture::Bilinear(texels) => {
            let wrap = match texels.wrap {
                Wrap::Clamp => "clamp",
                Wrap::Repeat => "repeat",
            };
            let rows = rows(&texels.albedo, texels.count[0]);
            format!("(\"bilinear\", ({wrap:?}, {rows}))")
        }
        Texture::Tiles(cells) => format!("(\"tiles\", {})", rows(&cells.albedo, cells.count[0])),
        Texture::Cells(cells) => match checks(cells) {
            Some([dark, light]) => {
                let [nu, nv] = cells.count;
                format!("(\"checkerboard\", ({nu}, {nv}, {dark:?}, {light:?}))")
            }
            None => format!("(\"cells\", {})", rows(&cells.albedo, cells.count[0])),
        },
    }
}

/// Values as a list of rows.
fn rows(values: &[f64], width: usize) -> String {
    let rows: Vec<String> = values.chunks(width).map(|row| format!("{row:?}")).collect();
    format!("[{}]", rows.join(", "))
}

/// The dark and the light albedo if the cells alternate.
fn checks(cells: &Cells) -> Option<[f64; 2]> {
    let n = cells.count[0];
    let [dark, light] = [*cells.albedo.first()?, *cells.albedo.get(1)?];
    let alternate = |(k, rho): (usize, &f64)| *rho == [dark, light][(k % n + k / n) % 2];
    (n > 1 && cells.albedo.iter().enumerate().all(alternate)).then_some([dark, light])
}
