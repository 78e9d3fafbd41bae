//! Three-bar groups in the manner of the resolution chart of 1951 (MIL-STD-150A): six elements to
//! each halving, bars five times as long as wide and as far apart as they are wide.

use super::Picture;
use super::figure::Figure;

/// Width and height of the chart in bars of the first element: 2 beside its figures of 12, 4
/// between the two columns, 6 for the second.
const CHART: [f64; 2] = [26.0, 36.0];

/// Elements of a group, and the groups: the first on the left, the others one below the other on
/// the right.
const ELEMENTS: usize = 6;
const GROUPS: usize = 4;

pub(super) fn draw(size: [usize; 2]) -> Picture {
    let [w, h] = size.map(|n| n as f64);
    let scale = (w / CHART[0]).min(h / CHART[1]);
    let corner = [0.5 * (w - CHART[0] * scale), 0.5 * (h - CHART[1] * scale)];
    let mut ink = Figure::new(size);
    let mut bar = |x: f64, y: f64, w: f64, h: f64| {
        let [x0, y0] = [corner[0] + scale * x, corner[1] + scale * y];
        let [x1, y1] = [x0 + scale * w, y0 + scale * h];
        ink.add(&[[x0, y0], [x1, y0], [x1, y1], [x0, y1]]);
    };
    let [left, right, top] = [2.0, 18.0, 2.0];
    let mut y = top;
    for k in 0..ELEMENTS * GROUPS {
        if k == ELEMENTS {
            y = top;
        }
        let x = if k < ELEMENTS { left } else { right };
        let width = libm::exp2(-(k as f64) / ELEMENTS as f64);
        for i in 0..3 {
            let across = 2.0 * f64::from(i) * width;
            bar(x + across, y, width, 5.0 * width);
            bar(x + 7.0 * width, y + across, 5.0 * width, width);
        }
        y += 7.0 * width;
    }
    let mut picture = Picture::flat(size, 1.0);
    picture.paint(&ink, 0.0);
    picture
}
