//! What is wrong or suspicious in how the parts of a scene stand to each other.

use std::fmt;

use super::error::{Fault, keys};
use super::laser::Profile;
use super::surface::{Role, Surface};
use super::{Scene, Texture};
use crate::geometry::{Basis, DVec3, Ray, Shape, ShapeId, SurfacePoint};

/// Something suspicious in a scene.
#[derive(Clone, Debug, PartialEq)]
pub enum Warning {
    /// No surface is hidden: there is nothing to model or recover.
    NothingHidden,
    /// Spots that lie in the camera's view, so that the camera sees them directly.
    SpotsInView(Vec<usize>),
    /// Spots that the beam does not reach, and the surface that stops it.
    BeamBlocked(Vec<usize>, String),
    /// Pixels whose line of sight to the wall is blocked, how many, and the surface that does it.
    PixelsBlocked(usize, String),
    /// Spots from which no element of the hidden surface can be lit: they lie behind its plane.
    SpotsBehind(Vec<usize>, String),
    /// Part of the view lies behind the hidden surface's plane and sees nothing of it.
    ViewBehind(String),
    /// Edges that are not perpendicular: (surface, angle in degrees).
    Skewed(String, f64),
    /// Elements that straddle the edges of a texture's cells.
    ElementsAcrossCells(String),
    /// Spots whose line to the hidden surface is blocked for every element.
    SpotsShadowed(Vec<usize>),
    /// Spots of which a part falls beside the wall and is lost.
    SpotsOverhang(Vec<usize>),
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NothingHidden => {
                write!(
                    f,
                    "no surface is hidden: frames can be rendered, but there is nothing to model or recover"
                )
            }
            Self::SpotsInView(spots) => {
                write!(
                    f,
                    "{} in the camera's view: the camera sees the direct light",
                    Spots(spots)
                )
            }
            Self::BeamBlocked(spots, by) => {
                write!(
                    f,
                    "the beam to {} is stopped by `{by}`: the light lands there instead",
                    Spots(spots)
                )
            }
            Self::PixelsBlocked(count, by) => {
                write!(
                    f,
                    "the line of sight of {count} pixels is blocked by `{by}`: they see it instead of the wall"
                )
            }
            Self::SpotsBehind(spots, hidden) => {
                write!(
                    f,
                    "{} behind the plane of `{hidden}` and cannot light it",
                    Spots(spots)
                )
            }
            Self::ViewBehind(hidden) => {
                write!(
                    f,
                    "part of the view lies behind the plane of `{hidden}` and receives nothing from it"
                )
            }
            Self::Skewed(name, angle) => {
                write!(
                    f,
                    "the edges of `{name}` meet at {angle:.3}°: it is taken as the parallelogram it is"
                )
            }
            Self::ElementsAcrossCells(name) => write!(
                f,
                "elements of `{name}` straddle the edges of its texture: the model takes the albedo at their centres"
            ),
            Self::SpotsOverhang(spots) => {
                write!(
                    f,
                    "{} hanging over the wall's edge: what falls beside it is lost",
                    Spots(spots)
                )
            }
            Self::SpotsShadowed(spots) => {
                write!(
                    f,
                    "{} lit, but every line from there to the hidden elements is blocked",
                    Spots(spots)
                )
            }
        }
    }
}

/// "spot 3 lies", "spots 3, 7–9 lie": compactly, at most a dozen ranges.
struct Spots<'a>(&'a [usize]);

impl fmt::Display for Spots<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut ranges: Vec<(usize, usize)> = Vec::new();
        for &s in self.0 {
            match ranges.last_mut() {
                Some((_, end)) if *end + 1 == s => *end = s,
                _ => ranges.push((s, s)),
            }
        }
        let more = ranges.len() > 12;
        let text: Vec<String> = ranges
            .iter()
            .take(12)
            .map(|(a, b)| {
                if a == b {
                    a.to_string()
                } else {
                    format!("{a}–{b}")
                }
            })
            .collect();
        let noun = if self.0.len() == 1 { "spot" } else { "spots" };
        write!(
            f,
            "{noun} {}{}",
            text.join(", "),
            if more { ", …" } else { "" }
        )
    }
}

/// Points of a hidden surface at which visibility is tested: the centres of an n × n grid.
fn probes(surface: &Surface, n: usize) -> Vec<SurfacePoint> {
    let centre = |i: usize| (i as f64 + 0.5) / n as f64;
    (0..n * n)
        .map(|i| surface.shape.at([centre(i % n), centre(i / n)]))
        .collect()
}

fn free(scene: &Scene, from: DVec3, on: Option<ShapeId>, to: DVec3, at: ShapeId) -> bool {
    Ray::between(from, to).is_some_and(|ray| !scene.bvh().blocked(&ray, [on, Some(at)]))
}

/// Probes a side for the camera's line of sight, and for each spot's.
const CAMERA_PROBES: usize = 33;
const SPOT_PROBES: usize = 9;

/// A camera in front of a hidden surface with a free line to any of 33 × 33 points of it contradicts the experiment.
pub(super) fn refuse_visible_hidden_face(scene: &Scene) -> Result<(), Fault> {
    for (id, surface) in scene.hidden() {
        let sees = probes(surface, CAMERA_PROBES).into_iter().any(|p| {
            let camera = scene.camera.position;
            (camera - p.position).dot(p.normal) > 0.0
                && free(scene, camera, None, p.position, id as ShapeId)
        });
        if sees {
            return Err(Fault::new(
                keys!["surface", id],
                format!(
                    "the camera sees the front of hidden surface `{}`",
                    surface.name
                ),
                "move the camera behind it or out of sight, turn the surface (front: u × v), or put an occluder between",
            ));
        }
    }
    Ok(())
}

/// Collects what is suspicious.
pub(super) fn warnings(scene: &Scene) -> Vec<Warning> {
    let mut found = Vec::new();
    if scene.hidden().next().is_none() {
        found.push(Warning::NothingHidden);
    }
    for surface in &scene.surfaces {
        if let Shape::Parallelogram(p) = &surface.shape
            && p.skew().abs() > 1e-6
        {
            let angle = libm::acos(p.skew()).to_degrees();
            found.push(Warning::Skewed(surface.name.clone(), angle));
        }
        let [cu, cv] = surface.albedo.smooth_cells();
        let [nu, nv] = surface.elements;
        let aligned =
            matches!(surface.albedo, Texture::Constant(_)) || (nu % cu == 0 && nv % cv == 0);
        if surface.role == Role::Hidden && !aligned {
            found.push(Warning::ElementsAcrossCells(surface.name.clone()));
        }
    }
    spots(scene, &mut found);
    pixels(scene, &mut found);
    found
}

fn spots(scene: &Scene, found: &mut Vec<Warning>) {
    let laser = &scene.laser;
    let reach = match laser.profile {
        Profile::Ideal => 0.0,
        Profile::Disc { radius } | Profile::Gaussian { radius } => radius,
    };
    let mut in_view = Vec::new();
    let mut shadowed = Vec::new();
    let mut overhanging = Vec::new();
    let mut blocked: Vec<(String, Vec<usize>)> = Vec::new();
    let view = &scene.camera.view;
    let [w, h] = [view.u().length(), view.v().length()];
    let hidden: Vec<(ShapeId, Vec<SurfacePoint>)> = scene
        .hidden()
        .map(|(id, s)| (id as ShapeId, probes(s, SPOT_PROBES)))
        .collect();
    for (i, spot) in laser.spots.iter().enumerate() {
        let target = spot.target.position;
        let [a, b] = view.coordinates(target);
        let near = |x: f64, side: f64| x * side >= -reach && (x - 1.0) * side <= reach;
        if near(a, w) && near(b, h) {
            in_view.push(i);
        }
        if reach > 0.0 && rim_leaves(scene, &spot.target, reach) {
            overhanging.push(i);
        }
        let beam = Ray::between(laser.position, target);
        let stop = beam.and_then(|ray| {
            scene
                .bvh()
                .closest(&ray, None)
                .filter(|hit| hit.t < ray.length * (1.0 - 1e-9))
        });
        if let Some(hit) = stop {
            let name = &scene.surfaces[hit.shape as usize].name;
            match blocked.iter_mut().find(|(n, _)| n == name) {
                Some((_, list)) => list.push(i),
                None => blocked.push((name.clone(), vec![i])),
            }
            continue;
        }
        let facing = |p: &&SurfacePoint| (target - p.position).dot(p.normal) > 0.0;
        let mut faced = hidden
            .iter()
            .flat_map(|(id, points)| points.iter().filter(facing).map(move |p| (id, p)));
        let faces = faced.clone().next().is_some();
        if faces && !faced.any(|(id, p)| free(scene, target, Some(spot.surface), p.position, *id)) {
            shadowed.push(i);
        }
    }
    if !overhanging.is_empty() {
        found.push(Warning::SpotsOverhang(overhanging));
    }
    if !in_view.is_empty() {
        found.push(Warning::SpotsInView(in_view));
    }
    found.extend(
        blocked
            .into_iter()
            .map(|(name, spots)| Warning::BeamBlocked(spots, name)),
    );
    if !shadowed.is_empty() {
        found.push(Warning::SpotsShadowed(shadowed));
    }
    for (_, surface) in scene.hidden() {
        let outline = surface.shape.outline();
        let faces = |q: DVec3| outline.iter().any(|p| (q - p.position).dot(p.normal) > 0.0);
        let behind: Vec<usize> = (0..laser.spots.len())
            .filter(|i| !faces(laser.spots[*i].target.position))
            .collect();
        if !behind.is_empty() {
            found.push(Warning::SpotsBehind(behind, surface.name.clone()));
        }
        if !scene.camera.view.corners().into_iter().all(faces) {
            found.push(Warning::ViewBehind(surface.name.clone()));
        }
    }
}

/// Whether part of a spot's rim has no relay surface below it.
fn rim_leaves(scene: &Scene, target: &SurfacePoint, radius: f64) -> bool {
    let basis = Basis::around(target.normal);
    (0..16).any(|k| {
        let (sin, cos) = libm::sincos(std::f64::consts::TAU * f64::from(k) / 16.0);
        let p = target.position + basis.to_world([radius * cos, radius * sin, 0.0]);
        let relays = scene.surfaces.iter().filter(|s| s.role == Role::Relay);
        relays
            .into_iter()
            .all(|s| s.shape.at_xy(p.x, p.y).is_empty())
    })
}

fn pixels(scene: &Scene, found: &mut Vec<Warning>) {
    let camera = &scene.camera;
    let mut blocked: Vec<(ShapeId, usize)> = Vec::new();
    for pixel in 0..camera.pixels() {
        let centre = camera.footprint(pixel).at([0.5, 0.5]);
        let Some(ray) = Ray::between(camera.position, centre) else {
            continue;
        };
        let stop = scene
            .bvh()
            .closest(&Ray::new(ray.origin, ray.direction), None);
        let Some(hit) = stop else { continue };
        let surface = &scene.surfaces[hit.shape as usize];
        let point = surface
            .shape
            .at_position(ray.origin + ray.direction * hit.t);
        let front = point.normal.dot(ray.direction) < 0.0;
        if surface.role != Role::Relay || !front {
            match blocked.iter_mut().find(|(s, _)| *s == hit.shape) {
                Some((_, count)) => *count += 1,
                None => blocked.push((hit.shape, 1)),
            }
        }
    }
    for (shape, count) in blocked {
        let name = scene.surfaces[shape as usize].name.clone();
        found.push(Warning::PixelsBlocked(count, name));
    }
}
