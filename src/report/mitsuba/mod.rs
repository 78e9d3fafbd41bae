//! A scene as a program for another renderer: Mitsuba 3.
//!
//! The file holds the scene as Python literals between the head of a program and its body, which
//! are the same for every scene (`head.py`, which says how each part is translated, then
//! `surfaces.py`, `materials.py`, `light.py`, `camera.py`). Coordinates stay the scene's own, in
//! f64.

mod material;
mod spot;
mod surface;

use std::fmt::Write as _;

use crate::geometry::DVec3;
use crate::scene::Scene;

const HEAD: &str = include_str!("head.py");
const BODY: [&str; 4] = [
    include_str!("surfaces.py"),
    include_str!("materials.py"),
    include_str!("light.py"),
    include_str!("camera.py"),
];

/// Why a scene cannot be written for Mitsuba.
#[derive(Debug, PartialEq, Eq, thiserror::Error)]
pub enum MitsubaError {
    /// It has no BRDF that reads the table as phicam does.
    #[error(
        "surface `{surface}` is of a measured material, and Mitsuba 3 reads no such table: in a copy of the scene, give it \
         `paint`, `coated`, `oren_nayar`, `conductor`, `lambertian` or a mixture of these"
    )]
    Measured {
        /// Its name.
        surface: String,
    },
    /// It shines, and the program lights scenes by their spots.
    #[error(
        "surface `{surface}` shines, and the Mitsuba program lights a scene by its laser: export a scene with a [laser] \
         table, in which the surface reflects"
    )]
    Shining {
        /// Its name.
        surface: String,
    },
}

/// A Python program that renders Φcam of `scene` with Mitsuba 3, in W, on an absolute scale; its
/// usage stands in its first lines.
///
/// # Errors
/// [`MitsubaError`] for a material that Mitsuba cannot have, or a surface that shines.
pub fn mitsuba_script(scene: &Scene) -> Result<String, MitsubaError> {
    Ok(format!("{HEAD}{}{}", literals(scene)?, BODY.concat()))
}

fn literals(scene: &Scene) -> Result<String, MitsubaError> {
    let camera = &scene.camera;
    let mut out = format!(
        "# ---- The scene, as phicam {} read it; lengths in its own unit, powers in W ----\n\n",
        env!("CARGO_PKG_VERSION")
    );
    let mut line = |name: &str, value: String| {
        let _ = writeln!(out, "{name} = {value}");
    };
    line("NAME", text(&scene.name));
    line("SCENE_HASH", text(&scene.hash));
    line("UNIT", text(scene.unit.symbol()));
    line("MAX_BOUNCES", scene.max_bounces.to_string());
    line("POWER", number(scene.laser.power));
    line("WAVELENGTH", number(scene.laser.wavelength));
    line("LASER", triple(scene.laser.position));
    line("PINHOLE", triple(camera.position));
    line("APERTURE_AREA", number(camera.aperture_area));
    line("COLUMNS", camera.columns.to_string());
    line("ROWS", camera.rows.to_string());
    let view = &camera.view;
    line(
        "VIEW",
        format!(
            "{{\"corner\": {}, \"u\": {}, \"v\": {}, \"normal\": {}}}",
            triple(view.corner()),
            triple(view.u()),
            triple(view.v()),
            triple(view.normal())
        ),
    );
    let (meshes, surfaces) = surface::literals(scene)?;
    line(
        "# Meshes in their own space: little-endian positions (f64) and triangles (u32), texture coordinates (f32) by triangle\n\
         # and corner.\nMESHES",
        meshes,
    );
    line(
        "# A mesh is MESHES[mesh] @ axes + translation. `panel`: another surface faces the other way in the same place. `brdf`:\n\
         # (albedo, theta_i, theta_o, azimuth between them, f_r in 1/sr) by phicam, in radians.\nSURFACES",
        surfaces,
    );
    let spots = scene.laser.spots.iter().map(|s| spot::literal(scene, s));
    line(
        "# What the beam lights, spot by spot: (\"point\", position, normal, albedo, share of the power),\n\
         # (\"disc\", centre, normal, albedo, radius), (\"gaussian\", centre, normal, albedo, 1/e^2 radius), and where the surface is\n\
         # not Lambertian (\"glossy\", position, normal, share of the power, number in SURFACES, phicam's parameters).\nSPOTS",
        format!("[\n{}]", spots.collect::<String>()),
    );
    out.push('\n');
    Ok(out)
}

/// A Python string literal in printable ASCII, whatever is in `s`.
fn text(s: &str) -> String {
    let mut out = String::from("\"");
    for c in s.chars() {
        match c {
            '"' | '\\' => out.extend(['\\', c]),
            ' '..='~' => out.push(c),
            _ => {
                let _ = write!(out, "\\U{:08x}", u32::from(c));
            }
        }
    }
    out + "\""
}

/// The shortest literal that reads back as the same f64.
fn number(x: f64) -> String {
    format!("{x:?}")
}

fn triple(p: DVec3) -> String {
    format!("({:?}, {:?}, {:?})", p.x, p.y, p.z)
}

#[cfg(test)]
mod tests;
