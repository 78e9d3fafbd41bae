//! What was built, in ordinary light: a picture of the scene from any place, for people. It is no measurement: its light has nothing to do with the laser,
//! and nothing that is computed elsewhere depends on it.
//!
//! Rays through the pixels find the first surface; points and normals are exact, albedos and BRDFs are those of the scene. Lit is it by an even sky, brighter
//! above than below, by one soft lamp over the viewer's left shoulder, and by a weak one at the viewer's eye that throws no shadow:
//!
//! > L = ∫ f_r L_sky V cosθ dω + f_r E_key V cosθ_key + f_r E_eye cosθ_eye
//!
//! with V = 0 in shadow, one direction of each a sample. The values are such that a white matt surface in full light is about 1.
//!
//! Surfaces have a black back; here it is shown, hatched in the colour of its role, so that one sees which way a surface faces. *Outer walls* stand open as
//! those of a doll's house: a relay or occluder that is flat and has nothing of the scene behind its plane, or is a sphere that reflects inside, throws no
//! shadow, and its back is clear glass wherever something else stands behind it.

mod light;
mod mark;
mod stand;
mod viewpoint;

use std::sync::atomic::Ordering;

use rayon::prelude::*;

use crate::geometry::{DVec3, Facing, Ray, Shape, ShapeId, SurfacePoint};
use crate::image::Transfer;
use crate::num::stream::{Key, LARGEST_NET, Sampling, Stream};
use crate::scene::{Role, Scene, Surface};
use crate::transport::Control;
use light::Light;
use mark::{Marks, Segment};
pub use stand::{Wishes, stand};
use viewpoint::Lens;
pub use viewpoint::{Viewpoint, ViewpointError};

/// Linear red, green and blue; 1 is the white of the picture.
pub type Colour = [f64; 3];

/// So much of what stands behind glass is replaced by the glass's own colour.
const GLASS: f64 = 0.08;
/// What a back reflects of the light that falls on it, on the stripes of its hatching and between them.
const BACK: [f64; 2] = [0.75, 0.35];
/// Period and width of the stripes, px.
const HATCHING: [f64; 2] = [12.0, 4.0];
/// More surfaces than this one behind the other are not looked through.
const MOST_PANES: usize = 64;

/// Whether spots, view, beams and devices are drawn into the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Marking {
    /// They are.
    Marked,
    /// Only surfaces.
    Bare,
}

/// How a portrait is made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PortraitPlan {
    /// Where the viewer stands.
    pub viewpoint: Viewpoint,
    /// Columns and rows.
    pub size: [usize; 2],
    /// Rays through each pixel, 1 to 2¹⁶.
    pub samples: u32,
    /// What is drawn besides surfaces.
    pub marking: Marking,
}

/// A picture for people.
#[derive(Clone, Debug, PartialEq)]
pub struct Portrait {
    /// Columns and rows.
    pub size: [usize; 2],
    /// Row by row from the top, not yet clipped at 1.
    pub colours: Vec<Colour>,
}

/// A portrait of `scene`; a pure function of its arguments. `Ok(None)` if stopped. Progress counts rays through pixels.
///
/// # Errors
/// [`ViewpointError`] for a place that nothing can be seen from, or a picture without pixels.
pub fn portrait(
    scene: &Scene,
    plan: &PortraitPlan,
    control: Control<'_>,
) -> Result<Option<Portrait>, ViewpointError> {
    let lens = Lens::new(&plan.viewpoint, plan.size)?;
    let samples = plan.samples.clamp(1, LARGEST_NET);
    let marks = match plan.marking {
        Marking::Marked => Marks::of(scene, &lens),
        Marking::Bare => Marks::default(),
    };
    let model = Model::new(scene);
    let light = Light::beside(&lens);
    let [width, height] = plan.size;
    let row = |y: usize| -> Option<Vec<Colour>> {
        if control.stop.load(Ordering::Relaxed) {
            return None;
        }
        let near = marks.of_row(y);
        let pixel = |x: usize| model.pixel(&lens, &light, &near, [x, y], samples);
        let colours: Vec<Colour> = (0..width).map(pixel).collect();
        (control.progress)(u64::from(samples) * width as u64);
        Some(colours)
    };
    let rows: Option<Vec<Vec<Colour>>> = (0..height).into_par_iter().map(row).collect();
    Ok(rows.map(|rows| Portrait {
        size: plan.size,
        colours: rows.concat(),
    }))
}

/// Which side of a surface is seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Face {
    Front,
    Back,
}

/// What a ray from the eye ends on.
#[derive(Clone, Copy, Debug)]
struct Seen {
    shape: ShapeId,
    point: SurfacePoint,
    face: Face,
    /// Panes of glass before it.
    panes: i32,
}

/// A scene as it is looked at.
struct Model<'a> {
    scene: &'a Scene,
    /// Which surfaces are outer walls.
    outer: Vec<bool>,
}

impl<'a> Model<'a> {
    fn new(scene: &'a Scene) -> Self {
        let outer = |id: usize| is_outer_wall(scene, id);
        Self {
            scene,
            outer: (0..scene.surfaces.len()).map(outer).collect(),
        }
    }

    fn surface(&self, shape: ShapeId) -> &Surface {
        &self.scene.surfaces[shape as usize]
    }

    /// What the ray ends on: the first surface that is not glass, or the first pane if there is nothing else.
    fn look(&self, ray: &Ray) -> Option<Seen> {
        let bvh = self.scene.bvh();
        let (mut ray, mut from, mut first) = (*ray, None, None);
        for panes in 0..MOST_PANES {
            let Some(hit) = bvh.closest(&ray, from) else {
                break;
            };
            let point = bvh.point(&ray, hit);
            let face = match point.normal.dot(ray.direction) < 0.0 {
                true => Face::Front,
                false => Face::Back,
            };
            let seen = Seen {
                shape: hit.shape,
                point,
                face,
                panes: panes as i32,
            };
            if face == Face::Front || !self.outer[hit.shape as usize] {
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
    fn pixel(
        &self,
        lens: &Lens,
        light: &Light,
        marks: &[&Segment],
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
            let colour = mark::over(marks, at, depth, behind);
            for c in 0..3 {
                sum[c] += colour[c];
            }
        }
        sum.map(|c| c / f64::from(samples))
    }

    fn shaded(&self, seen: &Seen, ray: &Ray, light: &Light, at: [f64; 2], u: [f64; 4]) -> Colour {
        let surface = self.surface(seen.shape);
        let SurfacePoint {
            position,
            normal,
            uv,
        } = seen.point;
        let lit = |direction| self.is_lit(position, seen.shape, direction);
        let colour = match seen.face {
            Face::Front => {
                let albedo = surface.albedo.albedo(uv);
                let brdf = |w: DVec3| surface.brdf(albedo, normal, w, -ray.direction);
                let value = light.reflected(normal, -ray.direction, brdf, lit, u);
                front(surface.role).map(|c| c * value)
            }
            Face::Back => {
                let striped = (at[0] + at[1]).rem_euclid(HATCHING[0]) < HATCHING[1];
                let albedo = if striped { BACK[0] } else { BACK[1] };
                let brdf = |_| albedo * std::f64::consts::FRAC_1_PI;
                let value = light.reflected(-normal, -ray.direction, brdf, lit, u);
                back(surface.role).map(|c| c * value)
            }
        };
        let clear = (1.0 - GLASS).powi(seen.panes);
        colour.map(|c| clear * c + (1.0 - clear) * 0.55)
    }
}

/// Whether a surface stands open: see the module.
fn is_outer_wall(scene: &Scene, id: usize) -> bool {
    let surface = &scene.surfaces[id];
    let plane = match &surface.shape {
        _ if surface.role == Role::Hidden => return false,
        Shape::Sphere(s) => return s.facing == Facing::Inside,
        Shape::Parallelogram(_) | Shape::Disc(_) => surface.shape.at([0.5, 0.5]),
        Shape::Body(_) => return false,
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

/// What the light that a front reflects is multiplied by: relays stay grey, the others are told apart.
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

#[cfg(test)]
mod tests;
