//! The samples of photographs as their files store them: integers stay integers, and no transfer
//! function is applied.

use super::orientation::Orientation;
use super::{Channel, ImageError, unsupported};

/// Most pixels of a photograph: 8192 × 8192.
pub const MOST_SAMPLED: usize = 1 << 26;
/// Most samples of a file, all its frames and channels together: 1 GiB as f64.
pub const MOST_SAMPLES: usize = 1 << 27;

/// One frame of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Samples {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Grey, or red, green and blue.
    pub channels: Vec<Channel>,
    /// As stored: row by row from the top, each from the left, all channels of a pixel together.
    pub values: Vec<f64>,
    /// The largest value that the file's integers can have; `None` for floating-point numbers.
    pub full_scale: Option<f64>,
    /// Whether the file's compression changes samples (JPEG).
    pub is_lossy: bool,
    /// γ ≠ 1 where the file says that light is (value/full scale)^γ: sRGB or gAMA of a PNG.
    pub gamma: Option<f64>,
}

impl Samples {
    /// The values of one channel, row by row from the top.
    pub fn channel(&self, channel: Channel) -> Option<Vec<f64>> {
        let at = self.channels.iter().position(|c| *c == channel)?;
        let values = self.values.iter().skip(at);
        Some(values.step_by(self.channels.len()).copied().collect())
    }

    /// Whether all channels of each pixel are equal: a grey photograph saved in colour.
    pub fn is_grey(&self) -> bool {
        let mut pixels = self.values.chunks_exact(self.channels.len().max(1));
        pixels.all(|pixel| pixel.iter().all(|x| *x == pixel[0]))
    }

    /// Without its alpha, which has to be opaque everywhere.
    pub(super) fn opaque(self, name: &str, opaque: f64) -> Result<Self, ImageError> {
        let count = self.channels.len();
        if self.channels.last() != Some(&Channel::Alpha) {
            return Ok(self);
        }
        if self
            .values
            .chunks_exact(count)
            .any(|p| p[count - 1] != opaque)
        {
            let reason =
                "it has transparent pixels (alpha), which no camera stores; save it without alpha";
            return Err(unsupported(name, reason));
        }
        let values = self.values.chunks_exact(count);
        Ok(Self {
            values: values
                .flat_map(|p| p[..count - 1].iter().copied())
                .collect(),
            channels: self.channels[..count - 1].to_vec(),
            ..self
        })
    }
}

/// Why a file of too many samples is not read.
pub(super) const TOO_MANY: &str =
    "it has more than 2²⁷ samples (1 GiB of numbers); crop it, or save it in parts";

/// The frame as the camera's note says that it was held.
pub(super) fn upright(frame: Samples, orientation: Orientation) -> Samples {
    if orientation.is_upright() {
        return frame;
    }
    let size = [frame.width, frame.height];
    let ([width, height], values) = orientation.turned(size, frame.channels.len(), &frame.values);
    Samples {
        width,
        height,
        values,
        ..frame
    }
}

pub(super) fn unknown_turn(name: &str, code: u16) -> ImageError {
    let reason = format!(
        "it notes the orientation {code}, which EXIF does not define (1 to 8); remove the note, or save it upright"
    );
    unsupported(name, reason)
}
