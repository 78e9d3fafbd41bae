//! Parts of hidden surfaces by their parameters.

use crate::geometry::{DVec3, Instance, Polygon, Shape};
use crate::scene::{Element, Surface};

#[derive(Clone, Copy, Debug)]
pub(super) enum Place {
    /// \[u, u + width\] × \[v, v + height\] of the surface's equal-area parameters.
    Cell { from: [f64; 2], size: [f64; 2] },
    /// A triangle within triangle `id` of a mesh.
    Triangle { id: u32, corners: [DVec3; 3] },
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

impl Place {
    /// All of it taken at its middle, and its corners where it is flat.
    pub(super) fn cell(&self, surface: &Surface) -> Option<(Element, Option<Polygon>)> {
        match (self, &surface.shape) {
            (Self::Triangle { id, corners }, Shape::Instance(body)) => {
                let element = on_triangle(surface, body, *id, corners, [1.0 / 3.0; 3], 1.0);
                Some((element, Some(corners.to_vec())))
            }
            (Self::Triangle { .. }, _) => None,
            (Self::Cell { from, size }, shape) => {
                let at = |[a, b]: [f64; 2]| [from[0] + a * size[0], from[1] + b * size[1]];
                let element = Element {
                    area: shape.area() * size[0] * size[1],
                    ..surface.element_at(at([0.5; 2]))
                };
                let rim = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
                let is_flat = match shape {
                    Shape::Parallelogram(_) => true,
                    Shape::Instance(body) => body.is_exact_patch(),
                    _ => false,
                };
                let corners = is_flat.then(|| rim.map(|ab| shape.at(at(ab)).position).to_vec());
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
                let rim = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(at);
                let sides = [[0.5, 0.0], [1.0, 0.5], [0.5, 1.0], [0.0, 0.5]].map(at);
                furthest(at([0.5; 2]), &[rim, sides].concat())
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
