//! The bench in three dimensions: what the page's script needs to draw the scene to scale.

mod cluster;
mod surface;
mod ways;

use std::sync::Arc;

use serde::Serialize;

use super::super::drawing::bench_svg;
use super::super::mark::MOST_SPOTS;
use super::super::page::{Library, Packed, Page, Precision};
use super::super::svg::escape;
use crate::geometry::{DVec3, Mesh, Shape};
use crate::scene::{Role, Scene};
use cluster::{Display, shares};
use surface::SurfaceBlock;
use ways::Ways;

/// All meshes together are drawn with at most so many triangles: a processor without graphics draws
/// them 30 times a second.
const MOST_TRIANGLES: usize = 12_000;
/// Bits behind the leading one of a vertex's coordinate, relative to the mesh's box: 1.5e-5 of its
/// size.
const VERTEX_BITS: u32 = 15;
/// Bits of a texture coordinate of a mesh.
const TEXTURE_BITS: u32 = 11;
/// Walls and occluders are framed unless they make the frame larger than this many times what
/// matters.
const ROOM: f64 = 3.0;

/// The scene as the script draws it; lengths in the scene's unit.
#[derive(Serialize)]
struct Bench<'a> {
    name: &'a str,
    unit: &'static str,
    /// What is up: +z, or the front of the surface that the scene calls a floor.
    up: [f64; 3],
    /// Box around spots, view, hidden surfaces, and the others where these stay readable.
    near: [[f64; 3]; 2],
    surfaces: Vec<SurfaceBlock<'a>>,
    meshes: Vec<MeshBlock>,
    spots: Spots,
    /// `None` where a surface shines.
    laser: Option<[f64; 3]>,
    camera: Camera,
    ways: Ways,
}

/// Where a mesh's vertices and triangles are in the blocks `bench-vertices`, `bench-triangles` and
/// `bench-coordinates`.
#[derive(Serialize)]
struct MeshBlock {
    /// How many vertices, in [−1, 1]³ until they are scaled and moved to `centre`.
    vertices: usize,
    triangles: usize,
    /// How many triangles the mesh itself has.
    whole: usize,
    centre: [f64; 3],
    scale: f64,
    /// Whether it has texture coordinates, six numbers a triangle.
    textured: bool,
}

/// The positions are in the block `bench-spots`, three numbers each: spots 0, `step`, 2 · `step` …
#[derive(Serialize)]
struct Spots {
    count: usize,
    step: usize,
}

/// Pinhole and view: pixel (column, row) shows corner + u · (column + ½)/columns + v · (row +
/// ½)/rows.
#[derive(Serialize)]
struct Camera {
    position: [f64; 3],
    corner: [f64; 3],
    u: [f64; 3],
    v: [f64; 3],
    columns: usize,
    rows: usize,
}

/// Adds the section: the drawing that turns, and the side and top views that stay as they are.
pub(super) fn section(page: &mut Page, scene: &Scene) {
    let (bench, display) = bench(scene);
    let mut notes = Vec::new();
    let [shown, whole] = [
        bench.meshes.iter().map(|m| m.triangles).sum::<usize>(),
        bench.meshes.iter().map(|m| m.whole).sum(),
    ];
    if shown < whole {
        notes.push(format!(
            "The rotatable drawing shows {shown} triangles of {whole}: vertices near each other \
             are merged at their mean."
        ));
    }
    let coarse = scene.surfaces.iter().zip(&bench.surfaces);
    let coarse: Vec<&str> = coarse
        .filter(|(_, block)| block.is_reduced())
        .map(|(s, _)| s.name.as_str())
        .collect();
    if !coarse.is_empty() {
        notes.push(format!(
            "The albedo of {} is averaged for this drawing.",
            coarse.join(", ")
        ));
    }
    let notes: String = notes
        .iter()
        .map(|note| format!("<p class=\"note\">{}</p>\n", escape(note)))
        .collect();
    page.section(
        "scene",
        "The scene",
        &format!(
            "<div id=\"bench-3d\"></div>\n{notes}<figure class=\"bench\">\n{}</figure>\n",
            bench_svg(scene)
        ),
    );
    page.json("bench", &bench);
    pack(page, scene, &bench, &display);
    page.needs(Library::Three);
}

/// The packed blocks.
fn pack(page: &mut Page, scene: &Scene, bench: &Bench, display: &[Display]) {
    let spots = scene.laser.beams().iter().step_by(bench.spots.step);
    let spots: Vec<f64> = spots.flat_map(|s| s.target.position.to_array()).collect();
    page.numbers("bench-spots", &Packed::new(&spots, Precision::Single(23)));
    if display.is_empty() {
        return;
    }
    let vertices: Vec<f64> = display
        .iter()
        .zip(&bench.meshes)
        .flat_map(|(d, block)| {
            let centre = DVec3::from_array(block.centre);
            d.positions
                .iter()
                .flat_map(move |p| ((*p - centre) / block.scale).to_array())
        })
        .collect();
    let triangles: Vec<f64> = display
        .iter()
        .flat_map(|d| d.triangles.as_flattened())
        .map(|v| f64::from(*v))
        .collect();
    let coordinates: Vec<f64> = display
        .iter()
        .filter_map(|d| d.uv.as_deref())
        .flat_map(|uv| uv.as_flattened().as_flattened())
        .copied()
        .collect();
    page.numbers(
        "bench-vertices",
        &Packed::new(&vertices, Precision::Single(VERTEX_BITS)),
    );
    page.numbers(
        "bench-triangles",
        &Packed::new(&triangles, Precision::Single(23)),
    );
    page.numbers(
        "bench-coordinates",
        &Packed::new(&coordinates, Precision::Single(TEXTURE_BITS)),
    );
}

/// The block, and the meshes whose numbers are packed beside it.
fn bench(scene: &Scene) -> (Bench<'_>, Vec<Display>) {
    let mut meshes: Vec<Arc<Mesh>> = Vec::new();
    for surface in &scene.surfaces {
        if let Shape::Instance(body) = &surface.shape
            && !meshes.iter().any(|m| Arc::ptr_eq(m, body.mesh()))
        {
            meshes.push(body.mesh().clone());
        }
    }
    let counts: Vec<usize> = meshes.iter().map(|m| m.triangles().len()).collect();
    let display: Vec<Display> = meshes
        .iter()
        .zip(shares(&counts, MOST_TRIANGLES))
        .map(|(mesh, most)| Display::of(mesh, most))
        .collect();
    let blocks = display.iter().zip(&meshes).map(|(d, mesh)| {
        let (low, high) = mesh.bounds();
        MeshBlock {
            vertices: d.positions.len(),
            triangles: d.triangles.len(),
            whole: d.whole,
            centre: (0.5 * (low + high)).to_array(),
            scale: 0.5 * (high - low).max_element(),
            textured: d.uv.is_some(),
        }
    });
    let (camera, spots) = (&scene.camera, scene.laser.beams().len());
    let step = spots.div_ceil(MOST_SPOTS).max(1);
    let bench = Bench {
        name: &scene.name,
        unit: scene.unit.symbol(),
        up: up(scene).to_array(),
        near: near(scene).map(|p| p.to_array()),
        surfaces: scene
            .surfaces
            .iter()
            .map(|s| SurfaceBlock::of(s, &meshes))
            .collect(),
        meshes: blocks.collect(),
        spots: Spots { count: spots, step },
        laser: (!scene.laser.is_shining()).then(|| scene.laser.position.to_array()),
        camera: Camera {
            position: camera.position.to_array(),
            corner: camera.view.corner().to_array(),
            u: camera.view.u().to_array(),
            v: camera.view.v().to_array(),
            columns: camera.columns,
            rows: camera.rows,
        },
        ways: Ways::of(scene, step),
    };
    (bench, display)
}

/// A surface called floor, flat and square to an axis, says by its front what is up; without one it
/// is +z, as in the static drawing.
fn up(scene: &Scene) -> DVec3 {
    let floor = scene
        .surfaces
        .iter()
        .find(|s| s.shape.is_flat() && s.name.to_lowercase().contains("floor"));
    let normal = floor.map_or(DVec3::Z, |s| s.shape.at([0.5, 0.5]).normal);
    let axes = [DVec3::X, DVec3::Y, DVec3::Z];
    axes.into_iter()
        .find(|a| a.dot(normal) > 1.0 - 1e-9)
        .unwrap_or(DVec3::Z)
}

/// The box that the drawing frames: lower and upper corner.
fn near(scene: &Scene) -> [DVec3; 2] {
    let grown = |[low, high]: [DVec3; 2], (l, h): (DVec3, DVec3)| [low.min(l), high.max(h)];
    let size = |[low, high]: [DVec3; 2]| (high - low).max_element();
    let spots = scene.laser.spots.iter().map(|s| s.target.position);
    let mut core = spots
        .chain(scene.camera.view.corners())
        .fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |b, p| {
            grown(b, (p, p))
        });
    for (_, s) in scene.hidden() {
        core = grown(core, s.shape.bounds());
    }
    let others = scene.surfaces.iter().filter(|s| s.role != Role::Hidden);
    others.fold(core, |frame, s| {
        let larger = grown(frame, s.shape.bounds());
        if size(larger) <= ROOM * size(core) {
            larger
        } else {
            frame
        }
    })
}

#[cfg(test)]
#[path = "tests.rs"]
mod tests;
