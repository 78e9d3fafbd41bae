//! Faces with more than three corners, divided into triangles.
//!
//! By cutting ears (Meisters, *Polygons have ears*, 1975): a corner whose neighbours see each other
//! within the polygon goes with them as a triangle. Signed areas add up to the polygon's winding
//! numbers whatever the diagonals; of an outline that does not cross itself these are 1 inside and
//! 0 outside, so that triangles which all turn its way cover it once.

use super::{MeshFileError, fan};
use crate::geometry::DVec3;

/// How far corners may leave their common plane, over the largest side of their box.
const FLAT: f64 = 1e-3;
/// Crossings are looked for between all pairs of sides.
const MOST_CORNERS: usize = 4096;
const CURE: &str = "divide the face into triangles before the export";

type Point = [f64; 2];

/// Faces of more than three corners that stand before their vertices, as fans: the first triangle,
/// their number, and where the face stands in the file.
pub(super) type Early = Vec<(usize, usize, usize)>;

/// Divides `early` faces, whose vertices are known by now, and what their corners have `beside`.
///
/// # Errors
/// Those of [`triangles`].
pub(super) fn divide_early<T: Copy>(
    early: &Early,
    positions: &[DVec3],
    faces: &mut [[u32; 3]],
    mut beside: Option<&mut [[T; 3]]>,
    place: impl Fn(usize) -> String,
) -> Result<(), MeshFileError> {
    for &(first, count, at) in early {
        let own = first..first + count;
        let corners = corners_of_fan(&faces[own.clone()]);
        let places = corners.iter().map(|c| positions[*c as usize]);
        let divided = triangles(&places.collect::<Vec<_>>(), || place(at))?;
        put(&mut faces[own.clone()], &divided);
        if let Some(beside) = beside.as_deref_mut() {
            put(&mut beside[own], &divided);
        }
    }
    Ok(())
}

/// Puts other triangles between the corners of a fan in its place.
fn put<T: Copy>(fan: &mut [[T; 3]], divided: &[[usize; 3]]) {
    let corners = corners_of_fan(fan);
    for (triangle, by) in fan.iter_mut().zip(divided) {
        *triangle = by.map(|k| corners[k]);
    }
}

/// The corners of a face by its fan.
fn corners_of_fan<T: Copy>(fan: &[[T; 3]]) -> Vec<T> {
    let first = fan.iter().take(1).flat_map(|t| [t[0], t[1]]);
    first.chain(fan.iter().map(|t| t[2])).collect()
}

/// n − 2 triangles between the given corners, by their numbers: the fan of the first corner where
/// the polygon is convex.
///
/// # Errors
/// [`MeshFileError::Malformed`] at `place` unless the corners lie in a plane and make an outline
/// that does not cross itself.
pub(super) fn triangles(
    corners: &[DVec3],
    place: impl Fn() -> String,
) -> Result<Vec<[usize; 3]>, MeshFileError> {
    let is_finite = corners.iter().all(|p| p.is_finite());
    // A vertex that is not a number is a defect of the triangles.
    if corners.len() < 4 || !is_finite {
        return Ok(fan(corners.len()));
    }
    let refused = |cause: String| MeshFileError::Malformed {
        place: place(),
        cause,
        cure: CURE,
    };
    let (normal, size) = plane(corners);
    if normal == DVec3::ZERO {
        return if are_in_line(corners, size) {
            Ok(fan(corners.len()))
        } else {
            Err(refused("the sides of the face cross each other".to_owned()))
        };
    }
    let height = |p: &DVec3| (*p - corners[0]).dot(normal);
    let (low, high) = corners
        .iter()
        .map(height)
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| {
            (l.min(x), h.max(x))
        });
    if high - low > FLAT * size {
        let off = (high - low) / size;
        let cause =
            format!("the face is not flat: its corners leave a plane by {off:.1e} of its size");
        return Err(refused(cause));
    }
    // Along the axis nearest to the normal, turned so that the front stays counterclockwise.
    let [x, y, z] = normal.to_array();
    let largest = normal.abs().max_element();
    let flat = |p: &DVec3| match (x.abs() == largest, y.abs() == largest) {
        (true, _) => [p.y * x.signum(), p.z],
        (_, true) => [p.z * y.signum(), p.x],
        _ => [p.x * z.signum(), p.y],
    };
    let outline: Vec<Point> = corners.iter().map(flat).collect();
    if is_convex(&outline) {
        return Ok(fan(corners.len()));
    }
    if outline.len() > MOST_CORNERS {
        let cause = format!(
            "a face of {} corners, {MOST_CORNERS} at most",
            outline.len()
        );
        return Err(refused(cause));
    }
    let whole = if crosses_itself(&outline) {
        None
    } else {
        ears(&outline)
    };
    whole.ok_or_else(|| refused("the sides of the face cross each other".to_owned()))
}

/// Unit normal of the mean plane (Newell's: Σ p_i × p_(i+1)), zero without area, and the largest
/// side of the box around the corners.
fn plane(corners: &[DVec3]) -> (DVec3, f64) {
    let ends = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let (low, high) = corners
        .iter()
        .fold(ends, |(l, h), p| (l.min(*p), h.max(*p)));
    let size = (high - low).max_element();
    let scaled = |p: DVec3| (p - corners[0]) / size;
    let sides = corners.windows(2).map(|w| scaled(w[0]).cross(scaled(w[1])));
    let area: DVec3 = sides.sum();
    if area.length() > 1e-12 {
        (area.normalize(), size)
    } else {
        (DVec3::ZERO, size)
    }
}

fn are_in_line(corners: &[DVec3], size: f64) -> bool {
    let from = corners[0];
    let furthest = corners
        .iter()
        .map(|p| *p - from)
        .reduce(|a, b| if b.length() > a.length() { b } else { a });
    let Some(along) = furthest.and_then(DVec3::try_normalize) else {
        return true;
    };
    let off = |p: &DVec3| (*p - from).cross(along).length();
    corners.iter().all(|p| off(p) <= 1e-12 * size)
}

/// Twice the area of a triangle, positive where it runs counterclockwise.
fn turn(a: Point, b: Point, c: Point) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// Whether every corner turns left, and all of them together once: then x grows along one run of
/// the sides, and falls along another.
fn is_convex(outline: &[Point]) -> bool {
    let n = outline.len();
    let corner = |i: usize| turn(outline[i], outline[(i + 1) % n], outline[(i + 2) % n]) > 0.0;
    let grows = |i: usize| outline[(i + 1) % n][0] > outline[i % n][0];
    (0..n).all(corner) && (0..n).filter(|i| grows(*i) != grows(i + 1)).count() == 2
}

/// Whether two sides cross within both; sides that touch do not.
fn crosses_itself(outline: &[Point]) -> bool {
    let n = outline.len();
    let side = |i: usize| (outline[i], outline[(i + 1) % n]);
    let apart = |p: f64, q: f64| (p > 0.0 && q < 0.0) || (p < 0.0 && q > 0.0);
    (0..n).any(|i| {
        let (a, b) = side(i);
        (i + 2..n).any(|k| {
            let (c, d) = side(k);
            apart(turn(a, b, c), turn(a, b, d)) && apart(turn(c, d, a), turn(c, d, b))
        })
    })
}

/// Ear after ear; `None` if none is left before the end. A corner on a straight line goes last,
/// with a triangle without area.
fn ears(outline: &[Point]) -> Option<Vec<[usize; 3]>> {
    let mut left: Vec<usize> = (0..outline.len()).collect();
    let around = |left: &[usize], i: usize| {
        let n = left.len();
        [left[(i + n - 1) % n], left[i], left[(i + 1) % n]]
    };
    // Cutting an ear changes what its two neighbours are, and nothing else (O'Rourke,
    // Computational Geometry in C, 1998).
    let mut is_ear: Vec<bool> = (0..left.len())
        .map(|i| can_go(outline, &left, around(&left, i)))
        .collect();
    let mut found = Vec::with_capacity(outline.len() - 2);
    while left.len() > 3 {
        let straight = |i: &usize| {
            let [a, b, c] = around(&left, *i).map(|k| outline[k]);
            turn(a, b, c) == 0.0
        };
        let at = match is_ear.iter().position(|e| *e) {
            Some(at) => at,
            None => (0..left.len()).find(straight)?,
        };
        found.push(around(&left, at));
        left.remove(at);
        is_ear.remove(at);
        let n = left.len();
        for i in [(at + n - 1) % n, at % n] {
            is_ear[i] = can_go(outline, &left, around(&left, i));
        }
    }
    let [a, b, c] = around(&left, 1).map(|k| outline[k]);
    found.push(around(&left, 1));
    (turn(a, b, c) >= 0.0).then_some(found)
}

/// Whether a corner turns left, and no other lies in the triangle with its neighbours.
fn can_go(outline: &[Point], left: &[usize], triangle: [usize; 3]) -> bool {
    let [a, b, c] = triangle.map(|k| outline[k]);
    let inside = |k: &usize| {
        let p = outline[*k];
        let away = p != a && p != b && p != c;
        away && turn(a, b, p) >= 0.0 && turn(b, c, p) >= 0.0 && turn(c, a, p) >= 0.0
    };
    turn(a, b, c) > 0.0 && !left.iter().any(inside)
}

#[cfg(test)]
mod tests;
