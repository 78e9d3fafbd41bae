//! Parts of hidden surfaces by their parameters.

use crate::geometry::{DVec3, Instance, Polygon, Shape};
use crate::scene::{Element, Surface};

#[derive(Clone, Copy, Debug)]
pub(super) enum Place {
    /// \[u, u + width\] × \[v, v + height\] of the surface's equal-area parameters.
    Cell { from: [f64; 2], size: [f64; 2] },
    /// A triangle within triangle `id` of a mesh.
    Triangle { id: u32, corners: [DVec3; 3] },
    /// A triangle of a disc's equal-area parameters, on one side of each of their diagonals, from
    /// the corner that is nearest to the disc's middle on.
    Wedge { corners: [[f64; 2]; 3] },
}

/// The triangles of a mesh that have an area, or the facets into which its texture cuts them.
pub(super) fn triangles(body: &Instance) -> Vec<Place> {
    let triangle = |(id, corners)| Place::Triangle { id, corners };
    let lit = |id: &u32| body.triangle_area(*id) > 0.0;
    match body.facets() {
        Some(facets) => {
            let all = facets.all().iter().filter(|f| lit(&f.triangle));
            let all = all.map(|f| (f.triangle, body.facet_corners(f)));
            all.map(triangle).collect()
        }
        None => {
            let all = (0..body.mesh().triangles().len() as u32).filter(lit);
            all.map(|id| (id, body.corners(id))).map(triangle).collect()
        }
    }
}

/// Cells of equal size, iu + iv·nu.
pub(super) fn grid([nu, nv]: [usize; 2]) -> impl Iterator<Item = Place> {
    let size = [1.0 / nu as f64, 1.0 / nv as f64];
    (0..nu * nv).map(move |cell| Place::Cell {
        from: [(cell % nu) as f64 * size[0], (cell / nu) as f64 * size[1]],
        size,
    })
}

/// Cells of equal size of a disc, those that a diagonal crosses in wedges. The map of Shirley and
/// Chiu has a kink along both diagonals, where a rule across them converges like 1/n². From the
/// middle on it is polar within each quarter: r = |a|, φ = π/4·b/a, so that a triangle's folded
/// nodes, b/a and a along their axes, have a smooth integrand.
pub(super) fn grid_of_disc(count: [usize; 2]) -> Vec<Place> {
    let pieces = |cell: Place| {
        let Place::Cell { from, size } = cell else {
            return vec![cell];
        };
        let whole = CORNERS.map(|[a, b]| [from[0] + a * size[0], from[1] + b * size[1]]);
        let mut figures = vec![whole.to_vec()];
        for sign in [1.0, -1.0] {
            // Rounding of a corner on the diagonal.
            let height = |[u, v]: [f64; 2]| match (u - 0.5) - sign * (v - 0.5) {
                h if h.abs() < 1e-14 => 0.0,
                h => h,
            };
            let halves = figures.iter().flat_map(|f| halved(f, height));
            figures = halves.filter(|f| f.len() > 2).collect();
        }
        match figures.len() {
            1 => vec![cell],
            _ => figures.into_iter().flat_map(wedges).collect(),
        }
    };
    grid(count).flat_map(pieces).collect()
}

/// Corners of the unit square.
pub(super) const CORNERS: [[f64; 2]; 4] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];

/// Both parts of a convex figure, where a height that is linear over it is not below and not above
/// 0.
pub(super) fn halved(figure: &[[f64; 2]], height: impl Fn([f64; 2]) -> f64) -> [Vec<[f64; 2]>; 2] {
    let mut parts = [Vec::new(), Vec::new()];
    for (k, p) in figure.iter().enumerate() {
        let q = figure[(k + 1) % figure.len()];
        let (h, next) = (height(*p), height(q));
        if h >= 0.0 {
            parts[0].push(*p);
        }
        if h <= 0.0 {
            parts[1].push(*p);
        }
        if h * next < 0.0 {
            let t = h / (h - next);
            let cut = [0, 1].map(|i| p[i] + t * (q[i] - p[i]));
            parts.iter_mut().for_each(|part| part.push(cut));
        }
    }
    parts
}

/// A convex figure of a disc's parameters in triangles from its corner nearest to the middle on.
fn wedges(mut figure: Vec<[f64; 2]>) -> Vec<Place> {
    let away = |[u, v]: [f64; 2]| (u - 0.5).powi(2) + (v - 0.5).powi(2);
    let nearest = (0..figure.len()).min_by(|i, k| away(figure[*i]).total_cmp(&away(figure[*k])));
    figure.rotate_left(nearest.unwrap_or(0));
    let wedge = |pair: &[[f64; 2]]| Place::Wedge {
        corners: [figure[0], pair[0], pair[1]],
    };
    figure[1..].windows(2).map(wedge).collect()
}

/// A point of a triangle of parameters.
pub(super) fn within([a, b, c]: &[[f64; 2]; 3], [x, y, z]: [f64; 3]) -> [f64; 2] {
    [0, 1].map(|i| a[i] * x + b[i] * y + c[i] * z)
}

/// The area of a triangle of parameters, of the unit square's.
pub(super) fn area_of([a, b, c]: &[[f64; 2]; 3]) -> f64 {
    0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])).abs()
}

impl Place {
    /// All of it taken at its middle, and its corners where it is flat.
    pub(super) fn cell(&self, surface: &Surface) -> Option<(Element, Option<Polygon>)> {
        match (self, &surface.shape) {
            (Self::Triangle { id, corners }, Shape::Instance(body)) => {
                let element = on_triangle(surface, body, *id, corners, [1.0 / 3.0; 3], 1.0);
                Some((element, Some(corners.to_vec())))
            }
            (Self::Triangle { .. }, _) => None,
            (Self::Wedge { corners }, shape) => {
                let element = Element {
                    area: shape.area() * area_of(corners),
                    ..surface.element_at(within(corners, [1.0 / 3.0; 3]))
                };
                Some((element, None))
            }
            (Self::Cell { from, size }, shape) => {
                let at = |[a, b]: [f64; 2]| [from[0] + a * size[0], from[1] + b * size[1]];
                let element = Element {
                    area: shape.area() * size[0] * size[1],
                    ..surface.element_at(at([0.5; 2]))
                };
                let is_flat = match shape {
                    Shape::Parallelogram(_) => true,
                    Shape::Instance(body) => body.is_exact_patch(),
                    _ => false,
                };
                let corners = is_flat.then(|| CORNERS.map(|ab| shape.at(at(ab)).position).to_vec());
                Some((element, corners))
            }
        }
    }

    /// Its middle and the largest distance from there to its rim.
    pub(super) fn ball(&self, surface: &Surface) -> (DVec3, f64) {
        let furthest = |middle: DVec3, rim: &[DVec3]| {
            let far = rim.iter().map(|p| (*p - middle).length());
            (middle, far.fold(0.0, f64::max))
        };
        match self {
            Self::Triangle {
                corners: [a, b, c], ..
            } => furthest((*a + *b + *c) / 3.0, &[*a, *b, *c]),
            Self::Cell { from, size } => {
                let at = |[a, b]: [f64; 2]| {
                    let uv = [from[0] + a * size[0], from[1] + b * size[1]];
                    surface.shape.at(uv).position
                };
                let rim = CORNERS.map(at);
                let sides = [[0.5, 0.0], [1.0, 0.5], [0.5, 1.0], [0.0, 0.5]].map(at);
                furthest(at([0.5; 2]), &[rim, sides].concat())
            }
            Self::Wedge { corners } => {
                let at = |weights| surface.shape.at(within(corners, weights)).position;
                let rim = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(at);
                let sides = [[0.5, 0.5, 0.0], [0.0, 0.5, 0.5], [0.5, 0.0, 0.5]].map(at);
                furthest(at([1.0 / 3.0; 3]), &[rim, sides].concat())
            }
        }
    }

    pub(super) fn quarters(&self) -> [Self; 4] {
        match *self {
            Self::Cell {
                from: [u, v],
                size: [w, h],
            } => {
                let size = [0.5 * w, 0.5 * h];
                [
                    [u, v],
                    [u + size[0], v],
                    [u, v + size[1]],
                    [u + size[0], v + size[1]],
                ]
                .map(|from| Self::Cell { from, size })
            }
            Self::Triangle {
                id,
                corners: [a, b, c],
            } => {
                let [p, q, r] = [(a + b) * 0.5, (b + c) * 0.5, (c + a) * 0.5];
                [[a, p, r], [p, b, q], [r, q, c], [p, q, r]]
                    .map(|corners| Self::Triangle { id, corners })
            }
            Self::Wedge { corners: [a, b, c] } => {
                let middle = |a: [f64; 2], b: [f64; 2]| [0, 1].map(|i| 0.5 * (a[i] + b[i]));
                let [p, q, r] = [middle(a, b), middle(b, c), middle(c, a)];
                [[a, p, r], [p, b, q], [r, q, c], [p, q, r]].map(|corners| Self::Wedge { corners })
            }
        }
    }
}

pub(super) fn on_triangle(
    surface: &Surface,
    body: &Instance,
    id: u32,
    [a, b, c]: &[DVec3; 3],
    [x, y, z]: [f64; 3],
    share: f64,
) -> Element {
    let point = body.on_triangle(id, *a * x + *b * y + *c * z);
    let area = 0.5 * (*b - *a).cross(*c - *a).length();
    Element {
        position: point.position,
        normal: point.normal,
        area: area * share,
        u_axis: DVec3::X,
        albedo: surface.albedo.albedo(point.uv),
    }
}
