//! What a list must not say.

use super::super::error::{PhotographError, refused};
use super::Set;

impl Set {
    /// With what contradicts itself refused.
    ///
    /// # Errors
    /// [`PhotographError::Refused`].
    pub fn checked(self) -> Result<Self, PhotographError> {
        let ways = [
            self.frames.is_some(),
            self.list.is_some(),
            !self.frame.is_empty(),
        ];
        if ways.iter().filter(|given| **given).count() != 1 {
            return Err(refused(
                "the photographs are not given, or in two ways",
                "give one of `frames = \"input_*.png\"`, `list = \"frames.csv\"` and [[frame]] tables",
            ));
        }
        let one_only = [
            (
                self.gamma.is_some() && self.response.is_some(),
                "gamma",
                "response",
            ),
            (
                self.crop.is_some() && !self.marks.is_empty(),
                "crop",
                "marks",
            ),
            (
                self.repeats.is_some() && self.frames.is_none(),
                "repeats",
                "a list of frames",
            ),
        ];
        if let Some((_, a, b)) = one_only.iter().find(|(both, ..)| *both) {
            return Err(refused(
                format!("{a} and {b} exclude each other"),
                format!("leave {a} or {b} out"),
            ));
        }
        let numbers = [
            ("exposure", self.exposure, 0.0),
            ("full_scale", self.full_scale, 0.0),
            ("saturation", self.saturation, 0.0),
            ("watts", self.watts, 0.0),
            ("halo", self.halo, 0.0),
        ];
        for (key, given, above) in numbers {
            if let Some(x) = given.filter(|x| !(x.is_finite() && *x > above)) {
                return Err(refused(
                    format!("{key} = {x} has no meaning"),
                    "use a positive number",
                ));
            }
        }
        if self.repeats == Some(0) {
            return Err(refused(
                "repeats = 0 leaves no photograph",
                "use at least 1",
            ));
        }
        if let Some(crop) = self.crop {
            let all = [crop.x, crop.y, crop.width, crop.height];
            if !(all.iter().all(|x| x.is_finite()) && crop.width > 0.0 && crop.height > 0.0) {
                return Err(refused(
                    "the crop has no area",
                    "give x, y, width and height in pixels",
                ));
            }
        }
        if self.camera.is_some_and(|lens| !lens.is_valid()) {
            return Err(refused(
                "the camera matrix has no meaning",
                "give fx and fy above 0, and finite numbers",
            ));
        }
        if self.camera.is_some() && self.marks.is_empty() {
            return Err(refused(
                "a camera matrix without marks does not say where the wall is",
                "give four or more [[marks]]",
            ));
        }
        self.camera_noise()?;
        Ok(self)
    }
}
