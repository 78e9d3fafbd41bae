//! One frame of one pixel, and where its counts lie.

use super::figures::{Figures, ShotNoise};
use crate::num::stream::Stream;

/// Where the counts of an entry lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Range {
    /// Between the ends: the value means what it says.
    Within,
    /// Every exposure time brings the entry within its noise of the upper end, or it or its dark
    /// frames are within theirs of the lower one. No frame reached an end, but the mean of such
    /// entries is off: those that did reach it are not among them.
    Near,
    /// The full well or the highest count was reached in a frame: the value is too low.
    Saturated,
    /// The converter cut off counts below 0 in a frame: the value is too high. A larger offset
    /// prevents it.
    Floored,
}

/// How many standard deviations of a frame the metered counts stay below the upper end. A frame x
/// deviations below the end loses φ(x)/x² of them on average, and metering lets 1 − Φ(8 − x) of the
/// entries there pass: the product, what the mean of no entry is moved by, is below 1e-9.
const MARGIN: f64 = 8.0;

impl Figures {
    /// Counts of one frame with `mean` electrons: electrons, well, read noise, gain, converter.
    pub(super) fn frame(&self, mean: f64, stream: &mut Stream) -> (f64, Range) {
        let electrons = match self.shot_noise {
            ShotNoise::Poisson => stream.poisson(mean),
            ShotNoise::None => mean,
        };
        let kept = electrons.min(self.full_well);
        let noise = match self.read_noise {
            0.0 => 0.0,
            sigma => sigma * stream.normal(),
        };
        let analog = (kept + noise) / self.gain + self.offset;
        let is_full = electrons > kept;
        if self.bits.is_none() {
            let range = if is_full {
                Range::Saturated
            } else {
                Range::Within
            };
            return (analog, range);
        }
        let rounded = analog.round();
        let top = self.top();
        let range = if is_full || rounded >= top {
            Range::Saturated
        } else if rounded < 0.0 {
            Range::Floored
        } else {
            Range::Within
        };
        (rounded.clamp(0.0, top), range)
    }

    /// Variance of the electrons of a frame with `mean` electrons: shot and read noise.
    pub(super) fn variance(&self, mean: f64) -> f64 {
        let shot = match self.shot_noise {
            ShotNoise::Poisson => mean.max(0.0),
            ShotNoise::None => 0.0,
        };
        shot + self.read_noise * self.read_noise
    }

    /// Whether frames with `mean` electrons stay below full well and highest count, noise included.
    pub(super) fn fits(&self, mean: f64) -> bool {
        let reach = mean + MARGIN * self.variance(mean).sqrt();
        reach <= self.full_well && reach / self.gain + self.offset < self.top() - 0.5
    }

    /// Whether frames with `mean` electrons stay above 0 counts, noise included: electrons are
    /// never fewer than none.
    pub(super) fn clears(&self, mean: f64) -> bool {
        let shot = self.variance(mean) - self.read_noise * self.read_noise;
        let least = (mean - MARGIN * shot.sqrt()).max(0.0) - MARGIN * self.read_noise;
        self.bits.is_none() || least / self.gain + self.offset >= -0.5
    }
}
