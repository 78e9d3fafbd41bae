//! Surfaces from their tables.

mod shape;

use super::body::Meshes;
use super::coordinates;
use super::error::{Fault, keys};
use super::file::{ElementsTable, Sides, SurfaceTable};
use super::files::Files;
use super::material::Material;
use super::pieces::facets_need;
use super::room::refuse_larger;
use super::surface::{Division, Role, Surface};
use super::texture::AlbedoTable;
use super::warning::Warning;
use super::{FARTHEST, FINEST};
use crate::geometry::Shape;
use shape::shape;

/// More elements along a side than this are taken for a mistake.
const MOST_ELEMENTS: u32 = 1024;
/// More cells in the textures of all surfaces together are taken for a mistake; they take half a
/// gigabyte.
const MOST_CELLS: usize = 1 << 26;
/// A picture or a measured material larger than this is not read: 256 MiB.
const LARGEST_PICTURE: u64 = 256 << 20;

/// The albedo with which a hidden surface of unknown albedo is drawn.
const STAND_IN: f64 = 0.5;

/// Checks all surfaces.
pub(super) fn from_tables(
    tables: &[SurfaceTable],
    files: &mut Files,
    wavelength: f64,
    found: &mut Vec<Warning>,
) -> Result<Vec<Surface>, Fault> {
    let mut surfaces: Vec<Surface> = Vec::with_capacity(tables.len());
    let mut cells = 0;
    let mut meshes = Meshes::default();
    for (i, table) in tables.iter().enumerate() {
        let mut sources = Sources {
            meshes: &mut meshes,
            files: &mut *files,
            wavelength,
            found: &mut *found,
            bare: None,
        };
        let surface = Surface::from_table(table, &surfaces, &mut sources)
            .map_err(|f| f.within(keys!["surface", i]))?;
        if surfaces.iter().any(|s| s.name == surface.name) {
            let cause = format!("two surfaces are called `{}`", surface.name);
            return Err(Fault::new(
                keys!["surface", i, "name"],
                cause,
                "give each its own name",
            ));
        }
        // A back has a copy of its front's texture.
        let copies = 1 + usize::from(table.sides == Some(Sides::Two));
        cells += copies * surface.albedo.held();
        if cells > MOST_CELLS {
            let cause = format!("the textures up to `{}` have {cells} cells", surface.name);
            let cure = format!("use {MOST_CELLS} at most, on all surfaces together");
            return Err(Fault::new(keys!["surface", i, "material"], cause, cure));
        }
        surfaces.push(surface);
    }
    // The backs come last, so that positions in the list are those in the file.
    for (i, table) in tables.iter().enumerate() {
        if table.sides == Some(Sides::Two) {
            let back = surfaces[i]
                .back()
                .map_err(|f| f.within(keys!["surface", i]))?;
            surfaces.push(back);
        }
    }
    refuse_coincident(&surfaces)?;
    if !surfaces.iter().any(|s| s.role == Role::Relay) {
        return Err(Fault::new(
            keys!["surface"],
            "no surface has the role `relay`: there is no wall for laser and camera",
            "add a [[surface]] with role = \"relay\"",
        ));
    }
    Ok(surfaces)
}

/// What surfaces are made from besides their tables.
struct Sources<'a> {
    meshes: &'a mut Meshes,
    files: &'a mut Files,
    wavelength: f64,
    found: &'a mut Vec<Warning>,
    /// The first face of the mesh without texture coordinates, where others have them.
    bare: Option<String>,
}

/// Two surfaces in one place that face the same way: it would be up to rounding which of them the
/// light meets. Back to back they make a panel with two faces, and edge to edge a larger surface.
fn refuse_coincident(surfaces: &[Surface]) -> Result<(), Fault> {
    for (i, a) in surfaces.iter().enumerate() {
        for (j, b) in surfaces.iter().enumerate().skip(i + 1) {
            let coincide = match (&a.shape, &b.shape) {
                (Shape::Parallelogram(p), Shape::Parallelogram(q)) => {
                    p.normal().dot(q.normal()) > 0.0 && p.overlaps(q)
                }
                (Shape::Disc(p), Shape::Disc(q)) => p.overlaps(q),
                (Shape::Disc(d), Shape::Parallelogram(p))
                | (Shape::Parallelogram(p), Shape::Disc(d)) => d.overlaps_patch(p),
                (p, q) => p == q,
            };
            if coincide {
                let cause = format!(
                    "`{}` lies in the plane of `{}` and overlaps it",
                    b.name, a.name
                );
                let cure = "lift one of them by a little, leave a hole in the other, or paint it as a texture";
                return Err(Fault::new(keys!["surface", j], cause, cure));
            }
        }
    }
    Ok(())
}

impl Surface {
    /// A surface in the same place whose front is this one's back.
    fn back(&self) -> Result<Self, Fault> {
        let shape = match &self.shape {
            Shape::Parallelogram(p) => Some(Shape::Parallelogram(p.turned())),
            Shape::Disc(d) => d.turned().map(Shape::Disc),
            Shape::Instance(b) => Some(Shape::Instance(b.turned())),
            Shape::Sphere(_) => None,
        };
        let refused = |cause: &str, cure: &str| Fault::new(keys!["sides"], cause, cure);
        if self.role == Role::Hidden {
            return Err(refused(
                "a hidden surface has one side: the model divides its front into elements",
                "remove `sides`, and put an occluder behind it if its back is to be seen",
            ));
        }
        let shape = shape.ok_or_else(|| {
            refused(
                "a sphere has one side, inside or outside",
                "remove `sides`, or add a second sphere that differs a little in radius",
            )
        })?;
        Ok(Self {
            name: format!("{} (back)", self.name),
            shape,
            ..self.clone()
        })
    }

    fn from_table(
        table: &SurfaceTable,
        earlier: &[Self],
        sources: &mut Sources<'_>,
    ) -> Result<Self, Fault> {
        if table.name.trim().is_empty() {
            return Err(Fault::new(
                keys!["name"],
                "a surface has no name",
                "give it one",
            ));
        }
        let role = table.role;
        let shape = shape(table, earlier, sources)?;
        refuse_beyond_numbers(&table.name, &shape)?;
        let wavelength = sources.wavelength;
        let files = &mut *sources.files;
        let mut read = |path: &str| files.bytes_or_words(path, LARGEST_PICTURE);
        let is_known = role != Role::Hidden
            || ![&table.material.lambertian, &table.material.shining]
                .iter()
                .any(|albedo| matches!(albedo, Some(AlbedoTable::Unknown(_))));
        let mut painted = table.material.clone();
        let stated = [&mut painted.lambertian, &mut painted.shining];
        for albedo in stated.into_iter().flatten().filter(|_| !is_known) {
            *albedo = STAND_IN.into();
        }
        let (material, albedo) = Material::from_table(&painted, wavelength, &mut read)
            .map_err(|f| f.within(keys!["material"]))?;
        let elements = match (role, table.elements) {
            (Role::Hidden, Some(ElementsTable::Faces(_))) => {
                let Shape::Instance(body) = &shape else {
                    let cause = "only a mesh can be divided into its faces";
                    let cure = "give elements along u and v: `elements = [8, 8]`";
                    return Err(Fault::new(keys!["elements"], cause, cure));
                };
                [body.mesh().triangles().len(), 1]
            }
            (Role::Hidden, Some(ElementsTable::Grid([nu, nv]))) => {
                if !(1..=MOST_ELEMENTS).contains(&nu) || !(1..=MOST_ELEMENTS).contains(&nv) {
                    let cause = format!("{nu} × {nv} elements");
                    let cure = format!("use 1 to {MOST_ELEMENTS} a side");
                    return Err(Fault::new(keys!["elements"], cause, cure));
                }
                [nu as usize, nv as usize]
            }
            (Role::Hidden, None) => {
                let faces = matches!(shape, Shape::Instance(_));
                return Err(Fault::new(
                    keys![],
                    format!(
                        "hidden surface `{}` does not say into how many elements it is divided",
                        table.name
                    ),
                    if faces {
                        "add `elements = \"faces\"`, or `elements = [8, 8]` along its texture coordinates"
                    } else {
                        "add `elements = [8, 8]` (along u and v)"
                    },
                ));
            }
            (_, None) => [0, 0],
            (_, Some(_)) => {
                return Err(Fault::new(
                    keys!["elements"],
                    "only a hidden surface is divided into elements",
                    "remove `elements`, or set role = \"hidden\"",
                ));
            }
        };
        let division = match table.elements {
            Some(ElementsTable::Faces(_)) => Division::Faces,
            _ => Division::Cells,
        };
        let surface = Self {
            name: table.name.clone(),
            role,
            shape,
            material,
            albedo,
            is_known,
            elements,
            division,
        };
        coordinates::refuse_unfit(&surface, sources.bare.as_deref())?;
        surface.refuse_large()?;
        Ok(surface.in_facets())
    }

    /// Refuses a mesh whose facets do not fit into memory.
    fn refuse_large(&self) -> Result<(), Fault> {
        let Shape::Instance(body) = &self.shape else {
            return Ok(());
        };
        let what = format!(
            "surface `{}`, cut along the edges of its texture,",
            self.name
        );
        refuse_larger(
            &what,
            facets_need(body, &self.albedo),
            "use a coarser texture",
        )
    }
}

/// Sizes whose squares or inverses a number cannot hold.
fn refuse_beyond_numbers(name: &str, shape: &Shape) -> Result<(), Fault> {
    let (low, high) = shape.bounds();
    let far = low.abs().max(high.abs()).max_element();
    let area = shape.area();
    let cause = if !(0.0..=FARTHEST).contains(&far) {
        format!("surface `{name}` reaches to {far}, farther than {FARTHEST:e}")
    } else if !(FINEST * FINEST..).contains(&area) {
        format!("surface `{name}` has an area of {area}, less than {FINEST:e} squared")
    } else {
        return Ok(());
    };
    Err(Fault::new(keys![], cause, "use another unit of length"))
}
