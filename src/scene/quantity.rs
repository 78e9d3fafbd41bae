//! Numbers that describe a sensor or an exposure, each with its range.

/// A number that describes a sensor or an exposure: its key and its range, for scene files, command
/// line and library alike.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(
    missing_docs,
    reason = "named as the keys that the table of the scene file documents"
)]
pub enum Quantity {
    QuantumEfficiency,
    DarkCurrent,
    FullWell,
    ReadNoise,
    Gain,
    Bits,
    Offset,
    RelativeNoise,
    Exposure,
    Frames,
    DarkFrames,
    Ambient,
    GlareFraction,
    GlareFalloff,
}

impl Quantity {
    /// Its key in the table.
    pub fn key(self) -> &'static str {
        match self {
            Self::QuantumEfficiency => "quantum_efficiency",
            Self::DarkCurrent => "dark_current",
            Self::FullWell => "full_well",
            Self::ReadNoise => "read_noise",
            Self::Gain => "gain",
            Self::Bits => "bits",
            Self::Offset => "offset",
            Self::RelativeNoise => "relative_noise",
            Self::Exposure => "exposure",
            Self::Frames => "frames",
            Self::DarkFrames => "dark_frames",
            Self::Ambient => "ambient",
            Self::GlareFraction => "fraction",
            Self::GlareFalloff => "falloff",
        }
    }

    /// `None` for a value that makes sense, else what would.
    pub fn refuses(self, value: f64) -> Option<&'static str> {
        let positive = value > 0.0 && value.is_finite();
        let not_negative = value >= 0.0 && value.is_finite();
        let (allowed, range) = match self {
            Self::QuantumEfficiency => (
                value > 0.0 && value <= 1.0,
                "a number above 0, up to 1: electrons per photon",
            ),
            Self::DarkCurrent => (not_negative, "0 or more electrons per second and pixel"),
            Self::FullWell => (
                value > 0.0,
                "a positive number of electrons, or inf for no limit",
            ),
            Self::ReadNoise => (not_negative, "0 or more electrons"),
            Self::Gain => (positive, "a positive number of electrons per count"),
            Self::Bits => (
                (0.0..=24.0).contains(&value),
                "1 to 24 bits, or 0 for no converter",
            ),
            Self::Offset => (
                (0.0..=65535.0).contains(&value),
                "0 or more counts, up to 65535",
            ),
            Self::RelativeNoise => (
                (0.0..1.0).contains(&value),
                "0 or more and below 1: relative to each entry, e.g. 0.01",
            ),
            Self::Exposure => (positive, "a positive time in s"),
            Self::Frames => ((1.0..=MOST_FRAMES).contains(&value), "1 to 1000000 frames"),
            Self::DarkFrames => ((0.0..=MOST_FRAMES).contains(&value), "0 to 1000000 frames"),
            Self::Ambient => (not_negative, "0 or more W into each pixel"),
            Self::GlareFraction => (
                (0.0..=1.0).contains(&value),
                "0 to 1: a part of the flux entering the lens",
            ),
            Self::GlareFalloff => (
                (1e-60..=1e60).contains(&value),
                "a positive length in the scene's unit, 1e-60 to 1e60",
            ),
        };
        (!allowed).then_some(range)
    }
}

/// Largest number of frames of one kind.
const MOST_FRAMES: f64 = 1e6;
