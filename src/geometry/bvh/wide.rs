//! The tree for many primitives: obvhs' binary tree, opened to eight children a node.
//!
//! A node keeps the boxes of its children coordinate by coordinate, so that one pass of wide instructions tests all eight (Wald,
//! Benthin and Boulos, *Getting rid of packets*, 2008). Boxes and rays are in f32, in the padded space of [`Space`]: the tree culls, its
//! caller decides.

use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::builder::build_bvh2;

use super::collapse::{Collapse, WIDTH};
use super::{PADDING, Space};
use crate::geometry::{DVec3, Ray};

/// Marks a child that is a leaf.
const LEAF: u32 = 1 << 31;

/// Eight boxes and what is in them.
#[derive(Clone, Debug)]
#[repr(align(64))]
struct Node {
    /// Lower and upper x, y, z; of an absent child ∞ and −∞, which no ray meets.
    bounds: [[f32; WIDTH]; 6],
    /// Index of a node, or of a leaf with [`LEAF`].
    children: [u32; WIDTH],
}

/// A tree over boxes.
#[derive(Clone, Debug)]
pub(in crate::geometry) struct WideTree {
    nodes: Vec<Node>,
    space: Space,
}

impl WideTree {
    pub(in crate::geometry) fn len(&self) -> usize { self.nodes.len() }
    /// The tree over `boxes` (lower and upper corners, finite). `leaf` is told the boxes that share a leaf, at most `most` of them, and
    /// returns the number by which the leaf is later visited.
    pub(in crate::geometry) fn new(
        boxes: &[(DVec3, DVec3)],
        (group, most): (u32, u32),
        mut leaf: impl FnMut(&[u32]) -> u32,
    ) -> Self {
        let space = Space::around(boxes.iter().copied());
        let padded: Vec<Aabb> = boxes.iter().map(|b| space.padded(*b)).collect();
        let parameters = BvhBuildParams {
            max_prims_per_leaf: 1,
            ..BvhBuildParams::medium_build()
        };
        let mut time = std::time::Duration::ZERO;
        let binary = build_bvh2(&padded, parameters, &mut time);
        let collapse = Collapse::new(&binary, group, most);
        let mut nodes = Vec::new();
        // Nodes of the binary tree whose children are still to be gathered, by the place of their own node.
        let mut open = vec![(0_u32, 0_usize)];
        nodes.push(Node::empty());
        while let Some((root, place)) = open.pop() {
            let members = collapse.children(root);
            let mut node = Node::empty();
            for (k, &index) in members.iter().enumerate() {
                let child = &binary.nodes[index as usize];
                node.set_bounds(k, child.aabb());
                node.children[k] = if collapse.is_leaf(index) {
                    LEAF | leaf(&collapse.primitives(index))
                } else {
                    nodes.push(Node::empty());
                    open.push((index, nodes.len() - 1));
                    (nodes.len() - 1) as u32
                };
            }
            nodes[place] = node;
        }
        Self { nodes, space }
    }

    /// Visits for each ray the leaves whose boxes it meets before a distance that starts as `ray.length`; `visit` is told the number of
    /// the ray and of the leaf and returns the new distance, a negative one to end the search.
    ///
    /// Several rays are under way at once: while one waits for memory, the others go on.
    #[inline(always)]
    pub(in crate::geometry) fn traverse(&self, rays: &[Ray], mut visit: impl FnMut(usize, u32) -> f64) {
        let mut waiting = 0..rays.len();
        let mut walks: [Walk; UNDER_WAY] = std::array::from_fn(|_| Walk::idle());
        let mut busy = 0;
        for walk in &mut walks {
            if let Some(i) = waiting.next() {
                walk.start(&self.space, i, &rays[i]);
                busy += 1;
            }
        }
        while busy > 0 {
            for walk in &mut walks {
                if walk.ray == usize::MAX {
                    continue;
                }
                if !walk.step(self, &mut visit) {
                    match waiting.next() {
                        Some(i) => walk.start(&self.space, i, &rays[i]),
                        None => {
                            walk.ray = usize::MAX;
                            busy -= 1;
                        }
                    }
                }
            }
        }
    }
}

/// Rays that are under way at once.
const UNDER_WAY: usize = 8;

/// A ray on its way through the tree.
struct Walk {
    ray: usize,
    origin: [f32; 3],
    inverse: [f32; 3],
    near: [usize; 3],
    /// Scale and offset from distances along the ray to those in the tree.
    scale: f64,
    advance: f64,
    end: f32,
    current: u32,
    stack: Vec<(f32, u32)>,
}

impl Walk {
    fn idle() -> Self {
        Self {
            ray: usize::MAX,
            origin: [0.0; 3],
            inverse: [0.0; 3],
            near: [0; 3],
            scale: 1.0,
            advance: 0.0,
            end: 0.0,
            current: 0,
            stack: Vec::with_capacity(128),
        }
    }

    #[inline(always)]
    fn start(&mut self, space: &Space, number: usize, ray: &Ray) {
        let (origin, advance) = space.start(ray);
        let direction = ray.direction.as_vec3a();
        // A component too small to be told from 0 keeps its sign and stays finite.
        let inverse = |d: f32| 1.0 / if d.abs() > 1e-20 { d } else { 1e-20_f32.copysign(d) };
        self.inverse = [inverse(direction.x), inverse(direction.y), inverse(direction.z)];
        for axis in 0..3 {
            self.near[axis] = 2 * axis + usize::from(self.inverse[axis] < 0.0);
        }
        self.ray = number;
        self.origin = origin.to_array();
        self.scale = space.scale;
        self.advance = advance;
        self.limit(ray.length);
        self.current = 0;
        self.stack.clear();
    }

    #[inline(always)]
    fn limit(&mut self, t: f64) {
        self.end = ((t * self.scale - self.advance).min(1e30) as f32) + 4.0 * PADDING;
    }

    /// One node or leaf further; whether there is more.
    #[inline(always)]
    fn step(&mut self, tree: &WideTree, visit: &mut impl FnMut(usize, u32) -> f64) -> bool {
        if self.current & LEAF == 0 {
            let node = &tree.nodes[self.current as usize];
            let (enter, mut hits) = node.meet(self.origin, self.inverse, self.near, self.end);
            let base = self.stack.len();
            while hits != 0 {
                let k = hits.trailing_zeros() as usize & (WIDTH - 1);
                hits &= hits - 1;
                let child = (enter[k], node.children[k]);
                self.stack.push(child);
                let mut at = self.stack.len() - 1;
                while at > base && self.stack[at - 1].0 < child.0 {
                    self.stack[at] = self.stack[at - 1];
                    at -= 1;
                }
                self.stack[at] = child;
            }
        } else {
            let t = visit(self.ray, self.current & !LEAF);
            if t < 0.0 {
                return false;
            }
            self.limit(t);
        }
        while let Some((enter, child)) = self.stack.pop() {
            if enter <= self.end {
                self.current = child;
                if child & LEAF == 0 {
                    let node = &tree.nodes[child as usize];
                    std::hint::black_box((node.bounds[0][0], node.bounds[4][0]));
                }
                return true;
            }
        }
        false
    }
}

impl Node {
    fn empty() -> Self {
        let (low, high) = ([f32::INFINITY; WIDTH], [f32::NEG_INFINITY; WIDTH]);
        Self {
            bounds: [low, high, low, high, low, high],
            children: [0; WIDTH],
        }
    }

    fn set_bounds(&mut self, k: usize, bounds: &Aabb) {
        for axis in 0..3 {
            self.bounds[2 * axis][k] = bounds.min[axis];
            self.bounds[2 * axis + 1][k] = bounds.max[axis];
        }
    }

    /// Where the ray enters each box, and a bit for each box that it meets before `end`.
    #[inline(always)]
    fn meet(
        &self,
        origin: [f32; 3],
        inverse: [f32; 3],
        near: [usize; 3],
        end: f32,
    ) -> ([f32; WIDTH], u32) {
        let larger = |a: f32, b: f32| if a > b { a } else { b };
        let smaller = |a: f32, b: f32| if a < b { a } else { b };
        let mut enter = [0.0; WIDTH];
        let mut leave = [end; WIDTH];
        for axis in 0..3 {
            let (first, last) = (&self.bounds[near[axis]], &self.bounds[near[axis] ^ 1]);
            for k in 0..WIDTH {
                enter[k] = larger((first[k] - origin[axis]) * inverse[axis], enter[k]);
                leave[k] = smaller((last[k] - origin[axis]) * inverse[axis], leave[k]);
            }
        }
        let mut bits = [0_u32; WIDTH];
        for k in 0..WIDTH {
            bits[k] = if enter[k] <= leave[k] { 1 << k } else { 0 };
        }
        (enter, bits.iter().fold(0, |a, b| a | b))
    }
}
