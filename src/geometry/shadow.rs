//! Shadows: what flat figures, spheres and small meshes hide from a point, exactly.
//!
//! A point w is hidden from x by a convex flat figure where the segment from x to w crosses it: w
//! lies within the cone from x over the figure, and beyond its plane. Both are half-spaces,
//!
//! > n_e·(w − x) > 0 for each edge e = (a, b), n_e = ±(a − x) × (b − x),   n·(w − a) > 0, n away from x,
//!
//! so that of a convex figure on the wall convex pieces stay in sight. A sphere hides what the disc
//! within its silhouette hides.

use std::f64::consts::TAU;

use super::corner::{Corner, Polygon, area_and_middle};
use super::moving::{Moving, PlaneRate};
use super::{Basis, DVec3, Sphere};

/// Sides of the polygon that stands for a circle, of the same area: its rim is off by less than
/// 8e-4 of the radius, to both sides.
const SIDES: usize = 64;
/// A point nearer to a figure's plane than this fraction of its size sees it edge-on.
pub(super) const EDGE_ON: f64 = 1e-9;

/// The points that something hides: where all n·w > d. Each plane has what else is known of it.
#[derive(Clone, Debug)]
pub struct Shadow<P = ()> {
    pub(super) planes: Vec<(DVec3, f64, P)>,
}

/// A plane of a shadow that is made.
enum Bound {
    /// That of the figure, with its normal away from the viewpoint.
    Figure(DVec3),
    /// That of an edge, by the indices of its ends, and ±1 as its normal is ±(a − x) × (b − x).
    Edge([usize; 2], f64),
}

impl Shadow {
    /// Of a convex flat figure with these corners, seen from `from`; `None` where it is edge-on.
    pub fn of_figure(corners: &[DVec3], from: DVec3) -> Option<Self> {
        Self::bounded(corners, from, |_| ())
    }

    /// Of a ball, seen from `from` outside it; `None` from inside.
    pub fn of_sphere(sphere: &Sphere, from: DVec3) -> Option<Self> {
        let axis = sphere.centre - from;
        let share = sphere.radius * sphere.radius / axis.length_squared();
        if share >= 1.0 - EDGE_ON {
            return None;
        }
        let radius = sphere.radius * (1.0 - share).sqrt();
        Self::of_figure(
            &circle(from + axis * (1.0 - share), axis.normalize(), radius),
            from,
        )
    }
}

impl<P> Shadow<P> {
    /// [`Shadow::of_figure`], each plane with what `of` says of it.
    fn bounded(corners: &[DVec3], from: DVec3, of: impl Fn(Bound) -> P) -> Option<Self> {
        let (area, middle) = area_and_middle(corners);
        let count = corners.len();
        let edges = || (0..count).map(|k| [k, (k + 1) % count]);
        let normal: DVec3 = edges()
            .map(|[a, b]| (corners[a] - middle).cross(corners[b] - middle))
            .sum();
        let normal = normal.try_normalize()?;
        let height = normal.dot(middle - from);
        if height.abs() <= EDGE_ON * area.sqrt() {
            return None;
        }
        let away = normal * height.signum();
        // What lies in the plane itself, as neighbours of a patch do, is not beyond it.
        let slack = EDGE_ON * (area.sqrt() + (middle - from).length());
        let beyond = (away, away.dot(middle) + slack, of(Bound::Figure(away)));
        let side = |[a, b]: [usize; 2]| {
            let n = (corners[a] - from)
                .cross(corners[b] - from)
                .try_normalize()?;
            let sign = n.dot(middle - from).signum();
            let n = n * sign;
            Some((n, n.dot(from), of(Bound::Edge([a, b], sign))))
        };
        let sides = edges().filter_map(side);
        Some(Self {
            planes: std::iter::once(beyond).chain(sides).collect(),
        })
    }

    /// Whether nothing of the convex hull of these points is hidden; errs to no.
    #[inline]
    pub fn misses<C: Corner>(&self, hull: &[C]) -> bool {
        let outside = |(n, d, _): &(DVec3, f64, P)| hull.iter().all(|w| n.dot(w.at()) <= *d);
        self.planes.iter().any(outside)
    }

    /// Whether nothing of the box about `middle` is hidden; errs to no.
    #[inline]
    pub fn misses_box(&self, middle: DVec3, half: DVec3) -> bool {
        let mut planes = self.planes.iter();
        planes.any(|(n, d, _)| n.dot(middle) + n.abs().dot(half) <= *d)
    }

    /// Whether all of that box is hidden.
    #[inline]
    pub fn covers_box(&self, middle: DVec3, half: DVec3) -> bool {
        let mut planes = self.planes.iter();
        planes.all(|(n, d, _)| n.dot(middle) - n.abs().dot(half) >= *d)
    }
}

/// [`Shadow::of_figure`] of a figure that moves, from a point that does not.
impl Shadow<PlaneRate> {
    /// [`Shadow::of_figure`] of a figure that moves, from a point that does not.
    pub(super) fn of_moving(figure: &[Moving], from: DVec3) -> Option<Self> {
        let corners: Vec<DVec3> = figure.iter().map(|corner| corner.at).collect();
        let first = figure.first()?;
        // The rate of x/|x|, along which its own length plays no part.
        let turned = |n: DVec3, length: f64, rate: DVec3| (rate - n * n.dot(rate)) / length;
        let of = |bound: Bound| -> PlaneRate {
            std::array::from_fn(|k| match bound {
                Bound::Figure(n) => {
                    let (mut whole, mut rate) = (DVec3::ZERO, DVec3::ZERO);
                    for (i, a) in figure.iter().enumerate() {
                        let b = &figure[(i + 1) % figure.len()];
                        let [pa, pb] = [a, b].map(|c| c.at - first.at);
                        let [da, db] = [a, b].map(|c| c.rate[k] - first.rate[k]);
                        whole += pa.cross(pb);
                        rate += da.cross(pb) + pa.cross(db);
                    }
                    let sign = n.dot(whole).signum();
                    let dn = turned(n, whole.length(), rate * sign);
                    (dn, dn.dot(first.at) + n.dot(first.rate[k]))
                }
                Bound::Edge([a, b], sign) => {
                    let [a, b] = [&figure[a], &figure[b]];
                    let [pa, pb] = [a.at - from, b.at - from];
                    let x = pa.cross(pb) * sign;
                    let rate = (a.rate[k].cross(pb) + pa.cross(b.rate[k])) * sign;
                    let length = x.length();
                    let dn = turned(x / length, length, rate);
                    (dn, dn.dot(from))
                }
            })
        };
        Self::bounded(&corners, from, of)
    }
}

/// A polygon of a circle's area.
pub(super) fn circle(centre: DVec3, normal: DVec3, radius: f64) -> Polygon {
    let basis = Basis::around(normal);
    let step = TAU / SIDES as f64;
    let reach = radius * (step / libm::sin(step)).sqrt();
    let corner = |k: usize| {
        let (sin, cos) = libm::sincos(step * k as f64);
        centre + basis.to_world([reach * cos, reach * sin, 0.0])
    };
    (0..SIDES).map(corner).collect()
}
