//! A photograph with what was found in it.

use super::colour::Rgb;
use super::encode::{PictureError, rgb};

/// A photograph, and places in it: columns and rows, (0, 0) the centre of the upper left pixel.
#[derive(Clone, Debug)]
pub struct Marked<'a> {
    /// Columns and rows.
    pub size: [usize; 2],
    /// Row by row from the top.
    pub values: &'a [f64],
    /// The border of the scene's view.
    pub outline: Vec<[f64; 2]>,
    /// The laser's spots.
    pub spots: Vec<[f64; 2]>,
    /// Marked points of the wall.
    pub marks: Vec<[f64; 2]>,
}

/// Largest side of the picture, px.
const SIDE: usize = 1024;
/// Smallest side: a photograph of fewer pixels is drawn larger.
const LEAST: usize = 256;
/// Orange, sky blue and bluish green of Okabe and Ito.
const OUTLINE: Rgb = [0xe6, 0x9f, 0x00];
const SPOT: Rgb = [0x56, 0xb4, 0xe9];
const MARK: Rgb = [0x00, 0x9e, 0x73];

/// The photograph as PNG, black at its least and white at its greatest value (√ in between), with
/// the view's border (orange), spots (blue, straight crosses) and marks (green, slanting ones).
///
/// # Errors
/// [`PictureError`].
pub fn photograph_png(drawn: &Marked<'_>) -> Result<Vec<u8>, PictureError> {
    let [width, height] = drawn.size;
    let long = width.max(height).max(1);
    let scale = if long > SIDE {
        SIDE as f64 / long as f64
    } else {
        LEAST.div_ceil(long) as f64
    };
    let size = [width, height].map(|n| ((n as f64 * scale) as usize).max(1));
    let finite = || drawn.values.iter().filter(|x| x.is_finite());
    let low = finite().copied().fold(f64::INFINITY, f64::min);
    let high = finite().copied().fold(f64::NEG_INFINITY, f64::max);
    let mut pixels = Vec::with_capacity(3 * size[0] * size[1]);
    for row in 0..size[1] {
        for column in 0..size[0] {
            let [u, v] = [(column, width), (row, height)]
                .map(|(k, n)| (((k as f64 + 0.5) / scale) as usize).min(n - 1));
            let part = (drawn.values[u + v * width] - low) / (high - low);
            let code = (255.0 * part.clamp(0.0, 1.0).sqrt()).round() as u8;
            pixels.extend([code; 3]);
        }
    }
    let mut canvas = Canvas {
        size,
        pixels,
        scale,
    };
    for pair in drawn.outline.windows(2) {
        canvas.line(pair[0], pair[1]);
    }
    let straight = [[1.0, 0.0], [0.0, 1.0]];
    let slanting = [[1.0, 1.0], [1.0, -1.0]];
    drawn
        .spots
        .iter()
        .for_each(|at| canvas.cross(*at, straight, SPOT));
    drawn
        .marks
        .iter()
        .for_each(|at| canvas.cross(*at, slanting, MARK));
    rgb(size, &canvas.pixels, None)
}

struct Canvas {
    size: [usize; 2],
    pixels: Vec<u8>,
    scale: f64,
}

impl Canvas {
    /// Colours the pixel at a place of the picture, if it has one.
    fn dot(&mut self, [x, y]: [f64; 2], colour: Rgb) {
        let [width, height] = self.size;
        if x >= 0.0 && y >= 0.0 && x < width as f64 && y < height as f64 {
            let at = 3 * (x as usize + y as usize * width);
            self.pixels[at..at + 3].copy_from_slice(&colour);
        }
    }

    /// The place in the picture of a place in the photograph.
    fn place(&self, at: [f64; 2]) -> [f64; 2] {
        at.map(|x| (x + 0.5) * self.scale)
    }

    fn line(&mut self, from: [f64; 2], to: [f64; 2]) {
        let (from, to) = (self.place(from), self.place(to));
        let length = (to[0] - from[0]).abs().max((to[1] - from[1]).abs());
        // What lies far outside is not drawn step by step.
        if !length.is_finite() || length > 16.0 * SIDE as f64 {
            return;
        }
        let steps = length.ceil().max(1.0) as usize;
        for k in 0..=steps {
            let t = k as f64 / steps as f64;
            self.dot([0, 1].map(|i| from[i] + t * (to[i] - from[i])), OUTLINE);
        }
    }

    fn cross(&mut self, at: [f64; 2], arms: [[f64; 2]; 2], colour: Rgb) {
        let centre = self.place(at);
        for arm in arms {
            for k in -4..=4 {
                self.dot([0, 1].map(|i| centre[i] + f64::from(k) * arm[i]), colour);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::encode::decoded;
    use super::*;

    /// A photograph of 256 × 256 is drawn pixel by pixel: √ of its values, a mark's crossing where
    /// the mark is, a spot's, and a corner of the border.
    #[test]
    fn what_was_found_is_drawn_in_its_place() {
        let values: Vec<f64> = (0..65536).map(|q| f64::from(q % 256)).collect();
        let drawn = Marked {
            size: [256, 256],
            values: &values,
            outline: vec![[100.0, 10.0], [120.0, 10.0]],
            spots: vec![[50.0, 60.0]],
            marks: vec![[200.0, 30.0], [-9.0, 1e12]],
        };
        let (width, height, pixels) = decoded(&photograph_png(&drawn).unwrap());
        assert_eq!((width, height), (256, 256));
        let at = |u: usize, v: usize| &pixels[3 * (u + 256 * v)..][..3];
        assert_eq!(at(0, 5), [0, 0, 0]);
        assert_eq!(at(255, 5), [255, 255, 255]);
        // 255·√(64/255) = 127.7
        assert_eq!(at(64, 5), [128, 128, 128]);
        assert_eq!(at(110, 10), OUTLINE);
        assert_eq!(
            (at(50, 60), at(54, 60), at(50, 56)),
            (&SPOT[..], &SPOT[..], &SPOT[..])
        );
        assert_eq!(
            (at(200, 30), at(203, 33), at(203, 27)),
            (&MARK[..], &MARK[..], &MARK[..])
        );
    }
}
