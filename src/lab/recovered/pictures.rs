//! Pictures to recover, drawn by chance, each a square of elements of reflectances 0 to 1; and what
//! is measured with them.

use crate::num::stream::{Key, Sampling, Stream};

mod crops;
mod defaults;

/// Cells of a fine picture along an element.
const FINE: usize = 6;
/// Smallest radius of a leaf, in cells of the fine picture.
const SMALLEST: f64 = 2.0;

/// Random numbers of a picture.
fn stream(seed: u64, kind: u32) -> Stream {
    let key = Key {
        seed,
        spot: kind,
        pixel: 0,
        block: 0,
    };
    Stream::new(Sampling::Pcg, key)
}

/// Dead leaves (Matheron 1968; statistics of photographs: Lee, Mumford and Huang 2001): discs of
/// even greys, radii of density r^−3, each over those before it, until all is covered; light that
/// falls off from a corner by chance; averaged over the elements. Greys spread by `contrast` about
/// ½ on average.
fn leaves(elements: usize, contrast: f64, seed: u64) -> Vec<f64> {
    let random = &mut stream(seed, 1);
    let cells = elements * FINE;
    let mut fine = vec![f64::NAN; cells * cells];
    let mut left = fine.len();
    let largest = cells as f64;
    // The last disc first: what is covered stays.
    while left > 0 {
        let share = random.uniform();
        let inverse = (1.0 - share) / (SMALLEST * SMALLEST) + share / (largest * largest);
        let radius = inverse.sqrt().recip();
        let at = [(); 2].map(|()| random.uniform() * (largest + 2.0 * radius) - radius);
        let grey = random.uniform() - 0.5;
        let range = |x: f64| {
            let end = |y: f64| y.clamp(0.0, largest) as usize;
            end(x - radius)..end(x + radius + 1.0)
        };
        for y in range(at[1]) {
            for x in range(at[0]) {
                let off = [x as f64 + 0.5 - at[0], y as f64 + 0.5 - at[1]];
                let cell = &mut fine[x + y * cells];
                if cell.is_nan() && off[0] * off[0] + off[1] * off[1] <= radius * radius {
                    *cell = grey;
                    left -= 1;
                }
            }
        }
    }
    let slope = [(); 2].map(|()| 0.5 * (random.uniform() - 0.5));
    let middle = 0.35 + 0.3 * random.uniform();
    let element = |j: usize| {
        let [x, y] = [j % elements, j / elements];
        let cell = |k: usize| fine[x * FINE + k % FINE + (y * FINE + k / FINE) * cells];
        let mean = (0..FINE * FINE).map(cell).sum::<f64>() / (FINE * FINE) as f64;
        let along = |k: usize| (k as f64 + 0.5) / elements as f64 - 0.5;
        let shade = slope[0] * along(x) + slope[1] * along(y);
        (middle + contrast * (mean + shade)).clamp(0.0, 1.0)
    };
    (0..elements * elements).map(element).collect()
}

/// Capital letters of 5 × 7 cells, a row a byte.
const LETTERS: [[u8; 7]; 10] = [
    [0x0e, 0x11, 0x11, 0x1f, 0x11, 0x11, 0x11], // A
    [0x1f, 0x10, 0x10, 0x1e, 0x10, 0x10, 0x1f], // E
    [0x1f, 0x10, 0x10, 0x1e, 0x10, 0x10, 0x10], // F
    [0x11, 0x11, 0x11, 0x1f, 0x11, 0x11, 0x11], // H
    [0x11, 0x12, 0x14, 0x18, 0x14, 0x12, 0x11], // K
    [0x10, 0x10, 0x10, 0x10, 0x10, 0x10, 0x1f], // L
    [0x1e, 0x11, 0x11, 0x1e, 0x10, 0x10, 0x10], // P
    [0x1e, 0x11, 0x11, 0x1e, 0x14, 0x12, 0x11], // R
    [0x1f, 0x04, 0x04, 0x04, 0x04, 0x04, 0x04], // T
    [0x1f, 0x01, 0x02, 0x04, 0x08, 0x10, 0x1f], // Z
];

/// A letter on 7 `times` as many elements a side: light on dark.
fn letter(which: usize, times: usize) -> Vec<bool> {
    let (rows, side) = (LETTERS[which % LETTERS.len()], 7 * times);
    let lit = |j: usize| {
        let (x, y) = (j % side / times, j / side / times);
        (1..6).contains(&x) && rows[6 - y] >> (5 - x) & 1 == 1
    };
    (0..side * side).map(lit).collect()
}

/// A board of so many fields a side, the first dark.
fn board(elements: usize, fields: usize) -> Vec<bool> {
    let cell = |k: usize| k * fields / elements;
    let odd = |j: usize| (cell(j % elements) + cell(j / elements)) % 2 == 1;
    (0..elements * elements).map(odd).collect()
}

/// A pattern of two levels.
fn of_levels(light: &[bool], levels: [f64; 2]) -> Vec<f64> {
    light.iter().map(|l| levels[usize::from(*l)]).collect()
}

/// The generator itself: what is known of dead leaves. Of even greys the variance of a point is
/// 1/12 of the contrast's square; and elements hang together less, the further apart they are.
#[test]
fn leaves_are_natural() {
    let (elements, pictures) = (16, 60);
    let (mut variance, mut at) = (0.0, [0.0; 4]);
    for seed in 0..pictures {
        let picture = leaves(elements, 0.4, seed);
        let mean = picture.iter().sum::<f64>() / picture.len() as f64;
        for (j, x) in picture.iter().enumerate() {
            variance += (x - mean).powi(2);
            for (k, apart) in [1, 2, 4, 8].into_iter().enumerate() {
                if j % elements + apart < elements {
                    let count = (elements - apart) as f64 / elements as f64;
                    at[k] += (x - mean) * (picture[j + apart] - mean) / count;
                }
            }
        }
    }
    let [one, two, four, eight] = at.map(|covariance| covariance / variance);
    let told = format!("{one} {two} {four} {eight}");
    assert!(
        one > 0.5 && one > two && two > four && four > eight,
        "{told}"
    );
}
