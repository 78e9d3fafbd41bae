//! Light paths of one step: points y drawn from a lit point s, in directions by the cosine.
//!
//! Next to a spot the light that reaches a surface grows like 1/d². Points drawn by area, or from
//! what the camera sees, seldom fall there, and 32 blocks of them may not show it. So each block
//! draws m points from s too, of density
//!
//! ```text
//! p_s(y) = V·cosθ_s·cosθ_y/(π d²) = V·G(y, s)/π        per unit area
//! ```
//!
//! Beside n points of density p each contribution f/(n·p) becomes f/(n·p + m·p_s), whichever way y
//! was found (balance heuristic: Veach, Guibas, *Optimally combining sampling techniques for Monte
//! Carlo rendering*, SIGGRAPH 1995). Unbiased because the sum is positive wherever f is. f has the
//! factor G(y, s), so f/(m·p_s) is bounded by the BRDFs; and where f ≠ 0, V = 1: the weight needs
//! no ray.

use std::f64::consts::FRAC_1_PI;
use std::ops::Range;

use super::area::SurfaceInteraction;
use super::beam::Beams;
use super::vertex::{Oriented, Vertex, geometry_term};
use super::visibility::may_be_visible;
use crate::geometry::{Basis, Ray};
use crate::num::stream::{Key, Sampling, Stream};
use crate::num::warp;
use crate::scene::Scene;

/// A spot has light paths if a surface is nearer to it than this many of the surface's
/// circumradii: beyond, the kernel varies little over the surface.
const NEAR: f64 = 0.5;

/// Which spots have light paths, and how many.
#[derive(Debug)]
pub(super) struct LightPaths {
    sampling: Sampling,
    /// Index of the first column's spot.
    first: usize,
    /// Columns of spots that surfaces come close to, ascending.
    columns: Vec<usize>,
    /// Light paths of each of those in a block: as many as samples.
    pub count: u32,
}

/// The end of a light path.
#[derive(Clone, Copy, Debug)]
pub(super) struct LightEnd {
    pub at: SurfaceInteraction,
    /// p_s, per unit area.
    pub density: f64,
}

impl LightPaths {
    /// For the columns of `spots` and blocks of `size` samples.
    pub(super) fn new(
        scene: &Scene,
        beams: &Beams<'_>,
        spots: &Range<usize>,
        (sampling, size): (Sampling, u32),
    ) -> Self {
        let near = |(column, spot): (usize, usize)| {
            let needed = scene.max_bounces > 2 && has_surfaces_near(scene, beams, spot);
            needed.then_some(column)
        };
        Self {
            sampling,
            first: spots.start,
            columns: spots.clone().enumerate().filter_map(near).collect(),
            count: size,
        }
    }

    /// Leaves them to the spots for which `needed` holds: others have points enough where every
    /// entry has points of its own ([`guide`](super::guide)).
    pub(super) fn keep(&mut self, needed: impl Fn(usize) -> bool) {
        self.columns.retain(|column| needed(self.first + column));
    }

    /// The columns among `range` that have light paths.
    pub(super) fn columns(&self, range: &Range<usize>) -> &[usize] {
        let place = |c: usize| self.columns.partition_point(|own| *own < c);
        &self.columns[place(range.start)..place(range.end)]
    }

    /// The random numbers of a column's light paths.
    pub(super) fn stream(&self, key: Key, column: usize) -> Stream {
        Stream::of_stratum(self.sampling, key, !1 - (self.first + column) as u32)
    }

    /// Multiplies the light that goes from `points`, in columns from `first` on, to y by the
    /// weight n·p/(n·p + m·p_s), where another strategy drew y with `density` = n·p.
    pub(super) fn weigh(
        &self,
        (y, density, m): (Oriented, f64, f64),
        points: &[Option<Vertex>],
        first: usize,
        row: &mut [f64],
    ) {
        for column in self.columns(&(first..first + points.len())) {
            let i = column - first;
            if let (Some(lit), true) = (&points[i], row[i] != 0.0) {
                row[i] *= weight(y, density, m, lit);
            }
        }
    }
}

/// n·p/(n·p + m·p_s) at y for the lit point, with `density` = n·p; 1 if that is infinite.
pub(super) fn weight(y: Oriented, density: f64, m: f64, lit: &Vertex) -> f64 {
    let term = geometry_term(y, lit.oriented()).map_or(0.0, |(term, _)| term);
    1.0 / (1.0 + m * FRAC_1_PI * term / density)
}

/// What a lit point lights in the direction of u; `None` where there is nothing, or its back.
pub(super) fn light_end(scene: &Scene, lit: &Vertex, u: [f64; 2]) -> Option<LightEnd> {
    let local = warp::cosine_hemisphere(u);
    let direction = Basis::around(lit.normal).to_world(local).normalize();
    let ray = Ray::new(lit.position, direction);
    let hit = scene.bvh().closest(&ray, Some(lit.shape))?;
    let at = SurfaceInteraction::hit(scene, &ray, hit);
    let (term, _) = geometry_term(at.oriented(), lit.oriented())?;
    Some(LightEnd {
        at,
        density: FRAC_1_PI * term,
    })
}

/// Whether a surface that the spot may light comes near to it.
fn has_surfaces_near(scene: &Scene, beams: &Beams<'_>, spot: usize) -> bool {
    let spot = &scene.laser.spots[spot];
    let at = spot.target.position;
    let mut others = scene.surfaces.iter().zip(0..);
    others.any(|(other, id)| {
        if id == spot.surface {
            return false;
        }
        let (centre, radius) = other.shape.circumsphere();
        let reach = NEAR * radius + beams.reach();
        (centre - at).length() - radius < reach
            && may_be_visible(scene, spot.surface, id)
            && other.shape.distance_to(at) < reach
    })
}
