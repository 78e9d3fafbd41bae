//! Division of hidden surfaces into resolution elements.

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
    /// [`Surface::lambertian_equivalent`]; of a cell of a mesh's texture coordinates that at its
    /// middle; of a single point ([`Surface::element_at`]) the texture's value.
    pub albedo: f64,
}

impl Surface {
    /// The elements, iu + iv·nu. Of rectangles, discs and spheres cells of equal area in their
    /// parameters, taken at their middle. Of a mesh the triangles, at their centroids; or the cells
    /// of its texture coordinates: each has the area of what the coordinates put there (the
    /// triangles clipped), the direction of that part's vector area as its normal, and the point of
    /// the mesh nearest to its centroid.
    pub fn divided(&self, [nu, nv]: [usize; 2]) -> Vec<Element> {
        let matt = self.lambertian_equivalent();
        match (&matt.shape, matt.division) {
            (Shape::Instance(body), Division::Faces) => faces(body, &matt.albedo),
            (Shape::Instance(body), Division::Cells) => cells(body, &matt.albedo, [nu, nv]),
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
        let largest = |uv: &[[f32; 2]; 3]| {
            let parts = shares(uv.map(|c| c.map(f64::from)), count);
            let most = parts.into_iter().max_by(|a, b| a.1.total_cmp(&b.1));
            most.map_or(0, |part| part.0)
        };
        uv.iter().map(largest).collect()
    }

    /// The point of the surface with parameters `uv` (of a mesh: to which its equal-area map takes
    /// them), without area.
    pub fn element_at(&self, uv: [f64; 2]) -> Element {
        let at = |uv| self.shape.at(uv);
        let point = at(uv);
        let along = match self.shape {
            Shape::Instance(_) => DVec3::ZERO,
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
    (0..body.mesh().triangles().len() as u32)
        .map(|t| {
            let [a, b, c] = body.corners(t);
            let area = body.triangle_area(t);
            let point = body.on_triangle(t, (a + b + c) / 3.0);
            if area > 0.0 {
                Element {
                    position: point.position,
                    normal: point.normal,
                    area,
                    u_axis: (b - a).normalize_or(DVec3::X),
                    albedo: albedo.albedo(point.uv),
                }
            } else {
                NOTHING
            }
        })
        .collect()
}

/// Faces as one element: their area, mean albedo, direction of the vector area, and the point of the
/// mesh nearest to the centroid.
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
}

/// A corner of a polygon in texture coordinates (in cells), and its weights in the triangle.
type Corner = ([f64; 2], DVec3);

fn cells(body: &Instance, albedo: &Texture, [nu, nv]: [usize; 2]) -> Vec<Element> {
    let mut parts = vec![Part::default(); nu * nv];
    let uv = body.mesh().uv().unwrap_or_default();
    for (t, uv) in uv.iter().enumerate() {
        let corners = body.corners(t as u32);
        let [a, b, c] = corners;
        let vector = (b - a).cross(c - a) * 0.5;
        let area = vector.length();
        if area <= 0.0 {
            continue;
        }
        let place = |weights: DVec3| a * weights.x + b * weights.y + c * weights.z;
        for (cell, share, middle) in shares(uv.map(|c| c.map(f64::from)), [nu, nv]) {
            let part = &mut parts[cell];
            part.area += area * share;
            part.moment += place(middle) * (area * share);
            part.vector += body.on_triangle(t as u32, a).normal * (area * share);
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
                albedo: albedo.albedo(point.uv),
            }
        })
        .collect()
}

/// The cells that a triangle with these texture coordinates covers: cell, share of the triangle's
/// area, and the weights of the three corners at the middle of that share. Coordinates beyond \[0,
/// 1\] are taken modulo 1, a triangle as a whole.
fn shares(uv: [[f64; 2]; 3], [nu, nv]: [usize; 2]) -> Vec<(usize, f64, DVec3)> {
    let count = [nu, nv];
    let mut corners = uv;
    for d in 0..2 {
        let whole = ((uv[0][d] + uv[1][d] + uv[2][d]) / 3.0).floor();
        let shift = if whole == 1.0 && uv.iter().all(|c| c[d] <= 1.0) {
            0.0
        } else {
            whole
        };
        for c in &mut corners {
            c[d] = ((c[d] - shift) * count[d] as f64).clamp(0.0, count[d] as f64);
        }
    }
    let range = |d: usize| {
        let low = corners.iter().map(|c| c[d]).fold(f64::INFINITY, f64::min);
        let high = corners.iter().map(|c| c[d]).fold(0.0, f64::max);
        let first = (low as usize).min(count[d] - 1);
        first..=(high as usize).min(count[d] - 1)
    };
    let weights = [DVec3::X, DVec3::Y, DVec3::Z];
    let whole: Vec<Corner> = corners.into_iter().zip(weights).collect();
    let total = area_and_middle(&whole).0;
    let [columns, rows] = [range(0), range(1)];
    // A triangle within one cell, or without extent in the picture, counts whole where its middle
    // is.
    if total <= 0.0 || (columns.start() == columns.end() && rows.start() == rows.end()) {
        let at = |d: usize| {
            let middle = (corners[0][d] + corners[1][d] + corners[2][d]) / 3.0;
            (middle as usize).min(count[d] - 1)
        };
        return vec![(at(0) + at(1) * nu, 1.0, DVec3::splat(1.0 / 3.0))];
    }
    let mut found = Vec::new();
    for row in rows {
        let strip = clip(
            clip(whole.clone(), 1, row as f64, 1.0),
            1,
            row as f64 + 1.0,
            -1.0,
        );
        for column in columns.clone() {
            let x = column as f64;
            let inside = clip(clip(strip.clone(), 0, x, 1.0), 0, x + 1.0, -1.0);
            let (area, middle) = area_and_middle(&inside);
            if area > 0.0 {
                found.push((column + row * nu, area / total, middle));
            }
        }
    }
    found
}

/// The part of a convex polygon where sign·(x_d − at) ≥ 0 (Sutherland and Hodgman, 1974).
fn clip(polygon: Vec<Corner>, d: usize, at: f64, sign: f64) -> Vec<Corner> {
    let height = |c: &Corner| sign * (c.0[d] - at);
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (i, from) in polygon.iter().enumerate() {
        let to = &polygon[(i + 1) % polygon.len()];
        let (a, b) = (height(from), height(to));
        if a >= 0.0 {
            kept.push(*from);
        }
        if (a > 0.0 && b < 0.0) || (a < 0.0 && b > 0.0) {
            let t = a / (a - b);
            let mid = [0, 1].map(|k| from.0[k] + (to.0[k] - from.0[k]) * t);
            kept.push((mid, from.1 + (to.1 - from.1) * t));
        }
    }
    kept
}

/// Area of a convex polygon in the picture, and the weights at its centroid.
fn area_and_middle(polygon: &[Corner]) -> (f64, DVec3) {
    let Some((origin, _)) = polygon.first() else {
        return (0.0, DVec3::ZERO);
    };
    let (mut area, mut moment) = (0.0, DVec3::ZERO);
    for pair in polygon[1..].windows(2) {
        let [p, q] = [pair[0].0, pair[1].0].map(|c| [c[0] - origin[0], c[1] - origin[1]]);
        let part = 0.5 * (p[0] * q[1] - p[1] * q[0]).abs();
        area += part;
        moment += (polygon[0].1 + pair[0].1 + pair[1].1) * (part / 3.0);
    }
    if area > 0.0 {
        (area, moment / area)
    } else {
        (0.0, DVec3::ZERO)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Shares add up to 1 and their middles to the triangle's; a right triangle over a 2 × 2 grid
    /// covers two cells of it by half a cell, one whole, one not at all.
    #[test]
    fn shares_of_a_triangle_are_its_parts() {
        let half = shares([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]], [2, 2]);
        let share = |cell| half.iter().find(|s| s.0 == cell).map_or(0.0, |s| s.1);
        for (cell, part) in [(0, 0.5), (1, 0.25), (2, 0.25), (3, 0.0)] {
            assert!(
                (share(cell) - part).abs() < 1e-15,
                "{cell}: {}",
                share(cell)
            );
        }
        for grid in [[1, 1], [3, 2], [7, 5], [64, 64]] {
            for uv in [
                [[0.1, 0.2], [0.9, 0.3], [0.4, 0.95]],
                [[0.0, 0.0], [1.0, 1.0], [1.0, 0.0]],
                [[1.2, 3.1], [1.7, 3.4], [1.3, 3.9]],
            ] {
                let parts = shares(uv, grid);
                let total: f64 = parts.iter().map(|p| p.1).sum();
                let middle: DVec3 = parts.iter().map(|p| p.2 * p.1).sum();
                assert!((total - 1.0).abs() < 1e-12, "{grid:?} {uv:?}: {total}");
                assert!((middle - DVec3::splat(1.0 / 3.0)).length() < 1e-12);
            }
        }
    }
}
