//! Standard normal numbers for the noise of photographs.

use crate::matrix::Matrix;
use crate::num::stream::{Key, Sampling, Stream};

/// One standard normal number for each entry of Φcam (pixels × spots), a function of seed, spot and
/// pixel alone, and of a block that no render reaches.
pub(super) fn normal_deviates(seed: u64, pixels: usize, spots: usize) -> Matrix {
    Matrix::from_fn(pixels, spots, |pixel, spot| {
        let key = Key {
            seed,
            spot: spot as u32,
            pixel: pixel as u32,
            block: u32::MAX,
        };
        Stream::new(Sampling::Pcg, key).normal()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The first four moments of 2e5 of them within five of their standard deviations, √(1/n),
    /// √(2/n), √(15/n), √(96/n); and entries of a larger matrix do not depend on its size.
    #[test]
    fn they_are_standard_normal_and_belong_to_their_entry() {
        let found = normal_deviates(3, 1000, 200);
        let n = found.len() as f64;
        let moment = |k: i32| found.iter().map(|x| x.powi(k)).sum::<f64>() / n;
        for (k, want, variance) in [(1, 0.0, 1.0), (2, 1.0, 2.0), (3, 0.0, 15.0), (4, 3.0, 96.0)] {
            let limit = 5.0 * (variance / n).sqrt();
            assert!((moment(k) - want).abs() < limit, "{k}: {}", moment(k));
        }
        let small = normal_deviates(3, 10, 20);
        assert_eq!(small, found.view((0, 0), (10, 20)).into_owned());
        let other = normal_deviates(4, 1000, 200);
        // Correlation of independent numbers has standard deviation 1/√n.
        assert!((found.dot(&other) / n).abs() < 5.0 / n.sqrt());
    }
}
