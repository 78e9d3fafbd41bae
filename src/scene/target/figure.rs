//! Coverage of pixels by outlines.

use std::f64::consts::{PI, TAU};

/// A point, x to the right and y downwards, in pixels from the upper left corner.
pub(super) type Point = [f64; 2];

/// A figure of one ink: the sum of polygons, with holes.
///
/// The part of a pixel that a polygon covers is computed exactly, by Green's theorem: each edge
/// adds to every pixel of the rows that it crosses its height in that row times the part of the
/// pixel on its right, with its sign. Where polygons of one figure overlap the sum ends at 1, so
/// that it is exact there too unless two outlines cross in the same pixel.
pub struct Figure {
    size: [usize; 2],
    /// Row by row, width + 1 each: differences of the coverage from the pixel on the left.
    steps: Vec<f64>,
}

impl Figure {
    /// Nothing, over a picture of so many columns and rows.
    pub fn new(size: [usize; 2]) -> Self {
        Self {
            size,
            steps: vec![0.0; (size[0] + 1) * size[1]],
        }
    }

    /// Adds the inside of a simple polygon, given in either sense. What lies outside the picture is
    /// cut off.
    pub fn add(&mut self, outline: &[Point]) {
        self.fill(outline, 1.0);
    }

    /// Takes the inside of a simple polygon away, which must have been added before.
    pub fn cut(&mut self, outline: &[Point]) {
        self.fill(outline, -1.0);
    }

    /// The covered part of each pixel, row by row from the top.
    pub fn coverage(&self) -> Vec<f64> {
        let width = self.size[0];
        let mut covered = Vec::with_capacity(width * self.size[1]);
        for row in self.steps.chunks_exact(width + 1) {
            let mut sum = 0.0;
            covered.extend(row[..width].iter().map(|step| {
                sum += step;
                f64::clamp(sum, 0.0, 1.0)
            }));
        }
        covered
    }

    fn fill(&mut self, outline: &[Point], sign: f64) {
        let edges = || outline.iter().zip(outline.iter().cycle().skip(1));
        // Twice the area; the left side of a polygon of positive area is walked upwards.
        let area: f64 = edges().map(|(p, q)| p[0] * q[1] - p[1] * q[0]).sum();
        for (p, q) in edges() {
            self.edge(*p, *q, -sign * area.signum());
        }
    }

    /// Adds one edge: in each pixel that it crosses, its height there times the part on its right,
    /// and its whole height to those further right.
    fn edge(&mut self, p: Point, q: Point, sign: f64) {
        let [width, height] = self.size;
        let at = |t: f64| [p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1])];
        // Where it crosses from pixel to pixel.
        let mut cuts = vec![0.0, 1.0];
        for (axis, most) in [(0, width), (1, height)] {
            let (a, b) = (p[axis], q[axis]);
            let first = a.min(b).ceil().max(0.0) as usize;
            let last = a.max(b).floor().min(most as f64);
            if a != b && last >= 0.0 {
                cuts.extend(
                    (first..=last as usize).map(|n| ((n as f64 - a) / (b - a)).clamp(0.0, 1.0)),
                );
            }
        }
        cuts.sort_unstable_by(f64::total_cmp);
        for pair in cuts.windows(2) {
            let [from, to] = [at(pair[0]), at(pair[1])];
            let middle = [0.5 * (from[0] + to[0]), 0.5 * (from[1] + to[1])];
            if middle[1] < 0.0 || middle[1] >= height as f64 || middle[0] >= width as f64 {
                continue;
            }
            let x = middle[0].max(0.0);
            let column = x as usize;
            let index = middle[1] as usize * (width + 1) + column;
            let left = x - column as f64;
            let rise = sign * (to[1] - from[1]);
            self.steps[index] += rise * (1.0 - left);
            self.steps[index + 1] += rise * left;
        }
    }
}

/// A disc as a regular polygon of the same area.
pub(super) fn disc(centre: Point, radius: f64, corners: usize) -> Vec<Point> {
    let step = TAU / corners as f64;
    let radius = radius * (step / libm::sin(step)).sqrt();
    let angles = (0..corners).map(|k| k as f64 * step);
    angles.map(|a| on_circle(centre, radius, a)).collect()
}

/// The arc around `centre` between two angles, from +x towards +y (downwards), by its points each
/// 2° or less.
pub(super) fn arc(centre: Point, radius: f64, [from, to]: [f64; 2]) -> Vec<Point> {
    let pieces = ((to - from).abs() / PI * 90.0).ceil().max(1.0) as usize;
    let angle = |k: usize| from + (to - from) * k as f64 / pieces as f64;
    (0..=pieces)
        .map(|k| on_circle(centre, radius, angle(k)))
        .collect()
}

fn on_circle(centre: Point, radius: f64, angle: f64) -> Point {
    let [c, s] = [libm::cos(angle), libm::sin(angle)];
    [centre[0] + radius * c, centre[1] + radius * s]
}

/// The cubic Bézier curve of four points, by 24 of its points without the first.
pub(super) fn curve([a, b, c, d]: [Point; 4]) -> impl Iterator<Item = Point> {
    (1..=24).map(move |k| {
        let t = f64::from(k) / 24.0;
        let s = 1.0 - t;
        let [wa, wb, wc, wd] = [s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t];
        [0, 1].map(|i| wa * a[i] + wb * b[i] + wc * c[i] + wd * d[i])
    })
}

/// The outline of a stroke of `width` along a smooth line.
pub(super) fn stroke(line: &[Point], width: f64) -> Vec<Point> {
    let side = |sign: f64| {
        (0..line.len()).map(move |k| {
            let (p, q) = (line[k.saturating_sub(1)], line[(k + 1).min(line.len() - 1)]);
            let [dx, dy] = [q[0] - p[0], q[1] - p[1]];
            let scale = sign * 0.5 * width / (dx * dx + dy * dy).sqrt();
            [line[k][0] - scale * dy, line[k][1] + scale * dx]
        })
    };
    side(1.0).chain(side(-1.0).rev()).collect()
}
