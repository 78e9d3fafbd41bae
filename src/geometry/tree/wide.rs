//! The tree for many primitives: obvhs' binary tree, opened to eight children a node.
//!
//! A node keeps the boxes of its children coordinate by coordinate, so that one pass of wide
//! instructions tests all eight (Wald, Benthin and Boulos, *Getting rid of packets*, 2008). A large
//! tree waits for memory most of the time; so several rays are under way at once, and what each
//! needs next is asked for before any of them goes on. Boxes and rays are in f32, in the padded
//! space of [`Space`]: the tree culls, its caller decides.

use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::builder::build_bvh2;

use super::collapse::{Collapse, WIDTH};
use super::space::Space;
use crate::geometry::{DVec3, Ray};

/// Marks a child that is a leaf.
const LEAF: u32 = 1 << 31;
/// Rays under way at once: enough to keep the memory busy, few enough for the first cache.
const UNDER_WAY: usize = 12;

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

/// What is asked at the leaves.
pub(in crate::geometry) trait Query {
    /// What is kept of a ray on its way.
    type State;
    /// Before the first node.
    fn begin(&self, ray: &Ray) -> Self::State;
    /// A number that depends on the memory of a leaf.
    fn touch(&self, leaf: u32) -> u32;
    /// Looks into a leaf; returns the distance beyond which nothing matters any more, a negative
    /// one to end the search.
    fn visit(&self, ray: &Ray, state: &mut Self::State, leaf: u32) -> f64;
}

impl WideTree {
    /// The tree over `boxes` (lower and upper corners, finite). `leaf` is told the boxes that share
    /// a leaf and returns the number, below 2³¹, by which the leaf is later visited. What is looked
    /// at in a leaf at once is a `group`.
    pub(in crate::geometry) fn new(
        boxes: &[(DVec3, DVec3)],
        group: u32,
        mut leaf: impl FnMut(&[u32]) -> u32,
    ) -> Self {
        let space = Space::around(boxes.iter().copied());
        let (distinct, members) = distinct(boxes.iter().map(|b| space.padded(*b)));
        let parameters = BvhBuildParams {
            max_prims_per_leaf: 1,
            ..BvhBuildParams::medium_build()
        };
        let mut time = std::time::Duration::ZERO;
        let binary = build_bvh2(&distinct, parameters, &mut time);
        let collapse = Collapse::new(&binary, group);
        let mut nodes = vec![Node::empty()];
        // Nodes of the binary tree that become wide ones, and where those stand.
        let mut open = vec![(0_u32, 0_usize)];
        while let Some((root, place)) = open.pop() {
            let mut node = Node::empty();
            for (k, index) in collapse.children(root).into_iter().enumerate() {
                node.set_bounds(k, binary.nodes[index as usize].aabb());
                node.children[k] = if collapse.is_leaf(index) {
                    let primitives = collapse.primitives(index);
                    let inside = primitives.iter().flat_map(|p| &members[*p as usize]);
                    LEAF | leaf(&inside.copied().collect::<Vec<u32>>())
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

    /// Takes each ray through the leaves whose boxes it meets before a distance that starts as its
    /// length; `done` receives the number of the ray and what has become of its state.
    #[inline(always)]
    pub(in crate::geometry) fn traverse<Q: Query>(
        &self,
        rays: &[Ray],
        query: &Q,
        mut done: impl FnMut(usize, Q::State),
    ) {
        let mut waiting = rays.iter().enumerate();
        let mut walks: Vec<Walk<Q::State>> = Vec::with_capacity(UNDER_WAY.min(rays.len()));
        walks.extend(waiting.by_ref().take(UNDER_WAY).map(|(i, ray)| {
            let stack = Vec::with_capacity(64);
            Walk::new(&self.space, (i, ray), query.begin(ray), stack)
        }));
        while !walks.is_empty() {
            let mut asked = 0;
            for walk in &walks {
                asked ^= match walk.current & LEAF {
                    0 => self.nodes[walk.current as usize].touch(),
                    _ => query.touch(walk.current & !LEAF),
                };
            }
            std::hint::black_box(asked);
            let mut at = 0;
            while at < walks.len() {
                let walk = &mut walks[at];
                if walk.step(self, rays, query) {
                    at += 1;
                    continue;
                }
                let finished = match waiting.next() {
                    Some((i, ray)) => {
                        let stack = std::mem::take(&mut walk.stack);
                        let next = Walk::new(&self.space, (i, ray), query.begin(ray), stack);
                        std::mem::replace(walk, next)
                    }
                    None => walks.swap_remove(at),
                };
                done(finished.ray, finished.state);
            }
        }
    }

    /// Visits leaves, near ones first, as long as their boxes are nearer to `p` than what `visit`
    /// last returned.
    pub(in crate::geometry) fn around(&self, p: DVec3, mut visit: impl FnMut(u32) -> f64) {
        let p = self.space.local(p).as_vec3a().to_array();
        let mut reach = f32::INFINITY;
        let mut stack = vec![(0.0, 0_u32)];
        while let Some((distance, current)) = stack.pop() {
            if distance > reach {
                continue;
            }
            if current & LEAF != 0 {
                reach = self.space.beyond(visit(current & !LEAF));
                continue;
            }
            let node = &self.nodes[current as usize];
            let base = stack.len();
            stack.extend((0..WIDTH).map(|k| (node.distance(k, p), node.children[k])));
            stack[base..].sort_by(|a, b| b.0.total_cmp(&a.0));
        }
    }
}

/// The distinct boxes, and which of the given ones each stands for: thousands of equal boxes would
/// make a tree as deep as their number.
fn distinct(boxes: impl Iterator<Item = Aabb>) -> (Vec<Aabb>, Vec<Vec<u32>>) {
    let key = |b: &Aabb| [b.min, b.max].map(|v| v.to_array().map(f32::to_bits));
    let mut keyed: Vec<_> = boxes.zip(0_u32..).map(|(b, i)| (key(&b), i, b)).collect();
    keyed.sort_unstable_by_key(|(key, i, _)| (*key, *i));
    let equal = || keyed.chunk_by(|a, b| a.0 == b.0);
    let members = equal().map(|same| same.iter().map(|(_, i, _)| *i).collect());
    (equal().map(|same| same[0].2).collect(), members.collect())
}

/// A ray on its way through the tree.
struct Walk<S> {
    ray: usize,
    state: S,
    origin: [f32; 3],
    inverse: [f32; 3],
    /// By axis, which of the node's bounds is met first.
    near: [usize; 3],
    /// How far the start was moved in the tree's space.
    advance: f64,
    /// Nothing beyond this matters.
    end: f32,
    /// Node or leaf to be visited next.
    current: u32,
    /// What is to be visited later, and where its box is entered.
    stack: Vec<(f32, u32)>,
}

impl<S> Walk<S> {
    #[inline(always)]
    fn new(
        space: &Space,
        (number, ray): (usize, &Ray),
        state: S,
        mut stack: Vec<(f32, u32)>,
    ) -> Self {
        let (origin, advance) = space.start(ray);
        // A component too small to be told from 0 keeps its sign and stays finite.
        let inverse = |d: f32| {
            1.0 / if d.abs() > 1e-20 {
                d
            } else {
                1e-20_f32.copysign(d)
            }
        };
        let [x, y, z] = ray.direction.as_vec3a().to_array();
        let inverse = [inverse(x), inverse(y), inverse(z)];
        let near = |axis: usize| 2 * axis + usize::from(inverse[axis] < 0.0);
        stack.clear();
        Self {
            ray: number,
            state,
            origin: origin.to_array(),
            inverse,
            near: [near(0), near(1), near(2)],
            advance,
            end: space.limit(ray.length, advance),
            current: 0,
            stack,
        }
    }

    /// One node or leaf further; whether there is more.
    #[inline(always)]
    fn step<Q: Query<State = S>>(&mut self, tree: &WideTree, rays: &[Ray], query: &Q) -> bool {
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
            let t = query.visit(&rays[self.ray], &mut self.state, self.current & !LEAF);
            if t < 0.0 {
                return false;
            }
            self.end = tree.space.limit(t, self.advance);
        }
        while let Some((enter, child)) = self.stack.pop() {
            if enter <= self.end {
                self.current = child;
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
            children: [LEAF; WIDTH],
        }
    }

    fn set_bounds(&mut self, k: usize, bounds: &Aabb) {
        for axis in 0..3 {
            self.bounds[2 * axis][k] = bounds.min[axis];
            self.bounds[2 * axis + 1][k] = bounds.max[axis];
        }
    }

    /// A number that depends on each of the node's four cache lines.
    #[inline(always)]
    fn touch(&self) -> u32 {
        let lines = [0, 2, 4].map(|i: usize| self.bounds[i][0].to_bits());
        lines[0] ^ lines[1] ^ lines[2] ^ self.children[0]
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
        // In halves, as wide instructions fold a register.
        let [a, b, c, d, e, f, g, h] = bits;
        (enter, ((a | e) | (c | g)) | ((b | f) | (d | h)))
    }

    /// Distance of a point from box `k`.
    fn distance(&self, k: usize, p: [f32; 3]) -> f32 {
        let outside = |axis: usize| {
            let (low, high) = (self.bounds[2 * axis][k], self.bounds[2 * axis + 1][k]);
            (low - p[axis]).max(p[axis] - high).max(0.0)
        };
        let [x, y, z] = [outside(0), outside(1), outside(2)];
        (x * x + y * y + z * z).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_boxes_are_one() {
        let at = |x: f32| Aabb::new([x; 3].into(), [x + 1.0; 3].into());
        let (boxes, members) = distinct([2.0, 1.0, 2.0, 3.0, 1.0, 2.0].map(at).into_iter());
        let starts: Vec<f32> = boxes.iter().map(|b| b.min.x).collect();
        assert_eq!(starts, [1.0, 2.0, 3.0]);
        assert_eq!(members, [vec![1, 4], vec![0, 2, 5], vec![3]]);
    }
}
