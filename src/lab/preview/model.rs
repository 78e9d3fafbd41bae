//! A scene as a viewer sees it: surfaces, hatched backs, outer walls of glass.

use std::f64::consts::FRAC_1_PI;

use super::light::{Colour, Light};
use super::overlay::{self, Mark};
use super::viewpoint::Lens;
use crate::geometry::{DVec3, Facing, Interaction, Ray, Shape, ShapeId};
use crate::image::Transfer;
use crate::num::stream::{Key, Sampling, Stream};
use crate::scene::{Role, Scene, Surface};

/// So much of what stands behind glass is replaced by the glass's own colour.
const GLASS: f64 = 0.08;
/// What a back reflects of the light that falls on it, on the stripes of its hatching and between
/// them.
const BACK: [f64; 2] = [0.75, 0.35];
/// Period and width of the stripes, px.
const HATCHING: [f64; 2] = [12.0, 4.0];
/// At most so many surfaces one behind the other are looked through.
const MOST_PANES: usize = 64;

/// What a ray from the viewer ends on.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seen {
    pub(super) shape: ShapeId,
    point: Interaction,
    /// Whether its front is seen, not its back.
    pub(super) is_front: bool,
    /// Panes of glass before it.
    pub(super) panes: i32,
}

/// A scene as it is looked at.
pub(super) struct Model<'a> {
    pub(super) scene: &'a Scene,
    /// Which surfaces are outer walls.
    outer: Vec<bool>,
}

impl<'a> Model<'a> {
    pub(super) fn new(scene: &'a Scene) -> Self {
        let outer = |id: usize| is_outer_wall(scene, id);
        Self {
            scene,
            outer: (0..scene.surfaces.len()).map(outer).collect(),
        }
    }

    pub(super) fn surface(&self, shape: ShapeId) -> &Surface {
        &self.scene.surfaces[shape as usize]
    }

    /// What the ray ends on: the first surface that is not glass, or the first pane if there is
    /// nothing else.
    pub(super) fn look(&self, ray: &Ray) -> Option<Seen> {
        let bvh = self.scene.bvh();
        let (mut ray, mut from, mut first) = (*ray, None, None);
        for panes in 0..MOST_PANES {
            let Some(hit) = bvh.closest(&ray, from) else {
                break;
            };
            let point = bvh.point(&ray, hit);
            let is_front = point.normal.dot(ray.direction) < 0.0;
            let seen = Seen {
                shape: hit.shape,
                point,
                is_front,
                panes: panes as i32,
            };
            if is_front || !self.outer[hit.shape as usize] {
                return Some(seen);
            }
            first.get_or_insert(Seen { panes: 0, ..seen });
            (ray.origin, from) = (point.position, Some(hit.shape));
        }
        first
    }

    /// Whether light from far away along `direction` reaches a point of `shape`.
    fn is_lit(&self, position: DVec3, shape: ShapeId, direction: DVec3) -> bool {
        let bvh = self.scene.bvh();
        let (mut ray, mut from) = (Ray::new(position, direction), Some(shape));
        for _ in 0..MOST_PANES {
            match bvh.closest(&ray, from) {
                None => return true,
                Some(hit) if self.outer[hit.shape as usize] => {
                    (ray.origin, from) = (bvh.point(&ray, hit).position, Some(hit.shape));
                }
                Some(_) => return false,
            }
        }
        false
    }

    /// The mean over `samples` rays through a pixel.
    pub(super) fn pixel(
        &self,
        lens: &Lens,
        light: &Light,
        marks: &[&Mark],
        [x, y]: [usize; 2],
        samples: u32,
    ) -> Colour {
        let key = Key {
            seed: 0,
            spot: Key::ALL_SPOTS,
            pixel: (x + y * lens.size()[0]) as u32,
            block: 0,
        };
        let mut stream = Stream::new(Sampling::Sobol, key);
        let mut sum = [0.0; 3];
        for index in 0..samples {
            stream.start(index);
            let [a, b, sky_u, sky_v] = stream.next_four();
            let [key_u, key_v, ..] = stream.next_four();
            let at = [x as f64 + a, y as f64 + b];
            let ray = lens.ray(at);
            let seen = self.look(&ray);
            let behind = match &seen {
                Some(seen) => self.shaded(seen, &ray, light, at, [sky_u, sky_v, key_u, key_v]),
                None => backdrop(at[1] / lens.size()[1] as f64),
            };
            let depth = seen.map_or(f64::INFINITY, |s| lens.depth(s.point.position));
            let colour = overlay::over(marks, at, depth, behind);
            for c in 0..3 {
                sum[c] += colour[c];
            }
        }
        sum.map(|c| c / f64::from(samples))
    }

    fn shaded(&self, seen: &Seen, ray: &Ray, light: &Light, at: [f64; 2], u: [f64; 4]) -> Colour {
        let surface = self.surface(seen.shape);
        let Interaction {
            position,
            normal,
            uv,
        } = seen.point;
        let lit = |direction| self.is_lit(position, seen.shape, direction);
        let colour = if seen.is_front {
            let albedo = surface.albedo.albedo(uv);
            let brdf = |w: DVec3| surface.brdf(albedo, normal, w, -ray.direction);
            let value = light.reflected(normal, -ray.direction, brdf, lit, u);
            front(surface.role).map(|c| c * value)
        } else {
            let striped = (at[0] + at[1]).rem_euclid(HATCHING[0]) < HATCHING[1];
            let albedo = if striped { BACK[0] } else { BACK[1] };
            let brdf = |_| albedo * FRAC_1_PI;
            let value = light.reflected(-normal, -ray.direction, brdf, lit, u);
            back(surface.role).map(|c| c * value)
        };
        let clear = (1.0 - GLASS).powi(seen.panes);
        colour.map(|c| clear * c + (1.0 - clear) * 0.55)
    }
}

/// Whether a surface is an outer wall: see the module.
pub(super) fn is_outer_wall(scene: &Scene, id: usize) -> bool {
    let surface = &scene.surfaces[id];
    let plane = match &surface.shape {
        _ if surface.role == Role::Hidden => return false,
        Shape::Sphere(s) => return s.facing == Facing::Inside,
        Shape::Parallelogram(_) | Shape::Disc(_) => surface.shape.at([0.5, 0.5]),
        Shape::Instance(_) => return false,
    };
    let others = scene.surfaces.iter().enumerate().filter(|(k, _)| *k != id);
    let (low, high) = surface.shape.bounds();
    let slack = 1e-6 * (high - low).length();
    let behind = |s: &Surface| match &s.shape {
        // The other side of the same panel.
        shape if shape.is_flat() => {
            let middle = shape.at([0.5, 0.5]);
            let same_plane = (middle.position - plane.position).dot(plane.normal).abs() <= slack;
            (same_plane && middle.normal.dot(plane.normal) < 0.0)
                || shape.reaches_above(plane.position, -plane.normal, slack)
        }
        shape => shape.reaches_above(plane.position, -plane.normal, slack),
    };
    !others.map(|(_, s)| s).any(behind)
}

/// What the light that a front reflects is multiplied by: relays stay grey, the others are told
/// apart.
fn front(role: Role) -> Colour {
    match role {
        Role::Relay => [1.0; 3],
        Role::Hidden => [0.72, 0.87, 1.0],
        Role::Occluder => [1.0, 0.93, 0.86],
    }
}

/// The same for a back.
fn back(role: Role) -> Colour {
    match role {
        Role::Relay => [0.6, 0.6, 0.6],
        Role::Hidden => [0.12, 0.38, 0.75],
        Role::Occluder => [0.52, 0.2, 0.42],
    }
}

/// Behind everything, from the top of the picture (0) to its foot (1).
fn backdrop(t: f64) -> Colour {
    [0.93, 0.95, 0.97].map(|c| Transfer::Srgb.decode(c - 0.16 * t))
}
