//! What a sensor cannot photograph.

use crate::scene::{MOST_BRACKETS, Quantity};

/// Why an exposure makes no sense. Each message names cause and cure.
#[derive(Clone, Copy, Debug, thiserror::Error, PartialEq)]
pub enum SensorError {
    /// A figure out of its range.
    #[error("{key} = {value} has no meaning; use {range}")]
    Figure {
        /// Which one.
        key: &'static str,
        /// The value given.
        value: f64,
        /// What would make sense.
        range: &'static str,
    },
    /// The converter has no room above its offset.
    #[error(
        "an offset of {offset} counts leaves nothing of {top} counts for light; lower `offset` or raise `bits`"
    )]
    Offset {
        /// The offset, counts.
        offset: f64,
        /// The highest count.
        top: f64,
    },
    /// No exposure time.
    #[error("no exposure time is given; give one, or several for a series")]
    NoTime,
    /// More exposure times than a series has.
    #[error("a series of {0} exposure times is too long; give 1 to {most}", most = MOST_BRACKETS)]
    ManyTimes(usize),
    /// Light that makes more electrons than a number holds.
    #[error(
        "an exposure of {time:e} s with the ambient light and dark current given makes more electrons than a number holds; \
         expose for a shorter time, or lower those"
    )]
    Overflow {
        /// The longest exposure time, s.
        time: f64,
    },
    /// Figures that leave nothing but infinities.
    #[error(
        "pixel {pixel}, spot {spot} comes out as {flux} W with a standard deviation of {stderr} W; figures of the sensor or the exposure time are \
         beyond all measure: check gain, read_noise, dark_current, quantum_efficiency and exposure"
    )]
    Unbounded {
        /// Pixel index.
        pixel: usize,
        /// Spot index.
        spot: usize,
        /// What was measured, W.
        flux: f64,
        /// Its standard deviation, W.
        stderr: f64,
    },
    /// A wavelength that light cannot have.
    #[error(
        "a wavelength of {0} m has no photons; give a positive number of metres, e.g. 632.8e-9"
    )]
    Wavelength(f64),
    /// A flux that cannot be.
    #[error(
        "the flux into pixel {pixel} for spot {spot} is {value:e} W; only finite fluxes of 0 or more can be photographed: give the clean flux of a render"
    )]
    Flux {
        /// Pixel index.
        pixel: usize,
        /// Spot index.
        spot: usize,
        /// The flux, W.
        value: f64,
    },
    /// Glare or a standard error of other size than the signal.
    #[error(
        "the glare or standard error has {found:?} (pixels, spots), the flux {expected:?}; take both from one scene"
    )]
    Shape {
        /// Rows and columns of the flux.
        expected: (usize, usize),
        /// Rows and columns of the other.
        found: (usize, usize),
    },
}

/// Refuses the first value that is out of its quantity's range.
pub(super) fn check(given: impl IntoIterator<Item = (Quantity, f64)>) -> Result<(), SensorError> {
    for (quantity, value) in given {
        if let Some(range) = quantity.refuses(value) {
            let key = quantity.key();
            return Err(SensorError::Figure { key, value, range });
        }
    }
    Ok(())
}
