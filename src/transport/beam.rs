//! Where the laser's light lands, or a surface shines.

use crate::geometry::{Basis, DVec3, Parallelogram, Ray, Region, Shape, ShapeId};
use crate::num::warp;
use crate::scene::{Profile, Scene};

use super::area::AreaSampler;
use super::vertex::{Oriented, Vertex};
use super::visibility::{End, all_ends, known_or_all};

/// The beams to all spots of the scene.
#[derive(Debug)]
pub(super) struct Beams<'a> {
    pub scene: &'a Scene,
    /// By spot, if beams have no width: where its light lands.
    pub ideal: Vec<Option<Vertex>>,
    /// Points of the surface that shines, by the brightness of its cells.
    bright: Option<AreaSampler>,
}

/// Which part of a beam is meant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Reach {
    /// All of its irradiance.
    Density,
    /// The points that it is sampled at.
    Samples,
    /// Nearly all of those; for what lands beyond, rays are cast.
    Expected,
}

impl<'a> Beams<'a> {
    pub(super) fn new(scene: &'a Scene) -> Self {
        let mut beams = Self {
            scene,
            ideal: Vec::new(),
            bright: scene
                .shining()
                .map(|(id, _)| AreaSampler::new(scene, &[id])),
        };
        if !beams.has_width() {
            let spots = 0..scene.laser.spots.len();
            beams.ideal = spots.map(|spot| beams.ideal_point(spot)).collect();
        }
        beams
    }

    /// Whether the light of a spot is spread over an area and has to be sampled.
    pub(super) fn has_width(&self) -> bool {
        self.scene.laser.profile != Profile::Ideal
    }

    /// Radius of a beam around its target, in the plane across the spot's normal: where its density
    /// vanishes (a Gaussian's underflows, exp(−2·19.4²) < 2⁻¹⁰⁷⁵), or where no sample falls any
    /// more (√(½·53·ln 2) < 4.3 of its 1/e² radii). Of what shines, from its middle to its rim.
    fn radius(&self, reach: Reach) -> f64 {
        match (self.scene.laser.profile, reach) {
            (Profile::Ideal, _) => 0.0,
            (Profile::Disc { radius }, _) => radius,
            (Profile::Gaussian { radius }, Reach::Density) => 19.4 * radius,
            (Profile::Gaussian { radius }, Reach::Samples) => 4.3 * radius,
            (Profile::Gaussian { radius }, Reach::Expected) => 3.0 * radius,
            (Profile::Shining { .. }, _) => self
                .scene
                .shining()
                .map_or(0.0, |(_, s)| s.shape.circumsphere().1),
        }
    }

    /// Radius of the beams around their targets, nearly all of their power.
    pub(super) fn reach(&self) -> f64 {
        self.radius(Reach::Expected)
    }

    /// The square around the target that holds that part of the beam; the part of a rectangle that
    /// shines.
    pub(super) fn square(&self, spot: usize, reach: Reach) -> Option<Parallelogram> {
        if let (Some((_, surface)), Some([from, size])) =
            (self.scene.shining(), self.scene.laser.part(spot))
        {
            let Shape::Parallelogram(plane) = &surface.shape else {
                return None;
            };
            let (u, v) = (plane.u(), plane.v());
            let corner = plane.corner() + u * from[0] + v * from[1];
            return Parallelogram::new(corner, u * size[0], v * size[1]);
        }
        let radius = self.radius(reach);
        let target = &self.scene.laser.spots[spot].target;
        let basis = Basis::around(target.normal);
        let (s, t) = (basis.s * radius, basis.t * radius);
        Parallelogram::new(target.position - s - t, s * 2.0, t * 2.0)
    }

    /// The shape that all of a beam with width lands on, if that is known before a ray is cast: a
    /// flat one that reaches as far as the beam, with nothing before it.
    fn surely_lands_on(&self, spot: usize, reach: Reach) -> Option<ShapeId> {
        let id = self.scene.laser.spots[spot].surface;
        if self.scene.laser.is_shining() {
            return Some(id);
        }
        let Shape::Parallelogram(plane) = &self.scene.surfaces[id as usize].shape else {
            return None;
        };
        let square = self.square(spot, reach)?;
        let mut corners = square.corners().into_iter();
        let inside = corners.all(|c| {
            let place = plane.coordinates(c);
            place.iter().all(|c| (0.0..=1.0).contains(c))
        });
        let laser = Region::point(self.scene.laser.position);
        let ends = [None, Some(id)];
        let bvh = self.scene.bvh();
        (inside && bvh.surely_free(&laser, &Region::patch(&square), ends)).then_some(id)
    }

    /// Where the light of a spot lands: nowhere, on a known part of a shape, or on any.
    pub(super) fn ends(&self, spot: usize) -> Vec<End> {
        match self.ideal.get(spot) {
            Some(lit) => {
                let end = |p: &Vertex| (p.shape, Some(Region::point(p.position)));
                lit.iter().map(end).collect()
            }
            None => match self.surely_lands_on(spot, Reach::Samples) {
                Some(id) => {
                    let square = self.square(spot, Reach::Samples);
                    vec![(id, square.as_ref().map(Region::patch))]
                }
                None => all_ends(self.scene),
            },
        }
    }

    /// Shapes on which the light of any spot of the scene may land.
    pub(super) fn lit_shapes(&self) -> Vec<ShapeId> {
        let known: Option<Vec<ShapeId>> = if self.has_width() {
            let spots = 0..self.scene.laser.spots.len();
            spots
                .map(|spot| self.surely_lands_on(spot, Reach::Samples))
                .collect()
        } else {
            Some(self.ideal.iter().flatten().map(|p| p.shape).collect())
        };
        known_or_all(self.scene, known)
    }

    /// Whether a pixel may see the lit spot of a beam with width: no only where its light surely
    /// lands beside the view, or where a hidden surface shines, which the camera does not see.
    pub(super) fn may_be_seen(&self, spot: usize) -> bool {
        if self.scene.laser.is_shining() {
            return false;
        }
        let lands = self.surely_lands_on(spot, Reach::Density);
        let (Some(_), Some(square)) = (lands, self.square(spot, Reach::Density)) else {
            return true;
        };
        let camera = &self.scene.camera;
        let normal = camera.view.normal();
        let height = normal.dot(camera.view.corner() - camera.position);
        let places = square.corners().map(|c| {
            let direction = c - camera.position;
            let t = height / normal.dot(direction);
            (t > 0.0).then(|| camera.view.coordinates(camera.position + direction * t))
        });
        let beside = |d: usize| {
            let all = |f: fn(f64) -> bool| places.iter().all(|p| p.is_some_and(|p| f(p[d])));
            all(|c| c < 0.0) || all(|c| c > 1.0)
        };
        !(beside(0) || beside(1))
    }

    /// A point lit by the beam of `spot`, distributed as its power: the irradiance integrates to
    /// Φlaser, so that each sample carries all of it. `None` where its light is lost.
    pub(super) fn point(&self, spot: usize, u: [f64; 2]) -> Option<Vertex> {
        let (offset, radius) = match self.scene.laser.profile {
            Profile::Ideal => return self.ideal[spot],
            Profile::Disc { radius } => (warp::disc(u), radius),
            Profile::Gaussian { radius } => (warp::gaussian_spot(u), radius),
            Profile::Shining { .. } => return self.shining_point(spot, u),
        };
        let target = &self.scene.laser.spots[spot].target;
        let [x, y] = offset.map(|c| c * radius);
        self.land(target.position + Basis::around(target.normal).to_world([x, y, 0.0]))
    }

    /// A point of what shines in a column, by the brightness of its cells. With p the density there
    /// per area and A the area of what shines, x/(p·A) stands in the place of x: the mean of
    /// M·A·(x/(p·A))/π is the integral of the radiance M·x/π.
    fn shining_point(&self, spot: usize, u: [f64; 2]) -> Option<Vertex> {
        let (scene, bright) = (self.scene, self.bright.as_ref()?);
        let (id, surface) = scene.shining()?;
        let [from, size] = scene.laser.part(spot)?;
        let vertex = |point| Vertex::new(scene, id, point, DVec3::ZERO, 1.0);
        if size != [1.0; 2] {
            let uv = std::array::from_fn(|d| from[d] + size[d] * u[d]);
            return Some(vertex(&surface.shape.at(uv)));
        }
        if bright.is_empty() {
            return None;
        }
        let (at, density) = bright.sample(scene, u);
        let vertex = vertex(&at.point);
        let albedo = vertex.albedo / (density * surface.shape.area());
        Some(Vertex { albedo, ..vertex })
    }

    /// Irradiance (W/area, per watt of power) of the beam of a wide spot on the front of a surface:
    /// 0 where the beam does not reach.
    ///
    /// The beam's rays carry f(o) per area of the plane through the target, o the offset there.
    /// Seen from the laser that plane and the surface at x share solid angles, dω = cosθ_plane
    /// dA_plane/d_plane² = cosθ_x dA_x/d_x², so E(x) = f(o) · (cosθ_x/d_x²)·(d_plane²/cosθ_plane),
    /// if nothing stands between.
    pub(super) fn irradiance(&self, spot: usize, x: Oriented, shape: ShapeId) -> f64 {
        let (radius, density): (f64, fn([f64; 2]) -> f64) = match self.scene.laser.profile {
            Profile::Ideal | Profile::Shining { .. } => return 0.0,
            Profile::Disc { radius } => (radius, warp::disc_density),
            Profile::Gaussian { radius } => (radius, warp::gaussian_spot_density),
        };
        let target = &self.scene.laser.spots[spot].target;
        let Some(ray) = Ray::between(self.scene.laser.position, x.0) else {
            return 0.0;
        };
        let (cos_plane, cos_x) = (-target.normal.dot(ray.direction), -x.1.dot(ray.direction));
        if cos_plane <= 0.0 || cos_x <= 0.0 {
            return 0.0;
        }
        let to_plane = target.normal.dot(ray.origin - target.position) / cos_plane;
        let offset = ray.origin + ray.direction * to_plane - target.position;
        let basis = Basis::around(target.normal);
        let f = density([basis.s.dot(offset) / radius, basis.t.dot(offset) / radius])
            / (radius * radius);
        if f <= 0.0 || self.scene.bvh().blocked(&ray, [None, Some(shape)]) {
            return 0.0;
        }
        f * cos_x / (ray.length * ray.length) * to_plane * to_plane / cos_plane
    }

    /// Where a beam without width lands: exactly on its target, unless something stands in its way.
    fn ideal_point(&self, spot: usize) -> Option<Vertex> {
        let spot = &self.scene.laser.spots[spot];
        let target = &spot.target;
        let ray = Ray::between(self.scene.laser.position, target.position)?;
        if self.scene.bvh().blocked(&ray, [None, Some(spot.surface)]) {
            return self.land(target.position);
        }
        Vertex::arrive(self.scene, spot.surface, target, ray.direction, 1.0)
    }

    /// First hit of the ray from the laser through `aim`.
    fn land(&self, aim: DVec3) -> Option<Vertex> {
        let from = self.scene.laser.position;
        let direction = (aim - from).try_normalize()?;
        let ray = Ray::new(from, direction);
        let hit = self.scene.bvh().closest(&ray, None)?;
        let point = self.scene.bvh().point(&ray, hit);
        Vertex::arrive(self.scene, hit.shape, &point, direction, 1.0)
    }
}
