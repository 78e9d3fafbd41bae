//! Numbers inside of a page.
//!
//! The values, as f64 or as f32 with so many bits of their mantissa, are taken as integers; of
//! these differences along the block are taken none to three times, whichever packs best (smooth
//! matrices shrink, noise does not); all first bytes come first, then all second ones, and so on;
//! the whole is deflated and written in base64. `page.js` takes the same steps back.

use std::io::Write;

use flate2::Compression;
use flate2::write::ZlibEncoder;

use super::super::encode::base64;

/// How exactly numbers are kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in super::super) enum Precision {
    /// All 64 bits.
    Exact,
    /// As f32 with so many of the 23 bits of its mantissa, rounded to nearest: a relative error of
    /// at most 2^−(bits+1).
    Single(u32),
}

/// Numbers, packed.
pub(in super::super) struct Packed {
    count: usize,
    width: usize,
    order: u32,
    base64: String,
}

/// Differences are taken at most so often.
const MOST_ORDER: u32 = 3;
/// Words on which the number of differences is tried.
const TRIED: usize = 1 << 15;

impl Packed {
    /// Packs values.
    pub(in super::super) fn new(values: &[f64], precision: Precision) -> Self {
        let (width, words): (usize, Vec<u64>) = match precision {
            Precision::Exact => (8, values.iter().map(|x| x.to_bits()).collect()),
            Precision::Single(bits) => (
                4,
                values
                    .iter()
                    .map(|x| u64::from(rounded(*x as f32, bits)))
                    .collect(),
            ),
        };
        // What packs best in the beginning packs best.
        let beginning = &words[..words.len().min(TRIED)];
        let tried =
            |order: &u32| deflated(&planes(&differences(beginning, *order, width), width)).len();
        let order = (0..=MOST_ORDER).min_by_key(tried).unwrap_or(0);
        let bytes = deflated(&planes(&differences(&words, order, width), width));
        Self {
            count: values.len(),
            width,
            order,
            base64: base64(&bytes),
        }
    }

    /// Bytes that it takes in a page.
    pub(in super::super) fn len(&self) -> usize {
        self.base64.len()
    }

    /// The element that holds it.
    pub(super) fn element(&self, id: &str) -> String {
        format!(
            "<script type=\"application/octet-stream\" id=\"{id}\" data-count=\"{}\" data-width=\"{}\" data-order=\"{}\">{}</script>\n",
            self.count, self.width, self.order, self.base64
        )
    }
}

/// The bits of x with its mantissa rounded to so many bits; what is not finite stays what it is.
fn rounded(x: f32, bits: u32) -> u32 {
    let drop = 23 - bits.min(23);
    if drop == 0 || !x.is_finite() {
        return x.to_bits();
    }
    // Rounding up may carry into the exponent, which is right: the next binade begins there. To
    // infinity it may not.
    let half = 1u32 << (drop - 1);
    let up = x.to_bits().wrapping_add(half) & !((1u32 << drop) - 1);
    if f32::from_bits(up).is_finite() {
        up
    } else {
        x.to_bits() & !((1u32 << drop) - 1)
    }
}

/// Differences of `order`, modulo 2^(8·width).
fn differences(words: &[u64], order: u32, width: usize) -> Vec<u64> {
    let mask = if width == 8 {
        u64::MAX
    } else {
        (1 << (8 * width)) - 1
    };
    let mut all = words.to_vec();
    for _ in 0..order {
        let mut before = 0;
        for word in &mut all {
            let this = *word;
            *word = this.wrapping_sub(before) & mask;
            before = this;
        }
    }
    all
}

/// The lowest byte of every word, then the next of every word, and so on.
fn planes(words: &[u64], width: usize) -> Vec<u8> {
    (0..width)
        .flat_map(|k| words.iter().map(move |w| w.to_le_bytes()[k]))
        .collect()
}

fn deflated(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::new(6));
    // Writing into memory cannot fail.
    let _ = encoder.write_all(bytes);
    encoder.finish().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use std::io::Read;

    use base64::prelude::{BASE64_STANDARD, Engine};

    use super::*;

    /// The way back, written on its own.
    fn unpacked(packed: &Packed) -> Vec<f64> {
        let bytes = BASE64_STANDARD.decode(&packed.base64).unwrap();
        let mut planes = Vec::new();
        flate2::read::ZlibDecoder::new(&bytes[..])
            .read_to_end(&mut planes)
            .unwrap();
        let (n, width) = (packed.count, packed.width);
        assert_eq!(planes.len(), n * width);
        let mut words: Vec<u64> = (0..n)
            .map(|i| (0..width).fold(0, |w, k| w | u64::from(planes[k * n + i]) << (8 * k)))
            .collect();
        for _ in 0..packed.order {
            for i in 1..n {
                words[i] = words[i].wrapping_add(words[i - 1]);
            }
        }
        let value = |w: &u64| match width {
            8 => f64::from_bits(*w),
            _ => f64::from(f32::from_bits(*w as u32)),
        };
        words.iter().map(value).collect()
    }

    fn odd() -> Vec<f64> {
        vec![
            0.0,
            -0.0,
            1e-300,
            f64::MAX,
            f64::INFINITY,
            f64::NEG_INFINITY,
            3.5e-13,
            -2.25,
        ]
    }

    #[test]
    fn exact_numbers_come_back_with_all_their_bits() {
        for values in [
            odd(),
            Vec::new(),
            (0..1000).map(|i| libm::sin(f64::from(i) * 1e-2)).collect(),
        ] {
            let back = unpacked(&Packed::new(&values, Precision::Exact));
            let bits = |v: &[f64]| v.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
            assert_eq!(bits(&back), bits(&values));
        }
        assert!(unpacked(&Packed::new(&[f64::NAN], Precision::Exact))[0].is_nan());
    }

    /// Rounding to nearest with n bits behind the leading one: off by at most 2^−(n+1) of the
    /// value.
    #[test]
    fn rounded_numbers_are_as_near_as_their_bits_allow() {
        let values: Vec<f64> = (0..5000)
            .map(|i| 1e-13 * libm::exp(libm::sin(f64::from(i) * 0.37) * 9.0))
            .collect();
        for bits in [23, 16, 10] {
            let back = unpacked(&Packed::new(&values, Precision::Single(bits)));
            let bound = libm::exp2(-f64::from(bits + 1)) * (1.0 + 1e-7);
            for (a, b) in values.iter().zip(&back) {
                assert!((a - b).abs() <= bound * a.abs(), "{bits}: {a} {b}");
            }
        }
        let back = unpacked(&Packed::new(
            &[f64::from(f32::MAX), f64::INFINITY, f64::NAN],
            Precision::Single(4),
        ));
        assert!(back[0].is_finite() && back[1] == f64::INFINITY && back[2].is_nan());
    }

    /// The second differences of x² are constant: next to nothing is left to pack.
    #[test]
    fn smooth_numbers_shrink() {
        let smooth: Vec<f64> = (0..40_000)
            .map(|i| 1.0 + 1e-9 * f64::from(i % 200))
            .collect();
        let packed = Packed::new(&smooth, Precision::Exact);
        assert!(packed.len() < 40_000, "{}", packed.len());
    }
}
