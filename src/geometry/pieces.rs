//! What of flat figures stays in sight past shadows, in convex pieces.

use super::DVec3;
use super::corner::Corner;
use super::shadow::Shadow;

/// Convex pieces of flat figures that stay in sight, shadow after shadow. Kept for reuse: a piece
/// is found in less time than its memory.
#[derive(Clone, Debug)]
pub struct Pieces<C = DVec3> {
    now: Figures<C>,
    next: Figures<C>,
    rest: Vec<C>,
    inside: Vec<C>,
    heights: Vec<f64>,
}

/// Figures one behind the other.
#[derive(Clone, Debug)]
struct Figures<C> {
    corners: Vec<C>,
    ends: Vec<usize>,
}

impl<C> Default for Pieces<C> {
    fn default() -> Self {
        Self {
            now: Figures::default(),
            next: Figures::default(),
            rest: Vec::new(),
            inside: Vec::new(),
            heights: Vec::new(),
        }
    }
}

impl<C> Default for Figures<C> {
    fn default() -> Self {
        Self {
            corners: Vec::new(),
            ends: Vec::new(),
        }
    }
}

impl<C: Corner> Figures<C> {
    fn clear(&mut self) {
        self.corners.clear();
        self.ends.clear();
    }

    fn close(&mut self) {
        self.ends.push(self.corners.len());
    }

    fn push(&mut self, figure: &[C]) {
        self.corners.extend_from_slice(figure);
        self.close();
    }

    fn iter(&self) -> impl Iterator<Item = &[C]> {
        let starts = std::iter::once(&0).chain(&self.ends);
        let ranges = starts.zip(&self.ends);
        ranges.map(|(start, end)| &self.corners[*start..*end])
    }
}

impl<C: Corner> Pieces<C> {
    /// Starts anew with these figures, which lie in the convex hull of some points, and takes away
    /// what shadows hide. Returns whether any shadow meets the hull.
    pub fn past<'f, 's>(
        &mut self,
        figures: impl IntoIterator<Item = &'f [C]>,
        hull: &[DVec3],
        shadows: impl IntoIterator<Item = &'s Shadow<C::Plane>>,
    ) -> bool
    where
        C: 'f,
        C::Plane: 's,
    {
        self.now.clear();
        figures.into_iter().for_each(|figure| self.now.push(figure));
        let mut met = false;
        for shadow in shadows.into_iter().filter(|s| !s.misses(hull)) {
            self.cut(shadow);
            met = true;
        }
        met
    }

    /// The pieces.
    pub fn iter(&self) -> impl Iterator<Item = &[C]> {
        self.now.iter()
    }

    /// Takes away what a shadow hides: of each figure what lies outside each half-space in turn
    /// stays, and what lies inside all goes.
    fn cut(&mut self, shadow: &Shadow<C::Plane>) {
        let Self {
            now,
            next,
            rest,
            inside,
            heights,
        } = self;
        next.clear();
        for figure in now.iter() {
            if shadow.misses(figure) {
                next.push(figure);
                continue;
            }
            rest.clear();
            rest.extend_from_slice(figure);
            for plane in &shadow.planes {
                let (n, d, _) = plane;
                heights.clear();
                heights.extend(rest.iter().map(|w| n.dot(w.at()) - d));
                if heights.iter().all(|h| *h >= 0.0) {
                    continue;
                }
                inside.clear();
                split(rest, heights, plane, [&mut *inside, &mut next.corners]);
                next.close();
                std::mem::swap(rest, inside);
                if rest.len() < 3 {
                    break;
                }
            }
        }
        std::mem::swap(now, next);
    }
}

/// Adds to both the parts of a convex figure whose corners have these heights over a plane.
fn split<C: Corner>(
    figure: &[C],
    heights: &[f64],
    plane: &(DVec3, f64, C::Plane),
    [inside, outside]: [&mut Vec<C>; 2],
) {
    for (i, (a, h)) in figure.iter().zip(heights).enumerate() {
        let next = if i + 1 == figure.len() { 0 } else { i + 1 };
        if *h >= 0.0 {
            inside.push(*a);
        }
        if *h <= 0.0 {
            outside.push(*a);
        }
        if h * heights[next] < 0.0 {
            let cut = C::crossing(a, &figure[next], [*h, heights[next]], plane);
            inside.push(cut);
            outside.push(cut);
        }
    }
}
