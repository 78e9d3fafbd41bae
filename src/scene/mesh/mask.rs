//! Flat masks of opaque and open cells.

use std::ops::Range;

use super::Triangles;
use crate::geometry::DVec3;

/// Where a row of cells is opaque: neighbours as one.
pub fn opaque_runs(row: &[bool]) -> impl Iterator<Item = Range<usize>> {
    let mut end = 0;
    let run = move |run: &[bool]| {
        let start = end;
        end += run.len();
        run[0].then_some(start..end)
    };
    row.chunk_by(|a, b| a == b).filter_map(run)
}

/// The unit square \[0, 1\]² in the plane z = 0, front towards +z, where `rows` have a `#`, the
/// first row at y = 1; open where they have a `.`. Neighbours in a row are one rectangle. u is x, v
/// is y.
///
/// # Errors
/// What is wrong with the rows, and how to mend it.
pub fn mask(rows: &[String]) -> Result<Triangles, (String, &'static str)> {
    let cells: Vec<Vec<char>> = rows.iter().map(|row| row.chars().collect()).collect();
    let (nv, nu) = (cells.len(), cells.first().map_or(0, Vec::len));
    if nu == 0 {
        return Err(("the mask has no cells".to_owned(), "give rows of # and ."));
    }
    if let Some(row) = cells.iter().position(|row| row.len() != nu) {
        let cause = format!(
            "row {} of the mask has another length than the first",
            row + 1
        );
        return Err((cause, "give every row the same number of cells"));
    }
    let mut made = Triangles::default();
    let mut uvs = Vec::new();
    for (j, row) in cells.iter().enumerate() {
        if let Some(c) = row.iter().find(|c| !matches!(c, '#' | '.')) {
            let cause = format!("a mask has no cells `{c}`");
            return Err((cause, "use # for opaque cells and . for open ones"));
        }
        let y = [nv - 1 - j, nv - j].map(|k| k as f64 / nv as f64);
        let opaque: Vec<bool> = row.iter().map(|c| *c == '#').collect();
        for run in opaque_runs(&opaque) {
            let x = [run.start, run.end].map(|k| k as f64 / nu as f64);
            let first = made.positions.len() as u32;
            let corners = [[x[0], y[0]], [x[1], y[0]], [x[1], y[1]], [x[0], y[1]]];
            let place = corners.map(|[x, y]| DVec3::new(x, y, 0.0));
            made.positions.extend(place);
            for triangle in [[0, 1, 2], [0, 2, 3]] {
                made.triangles.push(triangle.map(|k| first + k));
                uvs.push(triangle.map(|k| corners[k as usize]));
            }
        }
    }
    if made.triangles.is_empty() {
        let cause = "the mask has no opaque cell".to_owned();
        return Err((cause, "use # for opaque cells"));
    }
    made.uv = Some(uvs);
    Ok(made)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn opaque_cells_are_where_they_are_drawn() {
        let rows = ["##.", ".#."].map(str::to_owned);
        let made = mask(&rows).unwrap();
        let triangle = |t: &[u32; 3]| t.map(|k| made.positions[k as usize]);
        let area = |[a, b, c]: [DVec3; 3]| 0.5 * (b - a).cross(c - a).z;
        let areas: Vec<f64> = made.triangles.iter().map(|t| area(triangle(t))).collect();
        // Two cells of the upper row, one of the lower, each a sixth; all fronts up.
        let expected = [1.0 / 6.0, 1.0 / 6.0, 1.0 / 12.0, 1.0 / 12.0];
        assert!(
            areas
                .iter()
                .zip(expected)
                .all(|(a, b)| (a - b).abs() < 1e-15)
        );
        assert!(made.positions[..4].iter().all(|p| p.y >= 0.5 && p.x < 0.7));
        for bad in [
            &["#", "##"][..],
            &[][..],
            &["#x"][..],
            &["."][..],
            &[""][..],
        ] {
            let rows: Vec<String> = bad.iter().map(|r| (*r).to_owned()).collect();
            assert!(mask(&rows).is_err(), "{bad:?}");
        }
    }
}
