//! Camera paths: how a path goes on from a vertex.

use std::f64::consts::FRAC_1_PI;

use crate::geometry::{Basis, DVec3, Interaction, Ray, ShapeId};
use crate::num::stream::Stream;
use crate::num::warp;
use crate::scene::Scene;
use crate::scene::material::{Material, Part, mirrored};

use super::area::{AreaSampler, SurfaceInteraction};
use super::light_path::LightEnd;
use super::parts::FAR;
use super::vertex::{Vertex, geometry_term};
use super::visibility::may_be_visible;

/// How the next vertex is sampled.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Strategy {
    /// Not at all: nothing that reflects is visible from here.
    End,
    /// By the area of the surfaces: only hidden ones are visible, and they are at some distance.
    Area,
    /// By the lobe of the material: no hidden surface is visible.
    Lobe,
    /// Either, with probability ½, weighted by the density of the mixture.
    Both,
}

impl Strategy {
    /// The probability q of the area strategy; `None` where no path goes on.
    fn share_of_area(self) -> Option<f64> {
        match self {
            Self::End => None,
            Self::Area => Some(1.0),
            Self::Lobe => Some(0.0),
            Self::Both => Some(0.5),
        }
    }
}

/// The rule by which paths go on, computed once per scene.
#[derive(Debug)]
pub(super) struct PathSampler<'a> {
    scene: &'a Scene,
    /// Points of the hidden surfaces; where paths choose, of all that light may meet between.
    points: AreaSampler,
    /// By shape.
    strategies: Vec<Strategy>,
    /// By shape: whether only hidden surfaces at some distance are visible from it.
    far: Vec<bool>,
}

/// Points of the area strategy, with its probability.
pub(super) type Points<'p> = (&'p AreaSampler, f64);

impl<'a> PathSampler<'a> {
    /// `seen` are the shapes that pixels may see; `guide` samples those that light may meet before.
    pub(super) fn new(
        scene: &'a Scene,
        seen: &[ShapeId],
        guide: impl FnOnce() -> AreaSampler,
    ) -> Self {
        let hidden = scene.hidden().filter(|(_, s)| !s.is_black());
        let hidden: Vec<ShapeId> = hidden.map(|(id, _)| id as ShapeId).collect();
        let hidden = AreaSampler::new(scene, &hidden);
        let (mut strategies, far): (Vec<_>, _) = (0..scene.surfaces.len() as ShapeId)
            .map(|s| strategy(scene, &hidden, s))
            .unzip();
        let both = |s: &ShapeId| strategies[*s as usize] == Strategy::Both;
        let guided = seen.iter().any(both).then(guide);
        let points = match guided.filter(|points| !points.is_empty()) {
            None => hidden,
            Some(points) => {
                let all = (0..scene.surfaces.len() as ShapeId)
                    .all(|s| points.contains(s) || !hidden.contains(s));
                let area = strategies.iter_mut().filter(|s| **s == Strategy::Area);
                area.filter(|_| !all).for_each(|s| *s = Strategy::Both);
                points
            }
        };
        Self {
            scene,
            points,
            strategies,
            far,
        }
    }

    /// Whether only hidden surfaces at some distance are visible from `shape`.
    pub(super) fn far_from_hidden(&self, shape: ShapeId) -> bool {
        self.far[shape as usize]
    }

    /// Whether any path has to choose between strategies, or between the lobes of a material.
    pub(super) fn chooses(&self) -> bool {
        let mut all = self.strategies.iter().zip(&self.scene.surfaces);
        all.any(|(strategy, surface)| match strategy {
            Strategy::Both => true,
            Strategy::Lobe => !surface.is_lambertian(),
            Strategy::End | Strategy::Area => false,
        })
    }

    /// Calls `visit(n, x_n)` for the vertices n = 1 … `vertices` of the path that starts at
    /// `first`.
    ///
    /// `first_step` are the random numbers of the first step; each later step draws a set of four.
    pub(super) fn trace(
        &self,
        first: Option<Vertex>,
        vertices: u32,
        (first_step, own): ([f64; 3], Option<Points<'_>>),
        stream: &mut Stream,
        mut visit: impl FnMut(u32, &Vertex),
    ) {
        let mut next = first;
        for n in 1..=vertices {
            let Some(x) = next else { return };
            visit(n, &x);
            next = match n {
                _ if n == vertices => return,
                1 => self.next(&x, first_step, own),
                _ => {
                    let [u, v, choice, _] = stream.next_four();
                    self.next(&x, [u, v, choice], None)
                }
            };
        }
    }

    /// The vertex y after x: (u, v) places it, `choice` picks the strategy where there are two.
    ///
    /// Let q be the probability of the area strategy, p_A its density and p_L = p_ω · cosθ_y/d²
    /// that of the lobe strategy, both per unit area at y, with p_ω the density per solid angle by
    /// which the material is sampled (cosθ_x/π where it is Lambertian). Whichever strategy found y,
    /// the estimator of ∫ f dy is f(y)/(q·p_A(y) + (1 − q)·p_L(y)): unbiased because the density of
    /// the mixture is positive wherever f is. A point that the area strategy chose counts only if
    /// it is visible itself: to take the first hit in its direction instead would count a surface
    /// in front of it twice.
    fn next(
        &self,
        x: &Vertex,
        [u, v, choice]: [f64; 3],
        own: Option<Points<'_>>,
    ) -> Option<Vertex> {
        let (points, q) = self.points(x, own)?;
        let point = if choice < q {
            self.by_area(x, points, [u, v])?
        } else {
            self.by_lobe(x, [u, v], (choice - q) / (1.0 - q))?
        };
        let segment = geometry_term(x.oriented(), point.oriented())?;
        self.arrive(x, &point, &segment, (points, q), 0.0)
    }

    /// The area strategy at x; `None` where no path goes on.
    fn points<'p>(&'p self, x: &Vertex, own: Option<Points<'p>>) -> Option<Points<'p>> {
        let strategy = self.strategies[x.shape as usize];
        let own = own.filter(|_| strategy == Strategy::Both);
        own.or_else(|| Some((&self.points, strategy.share_of_area()?)))
    }

    /// Whether paths that go on from `shape` choose.
    pub(super) fn chooses_at(&self, shape: ShapeId) -> bool {
        self.strategies[shape as usize] == Strategy::Both
    }

    /// The vertex at the end of a light path, as many of which are drawn as paths, seen from x;
    /// `None` if it is not.
    pub(super) fn connect(
        &self,
        x: &Vertex,
        end: &LightEnd,
        own: Option<Points<'_>>,
    ) -> Option<Vertex> {
        let points = self.points(x, own)?;
        let segment = geometry_term(x.oriented(), end.at.oriented())?;
        let ends = [Some(x.shape), Some(end.at.shape)];
        if self.scene.bvh().blocked(&segment.1, ends) {
            return None;
        }
        self.arrive(x, &end.at, &segment, points, end.density)
    }

    /// The vertex at a visible point y, `density` that of the light paths there: the throughput is
    /// over the density of all.
    fn arrive(
        &self,
        x: &Vertex,
        at: &SurfaceInteraction,
        (term, ray): &(f64, Ray),
        (points, q): Points<'_>,
        density: f64,
    ) -> Option<Vertex> {
        let by_lobe = if q < 1.0 {
            self.lobe_density(x, &at.point, ray, *term)
        } else {
            0.0
        };
        let own = q * points.density(at) + (1.0 - q) * by_lobe;
        let throughput = x.throughput * x.brdf(self.scene, ray.direction) * term / (own + density);
        let y = Vertex::arrive(self.scene, at.shape, &at.point, ray.direction, throughput)?;
        y.reflects(self.scene)
            .then_some(Vertex { density: own, ..y })
    }

    fn by_area(&self, x: &Vertex, points: &AreaSampler, u: [f64; 2]) -> Option<SurfaceInteraction> {
        let (point, _) = points.sample(self.scene, u);
        let (_, ray) = geometry_term(x.oriented(), point.oriented())?;
        let ends = [Some(x.shape), Some(point.shape)];
        (!self.scene.bvh().blocked(&ray, ends)).then_some(point)
    }

    fn by_lobe(&self, x: &Vertex, u: [f64; 2], choice: f64) -> Option<SurfaceInteraction> {
        let basis = Basis::around(x.normal);
        let material = &self.scene.surfaces[x.shape as usize].material;
        let wi = sample_wi(material, x.albedo, basis.to_local(x.back), u, choice)?;
        let ray = Ray::new(x.position, basis.to_world(wi.to_array()).normalize());
        let hit = self.scene.bvh().closest(&ray, Some(x.shape))?;
        Some(SurfaceInteraction::hit(self.scene, &ray, hit))
    }

    /// Density of [`PathSampler::by_lobe`] per unit area at y, which `ray` reaches from x; `term`
    /// is cosθ_x·cosθ_y/d².
    fn lobe_density(&self, x: &Vertex, y: &Interaction, ray: &Ray, term: f64) -> f64 {
        let surface = &self.scene.surfaces[x.shape as usize];
        if surface.is_lambertian() {
            return FRAC_1_PI * term;
        }
        let basis = Basis::around(x.normal);
        let [wo, wi] = [x.back, ray.direction].map(|w| basis.to_local(w));
        let cos_y = -y.normal.dot(ray.direction);
        wi_density(&surface.material, x.albedo, wo, wi) * cos_y / (ray.length * ray.length)
    }
}

/// What is visible from shape `s`, judged conservatively: a strategy is left out only where it
/// cannot be needed.
fn strategy(scene: &Scene, hidden: &AreaSampler, s: ShapeId) -> (Strategy, bool) {
    let from = &scene.surfaces[s as usize];
    let shapes = 0..scene.surfaces.len() as ShapeId;
    let (sees_hidden, sees_other): (Vec<ShapeId>, Vec<ShapeId>) = shapes
        .filter(|t| may_be_visible(scene, s, *t))
        .partition(|t| hidden.contains(*t));
    let all_far = sees_hidden.iter().all(|t| {
        let (centre, radius) = scene.surfaces[*t as usize].shape.circumsphere();
        from.shape.distance_to(centre) > FAR * radius
    });
    let strategy = match (sees_hidden.is_empty(), sees_other.is_empty()) {
        (true, true) => Strategy::End,
        (true, false) => Strategy::Lobe,
        (false, true) if all_far && from.is_lambertian() => Strategy::Area,
        (false, _) => Strategy::Both,
    };
    (strategy, sees_other.is_empty() && all_far)
}

/// A direction `wi` for u ∈ [0, 1)² and `choice` ∈ [0, 1), distributed by [`wi_density`]; `None`
/// where it points below the surface. In the basis of the surface, its normal along z.
fn sample_wi(
    material: &Material,
    albedo: f64,
    wo: DVec3,
    u: [f64; 2],
    choice: f64,
) -> Option<DVec3> {
    match material {
        Material::Lambertian => Some(DVec3::from_array(warp::cosine_hemisphere(u))),
        Material::Mixture(parts) => {
            let (part, rest) = chosen(parts, choice)?;
            sample_wi(&part.material, part.albedo, wo, u, rest)
        }
        _ => {
            let lobe = material.lobe(albedo, wo);
            if choice >= lobe.glossy {
                return Some(DVec3::from_array(warp::cosine_hemisphere(u)));
            }
            let wi = mirrored(wo, lobe.ggx.visible_normal(wo, u));
            (wi.z > 0.0).then_some(wi)
        }
    }
}

/// Probability per solid angle that [`sample_wi`] gives `wi`; its integral over the hemisphere is 1
/// less the probability of `None`.
fn wi_density(material: &Material, albedo: f64, wo: DVec3, wi: DVec3) -> f64 {
    match material {
        Material::Lambertian => warp::cosine_hemisphere_density(wi.z),
        Material::Mixture(parts) => parts
            .iter()
            .map(|p| p.share * wi_density(&p.material, p.albedo, wo, wi))
            .sum(),
        _ => material.lobe(albedo, wo).density(wo, wi),
    }
}

/// The part that `choice` falls on, and its place within the part's share, again in [0, 1).
fn chosen(parts: &[Part], choice: f64) -> Option<(&Part, f64)> {
    let mut left = choice;
    for part in parts {
        if left < part.share {
            return Some((part, left / part.share));
        }
        left -= part.share;
    }
    // The shares add up to 1 up to rounding.
    let last = parts.iter().rfind(|p| p.share > 0.0)?;
    Some((last, 1.0 - f64::EPSILON))
}

#[cfg(test)]
mod tests;
