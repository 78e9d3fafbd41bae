//! Whether photographs are grey or in colour.

use super::error::{PhotographError, refused};
use crate::image::Samples;

/// The kind of the first photograph of a set of which a channel is chosen.
#[derive(Clone, Debug)]
pub(super) struct Kind {
    name: String,
    is_grey: bool,
}

impl Kind {
    /// That of the first photograph.
    pub(super) fn of(name: String, first: &Samples) -> Self {
        let is_grey = is_grey(first);
        Self { name, is_grey }
    }

    /// Refuses a photograph of another kind: what a grey one holds is no channel of the others, nor
    /// the mean of theirs.
    ///
    /// # Errors
    /// [`PhotographError::Refused`].
    pub(super) fn refuse_other(
        &self,
        name: &str,
        samples: &Samples,
    ) -> Result<(), PhotographError> {
        if is_grey(samples) == self.is_grey {
            return Ok(());
        }
        let first = &self.name;
        let (grey, colour) = if self.is_grey {
            (first.as_str(), name)
        } else {
            (name, first.as_str())
        };
        Err(refused(
            format!("{grey} is grey, and {colour} in colour: their light is not the same"),
            "give photographs of one kind, as the camera saved them: all in colour, or all grey",
        ))
    }

    /// Whether a dark frame or flat field of photographs in colour tells their channels apart by
    /// nothing, though it differs from pixel to pixel.
    pub(super) fn is_missed_by(&self, shared: &Samples) -> bool {
        let mut values = shared.values.windows(2);
        !self.is_grey && shared.is_grey() && values.any(|pair| pair[0] != pair[1])
    }
}

/// Whether there is one channel.
fn is_grey(samples: &Samples) -> bool {
    samples.channels.len() == 1
}
