//! Walking a path from the camera into the scene.

use std::f64::consts::FRAC_1_PI;

use crate::geometry::{Basis, DVec3, Ray, ShapeId, SurfacePoint};
use crate::num::stream::Stream;
use crate::num::warp;
use crate::scene::Scene;

use super::form::form;
use super::hidden::HiddenArea;
use super::sight::may_see;

/// A point where a path meets the front of a surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Vertex {
    pub position: DVec3,
    pub normal: DVec3,
    pub shape: ShapeId,
    pub albedo: f64,
    /// Flux into the pixel per unit of radiance leaving this vertex along the path, over the density of the path so far
    /// (length² sr).
    pub throughput: f64,
}

impl Vertex {
    /// The vertex where a ray along `direction` arrives at `shape` near `position`; `None` on a back or a black surface,
    /// from which no light can come.
    pub(super) fn arrive(
        scene: &Scene,
        shape: ShapeId,
        position: DVec3,
        direction: DVec3,
        throughput: f64,
    ) -> Option<Self> {
        let surface = &scene.surfaces[shape as usize];
        let point = surface.shape.at_position(position);
        (point.normal.dot(direction) < 0.0).then(|| Self::at(scene, shape, &point, throughput))?
    }

    /// The vertex at a point of `shape`; `None` on black.
    pub(super) fn at(
        scene: &Scene,
        shape: ShapeId,
        point: &SurfacePoint,
        throughput: f64,
    ) -> Option<Self> {
        let albedo = scene.surfaces[shape as usize].albedo.albedo(point.uv);
        (albedo > 0.0).then_some(Self {
            position: point.position,
            normal: point.normal,
            shape,
            albedo,
            throughput,
        })
    }
}

/// How a path leaves a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Strategy {
    /// Nothing that reflects can be seen from here.
    End,
    /// Points on the hidden surfaces by area: all that can be seen are hidden surfaces at some distance.
    Area,
    /// Directions by the cosine lobe: no hidden surface can be seen.
    Cosine,
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
}

/// A hidden surface this many of its circumradii away is sampled by area alone: the kernel varies little over it.
const FAR: f64 = 1.25;

impl<'a> Walk<'a> {
    pub(super) fn new(scene: &'a Scene) -> Self {
        let hidden = HiddenArea::new(scene);
        let strategies = (0..scene.surfaces.len())
            .map(|s| strategy(scene, &hidden, s))
            .collect();
        Self {
            scene,
            hidden,
            strategies,
        }
    }

    /// Whether paths leave `shape` towards hidden surfaces at some distance, or not at all.
    pub(super) fn by_area_alone(&self, shape: ShapeId) -> bool {
        matches!(
            self.strategies[shape as usize],
            Strategy::Area | Strategy::End
        )
    }

    /// Whether any path has to choose between strategies.
    pub(super) fn chooses(&self) -> bool {
        self.strategies.contains(&Strategy::Both)
    }

    /// The next vertex of the path: `u` places it, `choice` picks the strategy where there are two.
    ///
    /// Let q be the probability of the area strategy, p_A its density and p_C = cosθ_x/π · cosθ_y/d² that of the cosine
    /// strategy, both per unit area at y. Whatever strategy found y, the estimator of ∫ f dy is
    /// f(y)/(q·p_A(y) + (1 − q)·p_C(y)), which is unbiased wherever f > 0 implies a positive mixture density. A point that
    /// the area strategy chose counts only if it is visible itself: taking the first hit in its direction instead would
    /// count a surface in front of it twice.
    pub(super) fn next(&self, x: &Vertex, u: [f64; 2], choice: f64) -> Option<Vertex> {
        let q = match self.strategies[x.shape as usize] {
            Strategy::End => return None,
            Strategy::Area => 1.0,
            Strategy::Cosine => 0.0,
            Strategy::Both => 0.5,
        };
        let (shape, point) = if choice < q {
            self.by_area(x, u)?
        } else {
            self.by_cosine(x, u)?
        };
        let (form, _) = form((x.position, x.normal), (point.position, point.normal))?;
        let density = q * self.hidden.density(shape, point.uv) + (1.0 - q) * FRAC_1_PI * form;
        let throughput = x.throughput * x.albedo * FRAC_1_PI * form / density;
        Vertex::at(self.scene, shape, &point, throughput)
    }

    fn by_area(&self, x: &Vertex, u: [f64; 2]) -> Option<(ShapeId, SurfacePoint)> {
        let (shape, point, _) = self.hidden.sample(self.scene, u);
        let (_, ray) = form((x.position, x.normal), (point.position, point.normal))?;
        (!self.scene.bvh().blocked(&ray, [Some(x.shape), Some(shape)])).then_some((shape, point))
    }

    fn by_cosine(&self, x: &Vertex, u: [f64; 2]) -> Option<(ShapeId, SurfacePoint)> {
        let local = warp::cosine_hemisphere(u);
        let direction = Basis::around(x.normal).to_world(local).normalize();
        let hit = self
            .scene
            .bvh()
            .closest(&Ray::new(x.position, direction), Some(x.shape))?;
        let shape = &self.scene.surfaces[hit.shape as usize].shape;
        Some((hit.shape, shape.at_position(x.position + direction * hit.t)))
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
fn strategy(scene: &Scene, hidden: &HiddenArea, s: usize) -> Strategy {
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
    match (sees_hidden, sees_other) {
        (false, false) => Strategy::End,
        (false, true) => Strategy::Cosine,
        (true, false) if all_far => Strategy::Area,
        (true, _) => Strategy::Both,
    }
}
