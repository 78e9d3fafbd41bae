//! The camera: the first vertex of a path, and what the camera sees of the lit spots themselves.

use crate::geometry::{Blockers, DVec3, Parallelogram, Ray, Region, Shape, ShapeId};
use crate::num::lanes::widest;
use crate::scene::{Scene, Texture};

use super::vertex::{Batch, Vertex, constant_factor};
use super::visibility::{End, hide};

/// The line of sight of a pixel through the point (a, b) of its footprint, and the étendue that a
/// uniform sample of (a, b) stands for.
///
/// The flux into the pixel is Φ = ∫ L · A_lens·cosθ_cam dΩ; with the footprint's area as measure dΩ
/// = cosθ_view dA/d², and the aperture is parallel to the view: both cosines are the same. A
/// uniform point of the footprint therefore carries A_footprint · A_lens · cos²θ/d², d the distance
/// to the footprint (not to what stands in front of it).
fn line_of_sight(scene: &Scene, pixel: usize, ab: [f64; 2]) -> Option<(Ray, f64)> {
    let camera = &scene.camera;
    let footprint = camera.footprint(pixel);
    let line = Ray::between(camera.position, footprint.at(ab))?;
    let cos = camera.view.normal().dot(line.direction).abs();
    let etendue = footprint.area * camera.aperture_area * cos * cos / (line.length * line.length);
    Some((Ray::new(line.origin, line.direction), etendue))
}

/// What pixel `pixel` sees through the point (a, b) of its footprint; its throughput is the
/// étendue.
pub(super) fn first_vertex(scene: &Scene, pixel: usize, ab: [f64; 2]) -> Option<Vertex> {
    let (ray, etendue) = line_of_sight(scene, pixel, ab)?;
    let hit = scene.bvh().closest(&ray, None)?;
    let point = scene.bvh().point(&ray, hit);
    let x = Vertex::arrive(scene, hit.shape, &point, ray.direction, etendue);
    x.filter(|x| x.reflects(scene))
}

/// What one pixel sees first, as far as it is known before a ray is cast.
#[derive(Clone, Debug)]
pub(super) struct PixelView {
    pub pixel: usize,
    /// The flat shape that fills the pixel, with nothing before it.
    filled_by: Option<ShapeId>,
}

impl PixelView {
    pub(super) fn new(scene: &Scene, pixel: usize) -> Self {
        let mut shapes = 0..scene.surfaces.len() as ShapeId;
        let filled_by = shapes.find(|id| fills(scene, pixel, *id).is_some());
        Self { pixel, filled_by }
    }

    /// The shape that fills the pixel, if that is known.
    pub(super) fn shape(&self) -> Option<ShapeId> {
        self.filled_by
    }

    /// The same with its outline in the pixel.
    pub(super) fn end(&self, scene: &Scene) -> Option<End> {
        let id = self.filled_by?;
        Some((id, fills(scene, self.pixel, id)))
    }

    /// By shape: what can stand between the pixel's first vertices and each of `targets`.
    pub(super) fn blockers(&self, scene: &Scene, targets: &[ShapeId]) -> Vec<Blockers> {
        let mut all = vec![Blockers::Any; scene.surfaces.len()];
        if let Some(shape) = self.filled_by
            && let Some(outline) = fills(scene, self.pixel, shape)
        {
            for &to in targets {
                let other = Region::around(&scene.surfaces[to as usize].shape);
                let ends = [Some(shape), Some(to)];
                all[to as usize] = scene.bvh().blockers(&outline, &other, ends);
            }
        }
        all
    }

    /// [`first_vertex`] of the pixel, without a ray where one shape fills it.
    pub(super) fn vertex(&self, scene: &Scene, ab: [f64; 2]) -> Option<Vertex> {
        let Some((shape, plane)) = self.plane(scene) else {
            return first_vertex(scene, self.pixel, ab);
        };
        let (ray, etendue) = line_of_sight(scene, self.pixel, ab)?;
        let height = plane.normal().dot(plane.corner() - ray.origin);
        let at = ray.origin + ray.direction * (height / plane.normal().dot(ray.direction));
        let point = plane.at_position(at);
        let x = Vertex::arrive(scene, shape, &point, ray.direction, etendue);
        x.filter(|x| x.reflects(scene))
    }

    /// The plane of the shape that fills the pixel.
    fn plane<'s>(&self, scene: &'s Scene) -> Option<(ShapeId, &'s Parallelogram)> {
        let id = self.filled_by?;
        match &scene.surfaces[id as usize].shape {
            Shape::Parallelogram(plane) => Some((id, plane)),
            _ => None,
        }
    }

    /// First vertices for many points of the footprint, weighted by étendue · c (length² sr), c the
    /// constant factor of the BRDF; of weight 0 where nothing is seen.
    pub(super) fn vertices(&self, scene: &Scene, places: &[[f64; 2]], out: &mut Batch) {
        if let Some((shape, plane)) = self.plane(scene) {
            let surface = &scene.surfaces[shape as usize];
            if let Texture::Constant(albedo) = surface.albedo {
                let factor = constant_factor(surface, albedo);
                return self.on_plane(scene, places, out, (shape, plane, factor));
            }
        }
        for (i, ab) in places.iter().enumerate() {
            match self.vertex(scene, *ab) {
                Some(x) => {
                    let weight = x.throughput * x.constant_factor(scene);
                    out.set(i, x.oriented(), weight, x.shape);
                }
                None => out.set(i, (DVec3::ZERO, DVec3::ZERO), 0.0, 0),
            }
        }
    }

    /// With o the pinhole, f a point of the footprint, n_v and n the normals of view and surface
    /// and h = n·(c − o) its distance, the line of sight meets the surface at o + (f − o)·h/(n·(f −
    /// o)), and the point stands for A_footprint·A_lens·(n_v·(f − o))²/|f − o|⁴.
    fn on_plane(
        &self,
        scene: &Scene,
        places: &[[f64; 2]],
        out: &mut Batch,
        (shape, plane, constant_factor): (ShapeId, &Parallelogram, f64),
    ) {
        let camera = &scene.camera;
        let footprint = camera.footprint(self.pixel);
        let [corner, u, v] = [footprint.corner - camera.position, footprint.u, footprint.v];
        let (o, n, view) = (camera.position, plane.normal(), camera.view.normal());
        let height = n.dot(plane.corner() - o);
        let factor = footprint.area * camera.aperture_area * constant_factor;
        let ([x, y, z], weight) = out.put_on_plane(places.len(), shape, n);
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

/// C(x_k, y_k) = weight_k(x) · G·V · d(x_k): the flux into the pixel that sees x_k by the radiance
/// from y_k; `blockers` by shape of y.
pub(super) fn camera_terms(
    (scene, glossy): (&Scene, bool),
    blockers: &[Blockers],
    (x, y): (&Batch, &Batch),
    out: &mut [f64],
) {
    x.geometry_terms_to(y, &x.weight, out);
    if glossy {
        for (k, entry) in out.iter_mut().enumerate().filter(|(_, e)| **e != 0.0) {
            *entry *= x.factor_from(scene, k, y.place(k).0);
        }
    }
    let between = |k: usize| Some(&blockers[y.shape[k] as usize]);
    hide(scene.bvh(), out, between, |k| [x.place(k), y.place(k)]);
}

/// The outline of shape `id` in the pixel, if it is flat, shows its front to the pinhole over the
/// whole footprint, and nothing can stand before it.
fn fills(scene: &Scene, pixel: usize, id: ShapeId) -> Option<Region> {
    let Shape::Parallelogram(plane) = &scene.surfaces[id as usize].shape else {
        return None;
    };
    let camera = &scene.camera;
    let footprint = camera.footprint(pixel);
    let height = plane.normal().dot(plane.corner() - camera.position);
    let corner = |ab| {
        let direction = footprint.at(ab) - camera.position;
        let slope = plane.normal().dot(direction);
        let at = camera.position + direction * (height / slope);
        let place = plane.coordinates(at);
        let inside = place.iter().all(|c| (0.0..=1.0).contains(c));
        (slope < 0.0 && height < 0.0 && inside).then_some(at)
    };
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(corner);
    let outline = Region::flat(corners.into_iter().collect::<Option<_>>()?);
    let pinhole = Region::point(camera.position);
    let bvh = scene.bvh();
    let free = bvh.surely_free(&pinhole, &outline, [None, Some(id)]);
    free.then_some(outline)
}

/// Whether no shape can be in the pixel: between the pinhole and the footprint, enlarged from there
/// until it lies behind every shape, nothing can stand.
pub(super) fn sees_nothing(scene: &Scene, pixel: usize) -> bool {
    let camera = &scene.camera;
    let (o, normal) = (camera.position, camera.view.normal());
    let shapes = scene.surfaces.iter().map(|s| &s.shape);
    let depths = shapes.flat_map(|s| s.box_corners().map(|c| normal.dot(c - o).abs()));
    let height = normal.dot(camera.view.corner() - o).abs();
    let beyond = (2.0 * depths.fold(height, f64::max)) / height;
    let footprint = camera.footprint(pixel);
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let far = corners.map(|ab| o + (footprint.at(ab) - o) * beyond);
    let (pinhole, far) = (Region::point(o), Region::flat(far.to_vec()));
    scene.bvh().surely_free(&pinhole, &far, [None, None])
}
