//! Whether what is left over goes with the light.
//!
//! Of right standard errors z² has nothing in common with the light. Where errors are stated alike
//! and the noise is a share of each entry, or of counts, it grows with it: χ² of all entries may be
//! right, and no weight is. The correlation r of z² and ln of the light of n independent entries is
//! nearly normal with the standard deviation 1/√n by chance.

use super::certainty::BEYOND_CHANCE;
use crate::num::digits::figure;

/// Of pairs x = ln of the light and y = z²: their number, Σ x, Σ y, Σ x², Σ y² and Σ x y.
#[derive(Debug, Default)]
pub(in crate::lab) struct WithLight([f64; 6]);

impl WithLight {
    /// An entry of this light, W; of none nothing is known.
    pub(in crate::lab) fn add(&mut self, light: f64, square: f64) {
        if light > 0.0 {
            let (x, y) = (libm::log(light), square);
            let terms = [1.0, x, y, x * x, y * y, x * y];
            let sums = self.0.iter_mut().zip(terms);
            sums.for_each(|(sum, term)| *sum += term);
        }
    }

    /// The correlation, where it is beyond chance.
    pub(in crate::lab) fn correlation(&self) -> Option<f64> {
        let [n, x, y, xx, yy, xy] = self.0;
        let variance = |square: f64, sum: f64| square - sum * sum / n;
        let r = (xy - x * y / n) / (variance(xx, x) * variance(yy, y)).sqrt();
        (r.abs() * n.sqrt() > BEYOND_CHANCE).then_some(r)
    }
}

/// What is said of a correlation.
pub(in crate::lab) fn goes_with_light(r: f64) -> String {
    let (goes, are) = if r > 0.0 {
        (
            "GROWS",
            "too small for bright entries and too large for dark ones",
        )
    } else {
        (
            "FALLS",
            "too large for bright entries and too small for dark ones",
        )
    };
    format!(
        "what is left over {goes} with the light, over the standard errors (correlation of its squares with ln of the \
         light {}): these are {are}. Noise of counts goes with the root of the light, that of a source or a gain with \
         the light (--noise)",
        figure(r, 2)
    )
}
