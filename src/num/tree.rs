//! The fixed binary tree over the positions 0 … n − 1, in parts.

use std::ops::Range;

/// What neighbouring positions add up to, along the fixed binary tree of
/// [`tree_sum`](super::summation::tree_sum): node i of level k stands for the positions i·2ᵏ …
/// min((i + 1)·2ᵏ, n) − 1.
///
/// Held are the largest nodes that lie in the range pushed so far; which these are depends on the
/// range alone. So the value of a node is put together from the same two halves by the same
/// operation wherever and in whatever pieces it is computed, and comes out with the same bits.
#[derive(Clone, Debug, PartialEq)]
pub struct Tree<T> {
    total: u32,
    start: u32,
    nodes: Vec<(Range<u32>, T)>,
}

impl<T> Tree<T> {
    /// Nothing yet, of `total` positions, beginning at `start`.
    pub fn new(total: u32, start: u32) -> Self {
        Self {
            total,
            start,
            nodes: Vec::new(),
        }
    }

    /// The positions that are there.
    pub fn range(&self) -> Range<u32> {
        self.start..self.nodes.last().map_or(self.start, |(range, _)| range.end)
    }

    /// The largest nodes, in order.
    pub fn nodes(&self) -> &[(Range<u32>, T)] {
        &self.nodes
    }

    /// The node of all positions, once they are all there.
    pub fn root(&self) -> Option<&T> {
        match &self.nodes[..] {
            [(range, value)] if *range == (0..self.total) => Some(value),
            _ => None,
        }
    }

    /// Whether `range` is a node of the tree over `total` positions.
    pub fn is_node(total: u32, range: &Range<u32>) -> bool {
        if range.start >= range.end || range.end > total {
            return false;
        }
        let width = (range.end - range.start).next_power_of_two();
        let whole = range.end - range.start == width;
        range.start.is_multiple_of(width) && (whole || range.end == total)
    }

    /// Adds the node that follows; `join` makes a parent's value of those of its halves.
    ///
    /// # Errors
    /// The node, if it is none of the tree's, or not the next.
    pub fn push(
        &mut self,
        range: Range<u32>,
        value: T,
        mut join: impl FnMut((Range<u32>, T), (Range<u32>, T)) -> T,
    ) -> Result<(), Range<u32>> {
        if !Self::is_node(self.total, &range) || range.start != self.range().end {
            return Err(range);
        }
        self.nodes.push((range, value));
        while let [.., (left, _), (right, _)] = &self.nodes[..]
            && self.are_halves(left, right)
        {
            let (Some(right), Some(left)) = (self.nodes.pop(), self.nodes.pop()) else {
                unreachable!("two nodes were there");
            };
            let parent = left.0.start..right.0.end;
            self.nodes.push((parent, join(left, right)));
        }
        Ok(())
    }

    /// Whether two neighbours are the halves of one node.
    fn are_halves(&self, left: &Range<u32>, right: &Range<u32>) -> bool {
        let half = left.end - left.start;
        let Some(width) = half.checked_mul(2) else {
            return false;
        };
        let end = left.start.saturating_add(width).min(self.total);
        half.is_power_of_two() && left.start.is_multiple_of(width) && right.end == end
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::num::summation::tree_sum;
    use proptest::prelude::*;

    fn sum(terms: &[f64], range: Range<u32>) -> Tree<f64> {
        let mut tree = Tree::new(terms.len() as u32, range.start);
        for i in range {
            tree.push(i..i + 1, terms[i as usize], |a, b| a.1 + b.1)
                .unwrap();
        }
        tree
    }

    proptest! {
        /// Against the sum level by level, which knows nothing of parts: any cutting, and parts of
        /// parts, give its bits; the number of nodes held stays below twice the height.
        #[test]
        fn any_cutting_gives_the_same_bits(n in 1u32..200, cuts in proptest::collection::vec(0u32..200, 0..8)) {
            let terms: Vec<f64> = (0..n).map(|i| libm::sin(f64::from(i) * 7.3) * 1e3 + 1e-9).collect();
            let mut cuts: Vec<u32> = cuts.into_iter().map(|c| c % n).chain([0, n]).collect();
            cuts.sort_unstable();
            let mut whole = Tree::new(n, 0);
            for pair in cuts.windows(2) {
                let part = sum(&terms, pair[0]..pair[1]);
                prop_assert_eq!(part.range(), pair[0]..pair[1]);
                prop_assert!(part.nodes().len() <= 2 * 8);
                for (range, value) in part.nodes() {
                    prop_assert!(Tree::<f64>::is_node(n, range));
                    whole.push(range.clone(), *value, |a, b| a.1 + b.1).unwrap();
                }
            }
            prop_assert_eq!(whole.root().unwrap().to_bits(), tree_sum(&terms).to_bits());
        }
    }

    #[test]
    fn what_is_no_node_or_not_next_is_refused() {
        let mut tree = Tree::new(7, 2);
        let mut push = |range| tree.push(range, 1, |a, b| a.1 + b.1);
        assert_eq!(push(2..4), Ok(()));
        for bad in [2..4, 5..6, 4..8, 4..4, 4..5000] {
            assert_eq!(push(bad.clone()), Err(bad));
        }
        assert_eq!(push(4..7), Ok(()));
        assert_eq!(tree.root(), None);
        assert!(!Tree::<u8>::is_node(8, &(1..3)) && !Tree::<u8>::is_node(8, &(4..7)));
        assert!(Tree::<u8>::is_node(7, &(4..7)) && Tree::<u8>::is_node(7, &(0..7)));
    }
}
