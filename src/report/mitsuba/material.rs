//! Materials as Python literals.

use super::MitsubaError;
use crate::geometry::DVec3;
use crate::scene::material::{Material, SecondFacet};
use crate::scene::{Surface, Texture};

/// Polar angles of incidence and of reflection and the azimuth between the directions, in degrees,
/// of the values that the program compares: along the normal, into the mirror and beside it, back,
/// grazing, and out of the plane.
const ANGLES: [[f64; 3]; 12] = [
    [0.0, 0.0, 0.0],
    [0.0, 50.0, 0.0],
    [20.0, 35.0, 75.0],
    [30.0, 30.0, 180.0],
    [30.0, 40.0, 170.0],
    [45.0, 45.0, 0.0],
    [50.0, 65.0, 120.0],
    [60.0, 20.0, 30.0],
    [60.0, 60.0, 180.0],
    [70.0, 5.0, 90.0],
    [75.0, 60.0, 150.0],
    [80.0, 80.0, 180.0],
];

/// The kind and its figures; the albedo of all but a mixture stands in the surface.
pub(super) fn literal(material: &Material, surface: &str) -> Result<String, MitsubaError> {
    Ok(match material {
        Material::Lambertian => String::from("(\"lambertian\",)"),
        Material::OrenNayar(m) => format!("(\"oren_nayar\", {:?})", m.ratio()),
        Material::Coated(m) if m.second_facet() == SecondFacet::Passes => {
            format!("(\"paint\", {:?}, {:?})", m.ggx().alpha(), m.index())
        }
        Material::Coated(m) => format!(
            "(\"coated\", {:?}, {:?}, {:?})",
            m.ggx().alpha(),
            m.index(),
            m.internal_reflectance()
        ),
        Material::Conductor(m) => {
            let [eta, k] = m.index();
            format!("(\"conductor\", {:?}, {eta:?}, {k:?})", m.ggx().alpha())
        }
        Material::Measured(_) => {
            return Err(MitsubaError::Measured {
                surface: surface.to_owned(),
            });
        }
        Material::Shining(_) => {
            return Err(MitsubaError::Shining {
                surface: surface.to_owned(),
            });
        }
        Material::Mixture(parts) => {
            let mut list = String::new();
            for part in parts.iter() {
                let inner = literal(&part.material, surface)?;
                list += &format!("({:?}, {:?}, {inner}), ", part.weight, part.albedo);
            }
            format!("(\"mixture\", [{}])", list.trim_end_matches(", "))
        }
    })
}

/// The surface's BRDF where its albedo is largest; nothing if it is Lambertian, for that is nothing
/// to compare.
pub(super) fn values(surface: &Surface) -> String {
    if surface.is_lambertian() {
        return String::new();
    }
    let albedo = match &surface.albedo {
        Texture::Constant(rho) => *rho,
        varied => varied.largest(),
    };
    let direction = |theta: f64, phi: f64| {
        let ((sin, cos), (across, along)) = (libm::sincos(theta), libm::sincos(phi));
        DVec3::new(sin * along, sin * across, cos)
    };
    let value = |angles: &[f64; 3]| {
        let [i, o, phi] = angles.map(f64::to_radians);
        let f = surface
            .material
            .brdf(albedo, direction(i, 0.0), direction(o, phi));
        (f > 0.0).then(|| format!("({albedo:?}, {i:?}, {o:?}, {phi:?}, {f:?})"))
    };
    let values: Vec<String> = ANGLES.iter().filter_map(value).collect();
    format!(", \"brdf\": [{}]", values.join(", "))
}
