//! Division of hidden surfaces into resolution elements.

use super::pieces::{self, Grid};
use super::surface::{Division, Surface};
use super::texture::Texture;
use crate::geometry::{DVec3, Instance, Shape};

/// An element as the matrix model takes it: one point with a normal, and an area.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Element {
    /// Its middle.
    pub position: DVec3,
    /// Unit normal there; zero for an element without area.
    pub normal: DVec3,
    /// Area, length².
    pub area: f64,
    /// Unit vector along u, in the surface.
    pub u_axis: DVec3,
    /// Its mean albedo, of a surface that is not Lambertian that of
    /// [`Surface::lambertian_equivalent`]; of a single point ([`Surface::element_at`]) the
    /// texture's value.
    pub albedo: f64,
}

impl Surface {
    /// The elements, iu + iv·nu. Of rectangles, discs and spheres cells of equal area in their
    /// parameters, taken at their middle; so of a mesh that is a parallelogram in its texture
    /// coordinates. Of another the triangles, at their centroids; or the cells of its texture
    /// coordinates: each has the area of what the coordinates put there (the triangles clipped),
    /// the direction of that part's vector area as its normal, and the point of the mesh nearest
    /// to its centroid. Coordinates outside \[0, 1\] are taken as the texture takes them, repeated
    /// or held to the border. Albedos are means over the area, exact.
    pub fn divided(&self, [nu, nv]: [usize; 2]) -> Vec<Element> {
        let matt = self.lambertian_equivalent();
        match (&matt.shape, matt.division) {
            (Shape::Instance(body), Division::Faces) => faces(body, &matt.albedo),
            (Shape::Instance(body), Division::Cells) if !body.is_exact_patch() => {
                cells(body, &matt.albedo, matt.grid([nu, nv]))
            }
            (Shape::Instance(body), Division::Whole) => {
                vec![together(body, &faces(body, &matt.albedo))]
            }
            (shape, _) => {
                let area = shape.area() / (nu * nv) as f64;
                let range = |i: usize, n: usize| [i as f64 / n as f64, (i + 1) as f64 / n as f64];
                let middle = |[a, b]: [f64; 2]| 0.5 * (a + b);
                (0..nu * nv)
                    .map(|j| {
                        let [u, v] = [range(j % nu, nu), range(j / nu, nv)];
                        Element {
                            area,
                            albedo: matt.albedo.mean(u, v),
                            ..matt.element_at([middle(u), middle(v)])
                        }
                    })
                    .collect()
            }
        }
    }

    /// The cells of a mesh's texture coordinates that are its elements.
    pub(super) fn grid(&self, count: [usize; 2]) -> Grid {
        Grid {
            count,
            wrap: self.albedo.wrap(),
        }
    }

    /// By triangle of a mesh: the element that most of it belongs to. Empty for other shapes.
    pub fn elements_of_triangles(&self, count: [usize; 2]) -> Vec<usize> {
        let Shape::Instance(body) = &self.shape else {
            return Vec::new();
        };
        let uv = match self.division {
            Division::Faces => return (0..body.mesh().triangles().len()).collect(),
            Division::Cells => body.mesh().uv().unwrap_or_default(),
            Division::Whole => return vec![0; body.mesh().triangles().len()],
        };
        let grid = self.grid(count);
        let largest = |uv: &[[f64; 2]; 3]| {
            let parts = grid.cut(pieces::whole(*uv)).into_iter();
            let parts = parts.map(|p| (p.cell, pieces::share_and_moment(&p.corners).0));
            let most = parts.max_by(|a, b| a.1.total_cmp(&b.1));
            most.map_or(0, |part| part.0)
        };
        uv.iter().map(largest).collect()
    }

    /// The point of the surface with parameters `uv` (of a mesh: to which its equal-area map takes
    /// them), without area.
    pub fn element_at(&self, uv: [f64; 2]) -> Element {
        let at = |uv| self.shape.at(uv);
        let point = at(uv);
        let along = match &self.shape {
            Shape::Instance(body) if !body.is_exact_patch() => DVec3::ZERO,
            _ => at([1.0, uv[1]]).position - at([0.0, uv[1]]).position,
        };
        Element {
            position: point.position,
            normal: point.normal,
            area: 0.0,
            u_axis: along.normalize_or(DVec3::X),
            albedo: self.albedo.albedo(point.uv),
        }
    }
}

fn faces(body: &Instance, albedo: &Texture) -> Vec<Element> {
    let uv = body.mesh().uv();
    (0..body.mesh().triangles().len())
        .map(|k| {
            let t = k as u32;
            let [a, b, c] = body.corners(t);
            let area = body.triangle_area(t);
            let point = body.on_triangle(t, (a + b + c) / 3.0);
            if area > 0.0 {
                Element {
                    position: point.position,
                    normal: point.normal,
                    area,
                    u_axis: (b - a).normalize_or(DVec3::X),
                    albedo: uv.map_or(albedo.albedo(point.uv), |uv| {
                        pieces::albedo(albedo, pieces::whole(uv[k]))
                    }),
                }
            } else {
                NOTHING
            }
        })
        .collect()
}

/// Faces as one element: their area, mean albedo, direction of the vector area, and the point of
/// the mesh nearest to the centroid.
fn together(body: &Instance, faces: &[Element]) -> Element {
    let area: f64 = faces.iter().map(|e| e.area).sum();
    let vector: DVec3 = faces.iter().map(|e| e.normal * e.area).sum();
    let moment: DVec3 = faces.iter().map(|e| e.position * e.area).sum();
    Element {
        position: body.at_position(moment / area).position,
        normal: vector.normalize_or_zero(),
        area,
        u_axis: DVec3::X,
        albedo: faces.iter().map(|e| e.albedo * e.area).sum::<f64>() / area,
    }
}

const NOTHING: Element = Element {
    position: DVec3::ZERO,
    normal: DVec3::ZERO,
    area: 0.0,
    u_axis: DVec3::X,
    albedo: 0.0,
};

/// What lies in a cell so far.
#[derive(Clone, Copy, Default)]
struct Part {
    area: f64,
    moment: DVec3,
    vector: DVec3,
    /// ∫ρ dA.
    light: f64,
}

fn cells(body: &Instance, albedo: &Texture, grid: Grid) -> Vec<Element> {
    let mut parts = vec![Part::default(); grid.count[0] * grid.count[1]];
    let uv = body.mesh().uv().unwrap_or_default();
    for (t, uv) in uv.iter().enumerate() {
        let [a, b, c] = body.corners(t as u32);
        let area = body.triangle_area(t as u32);
        if area <= 0.0 {
            continue;
        }
        let normal = body.on_triangle(t as u32, a).normal;
        for piece in grid.cut(pieces::whole(*uv)) {
            let (share, moment) = pieces::share_and_moment(&piece.corners);
            let part = &mut parts[piece.cell];
            part.area += area * share;
            part.moment += (a * moment.x + b * moment.y + c * moment.z) * area;
            part.vector += normal * (area * share);
            part.light += area * pieces::albedo(albedo, piece.corners);
        }
    }
    parts
        .into_iter()
        .map(|part| {
            let normal = part.vector.try_normalize();
            let (Some(normal), true) = (normal, part.area > 0.0) else {
                return NOTHING;
            };
            let point = body.at_position(part.moment / part.area);
            Element {
                position: point.position,
                normal,
                area: part.area,
                u_axis: DVec3::X,
                albedo: part.light / part.area,
            }
        })
        .collect()
}
