//! A scene as a program for another renderer: Mitsuba 3.
//!
//! The file holds the scene as Python literals, followed by a program that is the same for every scene
//! (`mitsuba.py`, whose header says how each part is translated). Coordinates stay the scene's own, in f64.

use std::fmt::Write as _;

use crate::geometry::{Basis, DVec3, Facing, Ray, Shape, ShapeId};
use crate::num::warp;
use crate::scene::{Cells, Laser, Profile, Scene, Spot, Surface, Texture, Wrap};

const PROGRAM: &str = include_str!("mitsuba.py");
/// Where the scene stands in the program.
const MARK: &str = "# @scene@\n";
/// A spot that does not fall whole on one flat surface of one albedo is SIDE² points of equal power.
const SIDE: usize = 32;
/// A Gaussian ends here, in units of its radius w: exp(−2·3²) = 1.5e-8 of the peak.
const CUT: f64 = 3.0;

/// A Python program that renders Φcam of `scene` with Mitsuba 3, in W, on an absolute scale; its usage stands in its first
/// lines.
pub fn mitsuba_script(scene: &Scene) -> String {
    let (before, after) = PROGRAM.split_once(MARK).unwrap_or((PROGRAM, ""));
    format!("{before}{}{after}", literals(scene))
}

fn literals(scene: &Scene) -> String {
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
    let surfaces: String = scene.surfaces.iter().map(surface).collect();
    line("SURFACES", format!("[\n{surfaces}]"));
    let spots = scene.laser.spots.iter().map(|s| spot(scene, s));
    line(
        "# What the beam lights, spot by spot: (\"point\", position, normal, albedo, share of the power),\n\
         # (\"disc\", centre, normal, albedo, radius) or (\"gaussian\", centre, normal, albedo, 1/e^2 radius).\nSPOTS",
        format!("[\n{}]", spots.collect::<String>()),
    );
    out
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

fn surface(s: &Surface) -> String {
    let shape = match &s.shape {
        Shape::Parallelogram(p) => format!(
            "\"shape\": \"parallelogram\", \"corner\": {}, \"u\": {}, \"v\": {}",
            triple(p.corner()),
            triple(p.u()),
            triple(p.v())
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
        Shape::Disc(d) => format!(
            "\"shape\": \"disc\", \"centre\": {}, \"normal\": {}, \"radius\": {:?}",
            triple(d.centre()),
            triple(d.normal()),
            d.radius()
        ),
        Shape::Body(b) => {
            let corners = (0..b.mesh().triangles().len() as u32).map(|t| b.corners(t));
            let corners: Vec<String> = corners.map(|c| c.map(triple).join(", ")).collect();
            format!(
                "\"shape\": \"mesh\", \"triangles\": [({})]",
                corners.join("), (")
            )
        }
    };
    let name = text(&s.name);
    let albedo = albedo(&s.albedo);
    format!("    {{\"name\": {name}, {shape}, \"albedo\": {albedo}}},\n")
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
        Texture::Cells(cells) | Texture::Tiles(cells) => match checks(cells) {
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

/// A map of the unit square.
type Warp = fn(warp::Point2) -> warp::Point2;

/// Where a ray of the beam lands.
struct Landing {
    shape: ShapeId,
    position: DVec3,
    normal: DVec3,
    albedo: f64,
}

/// First surface that the ray from the laser through `aim` meets, if it meets its front.
fn land(scene: &Scene, aim: DVec3) -> Option<Landing> {
    let from = scene.laser.position;
    let direction = (aim - from).try_normalize()?;
    let ray = Ray::new(from, direction);
    let hit = scene.bvh().closest(&ray, None)?;
    let surface = &scene.surfaces[hit.shape as usize];
    let point = scene.bvh().point(&ray, hit);
    (point.normal.dot(direction) < 0.0).then(|| Landing {
        shape: hit.shape,
        position: point.position,
        normal: point.normal,
        albedo: surface.albedo.albedo(point.uv),
    })
}

/// One entry of SPOTS.
fn spot(scene: &Scene, spot: &Spot) -> String {
    let Laser { profile, .. } = scene.laser;
    let target = spot.target;
    let frame = Basis::around(target.normal);
    let aim = |[x, y]: [f64; 2], scale: f64| {
        land(
            scene,
            target.position + frame.to_world([x * scale, y * scale, 0.0]),
        )
    };
    let entry = |kind: &str, at: &Landing, size: f64| {
        format!(
            "(\"{kind}\", {}, {}, {:?}, {size:?})",
            triple(at.position),
            triple(at.normal),
            at.albedo
        )
    };
    let centre = aim([0.0, 0.0], 0.0);
    let (kind, radius, reach, map): (_, _, _, Warp) = match profile {
        Profile::Ideal => {
            let at = centre.map_or(String::new(), |at| entry("point", &at, 1.0));
            return format!("    [{at}],\n");
        }
        Profile::Disc { radius } => ("disc", radius, radius, warp::disc),
        Profile::Gaussian { radius } => ("gaussian", radius, CUT * radius, warp::gaussian_spot),
    };
    let whole = centre.filter(|at| {
        let same = |p: Landing| p.shape == spot.surface && p.albedo == at.albedo;
        // The concentric map takes the border of the square to the rim.
        let rim = (0..64).flat_map(|k| {
            let t = f64::from(k) / 64.0;
            [[t, 0.0], [1.0, t], [1.0 - t, 1.0], [0.0, 1.0 - t]]
        });
        scene.surfaces[spot.surface as usize].shape.is_flat()
            && grid(64)
                .chain(rim)
                .all(|u| aim(warp::disc(u), reach).is_some_and(same))
    });
    let parts: Vec<String> = match whole {
        Some(at) => vec![entry(kind, &at, radius)],
        None => grid(SIDE)
            .filter_map(|u| aim(map(u), radius))
            .map(|at| entry("point", &at, 1.0 / (SIDE * SIDE) as f64))
            .collect(),
    };
    format!("    [{}],\n", parts.join(", "))
}

/// Middles of the cells of an n × n grid over the unit square.
fn grid(n: usize) -> impl Iterator<Item = [f64; 2]> {
    let middle = move |i: usize| (i as f64 + 0.5) / n as f64;
    (0..n * n).map(move |k| [middle(k % n), middle(k / n)])
}

#[cfg(test)]
#[path = "mitsuba_tests.rs"]
mod tests;
