//! Walking a path from the camera into the scene.

use std::f64::consts::FRAC_1_PI;

use crate::geometry::{Basis, DVec3, Ray, ShapeId, SurfacePoint};
use crate::num::stream::Stream;
use crate::num::warp;
use crate::scene::{Scene, Surface};

use super::form::form;
use super::hidden::HiddenArea;
use super::lobe;
use super::sight::may_see;

/// A point where a path meets the front of a surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Vertex {
    pub position: DVec3,
    pub normal: DVec3,
    pub shape: ShapeId,
    pub albedo: f64,
    /// Unit vector back along the path; zero where a Lambertian surface need not know it.
    pub towards: DVec3,
    /// Flux into the pixel per unit of radiance leaving this vertex along the path, over the density of the path so far
    /// (length² sr).
    pub throughput: f64,
}

impl Vertex {
    /// The vertex where a ray along `direction` arrives at a point of `shape`; `None` on a back or a black surface, from which no light
    /// can come.
    pub(super) fn arrive(
        scene: &Scene,
        shape: ShapeId,
        point: &SurfacePoint,
        direction: DVec3,
        throughput: f64,
    ) -> Option<Self> {
        let front = point.normal.dot(direction) < 0.0;
        let vertex = front.then(|| Self::at(scene, shape, point, throughput))??;
        Some(Self {
            towards: -direction,
            ..vertex
        })
    }

    /// The vertex at a point of `shape`, whoever looks at it; `None` on black.
    pub(super) fn at(
        scene: &Scene,
        shape: ShapeId,
        point: &SurfacePoint,
        throughput: f64,
    ) -> Option<Self> {
        let surface = &scene.surfaces[shape as usize];
        let albedo = surface.albedo.albedo(point.uv);
        (!surface.material.is_black(albedo)).then_some(Self {
            position: point.position,
            normal: point.normal,
            shape,
            albedo,
            towards: DVec3::ZERO,
            throughput,
        })
    }

    /// f_r of what comes along the unit vector `from` (pointing to where it comes from), towards the path so far.
    pub(super) fn brdf(&self, scene: &Scene, from: DVec3) -> f64 {
        let surface = &scene.surfaces[self.shape as usize];
        match surface.is_lambertian() {
            true => self.albedo * FRAC_1_PI,
            false => surface.brdf(self.albedo, self.normal, from, self.towards),
        }
    }
}

/// How a path leaves a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Strategy {
    /// Nothing that reflects can be seen from here.
    End,
    /// Points on the hidden surfaces by area: all that can be seen are hidden surfaces at some distance.
    Area,
    /// Directions by the material's lobe: no hidden surface can be seen.
    Lobe,
    /// Either, with probability ½, weighted by the mixture's density.
    Both,
}

/// The rule by which paths go on, worked out once per scene.
#[derive(Debug)]
pub(super) struct Walk<'a> {
    scene: &'a Scene,
    hidden: HiddenArea,
    /// By shape.
    strategies: Vec<Strategy>,
    /// By shape: whether all that it may see are hidden surfaces at some distance.
    far: Vec<bool>,
}

/// A hidden surface this many of its circumradii away is sampled by area alone: the kernel varies little over it.
const FAR: f64 = 1.25;

impl<'a> Walk<'a> {
    pub(super) fn new(scene: &'a Scene) -> Self {
        let hidden = HiddenArea::new(scene);
        let (strategies, far) = (0..scene.surfaces.len())
            .map(|s| strategy(scene, &hidden, s))
            .unzip();
        Self {
            scene,
            hidden,
            strategies,
            far,
        }
    }

    /// Whether all that can be seen from `shape` are hidden surfaces at some distance.
    pub(super) fn far_from_hidden(&self, shape: ShapeId) -> bool {
        self.far[shape as usize]
    }

    /// Whether any path has to choose between strategies, or between the lobes of a material.
    pub(super) fn chooses(&self) -> bool {
        let glossy =
            |(s, surface): (&Strategy, &Surface)| *s == Strategy::Lobe && !surface.is_lambertian();
        self.strategies.contains(&Strategy::Both)
            || self.strategies.iter().zip(&self.scene.surfaces).any(glossy)
    }

    /// The next vertex of the path: `u` places it, `choice` picks the strategy where there are two.
    ///
    /// Let q be the probability of the area strategy, p_A its density and p_C = p_ω · cosθ_y/d² that of the lobe strategy, p_ω the
    /// density per solid angle by which the material is sampled (cosθ_x/π where it is Lambertian), both per unit area at y. Whatever strategy found y, the estimator of ∫ f dy is
    /// f(y)/(q·p_A(y) + (1 − q)·p_C(y)), which is unbiased wherever f > 0 implies a positive mixture density. A point that
    /// the area strategy chose counts only if it is visible itself: taking the first hit in its direction instead would
    /// count a surface in front of it twice.
    pub(super) fn next(&self, x: &Vertex, u: [f64; 2], choice: f64) -> Option<Vertex> {
        let q = match self.strategies[x.shape as usize] {
            Strategy::End => return None,
            Strategy::Area => 1.0,
            Strategy::Lobe => 0.0,
            Strategy::Both => 0.5,
        };
        let (shape, point) = if choice < q {
            self.by_area(x, u)?
        } else {
            self.by_lobe(x, u, (choice - q) / (1.0 - q))?
        };
        let (form, ray) = form((x.position, x.normal), (point.position, point.normal))?;
        let by_lobe = match q < 1.0 {
            true => self.lobe_density(x, &point, &ray, form),
            false => 0.0,
        };
        let density = q * self.hidden.density(shape, point.uv) + (1.0 - q) * by_lobe;
        let throughput = x.throughput * x.brdf(self.scene, ray.direction) * form / density;
        Vertex::arrive(self.scene, shape, &point, ray.direction, throughput)
    }

    fn by_area(&self, x: &Vertex, u: [f64; 2]) -> Option<(ShapeId, SurfacePoint)> {
        let (shape, point, _) = self.hidden.sample(self.scene, u);
        let (_, ray) = form((x.position, x.normal), (point.position, point.normal))?;
        (!self.scene.bvh().blocked(&ray, [Some(x.shape), Some(shape)])).then_some((shape, point))
    }

    fn by_lobe(&self, x: &Vertex, u: [f64; 2], choice: f64) -> Option<(ShapeId, SurfacePoint)> {
        let surface = &self.scene.surfaces[x.shape as usize];
        let basis = Basis::around(x.normal);
        let local = match surface.is_lambertian() {
            true => warp::cosine_hemisphere(u),
            false => {
                let exitant = basis.to_local(x.towards);
                lobe::sample(&surface.material, x.albedo, exitant, u, choice)?.to_array()
            }
        };
        let ray = Ray::new(x.position, basis.to_world(local).normalize());
        let hit = self.scene.bvh().closest(&ray, Some(x.shape))?;
        Some((hit.shape, self.scene.bvh().point(&ray, hit)))
    }

    /// Density of [`Walk::by_lobe`] per unit area at y, which `ray` reaches from x; `form` is cosθ_x·cosθ_y/d².
    fn lobe_density(&self, x: &Vertex, y: &SurfacePoint, ray: &Ray, form: f64) -> f64 {
        let surface = &self.scene.surfaces[x.shape as usize];
        if surface.is_lambertian() {
            return FRAC_1_PI * form;
        }
        let basis = Basis::around(x.normal);
        let [exitant, incident] = [x.towards, ray.direction].map(|w| basis.to_local(w));
        let cos_y = -y.normal.dot(ray.direction);
        lobe::density(&surface.material, x.albedo, exitant, incident) * cos_y
            / (ray.length * ray.length)
    }

    /// Walks from `first` and calls `visit(n, vertex)` for vertices n = 1 … `vertices`.
    ///
    /// `u` and `choice` serve the first step; later steps draw a set of four dimensions each.
    pub(super) fn run(
        &self,
        first: Option<Vertex>,
        vertices: u32,
        u: [f64; 2],
        choice: f64,
        stream: &mut Stream,
        mut visit: impl FnMut(u32, &Vertex),
    ) {
        let mut at = first;
        for n in 1..=vertices {
            let Some(vertex) = at else { return };
            visit(n, &vertex);
            if n == vertices {
                return;
            }
            at = if n == 1 {
                self.next(&vertex, u, choice)
            } else {
                let [a, b, c, _] = stream.next_four();
                self.next(&vertex, [a, b], c)
            };
        }
    }
}

/// What can be seen from shape `s`, judged conservatively: a strategy is left out only where it cannot be needed.
fn strategy(scene: &Scene, hidden: &HiddenArea, s: usize) -> (Strategy, bool) {
    let from = &scene.surfaces[s].shape;
    let mut sees_hidden = false;
    let mut sees_other = false;
    let mut all_far = true;
    for t in (0..scene.surfaces.len()).filter(|t| may_see(scene, s, *t)) {
        if hidden.contains(t as ShapeId) {
            sees_hidden = true;
            let shape = &scene.surfaces[t].shape;
            let (centre, radius) = shape.circumsphere();
            all_far &= from.distance_to(centre) > FAR * radius;
        } else {
            sees_other = true;
        }
    }
    let strategy = match (sees_hidden, sees_other) {
        (false, false) => Strategy::End,
        (false, true) => Strategy::Lobe,
        (true, false) if all_far && scene.surfaces[s].is_lambertian() => Strategy::Area,
        (true, _) => Strategy::Both,
    };
    (strategy, !sees_other && all_far)
}
