//! Where the laser's light lands.

use std::f64::consts::FRAC_1_PI;

use crate::geometry::{Basis, DVec3, Parallelogram, Ray, Region, Shape, ShapeId, SurfacePoint};
use crate::num::warp;
use crate::scene::{Profile, Scene};

/// A point lit by the beam: the first surface in its way, seen from the front.
#[derive(Clone, Copy, Debug)]
pub(super) struct LitPoint {
    pub position: DVec3,
    pub normal: DVec3,
    pub shape: ShapeId,
    pub albedo: f64,
    /// Unit vector to the laser.
    pub towards: DVec3,
}

impl LitPoint {
    fn new(scene: &Scene, shape: ShapeId, point: &SurfacePoint, direction: DVec3) -> Option<Self> {
        let albedo = scene.surfaces[shape as usize].albedo.albedo(point.uv);
        (point.normal.dot(direction) < 0.0).then_some(Self {
            position: point.position,
            normal: point.normal,
            shape,
            albedo,
            towards: -direction,
        })
    }

    /// f_r between the beam and the direction to the point `to`.
    pub(super) fn brdf(&self, scene: &Scene, to: DVec3) -> f64 {
        let surface = &scene.surfaces[self.shape as usize];
        if surface.is_lambertian() {
            return self.albedo * FRAC_1_PI;
        }
        let exitant = (to - self.position).normalize_or_zero();
        surface.brdf(self.albedo, self.normal, self.towards, exitant)
    }
}

/// The beams to all spots.
#[derive(Debug)]
pub(super) struct Beams<'a> {
    scene: &'a Scene,
    /// Where the beam lands if it has no width.
    ideal: Vec<Option<LitPoint>>,
    /// Spots without width that a pixel may see directly.
    in_view: Vec<bool>,
}

/// What of a beam is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Reach {
    /// Its irradiance.
    Density,
    /// The points that it is sampled at.
    Samples,
    /// Nearly all of those; what lands beyond is asked ray by ray.
    Expected,
}

impl<'a> Beams<'a> {
    pub(super) fn new(scene: &'a Scene) -> Self {
        let spots = 0..scene.laser.spots.len();
        let mut beams = Self {
            scene,
            ideal: Vec::new(),
            in_view: Vec::new(),
        };
        if !beams.has_width() {
            beams.ideal = spots.clone().map(|l| beams.ideal_spot(l)).collect();
        }
        beams.in_view = beams
            .ideal
            .iter()
            .map(|point| point.is_some_and(|p| scene.camera.pixel_of(p.position).is_some()))
            .collect();
        beams
    }

    /// Whether the lit point is spread over an area and has to be sampled.
    pub(super) fn has_width(&self) -> bool {
        self.scene.laser.profile != Profile::Ideal
    }

    /// The point where the beam of a spot without width lands, if a pixel may see it directly.
    pub(super) fn point_in_view(&self, spot: usize) -> Option<LitPoint> {
        match self.in_view.get(spot) {
            Some(true) => self.ideal[spot],
            _ => None,
        }
    }

    /// How far from the target a beam with width reaches, in the plane across the spot's normal: where its density vanishes (a Gaussian's
    /// underflows, exp(−2·19.4²) < 2⁻¹⁰⁷⁵), or where no sample falls any more (√(½·53·ln 2) < 4.3 of its 1/e² radii).
    fn reach(&self, what: Reach) -> f64 {
        match (self.scene.laser.profile, what) {
            (Profile::Ideal, _) => 0.0,
            (Profile::Disc { radius }, _) => radius,
            (Profile::Gaussian { radius }, Reach::Density) => 19.4 * radius,
            (Profile::Gaussian { radius }, Reach::Samples) => 4.3 * radius,
            (Profile::Gaussian { radius }, Reach::Expected) => 3.0 * radius,
        }
    }

    /// The square around the target that holds all of that.
    pub(super) fn square(&self, spot: usize, what: Reach) -> Option<Parallelogram> {
        let reach = self.reach(what);
        let target = &self.scene.laser.spots[spot].target;
        let basis = Basis::around(target.normal);
        let (s, t) = (basis.s * reach, basis.t * reach);
        Parallelogram::new(target.position - s - t, s * 2.0, t * 2.0)
    }

    /// The shape on which all of a beam with width lands, if that is known before a ray is cast: a flat one that reaches
    /// as far as the beam, with nothing before it.
    pub(super) fn surely_lands_on(&self, spot: usize, what: Reach) -> Option<ShapeId> {
        let id = self.scene.laser.spots[spot].surface;
        let Shape::Parallelogram(plane) = &self.scene.surfaces[id as usize].shape else {
            return None;
        };
        let square = self.square(spot, what)?;
        let inside = |c: &DVec3| {
            let place = plane.coordinates(*c);
            place.iter().all(|c| (0.0..=1.0).contains(c))
        };
        let laser = Region::point(self.scene.laser.position);
        let ends = [None, Some(id)];
        let free = || {
            self.scene
                .bvh()
                .surely_free(&laser, &Region::patch(&square), ends)
        };
        (square.corners().iter().all(inside) && free()).then_some(id)
    }

    /// Whether a pixel may see the lit spot itself: no only where its light surely lands beside the view.
    pub(super) fn may_be_seen(&self, spot: usize) -> bool {
        if !self.has_width() {
            return self.point_in_view(spot).is_some();
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
            let all = |f: &dyn Fn(f64) -> bool| places.iter().all(|p| p.is_some_and(|p| f(p[d])));
            all(&|c| c < 0.0) || all(&|c| c > 1.0)
        };
        !(beside(0) || beside(1))
    }

    /// A point lit by beam `spot`, distributed as its power: the irradiance integrates to Φlaser, so that each sample
    /// carries all of it. `None` where the beam's ray lands nowhere or on a black back.
    pub(super) fn point(&self, spot: usize, u: [f64; 2]) -> Option<LitPoint> {
        let (offset, radius) = match self.scene.laser.profile {
            Profile::Ideal => return self.ideal[spot],
            Profile::Disc { radius } => (warp::disc(u), radius),
            Profile::Gaussian { radius } => (warp::gaussian_spot(u), radius),
        };
        let target = &self.scene.laser.spots[spot].target;
        let [x, y] = offset.map(|c| c * radius);
        self.land(target.position + Basis::around(target.normal).to_world([x, y, 0.0]))
    }

    /// Irradiance (W/area, per watt of power) that the beam of a wide spot makes at a point of the scene, seen from its front:
    /// 0 where the beam does not reach.
    ///
    /// The beam's rays carry f(o) per area of the plane through the target, o the offset there. Seen from the laser that plane and the
    /// surface at x share solid angles, dω = cosθ_plane dA_plane/d_plane² = cosθ_x dA_x/d_x², so
    /// E(x) = f(o) · (cosθ_x/d_x²)·(d_plane²/cosθ_plane), if nothing stands between.
    pub(super) fn irradiance(&self, spot: usize, x: (DVec3, DVec3), shape: ShapeId) -> f64 {
        let density: fn([f64; 2]) -> f64 = match self.scene.laser.profile {
            Profile::Ideal => return 0.0,
            Profile::Disc { .. } => warp::disc_density,
            Profile::Gaussian { .. } => warp::gaussian_spot_density,
        };
        let (Profile::Disc { radius } | Profile::Gaussian { radius }) = self.scene.laser.profile
        else {
            return 0.0;
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
    fn ideal_spot(&self, spot: usize) -> Option<LitPoint> {
        let spot = &self.scene.laser.spots[spot];
        let target = &spot.target;
        let ray = Ray::between(self.scene.laser.position, target.position)?;
        if self.scene.bvh().blocked(&ray, [None, Some(spot.surface)]) {
            return self.land(target.position);
        }
        LitPoint::new(self.scene, spot.surface, target, ray.direction)
    }

    /// First hit of the ray from the laser through `aim`.
    fn land(&self, aim: DVec3) -> Option<LitPoint> {
        let from = self.scene.laser.position;
        let direction = (aim - from).try_normalize()?;
        let ray = Ray::new(from, direction);
        let hit = self.scene.bvh().closest(&ray, None)?;
        let point = self.scene.bvh().point(&ray, hit);
        LitPoint::new(self.scene, hit.shape, &point, direction)
    }
}
