//! Which nodes of a binary tree become the nodes of a wide one?
//!
//! The choice with the least expected cost of a ray, found from the leaves upwards (Ylitie, Karras
//! and Laine, *Efficient incoherent ray traversal on GPUs through compressed wide BVHs*, 2017,
//! section 3): of a subtree n with surface A and P primitives,
//!
//! - C(n, 1) = A as a leaf where P is at most a group, A + D(n, 8) as a node otherwise,
//! - C(n, i) = min(C(n, i − 1), D(n, i)) as up to i children of one node,
//! - D(n, i) = min over k of C(left, k) + C(right, i − k).

use obvhs::bvh2::Bvh2;

/// Children of a wide node.
pub(super) const WIDTH: usize = 8;

/// What to make of each node of the binary tree.
pub(super) struct Collapse<'a> {
    tree: &'a Bvh2,
    /// Number of primitives below.
    count: Vec<u32>,
    /// Of the i + 1 children that a subtree may become, how many are from its left; 0: as with one
    /// fewer.
    left: Vec<[u8; WIDTH]>,
    leaf: Vec<bool>,
}

impl<'a> Collapse<'a> {
    /// For leaves of at most `group` primitives.
    pub(super) fn new(tree: &'a Bvh2, group: u32) -> Self {
        let nodes = &tree.nodes;
        let mut order = vec![0_u32];
        let mut next = 0;
        while next < order.len() {
            let node = &nodes[order[next] as usize];
            if !node.is_leaf() {
                order.extend([node.first_index, node.first_index + 1]);
            }
            next += 1;
        }
        let mut cost = vec![[0.0_f32; WIDTH]; nodes.len()];
        let mut all = Self {
            tree,
            count: vec![0; nodes.len()],
            left: vec![[0; WIDTH]; nodes.len()],
            leaf: vec![false; nodes.len()],
        };
        for n in order.into_iter().rev().map(|n| n as usize) {
            let node = &nodes[n];
            let area = node.aabb().half_area();
            if node.is_leaf() {
                all.count[n] = node.prim_count;
                all.leaf[n] = true;
                cost[n] = [area; WIDTH];
                continue;
            }
            let (l, r) = (node.first_index as usize, node.first_index as usize + 1);
            all.count[n] = all.count[l] + all.count[r];
            let mut best = [f32::INFINITY; WIDTH];
            for i in 1..WIDTH {
                for k in 0..i {
                    let both = cost[l][k] + cost[r][i - 1 - k];
                    if both < best[i] {
                        best[i] = both;
                        all.left[n][i] = k as u8 + 1;
                    }
                }
            }
            best[0] = area + best[WIDTH - 1];
            if all.count[n] <= group {
                best[0] = area;
                all.leaf[n] = true;
            }
            for i in 1..WIDTH - 1 {
                if best[i] >= best[i - 1] {
                    best[i] = best[i - 1];
                    all.left[n][i] = 0;
                }
            }
            cost[n] = best;
        }
        all
    }

    /// Whether a subtree becomes a leaf.
    pub(super) fn is_leaf(&self, n: u32) -> bool {
        self.leaf[n as usize]
    }

    /// The children of the wide node that subtree `n` becomes.
    pub(super) fn children(&self, n: u32) -> Vec<u32> {
        let mut found = Vec::with_capacity(WIDTH);
        if self.is_leaf(n) {
            found.push(n);
        } else {
            self.split(n, WIDTH - 1, &mut found);
        }
        found
    }

    fn split(&self, n: u32, i: usize, found: &mut Vec<u32>) {
        let k = self.left[n as usize][i] as usize;
        let l = self.tree.nodes[n as usize].first_index;
        self.gather(l, k - 1, found);
        self.gather(l + 1, i - k, found);
    }

    fn gather(&self, n: u32, mut i: usize, found: &mut Vec<u32>) {
        while i > 0 && self.left[n as usize][i] == 0 {
            i -= 1;
        }
        if i == 0 {
            found.push(n);
        } else {
            self.split(n, i, found);
        }
    }

    /// The primitives of subtree `n`.
    pub(super) fn primitives(&self, n: u32) -> Vec<u32> {
        let mut open = vec![n];
        let mut found = Vec::with_capacity(self.count[n as usize] as usize);
        while let Some(n) = open.pop() {
            let node = &self.tree.nodes[n as usize];
            if node.is_leaf() {
                let first = node.first_index as usize;
                let range = first..first + node.prim_count as usize;
                found.extend(&self.tree.primitive_indices[range]);
            } else {
                open.extend([node.first_index + 1, node.first_index]);
            }
        }
        found
    }
}
