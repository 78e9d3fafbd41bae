//! The shape of a surface, as its table says.

use super::Sources;
use crate::geometry::{DVec3, Disc, Parallelogram, Shape, Sphere};
use crate::scene::error::{Fault, keys};
use crate::scene::file::SurfaceTable;
use crate::scene::surface::Surface;
use crate::scene::warning::Warning;

pub(super) fn shape(
    table: &SurfaceTable,
    earlier: &[Surface],
    sources: &mut Sources<'_>,
) -> Result<Shape, Fault> {
    let v = DVec3::from_array;
    match (&table.rectangle, &table.sphere, &table.disc, &table.mesh) {
        (Some(r), None, None, None) => {
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
        (None, None, Some(d), None) => Disc::new(v(d.centre), v(d.normal), d.radius)
            .map(Shape::Disc)
            .ok_or_else(|| {
                let cause = format!("disc `{}` has no area or no normal", table.name);
                let cure = "use a finite centre, a normal that is not zero and a positive radius";
                Fault::new(keys!["disc"], cause, cure)
            }),
        (None, None, None, Some(m)) => {
            let (body, told) = sources
                .meshes
                .place(m, earlier, sources.files)
                .map_err(|f| f.within(keys!["mesh"]))?;
            let defects = told.defects;
            sources.bare = told.bare;
            if let Some(paint) = told.paint {
                let name = table.name.clone();
                sources.found.push(Warning::MeshPaint(name, paint));
            }
            let open = m.closed == Some(true) && !defects.is_closed();
            if open || !defects.is_empty() {
                let name = table.name.clone();
                sources.found.push(Warning::Mesh(name, defects));
            }
            Ok(Shape::Instance(body))
        }
        (None, Some(s), None, None) => {
            let sphere = Sphere::new(v(s.centre), s.radius, s.face).ok_or_else(|| {
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
        shapes => Err(Fault::new(
            keys![],
            format!(
                "surface `{}` needs exactly one of `rectangle`, `disc`, `sphere` and `mesh`",
                table.name
            ),
            match shapes {
                (None, None, None, None) => "add `rectangle = { corner = […], u = […], v = […] }`",
                _ => "keep one of them",
            },
        )),
    }
}
