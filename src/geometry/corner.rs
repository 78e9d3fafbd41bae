//! Corners of flat figures.

use super::DVec3;

/// Corners of a convex flat figure, in order around it.
pub type Polygon = Vec<DVec3>;

/// A corner of a figure that is cut.
pub trait Corner: Copy {
    /// What it has to know of a plane besides n·w = d.
    type Plane;

    /// Where it is.
    fn at(&self) -> DVec3;

    /// Where the line from `a` to `b`, at `heights` of opposite signs over a plane, crosses it.
    fn crossing(a: &Self, b: &Self, heights: [f64; 2], plane: &(DVec3, f64, Self::Plane)) -> Self;
}

impl Corner for DVec3 {
    type Plane = ();

    #[inline]
    fn at(&self) -> DVec3 {
        *self
    }

    #[inline]
    fn crossing(a: &Self, b: &Self, [h, k]: [f64; 2], _: &(DVec3, f64, ())) -> Self {
        *a + (*b - *a) * (h / (h - k))
    }
}

/// Area and centroid of a convex flat figure; of one without area its first corner.
pub fn area_and_middle(figure: &[DVec3]) -> (f64, DVec3) {
    let Some(first) = figure.first() else {
        return (0.0, DVec3::ZERO);
    };
    let mut sum = (0.0, DVec3::ZERO);
    for pair in figure[1..].windows(2) {
        let (a, b) = (pair[0] - *first, pair[1] - *first);
        let area = 0.5 * a.cross(b).length();
        sum = (sum.0 + area, sum.1 + (a + b) * (area / 3.0));
    }
    match sum.0 {
        0.0 => (0.0, *first),
        area => (area, *first + sum.1 / area),
    }
}
