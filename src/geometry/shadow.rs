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

use super::{Basis, Blockers, Bvh, DVec3, Facing, Shape, ShapeId, Sphere};

/// Corners of a convex flat figure, in order around it.
pub type Polygon = Vec<DVec3>;

/// Sides of the polygon that stands for a circle, of the same area: its rim is off by less than
/// 8e-4 of the radius, to both sides.
const SIDES: usize = 64;
/// Meshes of more triangles are asked ray by ray.
const MOST_TRIANGLES: usize = 256;
/// A point nearer to a figure's plane than this fraction of its size sees it edge-on.
const EDGE_ON: f64 = 1e-9;

/// The points that something hides: where all n·w > d.
#[derive(Clone, Debug)]
pub struct Shadow {
    planes: Vec<(DVec3, f64)>,
}

impl Shadow {
    /// Of a convex flat figure with these corners, seen from `from`; `None` where it is edge-on.
    pub fn of_figure(corners: &[DVec3], from: DVec3) -> Option<Self> {
        let (area, middle) = area_and_middle(corners);
        let next = corners.iter().cycle().skip(1);
        let edges: Vec<(DVec3, DVec3)> = corners.iter().copied().zip(next.copied()).collect();
        let normal: DVec3 = edges
            .iter()
            .map(|(a, b)| (*a - middle).cross(*b - middle))
            .sum();
        let normal = normal.try_normalize()?;
        let height = normal.dot(middle - from);
        if height.abs() <= EDGE_ON * area.sqrt() {
            return None;
        }
        let away = normal * height.signum();
        // What lies in the plane itself, as neighbours of a patch do, is not beyond it.
        let slack = EDGE_ON * (area.sqrt() + (middle - from).length());
        let beyond = (away, away.dot(middle) + slack);
        let side = |(a, b): &(DVec3, DVec3)| {
            let n = (*a - from).cross(*b - from).try_normalize()?;
            let n = n * n.dot(middle - from).signum();
            Some((n, n.dot(from)))
        };
        let sides = edges.iter().filter_map(side);
        Some(Self {
            planes: std::iter::once(beyond).chain(sides).collect(),
        })
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

    /// Whether nothing of the convex hull of these points is hidden; errs to no.
    pub fn misses(&self, hull: &[DVec3]) -> bool {
        let outside = |(n, d): &(DVec3, f64)| hull.iter().all(|w| n.dot(*w) <= *d);
        self.planes.iter().any(outside)
    }

    /// Whether all of the convex hull of these points is hidden.
    pub fn covers(&self, hull: &[DVec3]) -> bool {
        let inside = |(n, d): &(DVec3, f64)| hull.iter().all(|w| n.dot(*w) >= *d);
        self.planes.iter().all(inside)
    }
}

impl Hidden {
    /// The shapes that have to be asked, for segments that end on the convex hull of these points.
    pub fn asked(&self, hull: &[DVec3]) -> Blockers {
        let near = |around: &Option<Shadow>| around.as_ref().is_none_or(|a| !a.misses(hull));
        let asked = self.by_rays.iter().filter(|(_, around)| near(around));
        Blockers::Among(asked.map(|(id, _)| *id).collect())
    }
}

/// Convex pieces of flat figures that stay in sight, shadow after shadow. Kept for reuse: a piece
/// is found in less time than its memory.
#[derive(Clone, Debug, Default)]
pub struct Pieces {
    now: Figures,
    next: Figures,
    rest: Polygon,
    inside: Polygon,
    heights: Vec<f64>,
}

/// Figures one behind the other.
#[derive(Clone, Debug, Default)]
struct Figures {
    corners: Vec<DVec3>,
    ends: Vec<usize>,
}

impl Figures {
    fn clear(&mut self) {
        self.corners.clear();
        self.ends.clear();
    }

    fn close(&mut self) {
        self.ends.push(self.corners.len());
    }

    fn push(&mut self, figure: &[DVec3]) {
        self.corners.extend_from_slice(figure);
        self.close();
    }

    fn iter(&self) -> impl Iterator<Item = &[DVec3]> {
        let starts = std::iter::once(&0).chain(&self.ends);
        let ranges = starts.zip(&self.ends);
        ranges.map(|(start, end)| &self.corners[*start..*end])
    }
}

impl Pieces {
    /// Starts anew with these figures, which lie in the convex hull of some points, and takes away
    /// what shadows hide. Returns whether any shadow meets the hull.
    pub fn past<'f, 's>(
        &mut self,
        figures: impl IntoIterator<Item = &'f [DVec3]>,
        hull: &[DVec3],
        shadows: impl IntoIterator<Item = &'s Shadow>,
    ) -> bool {
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
    pub fn iter(&self) -> impl Iterator<Item = &[DVec3]> {
        self.now.iter()
    }

    /// Takes away what a shadow hides: of each figure what lies outside each half-space in turn
    /// stays, and what lies inside all goes.
    fn cut(&mut self, shadow: &Shadow) {
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
            for (n, d) in &shadow.planes {
                heights.clear();
                heights.extend(rest.iter().map(|w| n.dot(*w) - d));
                if heights.iter().all(|h| *h >= 0.0) {
                    continue;
                }
                inside.clear();
                split(rest, heights, inside, &mut next.corners);
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
fn split(figure: &[DVec3], heights: &[f64], inside: &mut Vec<DVec3>, outside: &mut Vec<DVec3>) {
    for (i, (a, h)) in figure.iter().zip(heights).enumerate() {
        let next = if i + 1 == figure.len() { 0 } else { i + 1 };
        if *h >= 0.0 {
            inside.push(*a);
        }
        if *h <= 0.0 {
            outside.push(*a);
        }
        if h * heights[next] < 0.0 {
            let cut = *a + (figure[next] - *a) * (h / (h - heights[next]));
            inside.push(cut);
            outside.push(cut);
        }
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

/// Triangles as figures: of two that follow each other and make up a parallelogram, that.
fn figures(triangles: Vec<[DVec3; 3]>) -> Vec<Polygon> {
    let mut found: Vec<Polygon> = Vec::new();
    for [a, b, c] in triangles {
        match found.last_mut() {
            // (p, q, r) and (p, r, s) with s = p + r − q.
            Some(last) if last.len() == 3 && last[0] == a && last[2] == b => {
                let expected = last[0] + last[2] - last[1];
                if (c - expected).length() <= EDGE_ON * (c - a).length() {
                    last.push(c);
                } else {
                    found.push(vec![a, b, c]);
                }
            }
            _ => found.push(vec![a, b, c]),
        }
    }
    found
}

/// A polygon of a circle's area.
fn circle(centre: DVec3, normal: DVec3, radius: f64) -> Polygon {
    let basis = Basis::around(normal);
    let step = TAU / SIDES as f64;
    let reach = radius * (step / libm::sin(step)).sqrt();
    let corner = |k: usize| {
        let (sin, cos) = libm::sincos(step * k as f64);
        centre + basis.to_world([reach * cos, reach * sin, 0.0])
    };
    (0..SIDES).map(corner).collect()
}

/// What stands in the way in a scene, ready to be seen from many points.
#[derive(Clone, Debug)]
pub struct Opaque {
    figures: Vec<(ShapeId, Polygon)>,
    spheres: Vec<(ShapeId, Sphere)>,
    /// Meshes of many triangles.
    by_rays: Vec<ShapeId>,
}

/// What is hidden from one point.
#[derive(Clone, Debug)]
pub struct Hidden {
    /// Exactly.
    pub shadows: Vec<Shadow>,
    /// Shapes that have to be asked ray by ray besides, each with what its circumsphere hides.
    pub by_rays: Vec<(ShapeId, Option<Shadow>)>,
}

impl Opaque {
    /// All shapes of a scene for which `counts` holds.
    pub fn new(bvh: &Bvh, counts: impl Fn(ShapeId) -> bool) -> Self {
        let mut found = Self {
            figures: Vec::new(),
            spheres: Vec::new(),
            by_rays: Vec::new(),
        };
        for (id, shape) in (0..).zip(bvh.shapes()).filter(|(id, _)| counts(*id)) {
            match shape {
                Shape::Parallelogram(p) => found.figures.push((id, p.corners().to_vec())),
                Shape::Disc(d) => {
                    let corners = circle(d.centre(), d.normal(), d.radius());
                    found.figures.push((id, corners));
                }
                Shape::Sphere(s) => found.spheres.push((id, *s)),
                Shape::Instance(body) => {
                    let count = body.mesh().triangles().len();
                    if count > MOST_TRIANGLES {
                        found.by_rays.push(id);
                    } else {
                        let triangles = (0..count as u32).map(|t| body.corners(t));
                        let figures = figures(triangles.collect());
                        found.figures.extend(figures.into_iter().map(|f| (id, f)));
                    }
                }
            }
        }
        found
    }

    /// Whether there are meshes that have to be asked ray by ray.
    pub fn has_meshes(&self) -> bool {
        !self.by_rays.is_empty()
    }

    /// What is hidden from `from`, a point of shape `own`: that shape hides nothing of its own
    /// unless it is a mesh.
    pub fn from(&self, from: DVec3, own: Option<ShapeId>, bvh: &Bvh) -> Hidden {
        let is_mesh = |id: ShapeId| matches!(bvh.shapes()[id as usize], Shape::Instance(_));
        let other = |id: &ShapeId| Some(*id) != own || is_mesh(*id);
        let figures = self.figures.iter().filter(|(id, _)| other(id));
        let figures = figures.filter_map(|(_, corners)| Shadow::of_figure(corners, from));
        let around = |id: &ShapeId| {
            let (centre, radius) = bvh.shapes()[*id as usize].circumsphere();
            let sphere = Sphere::new(centre, radius, Facing::Outside);
            (*id, sphere.and_then(|s| Shadow::of_sphere(&s, from)))
        };
        let mut by_rays: Vec<_> = self.by_rays.iter().map(around).collect();
        let mut shadows: Vec<Shadow> = figures.collect();
        for (id, sphere) in self.spheres.iter().filter(|(id, _)| other(id)) {
            match Shadow::of_sphere(sphere, from) {
                Some(shadow) => shadows.push(shadow),
                None => by_rays.push((*id, None)),
            }
        }
        Hidden { shadows, by_rays }
    }
}

#[cfg(test)]
mod tests;
