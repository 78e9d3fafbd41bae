//! The two sides of the three-bounce integral past what stands in the way.
//!
//! > c_p(x) = ∫_p f_r3 G(x, w) V(x, w) dE(w),   d_l(x) = ∫_l f_r1 G(x, w) V(x, w) dΦ(w),
//! > Φ\[p,l\] = ∫ c_p(x) (ρ(x)/π) d_l(x) dA
//!
//! Where a surface shines, d_l(x) is its exitance M, or 0 where it is dark.
//!
//! Of a flat wall what the camera sees of a pixel's footprint, and of that what x sees, are convex
//! pieces, found exactly ([`Shadow`]) for one viewpoint x of each cell; each is taken at its
//! centroid. A mesh is taken triangle by triangle, as far as these are not too many, and a sphere
//! for facets that touch it, which shrink with the parts. So is what a lit point sees of a flat
//! cell of the hidden surface. Other walls, cells and large meshes are asked ray by ray. How finely
//! footprints and spots are divided for this is up to [`super::divided`].

mod lit;
mod seen;

use rayon::prelude::*;

use super::beam::{Lit, reached};
use super::blocks::Blocks;
use super::kernel::Kernel;
use super::parts::Footprints;
use super::patch::{Patch, triangles};
use crate::geometry::{Blockers, DVec3, Opaque, Ray, ShapeId, area_and_middle};
use crate::scene::Scene;

/// Light with nothing in the way, and past what is.
pub(super) type Both = [f64; 2];

/// A scene ready to be asked.
pub(super) struct Obstructed<'a> {
    pub scene: &'a Scene,
    kernel: Kernel,
    pub opaque: Opaque,
    /// The parts of each pixel's footprint.
    pub pixels: Vec<Vec<Patch>>,
    pub blocks: Blocks,
    /// Points of the wall that are looked at, where no footprint is near for its size.
    pub walls: usize,
    /// Of each spot.
    pub lit: Vec<Vec<Lit>>,
}

impl<'a> Obstructed<'a> {
    /// Spots by `nodes` from their middle to their rim; each part of a footprint that is far for
    /// its size in `side` × `side` more.
    pub(super) fn new(
        scene: &'a Scene,
        kernel: Kernel,
        obstacles: &[ShapeId],
        (nodes, side): (usize, usize),
    ) -> Self {
        let lit = reached(scene, nodes);
        let opaque = Opaque::new(scene.bvh(), |id| obstacles.contains(&id));
        let hidden = opaque.from(scene.camera.position, None, scene.bvh());
        let footprints = Footprints::new(scene);
        let squares = |p| {
            let parts = footprints.parts(p).into_iter();
            let all = parts.flat_map(|part| {
                let size = part.side / side as f64;
                let at = move |k: usize, axis: usize| part.from[axis] + k as f64 * size;
                (0..side * side).map(move |k| ([at(k % side, 0), at(k / side, 1)], size))
            });
            all.collect()
        };
        let squares: Vec<Vec<_>> = (0..scene.camera.pixels()).map(squares).collect();
        let pixel = |(p, squares): (usize, &Vec<([f64; 2], f64)>)| {
            let patches = squares
                .iter()
                .flat_map(|s| Patch::all(&footprints, p, *s, &hidden));
            patches.collect()
        };
        let pixels: Vec<Vec<Patch>> = squares.par_iter().enumerate().map(pixel).collect();
        let more = pixels.iter().map(Vec::len).sum::<usize>()
            - squares.iter().map(Vec::len).sum::<usize>();
        Self {
            scene,
            kernel,
            opaque,
            blocks: Blocks::new(&pixels, scene.camera.columns),
            walls: pixels.len() * side * side + more + lit.iter().map(Vec::len).sum::<usize>(),
            pixels,
            lit,
        }
    }

    /// Number of spots.
    pub(super) fn spots(&self) -> usize {
        self.lit.len()
    }

    /// Number of pixels.
    pub(super) fn pixels(&self) -> usize {
        self.pixels.len()
    }

    /// Whether anything is asked ray by ray.
    pub(super) fn by_rays(&self) -> bool {
        let mut patches = self.pixels.iter().flatten();
        self.opaque.has_meshes() || patches.any(|p| p.corners.is_none() && p.whole.weight > 0.0)
    }

    /// Whether wall and obstacles are flat and no edge of the wall is in sight, so that shadows can
    /// be followed as they move.
    pub(super) fn is_flat(&self) -> bool {
        let mut patches = self.pixels.iter().flatten();
        let is_flat = |id: ShapeId| self.scene.surfaces[id as usize].shape.is_flat();
        let is_whole = |p: &Patch| p.corners.is_some() && !p.is_cut;
        let flat = |p: &Patch| is_whole(p) && p.whole.surface.is_some_and(is_flat);
        self.opaque.is_flat() && patches.all(flat)
    }

    /// What a pixel's light past everything may be off by because it is not known of all of its
    /// footprint what the camera sees there: half of that, of what lies on a wall.
    pub(super) fn undecided(&self, pixel: usize) -> f64 {
        let patches = &self.pixels[pixel];
        let undecided: f64 = patches.iter().map(|p| p.share * p.undecided).sum();
        let on_wall = patches.iter().filter(|p| p.whole.weight > 0.0);
        let all: f64 = on_wall.map(|p| p.share).sum();
        if undecided > 0.0 {
            (0.5 * undecided / all).min(1.0)
        } else {
            0.0
        }
    }

    /// What of the wall each pixel looks at and each spot lights: the wall and points around it.
    pub(super) fn places(&self) -> [Vec<(Option<ShapeId>, Vec<DVec3>)>; 2] {
        let seen = |patches: &Vec<Patch>| {
            let patches = patches.iter().filter(|p| p.whole.weight > 0.0);
            let around = |p: &Patch| match &p.corners {
                Some(corners) => corners.to_vec(),
                None => vec![p.whole.position],
            };
            let wall = patches.clone().find_map(|p| p.whole.surface);
            (wall, patches.flat_map(around).collect())
        };
        let lit = |lit: &Vec<Lit>| {
            let lit = lit.iter().map(|lit| &lit.left).filter(|w| w.weight > 0.0);
            let wall = lit.clone().find_map(|w| w.surface);
            (wall, lit.map(|w| w.position).collect())
        };
        [
            self.pixels.iter().map(seen).collect(),
            self.lit.iter().map(lit).collect(),
        ]
    }

    /// Pairs of a cell and a pixel, or a point of a spot, that are worth looking at.
    pub(super) fn most_pairs(&self) -> f64 {
        if self.by_rays() { 8e6 } else { 1e8 }
    }

    /// Whether nothing of `blockers` stands between a point of the first surface and the place on
    /// the other.
    fn is_free(
        &self,
        from: DVec3,
        to: (ShapeId, DVec3),
        wall: ShapeId,
        blockers: &Blockers,
    ) -> bool {
        blockers.none()
            || Ray::between(from, to.1).is_some_and(|ray| {
                let ends = [Some(wall), Some(to.0)];
                !self.scene.bvh().blocked_by(blockers, &ray, ends)
            })
    }
}

/// The share of a piece's light that is in free sight, by its triangles, where something has to be
/// asked ray by ray.
fn free_share(
    piece: &[DVec3],
    asked: &Blockers,
    light: impl Fn((f64, DVec3)) -> f64,
    free: impl Fn(DVec3) -> bool,
) -> f64 {
    if asked.none() {
        return 1.0;
    }
    let (mut all, mut left) = (0.0, 0.0);
    for part in triangles(piece) {
        let (area, middle) = area_and_middle(&part);
        let own = light((area, middle));
        all += own;
        if free(middle) {
            left += own;
        }
    }
    if all > 0.0 { left / all } else { 0.0 }
}
