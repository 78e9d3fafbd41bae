//! The sensor chain against the distributions that each stage must follow, against its own law, and
//! glare against closed forms.

mod counts;
mod glare;
mod law;
mod stages;

use phicam::matrix::Matrix;
use phicam::sensor::{Exposed, Exposure, Figures, Light, Sensor, Stated};

const WAVELENGTH: f64 = 632.8e-9;
/// Probability with which each of these tests may reject a right program; the seeds are fixed.
const SIGNIFICANCE: f64 = 1e-4;

/// Photographs `flux` alone, pixels × spots, with the deviation by the law.
fn expose(figures: Figures, flux: &Matrix, exposure: &Exposure, seed: u64) -> Exposed {
    let light = Light::new(flux, WAVELENGTH).unwrap();
    Sensor::new(figures)
        .unwrap()
        .expose(&light, exposure, Stated::Oracle, seed)
        .unwrap()
}
