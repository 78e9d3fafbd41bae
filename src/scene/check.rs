//! What is wrong or suspicious in how the parts of a scene stand to each other.

mod places;

use super::Scene;
use super::error::{Fault, keys};
use super::laser::{Profile, Spot};
use super::surface::{Role, Surface, is_off_the_wall};
use super::warning::Warning;
use crate::geometry::{Basis, DVec3, Interaction, Ray, Shape, ShapeId};
use places::{behind_walls, together};

/// Points of a hidden surface at which visibility is tested: the centres of an n × n grid.
fn probes(surface: &Surface, n: usize) -> Vec<Interaction> {
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

/// Lines of sight a side of the view: they meet what lies between the points of a surface.
const SIGHTS: usize = 129;

/// A camera in front of a hidden surface contradicts the experiment, with a free line to any of
/// 33 × 33 points of it or where it is met first through any of 129 × 129 points of the view.
pub(super) fn refuse_visible_hidden_face(scene: &Scene) -> Result<(), Fault> {
    let camera = scene.camera.position;
    let seen = hidden_in_view(scene);
    for (id, surface) in scene.hidden() {
        let shape = id as ShapeId;
        let sees =
            |p: &Interaction| is_front(p, camera) && free(scene, camera, None, p.position, shape);
        if seen.contains(&shape) || probes(surface, CAMERA_PROBES).iter().any(sees) {
            return Err(Fault::new(
                keys!["surface", id],
                format!(
                    "the camera sees the front of hidden surface `{}`",
                    surface.name
                ),
                match surface.shape {
                    Shape::Sphere(_) => "move it out of sight, or put an occluder between",
                    Shape::Instance(_) => {
                        "move the camera behind it or out of sight, turn the mesh (`flip = true` exchanges front and back), or put an occluder between"
                    }
                    _ => {
                        "move the camera behind it or out of sight, turn the surface (front: u × v), or put an occluder between"
                    }
                },
            ));
        }
    }
    Ok(())
}

/// The hidden surfaces whose front is seen through a point of the view.
fn hidden_in_view(scene: &Scene) -> Vec<ShapeId> {
    let camera = scene.camera.position;
    if !scene.hidden().any(|(_, s)| is_faced(s, camera)) {
        return Vec::new();
    }
    let at = |k: usize| k as f64 / (SIGHTS - 1) as f64;
    let points = (0..SIGHTS * SIGHTS).map(|k| [at(k % SIGHTS), at(k / SIGHTS)]);
    let mut found = Vec::new();
    for (shape, point) in
        points.filter_map(|at| scene.seen_through(scene.camera.view.at(at).position))
    {
        let is_hidden = scene.surfaces[shape as usize].role == Role::Hidden;
        if is_hidden && !found.contains(&shape) && is_front(&point, camera) {
            found.push(shape);
        }
    }
    found
}

/// Whether q lies in front of a point of a surface.
fn is_front(point: &Interaction, q: DVec3) -> bool {
    (q - point.position).dot(point.normal) > 0.0
}

/// Surfaces that light by way of a hidden one meets: wall, hidden surface, wall.
const THREE_BOUNCES: u32 = 3;
/// A decade beyond the wavelengths of lasers, F₂ at 157 nm to CO₂ at 10.6 µm, m; and three beyond
/// their continuous powers, 1 µW to 100 kW, W.
const WAVELENGTHS: [f64; 2] = [1.6e-8, 1.1e-4];
const POWERS: [f64; 2] = [1e-6, 1.0];

/// A share of a measured table that is missing, from which on it is told: entries that the horizon
/// cuts are fewer.
const NOTABLE: f64 = 0.01;

/// 1/e² radii of a Gaussian spot beyond which lies e^−24.5 of its power: light by way of a hidden
/// surface is more than that.
const TAIL: f64 = 3.5;

/// Collects what is suspicious.
pub(super) fn warnings(scene: &Scene) -> Vec<Warning> {
    let mut found = scene.found.clone();
    if scene.hidden().next().is_none() {
        found.push(Warning::NothingHidden);
    } else if scene.max_bounces < THREE_BOUNCES && !scene.laser.is_shining() {
        found.push(Warning::TooFewBounces(scene.max_bounces));
    }
    for surface in &scene.surfaces {
        if let Shape::Parallelogram(p) = &surface.shape
            && p.skew().abs() > 1e-6
        {
            let angle = libm::acos(p.skew()).to_degrees();
            found.push(Warning::Skewed(surface.name.clone(), angle));
        }
        let unmeasured = surface.material.unmeasured();
        if unmeasured > NOTABLE {
            found.push(Warning::NotMeasured(surface.name.clone(), unmeasured));
        }
        if surface.role == Role::Hidden && !surface.is_aligned() {
            found.push(Warning::ElementsAcrossCells(surface.name.clone()));
        }
    }
    let laser = &scene.laser;
    let beyond = |x: f64, [low, high]: [f64; 2]| x < low || x > high;
    if beyond(laser.wavelength, WAVELENGTHS) {
        found.push(Warning::Wavelength(laser.wavelength));
    }
    if beyond(laser.power, POWERS) && !laser.is_shining() {
        found.push(Warning::Power(laser.power));
    }
    let entries = scene.camera.pixels() * laser.spots.len();
    let elements = scene
        .hidden()
        .map(|(_, s)| s.elements[0] * s.elements[1])
        .sum();
    if entries < elements {
        found.push(Warning::FewPhotographs { entries, elements });
    }
    spots(scene, &mut found);
    together(scene, &mut found);
    behind_walls(scene, &mut found);
    pixels(scene, &mut found);
    found
}

fn spots(scene: &Scene, found: &mut Vec<Warning>) {
    let laser = &scene.laser;
    let reach = match laser.profile {
        Profile::Ideal => 0.0,
        Profile::Disc { radius } | Profile::Gaussian { radius } => radius,
        Profile::Shining { .. } => return view_behind(scene, found),
    };
    let tail = match laser.profile {
        Profile::Gaussian { radius } => TAIL * radius,
        _ => reach,
    };
    let mut in_view = Vec::new();
    let mut shadowed = Vec::new();
    let mut overhanging = Vec::new();
    let mut blocked: Vec<(String, Vec<usize>)> = Vec::new();
    let hidden: Vec<(ShapeId, Vec<Interaction>)> = scene
        .hidden()
        .map(|(id, s)| (id as ShapeId, probes(s, SPOT_PROBES)))
        .collect();
    for (i, spot) in laser.spots.iter().enumerate() {
        let target = spot.target.position;
        if in_view_of(scene, spot, tail) {
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
        let facing = |p: &&Interaction| is_front(p, target);
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
        let behind: Vec<usize> = (0..laser.spots.len())
            .filter(|i| !is_faced(surface, laser.spots[*i].target.position))
            .collect();
        if !behind.is_empty() {
            found.push(Warning::SpotsBehind(behind, surface.name.clone()));
        }
    }
    view_behind(scene, found);
}

/// Whether a point lies in front of some of a surface. Every point does of a sphere, and of a mesh
/// that is closed and wound outwards: one of its faces is found soon.
fn is_faced(surface: &Surface, q: DVec3) -> bool {
    match &surface.shape {
        Shape::Sphere(_) => true,
        Shape::Instance(body) => body.faces(q),
        flat => {
            let outline = flat.outline();
            outline.iter().any(|p| is_front(p, q))
        }
    }
}

fn view_behind(scene: &Scene, found: &mut Vec<Warning>) {
    for (_, surface) in scene.hidden() {
        let corners = scene.camera.view.corners();
        if !corners.into_iter().all(|q| is_faced(surface, q)) {
            found.push(Warning::ViewBehind(surface.name.clone()));
        }
    }
}

/// Whether the camera may see a spot of radius `reach` directly: its line of sight crosses the
/// view's rectangle (or passes it no further away than the spot reaches), meets the front, and, for
/// a point, nothing on its way.
fn in_view_of(scene: &Scene, spot: &Spot, reach: f64) -> bool {
    let (camera, target) = (&scene.camera, &spot.target);
    let view = &camera.view;
    let sight = target.position - camera.position;
    let (forward, facing) = (-view.normal().dot(sight), -target.normal.dot(sight));
    if forward <= 0.0 || facing <= 0.0 {
        return false;
    }
    let to_view = view.normal().dot(camera.position - view.corner()) / forward;
    let [a, b] = view.coordinates(camera.position + sight * to_view);
    let near = |x: f64, side: f64| x * side >= -reach && (x - 1.0) * side <= reach;
    near(a, view.u().length())
        && near(b, view.v().length())
        && (reach > 0.0
            || Ray::between(target.position, camera.position)
                .is_some_and(|ray| !scene.bvh().blocked(&ray, [Some(spot.surface), None])))
}

/// Whether part of a spot's rim has no relay surface below it.
fn rim_leaves(scene: &Scene, target: &Interaction, radius: f64) -> bool {
    let basis = Basis::around(target.normal);
    (0..16).any(|k| {
        let (sin, cos) = libm::sincos(std::f64::consts::TAU * f64::from(k) / 16.0);
        let p = target.position + basis.to_world([radius * cos, radius * sin, 0.0]);
        is_off_the_wall(&scene.surfaces, [p.x, p.y])
    })
}

fn pixels(scene: &Scene, found: &mut Vec<Warning>) {
    let camera = &scene.camera;
    let mut blocked: Vec<(ShapeId, usize)> = Vec::new();
    for pixel in 0..camera.pixels() {
        let centre = camera.footprint(pixel).at([0.5, 0.5]);
        let Some((shape, point)) = scene.seen_through(centre) else {
            continue;
        };
        let role = scene.surfaces[shape as usize].role;
        if role != Role::Relay || !is_front(&point, camera.position) {
            match blocked.iter_mut().find(|(s, _)| *s == shape) {
                Some((_, count)) => *count += 1,
                None => blocked.push((shape, 1)),
            }
        }
    }
    for (shape, count) in blocked {
        let name = scene.surfaces[shape as usize].name.clone();
        found.push(Warning::PixelsBlocked(count, name));
    }
}
