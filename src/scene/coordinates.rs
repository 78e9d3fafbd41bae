//! What a surface needs of its mesh's texture coordinates.

use super::error::{Fault, keys};
use super::pieces::{self, Grid};
use super::surface::{Division, Role, Surface};
use super::texture::{Texture, Wrap};
use crate::geometry::{Instance, Shape};

/// Cells of textures and elements that the triangles of a surface may cover, about.
const MOST_COVERED: f64 = (1_u64 << 28) as f64;
/// How much of an element may lie in two places: coordinates are rounded, and seams overlap a
/// little.
const SEAM: f64 = 1e-3;

/// Refuses a surface whose mesh has no texture coordinates for its albedo or its elements
/// (`bare`: the first face that has none where others have), or has none that mean anything.
pub(super) fn refuse_unfit(surface: &Surface, bare: Option<&str>) -> Result<(), Fault> {
    let Shape::Instance(body) = &surface.shape else {
        return Ok(());
    };
    let in_cells = surface.role == Role::Hidden && surface.division == Division::Cells;
    let is_varied = !matches!(surface.albedo, Texture::Constant(_));
    let Some(uv) = body.mesh().uv() else {
        return missing(&surface.name, [in_cells, is_varied], bare);
    };
    let mut grids = Vec::new();
    if is_varied {
        grids.push(Grid::of_texture(&surface.albedo));
    }
    if in_cells {
        grids.push(surface.grid(surface.elements));
    }
    for grid in &grids {
        let covered: f64 = uv.iter().map(|t| grid.pieces(t)).sum();
        if covered > MOST_COVERED {
            let cause = format!(
                "the texture coordinates of `{}` cover {covered:.1e} cells of its texture or elements",
                surface.name
            );
            let cure = "let them repeat the picture less often, or use a coarser one";
            return Err(Fault::new(keys!["mesh"], cause, cure));
        }
    }
    if in_cells {
        refuse_tiles(surface, body)?;
    }
    Ok(())
}

fn missing(name: &str, [in_cells, is_varied]: [bool; 2], bare: Option<&str>) -> Result<(), Fault> {
    let cause = |what: &str| {
        let face = bare.map_or(String::new(), |place| {
            format!(": the face in {place} of the file has none, and others have")
        });
        format!("the mesh of `{name}` has no texture coordinates for {what}{face}")
    };
    if in_cells {
        let cure = "write `elements = \"faces\"`, or use a mesh with texture coordinates";
        return Err(Fault::new(keys!["elements"], cause("cells of them"), cure));
    }
    if is_varied {
        let cause = cause("an albedo that varies");
        let cure = "use a constant albedo, or a mesh with texture coordinates";
        return Err(Fault::new(keys!["material"], cause, cure));
    }
    Ok(())
}

/// Refuses elements that would lie in several places because coordinates repeat the picture.
fn refuse_tiles(surface: &Surface, body: &Instance) -> Result<(), Fault> {
    let uv = body.mesh().uv().unwrap_or_default();
    let places = || uv.as_flattened().iter();
    if places().all(|p| p.iter().all(|x| (0.0..=1.0).contains(x))) {
        return Ok(());
    }
    let grid = surface.grid(surface.elements);
    if grid.wrap == Wrap::Clamp {
        return Ok(());
    }
    // By element: its first tile, whether there are others, and how often it is covered.
    let mut found = vec![(None, false, 0.0); grid.count[0] * grid.count[1]];
    let cell = 1.0 / found.len() as f64;
    for triangle in uv {
        for piece in grid.cut(pieces::whole(*triangle)) {
            let (first, others, covered) = &mut found[piece.cell];
            let tile = *first.get_or_insert(piece.tile);
            *others |= tile != piece.tile;
            *covered += pieces::extent(&piece.corners) / cell;
        }
    }
    if !found
        .iter()
        .any(|(_, others, covered)| *others && *covered > 1.0 + SEAM)
    {
        return Ok(());
    }
    let range = |d: usize| {
        let ends = (f64::INFINITY, f64::NEG_INFINITY);
        places().fold(ends, |(low, high), p| (low.min(p[d]), high.max(p[d])))
    };
    let ((u0, u1), (v0, v1)) = (range(0), range(1));
    let cause = format!(
        "elements of `{}` lie in several places: its texture coordinates go from u = {u0} to {u1} and from v = {v0} to {v1}, and an element is the same cell of each repetition of [0, 1]",
        surface.name
    );
    let cure = "write `elements = \"faces\"`, or lay the mesh out once on [0, 1] and repeat the picture itself";
    Err(Fault::new(keys!["elements"], cause, cure))
}
