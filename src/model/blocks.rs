//! The pixels that shadows may meet, found by halving the photograph.

use std::ops::Range;

use super::obstacles::{ends, hull};
use super::patch::Patch;
use crate::geometry::{DVec3, Hidden};

/// Pixels of a rectangle of the photograph, with the middle and half the sides of a box that holds
/// their footprints, and its corners.
struct Block {
    middle: DVec3,
    half: DVec3,
    hull: Vec<DVec3>,
    columns: Range<usize>,
    rows: Range<usize>,
    /// The two halves, unless it is one pixel.
    halves: Option<[usize; 2]>,
    /// Whether the wall is flat and the camera sees all of it.
    open: bool,
}

/// A photograph in halves, down to single pixels.
pub(super) struct Blocks {
    /// The whole first.
    all: Vec<Block>,
    /// Columns of the photograph.
    columns: usize,
}

impl Blocks {
    /// Of all pixels, row by row, each in its parts.
    pub(super) fn new(pixels: &[Vec<Patch>], columns: usize) -> Self {
        let mut found = Self {
            all: Vec::new(),
            columns,
        };
        found.add(pixels, 0..columns, 0..pixels.len() / columns);
        found
    }

    fn add(&mut self, pixels: &[Vec<Patch>], columns: Range<usize>, rows: Range<usize>) -> usize {
        let all = rows
            .clone()
            .flat_map(|row| columns.clone().map(move |c| (c, row)));
        let patches: Vec<&Patch> = all
            .flat_map(|(c, row)| &pixels[c + row * self.columns])
            .collect();
        let points = |p: &&Patch| p.corners.clone().unwrap_or_else(|| vec![p.whole.position]);
        let at = self.all.len();
        let hull = hull(patches.iter().flat_map(points));
        let (low, high) = ends(hull.iter().copied());
        let block = Block {
            middle: 0.5 * (low + high),
            half: 0.5 * (high - low),
            hull,
            open: patches.iter().all(|p| p.open && p.corners.is_some()),
            columns: columns.clone(),
            rows: rows.clone(),
            halves: None,
        };
        self.all.push(block);
        let middle = |r: &Range<usize>| r.start + r.len() / 2;
        if columns.len() * rows.len() > 1 {
            let [first, second] = if columns.len() >= rows.len() {
                let m = middle(&columns);
                [(columns.start..m, rows.clone()), (m..columns.end, rows)]
            } else {
                let m = middle(&rows);
                [(columns.clone(), rows.start..m), (columns, m..rows.end)]
            };
            let halves = [
                self.add(pixels, first.0, first.1),
                self.add(pixels, second.0, second.1),
            ];
            self.all[at].halves = Some(halves);
        }
        at
    }

    /// Tells of each pixel of which something may be hidden the indices of the shadows that may
    /// take it; none where all of it is hidden.
    pub(super) fn visit(&self, hidden: &Hidden, each: &mut dyn FnMut(usize, Option<&[usize]>)) {
        let met = (0..hidden.shadows.len()).collect();
        self.visit_block((0, 0), &mut Visit { hidden, met }, each);
    }

    /// A block of pixels, of which the shadows `met[first..]` may take something.
    fn visit_block(
        &self,
        (block, first): (usize, usize),
        visit: &mut Visit<'_>,
        each: &mut dyn FnMut(usize, Option<&[usize]>),
    ) {
        let block = &self.all[block];
        let shadows = &visit.hidden.shadows;
        let own = visit.met.len();
        for k in first..own {
            let shadow = visit.met[k];
            if !shadows[shadow].misses_box(block.middle, block.half) {
                visit.met.push(shadow);
            }
        }
        let met = &visit.met[own..];
        let covers = |s: &usize| shadows[*s].covers_box(block.middle, block.half);
        if met.iter().any(covers) {
            for row in block.rows.clone() {
                let first = row * self.columns;
                let own = first + block.columns.start..first + block.columns.end;
                own.for_each(|p| each(p, None));
            }
        } else if !met.is_empty() || !block.open || !visit.hidden.asked(&block.hull, None).none() {
            match block.halves {
                Some(halves) => {
                    for half in halves {
                        self.visit_block((half, own), visit, each);
                    }
                }
                None => {
                    let p = block.columns.start + block.rows.start * self.columns;
                    each(p, Some(met));
                }
            }
        }
        visit.met.truncate(own);
    }
}

/// What is needed to find the pixels that shadows meet.
struct Visit<'a> {
    hidden: &'a Hidden,
    /// Indices of shadows: of each block on the way down those that its parent's may meet.
    met: Vec<usize>,
}
