//! Surfaces.

use super::error::{Fault, keys};
use super::file::{FaceName, RoleName, SurfaceTable};
use super::material::Material;
use super::texture::Texture;
use crate::geometry::{DVec3, Facing, Parallelogram, Shape, Sphere, SurfacePoint};

/// More elements along a side than this are taken for a mistake.
const MOST_ELEMENTS: u32 = 1024;

/// What a surface is there for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// The wall: takes the laser spots (S1) and is what the camera sees (S3).
    Relay,
    /// The object around the corner (S2), to be recovered.
    Hidden,
    /// Anything else that reflects or blocks light.
    Occluder,
}

/// A Lambertian surface: its front reflects, its back is black, both are opaque.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    /// Name, unique in the scene.
    pub name: String,
    /// What it is there for.
    pub role: Role,
    /// Its geometry.
    pub shape: Shape,
    /// Its albedo.
    pub albedo: Texture,
    /// Elements along u and v into which the matrix model divides it; \[0, 0\] unless hidden.
    pub elements: [usize; 2],
}

/// Checks all surfaces.
pub(super) fn from_tables(tables: &[SurfaceTable], wavelength: f64) -> Result<Vec<Surface>, Fault> {
    let mut surfaces: Vec<Surface> = Vec::with_capacity(tables.len());
    for (i, table) in tables.iter().enumerate() {
        let surface =
            Surface::from_table(table, wavelength).map_err(|f| f.within(keys!["surface", i]))?;
        if surfaces.iter().any(|s| s.name == surface.name) {
            let cause = format!("two surfaces are called `{}`", surface.name);
            return Err(Fault::new(
                keys!["surface", i, "name"],
                cause,
                "give each its own name",
            ));
        }
        surfaces.push(surface);
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

/// Two surfaces in one place that face the same way: it would be up to rounding which of them the light meets. Back to back
/// they make a panel with two faces, and edge to edge a larger surface.
fn refuse_coincident(surfaces: &[Surface]) -> Result<(), Fault> {
    for (i, a) in surfaces.iter().enumerate() {
        for (j, b) in surfaces.iter().enumerate().skip(i + 1) {
            let coincide = match (&a.shape, &b.shape) {
                (Shape::Parallelogram(p), Shape::Parallelogram(q)) => {
                    p.normal().dot(q.normal()) > 0.0 && p.overlaps(q)
                }
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
    /// The point above or below (x, y) that shows its front to `device`; of a sphere's two the lower one.
    pub(super) fn facing_at_xy(&self, x: f64, y: f64, device: DVec3) -> Option<SurfacePoint> {
        let mut points = self.shape.at_xy(x, y).into_iter();
        points.find(|p| (device - p.position).dot(p.normal) > 0.0)
    }

    fn from_table(table: &SurfaceTable, wavelength: f64) -> Result<Self, Fault> {
        if table.name.trim().is_empty() {
            return Err(Fault::new(
                keys!["name"],
                "a surface has no name",
                "give it one",
            ));
        }
        let role = match table.role {
            RoleName::Relay => Role::Relay,
            RoleName::Hidden => Role::Hidden,
            RoleName::Occluder => Role::Occluder,
        };
        let shape = shape(table)?;
        let mut no_files = |path: &str| Err(format!("{path}: this scene has no folder to look in"));
        let (material, albedo) = Material::from_table(&table.material, wavelength, &mut no_files)
            .map_err(|f| f.within(keys!["material"]))?;
        if !material.is_lambertian() {
            let cause = "this material is not traced yet";
            return Err(Fault::new(keys!["material"], cause, "use `lambertian`"));
        }
        let elements = match (role, table.elements) {
            (Role::Hidden, Some([nu, nv])) => {
                if !(1..=MOST_ELEMENTS).contains(&nu) || !(1..=MOST_ELEMENTS).contains(&nv) {
                    let cause = format!("{nu} × {nv} elements");
                    let cure = format!("use 1 to {MOST_ELEMENTS} a side");
                    return Err(Fault::new(keys!["elements"], cause, cure));
                }
                [nu as usize, nv as usize]
            }
            (Role::Hidden, None) => {
                return Err(Fault::new(
                    keys![],
                    format!(
                        "hidden surface `{}` does not say into how many elements it is divided",
                        table.name
                    ),
                    "add `elements = [8, 8]` (along u and v)",
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
        if role == Role::Hidden && !shape.is_flat() {
            return Err(Fault::new(
                keys!["sphere"],
                "a hidden surface must be a rectangle: the matrix model divides nothing else into elements",
                "use `rectangle`, or another role",
            ));
        }
        Ok(Self {
            name: table.name.clone(),
            role,
            shape,
            albedo,
            elements,
        })
    }
}

fn shape(table: &SurfaceTable) -> Result<Shape, Fault> {
    let v = DVec3::from_array;
    match (&table.rectangle, &table.sphere) {
        (Some(r), None) => {
            if [r.corner, r.u, r.v]
                .iter()
                .flatten()
                .any(|x| !x.is_finite())
            {
                let cause = format!(
                    "surface `{}` has a coordinate that is not finite",
                    table.name
                );
                return Err(Fault::new(keys!["rectangle"], cause, "use finite numbers"));
            }
            let patch = Parallelogram::new(v(r.corner), v(r.u), v(r.v)).ok_or_else(|| {
                let cause = format!("surface `{}` has no area: u × v vanishes", table.name);
                Fault::new(
                    keys!["rectangle"],
                    cause,
                    "give two edges that are neither zero nor parallel",
                )
            })?;
            Ok(Shape::Parallelogram(patch))
        }
        (None, Some(s)) => {
            let facing = match s.face {
                FaceName::Outside => Facing::Outside,
                FaceName::Inside => Facing::Inside,
            };
            let sphere = Sphere::new(v(s.centre), s.radius, facing).ok_or_else(|| {
                let cause = format!(
                    "sphere `{}` has radius {}: it has no area",
                    table.name, s.radius
                );
                Fault::new(
                    keys!["sphere"],
                    cause,
                    "use a finite centre and a positive radius",
                )
            })?;
            Ok(Shape::Sphere(sphere))
        }
        _ => Err(Fault::new(
            keys![],
            format!(
                "surface `{}` needs exactly one of `rectangle` and `sphere`",
                table.name
            ),
            "add `rectangle = { corner = […], u = […], v = […] }`",
        )),
    }
}
