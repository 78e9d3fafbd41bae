//! Many rays against few flat shapes: eight rays at a time against each shape.
//!
//! The arithmetic is that of one ray, operation by operation, so the answers are the same bit for
//! bit.

use super::bvh::TIE;
use super::{Blockers, Bvh, DVec3, Hit, Instance, Parallelogram, Ray, Shape, ShapeId};
use crate::num::lanes::widest;

/// Rays tested at a time: a register of AVX-512.
const EIGHT: usize = 8;
/// Up to so many shapes are tested one by one for a batch of rays; with more the tree is faster
/// (`benches/rays.rs`).
const FLAT: usize = 32;
/// No shape.
const NONE: u64 = u64::MAX;
/// Batches of fewer rays go one by one.
const WORTHWHILE: usize = 3;

/// Eight rays, coordinate by coordinate.
struct Eight {
    origin: [[f64; EIGHT]; 3],
    direction: [[f64; EIGHT]; 3],
    length: [f64; EIGHT],
}

impl Eight {
    /// What is missing to eight is met nowhere.
    #[inline(always)]
    fn new(rays: &[Ray]) -> Self {
        let mut eight = Self {
            origin: [[0.0; EIGHT]; 3],
            direction: [[0.0; EIGHT]; 3],
            length: [0.0; EIGHT],
        };
        for (k, ray) in rays.iter().enumerate().take(EIGHT) {
            for axis in 0..3 {
                eight.origin[axis][k] = ray.origin[axis];
                eight.direction[axis][k] = ray.direction[axis];
            }
            eight.length[k] = ray.length;
        }
        eight
    }

    #[inline(always)]
    fn ray(&self, k: usize) -> Ray {
        let at = |a: &[[f64; EIGHT]; 3]| DVec3::new(a[0][k], a[1][k], a[2][k]);
        Ray {
            origin: at(&self.origin),
            direction: at(&self.direction),
            length: self.length[k],
        }
    }
}

#[inline(always)]
fn number(shape: Option<ShapeId>) -> u64 {
    shape.map_or(NONE, u64::from)
}

impl Bvh {
    /// [`Bvh::closest`] for many rays, each with the shape that it starts on.
    ///
    /// # Panics
    /// If there are not as many starts as rays.
    pub fn closest_many(&self, rays: &[Ray], from: &[Option<ShapeId>]) -> Vec<Option<Hit>> {
        assert_eq!(rays.len(), from.len());
        let flat = |shape: &Shape| match shape {
            Shape::Parallelogram(patch) => Some(*patch),
            Shape::Sphere(_) | Shape::Disc(_) | Shape::Instance(_) => None,
        };
        let few = self.shapes().len() <= FLAT && rays.len() >= WORTHWHILE;
        let patches: Option<Vec<_>> = few
            .then(|| self.shapes().iter().map(flat).collect())
            .flatten();
        let Some(patches) = patches else {
            let each = rays.iter().zip(from);
            return each.map(|(ray, from)| self.closest(ray, *from)).collect();
        };
        let mut hits = vec![None; rays.len()];
        widest(
            #[inline(always)]
            || {
                let chunks = rays.chunks(EIGHT).zip(from.chunks(EIGHT));
                for ((rays, from), hits) in chunks.zip(hits.chunks_mut(EIGHT)) {
                    closest(&patches, rays, from, hits);
                }
            },
        );
        hits
    }

    /// [`Bvh::blocked_by`] for many segments, each with the shapes at its ends.
    ///
    /// # Panics
    /// If there are not as many pairs of ends as segments.
    pub fn blocked_many(
        &self,
        blockers: &Blockers,
        segments: &[Ray],
        ends: &[[Option<ShapeId>; 2]],
    ) -> Vec<bool> {
        assert_eq!(segments.len(), ends.len());
        let count = match blockers {
            Blockers::Among(ids) => ids.len(),
            Blockers::Any => self.shapes().len(),
        };
        if count > FLAT || segments.len() < WORTHWHILE {
            let each = segments.iter().zip(ends);
            return each
                .map(|(ray, ends)| self.blocked_by(blockers, ray, *ends))
                .collect();
        }
        let all: Vec<ShapeId>;
        let ids = match blockers {
            Blockers::Among(ids) => ids,
            Blockers::Any => {
                all = (0..count as ShapeId).collect();
                &all
            }
        };
        let mut blocked = vec![false; segments.len()];
        widest(
            #[inline(always)]
            || {
                let chunks = segments.chunks(EIGHT).zip(ends.chunks(EIGHT));
                for ((segments, ends), blocked) in chunks.zip(blocked.chunks_mut(EIGHT)) {
                    self.block(ids, segments, ends, blocked);
                }
            },
        );
        for &id in ids {
            if let Shape::Instance(body) = &self.shapes()[id as usize] {
                block_by_body(body, segments, &mut blocked);
            }
        }
        blocked
    }

    /// At most eight segments, and all shapes but meshes.
    #[inline(always)]
    fn block(
        &self,
        ids: &[ShapeId],
        segments: &[Ray],
        ends: &[[Option<ShapeId>; 2]],
        blocked: &mut [bool],
    ) {
        let eight = Eight::new(segments);
        let mut from = [NONE; EIGHT];
        let mut to = [NONE; EIGHT];
        for (k, ends) in ends.iter().enumerate().take(EIGHT) {
            (from[k], to[k]) = (number(ends[0]), number(ends[1]));
        }
        let mut free = [true; EIGHT];
        for &id in ids {
            let own = u64::from(id);
            match &self.shapes()[id as usize] {
                Shape::Parallelogram(patch) => {
                    for k in 0..EIGHT {
                        let stands = patch.blocks(&eight.ray(k));
                        free[k] &= !(stands & (from[k] != own) & (to[k] != own));
                    }
                }
                Shape::Instance(_) => {}
                shape => {
                    for (k, ray) in segments.iter().enumerate().take(EIGHT) {
                        free[k] = free[k] && !shape.blocks(ray, from[k] == own, to[k] == own);
                    }
                }
            }
        }
        blocked.iter_mut().zip(free).for_each(|(b, f)| *b = !f);
    }
}

/// Meshes are asked last, for what is still free, many segments at once.
fn block_by_body(body: &Instance, segments: &[Ray], blocked: &mut [bool]) {
    let free: Vec<usize> = (0..segments.len()).filter(|i| !blocked[*i]).collect();
    let asked: Vec<Ray> = free.iter().map(|i| segments[*i]).collect();
    for (i, stands) in free.iter().zip(body.blocks_many(&asked)) {
        blocked[*i] = stands;
    }
}

/// The first hits of at most eight rays: the search of [`Bvh::closest`] for all of them at once.
#[inline(always)]
fn closest(
    patches: &[Parallelogram],
    rays: &[Ray],
    from: &[Option<ShapeId>],
    hits: &mut [Option<Hit>],
) {
    let eight = Eight::new(rays);
    let mut start = [NONE; EIGHT];
    for (k, from) in from.iter().enumerate().take(EIGHT) {
        start[k] = number(*from);
    }
    let mut best = [NONE; EIGHT];
    let mut at = eight.length;
    let mut fronts = [false; EIGHT];
    for (id, patch) in patches.iter().enumerate() {
        let id = id as u64;
        for k in 0..EIGHT {
            let mut ray = eight.ray(k);
            let size = ray.origin.abs().max_element();
            let none = best[k] == NONE;
            let limit = (at[k] + TIE * (at[k] + size)).min(ray.length);
            ray.length = if none { ray.length } else { limit };
            let (t, met) = patch.crossing(&ray);
            let front = patch.normal().dot(ray.direction) < 0.0;
            let apart = (t - at[k]).abs() > TIE * (t + size);
            let before = (apart & (t < at[k])) | (!apart & front & !fronts[k]);
            let first = met & (start[k] != id) & (none | before);
            best[k] = if first { id } else { best[k] };
            at[k] = if first { t } else { at[k] };
            fronts[k] = if first { front } else { fronts[k] };
        }
    }
    for (k, hit) in hits.iter_mut().enumerate().take(EIGHT) {
        let shape = best[k] as ShapeId;
        *hit = (best[k] != NONE).then_some(Hit {
            shape,
            t: at[k],
            triangle: 0,
        });
    }
}

#[cfg(test)]
mod tests;
