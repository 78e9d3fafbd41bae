//! Labels that keep out of each other's way.

use super::svg::{Close, Svg, fill, shortened, stroke};

/// Size of the type, px.
pub(super) const SIZE: f64 = 12.0;
/// Width of a character of the type, rounded up, px.
pub(super) const CHARACTER: f64 = 7.2;
/// More characters than this are cut.
const LONGEST: usize = 34;

/// A rectangle: left, top, right, bottom.
type Area = [f64; 4];

/// Places for labels inside a frame.
pub(super) struct Labels {
    frame: Area,
    taken: Vec<Area>,
    marks: Vec<Area>,
}

impl Labels {
    /// For a frame given by its upper left corner and its size.
    pub(super) fn new([x, y]: [f64; 2], [w, h]: [f64; 2]) -> Self {
        Self {
            frame: [x, y, x + w, y + h],
            taken: Vec::new(),
            marks: Vec::new(),
        }
    }

    /// Asks labels to stay off an area, if they can.
    pub(super) fn avoid(&mut self, area: Area) {
        self.marks.push(area);
    }

    /// Writes `text` as near to `anchor` as is free, in `colour` with a white halo; from farther
    /// away with a thin line.
    pub(super) fn place(&mut self, svg: &mut Svg, anchor: [f64; 2], colour: &str, text: &str) {
        let text = shortened(text, LONGEST);
        let width = CHARACTER * text.chars().count() as f64;
        let ways = [
            [1.0, -1.0],
            [1.0, 1.0],
            [-1.0, -1.0],
            [-1.0, 1.0],
            [0.0, -1.0],
            [0.0, 1.0],
            [1.0, 0.0],
            [-1.0, 0.0],
        ];
        let candidates = [6.0, 16.0, 30.0, 46.0, 64.0, 84.0, 106.0, 130.0]
            .into_iter()
            .flat_map(|d| {
                ways.map(|[a, b]| {
                    let left = anchor[0] + a * d + 0.5 * (a - 1.0) * width;
                    let top = anchor[1] + b * d + 0.5 * (b - 1.0) * SIZE;
                    (d, [left, top, left + width, top + SIZE])
                })
            });
        // A long way to the label is worth no more than a few marks left free.
        let best = candidates
            .map(|(d, area)| (self.cost(area) + 2.0 * d, d, area))
            .min_by(|a, b| a.0.total_cmp(&b.0));
        let Some((_, distance, area)) = best else {
            return;
        };
        if distance > 6.0 {
            let near = [
                anchor[0].clamp(area[0], area[2]),
                anchor[1].clamp(area[1], area[3]),
            ];
            let style = stroke(colour, 0.7);
            svg.path(&[anchor, near], Close::No, &style);
        }
        halo(svg, [area[0], area[3] - 2.0], &fill(colour), &text);
        self.taken.push(area);
    }

    /// Area shared with marks, plus a hundred times that outside the frame or shared with other
    /// labels.
    fn cost(&self, area: Area) -> f64 {
        let size = (area[2] - area[0]) * (area[3] - area[1]);
        let outside = size - overlap(area, self.frame);
        let padded = [area[0] - 3.0, area[1] - 2.0, area[2] + 3.0, area[3] + 2.0];
        let shared = |with: &[Area]| with.iter().map(|t| overlap(padded, *t)).sum::<f64>();
        shared(&self.marks) + 100.0 * (shared(&self.taken) + outside)
    }
}

fn overlap(a: Area, b: Area) -> f64 {
    let side = |i: usize| (a[i + 2].min(b[i + 2]) - a[i].max(b[i])).max(0.0);
    side(0) * side(1)
}

/// Text with a white halo: drawn twice, which every viewer understands.
pub(super) fn halo(svg: &mut Svg, at: [f64; 2], style: &str, text: &str) {
    let under = format!(
        "fill=\"#fff\" stroke=\"#fff\" stroke-width=\"3.5\" stroke-linejoin=\"round\" font-size=\"{SIZE}\" aria-hidden=\"true\""
    );
    svg.text(at, &under, text);
    svg.text(at, &format!("{style} font-size=\"{SIZE}\""), text);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_of_one_place_do_not_overlap() {
        let mut labels = Labels::new([0.0, 0.0], [400.0, 300.0]);
        let mut svg = Svg::default();
        for i in 0..10 {
            labels.place(&mut svg, [200.0, 150.0], "#000", &format!("label {i}"));
        }
        for (i, a) in labels.taken.iter().enumerate() {
            assert!(
                labels.taken[..i].iter().all(|b| overlap(*a, *b) == 0.0),
                "{i}"
            );
            assert_eq!(
                overlap(*a, labels.frame),
                (a[2] - a[0]) * (a[3] - a[1]),
                "outside the frame"
            );
        }
    }

    #[test]
    fn labels_stay_inside_at_the_edge() {
        let mut labels = Labels::new([0.0, 0.0], [400.0, 300.0]);
        let mut svg = Svg::default();
        labels.place(&mut svg, [399.0, 1.0], "#000", "a long label at the corner");
        let [l, t, r, b] = labels.taken[0];
        assert!(l >= 0.0 && t >= 0.0 && r <= 400.0 && b <= 300.0);
    }
}
