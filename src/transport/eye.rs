//! What every pixel sees first.

use super::gloss;
use super::packet::Packet;
use super::pinhole;
use super::shadow::Shadows;
use super::sight::known_or_all;
use super::walk::Vertex;
use crate::geometry::{Blockers, DVec3, Parallelogram, Ray, Region, Shape, ShapeId};
use crate::num::lanes::widest;
use crate::scene::{Scene, Texture};

/// The part of the scene that one pixel sees first, as far as it is known before a ray is cast.
#[derive(Clone, Debug)]
pub(super) struct Sighting {
    pixel: usize,
    /// The flat shape that fills the pixel, with nothing before it, and its outline there.
    fills: Option<(ShapeId, Parallelogram, Region)>,
}

impl Sighting {
    pub(super) fn new(scene: &Scene, pixel: usize) -> Self {
        let fills = (0..scene.surfaces.len()).find_map(|id| fills(scene, pixel, id as ShapeId));
        Self { pixel, fills }
    }

    /// The pixel.
    pub(super) fn pixel(&self) -> usize {
        self.pixel
    }

    /// The shape that fills the pixel, if that is known.
    pub(super) fn shape(&self) -> Option<ShapeId> {
        self.fills.as_ref().map(|(shape, ..)| *shape)
    }

    /// By shape: what may stand between the pixel's first vertices and each of `targets`.
    pub(super) fn blockers(&self, scene: &Scene, targets: &[ShapeId]) -> Vec<Blockers> {
        let mut all = vec![Blockers::Any; scene.surfaces.len()];
        if let Some((shape, _, region)) = &self.fills {
            for &to in targets {
                let other = Region::around(&scene.surfaces[to as usize].shape);
                let ends = [Some(*shape), Some(to)];
                all[to as usize] = scene.bvh().blockers(region, &other, ends);
            }
        }
        all
    }

    /// The first vertex through the point (a, b) of the footprint, as [`pinhole::first_vertex`] finds it.
    pub(super) fn vertex(&self, scene: &Scene, ab: [f64; 2]) -> Option<Vertex> {
        let Some((shape, plane, _)) = &self.fills else {
            return pinhole::first_vertex(scene, self.pixel, ab);
        };
        let camera = &scene.camera;
        let footprint = camera.footprint(self.pixel);
        let line = Ray::between(camera.position, footprint.at(ab))?;
        let cos = camera.view.normal().dot(line.direction).abs();
        let etendue =
            footprint.area * camera.aperture_area * cos * cos / (line.length * line.length);
        let height = plane.normal().dot(plane.corner() - line.origin);
        let at = line.origin + line.direction * (height / plane.normal().dot(line.direction));
        let point = plane.at_position(at);
        Vertex::arrive(scene, *shape, &point, line.direction, etendue)
    }

    /// First vertices for many points of the footprint, weighted by étendue · ρ/π (length² sr), or étendue where ρ/π is not how the surface reflects; without weight where nothing is seen.
    pub(super) fn vertices(&self, scene: &Scene, places: &[[f64; 2]], out: &mut Packet) {
        let constant = |id: ShapeId| match &scene.surfaces[id as usize].albedo {
            Texture::Constant(rho) => Some(gloss::weight(scene, id, *rho)),
            _ => None,
        };
        if let Some((shape, plane, _)) = &self.fills
            && let Some(weight) = constant(*shape)
        {
            return self.on_plane(scene, places, out, (*shape, plane, weight));
        }
        for (i, ab) in places.iter().enumerate() {
            match self.vertex(scene, *ab) {
                Some(x) => {
                    let weight = x.throughput * gloss::weight(scene, x.shape, x.albedo);
                    out.set(i, (x.position, x.normal), weight, x.shape);
                }
                None => out.set(i, (DVec3::ZERO, DVec3::ZERO), 0.0, 0),
            }
        }
    }

    /// With o the pinhole, f a point of the footprint, n_v and n the normals of view and surface and h = n·(c − o) its distance, the line
    /// of sight meets the surface at o + (f − o)·h/(n·(f − o)), and the point stands for A_footprint·A_lens·(n_v·(f − o))²/|f − o|⁴.
    fn on_plane(
        &self,
        scene: &Scene,
        places: &[[f64; 2]],
        out: &mut Packet,
        (shape, plane, reflection): (ShapeId, &Parallelogram, f64),
    ) {
        let camera = &scene.camera;
        let footprint = camera.footprint(self.pixel);
        let [corner, u, v] = [footprint.corner - camera.position, footprint.u, footprint.v];
        let (o, n, view) = (camera.position, plane.normal(), camera.view.normal());
        let height = n.dot(plane.corner() - o);
        let factor = footprint.area * camera.aperture_area * reflection;
        out.fill_shape(shape, n, places.len());
        let ([x, y, z], weight) = out.places_mut(places.len());
        widest(
            #[inline(always)]
            || {
                for (i, [a, b]) in places.iter().enumerate() {
                    let f = [
                        corner.x + u.x * a + v.x * b,
                        corner.y + u.y * a + v.y * b,
                        corner.z + u.z * a + v.z * b,
                    ];
                    let dot = |m: DVec3| m.x * f[0] + m.y * f[1] + m.z * f[2];
                    let (t, slope) = (height / dot(n), dot(view));
                    x[i] = o.x + f[0] * t;
                    y[i] = o.y + f[1] * t;
                    z[i] = o.z + f[2] * t;
                    let square = f[0] * f[0] + f[1] * f[1] + f[2] * f[2];
                    weight[i] = factor * (slope * slope) / (square * square);
                }
            },
        );
    }
}

/// Sets the entries to 0 between whose points something stands; `blockers` by shape of the second.
pub(super) fn hide(
    scene: &Scene,
    blockers: &[Blockers],
    (x, y): (&Packet, &Packet),
    entries: &mut [f64],
) {
    let mut asked = Shadows::default();
    for k in 0..entries.len() {
        let between = &blockers[y.shape[k] as usize];
        if entries[k] == 0.0 || between.none() {
            continue;
        }
        let ends = [Some(x.shape[k]), Some(y.shape[k])];
        match x.segment(k, y.point(k).0) {
            Some(ray) => asked.ask(scene.bvh(), between, (k, ray, ends), entries),
            None => entries[k] = 0.0,
        }
    }
    asked.answer(scene.bvh(), entries);
}

/// Shapes that some pixel may see.
pub(super) fn seen(scene: &Scene, sightings: &[Sighting]) -> Vec<ShapeId> {
    known_or_all(scene, sightings.iter().map(Sighting::shape).collect())
}

/// Shape `id` with its outline in the pixel, if it is flat, shows its front to the pinhole over the whole footprint, and nothing can
/// stand before it.
fn fills(scene: &Scene, pixel: usize, id: ShapeId) -> Option<(ShapeId, Parallelogram, Region)> {
    let Shape::Parallelogram(plane) = scene.surfaces[id as usize].shape else {
        return None;
    };
    let camera = &scene.camera;
    let footprint = camera.footprint(pixel);
    let height = plane.normal().dot(plane.corner() - camera.position);
    let mut corners = Vec::with_capacity(4);
    for ab in [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]] {
        let direction = footprint.at(ab) - camera.position;
        let slope = plane.normal().dot(direction);
        if slope >= 0.0 || height >= 0.0 {
            return None;
        }
        let at = camera.position + direction * (height / slope);
        let inside = plane
            .coordinates(at)
            .iter()
            .all(|c| (0.0..=1.0).contains(c));
        if !inside {
            return None;
        }
        corners.push(at);
    }
    let outline = Region::flat(corners);
    let pinhole = Region::point(camera.position);
    let free = scene
        .bvh()
        .surely_free(&pinhole, &outline, [None, Some(id)]);
    free.then_some((id, plane, outline))
}
