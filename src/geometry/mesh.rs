//! Triangle meshes.

mod group;

use super::bvh::WideTree;
use super::{DVec3, Ray};
use group::{GROUP, Group, Sheared};
use crate::num::lanes::widest;

/// Largest number of triangles in a leaf of the tree.
const LEAF: u32 = 4;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshHit {
    pub triangle: u32,
    pub t: f64,
}

/// A surface of triangles.
#[derive(Clone)]
pub struct Mesh {
    positions: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    tree: WideTree,
    groups: Vec<Group>,
}

impl Mesh {
    pub fn stats(&self) -> String { format!("{} groups {} nodes", self.groups.len(), self.tree.len()) }
    pub fn new(positions: Vec<DVec3>, triangles: Vec<[u32; 3]>) -> Self {
        let corners = |i: u32| triangles[i as usize].map(|c| positions[c as usize]);
        let boxes: Vec<(DVec3, DVec3)> = (0..triangles.len() as u32)
            .map(|i| {
                let [a, b, c] = corners(i);
                (a.min(b).min(c), a.max(b).max(c))
            })
            .collect();
        let mut groups = Vec::new();
        let tree = WideTree::new(&boxes, (GROUP as u32, LEAF), |members| {
            let first = groups.len() as u32;
            for chunk in members.chunks(GROUP) {
                let t: Vec<_> = chunk.iter().map(|i| (*i, corners(*i))).collect();
                groups.push(Group::new(&t, false));
            }
            if let Some(g) = groups.last_mut() {
                g.last = true;
            }
            first
        });
        Self { positions, triangles, tree, groups }
    }

    pub fn closest_many(&self, rays: &[Ray]) -> Vec<Option<MeshHit>> {
        let sheared: Vec<Sheared> = rays.iter().map(Sheared::new).collect();
        let mut best: Vec<MeshHit> = rays.iter().map(|r| MeshHit { triangle: u32::MAX, t: r.length }).collect();
        widest(#[inline(always)] || {
            self.tree.traverse(rays, #[inline(always)] |i, leaf| {
                let best = &mut best[i];
                let mut at = leaf as usize;
                loop {
                    let group = &self.groups[at];
                    let (t, mut hits) = group.meet(&sheared[i], best.t);
                    while hits != 0 {
                        let k = hits.trailing_zeros() as usize & (GROUP - 1);
                        hits &= hits - 1;
                        if t[k] < best.t && off_plane(group.corners(k), rays[i].origin) {
                            *best = MeshHit { triangle: group.triangles[k], t: t[k] };
                        }
                    }
                    if group.last {
                        return best.t;
                    }
                    at += 1;
                }
            });
        });
        best.into_iter().map(|b| (b.triangle != u32::MAX).then_some(b)).collect()
    }

    pub fn blocked_many(&self, rays: &[Ray]) -> Vec<bool> {
        let sheared: Vec<Sheared> = rays.iter().map(Sheared::new).collect();
        let mut blocked = vec![false; rays.len()];
        widest(#[inline(always)] || {
            self.tree.traverse(rays, #[inline(always)] |i, leaf| {
                let ray = &rays[i];
                let mut at = leaf as usize;
                loop {
                    let group = &self.groups[at];
                    let (_, mut hits) = group.meet(&sheared[i], ray.length);
                    while hits != 0 {
                        let k = hits.trailing_zeros() as usize & (GROUP - 1);
                        hits &= hits - 1;
                        let corners = group.corners(k);
                        if off_plane(corners, ray.origin) && off_plane(corners, ray.origin + ray.direction * ray.length) {
                            blocked[i] = true;
                            return -1.0;
                        }
                    }
                    if group.last {
                        return ray.length;
                    }
                    at += 1;
                }
            });
        });
        blocked
    }
}

#[inline(always)]
fn off_plane([a, b, c]: [DVec3; 3], p: DVec3) -> bool {
    const ROUNDING: f64 = 1e-12;
    let normal = (b - a).cross(c - a);
    if !p.is_finite() { return true; }
    let reach = p.abs().max_element() + a.abs().max_element();
    let height = normal.dot(p - a).abs();
    !(height <= ROUNDING * reach * normal.length())
}
