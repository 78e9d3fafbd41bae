//! The figures of a sensor.

use serde::Serialize;

use super::error::{SensorError, check};
use crate::scene::Quantity;

/// How electrons come.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum ShotNoise {
    /// At random: their number has a Poisson distribution.
    Poisson,
    /// Exactly as many as expected, fractions included.
    None,
}

/// What a sensor does to light.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Figures {
    /// η: electrons per photon at the laser's wavelength.
    pub quantum_efficiency: f64,
    /// D: electrons per second and pixel.
    pub dark_current: f64,
    /// Electrons that a pixel holds; infinite for no limit.
    pub full_well: f64,
    /// σ_r: electrons, root mean square, per frame.
    pub read_noise: f64,
    /// K: electrons per count.
    pub gain: f64,
    /// Bits of the converter; `None`: counts are neither rounded nor limited.
    pub bits: Option<u32>,
    /// Counts of a pixel without electrons.
    pub offset: f64,
    /// How electrons come.
    pub shot_noise: ShotNoise,
    /// ρ: each finished entry is multiplied by 1 + ρ·N(0, 1).
    pub relative_noise: f64,
}

impl Figures {
    /// No noise, no limit, an electron for every photon.
    pub const IDEAL: Self = Self {
        quantum_efficiency: 1.0,
        dark_current: 0.0,
        full_well: f64::INFINITY,
        read_noise: 0.0,
        gain: 1.0,
        bits: None,
        offset: 0.0,
        shot_noise: ShotNoise::None,
        relative_noise: 0.0,
    };

    /// The highest count of the converter.
    pub fn top(&self) -> f64 {
        self.bits
            .map_or(f64::INFINITY, |bits| f64::from((1u32 << bits) - 1))
    }

    /// Electrons of so many counts.
    pub(super) fn electrons(&self, counts: f64) -> f64 {
        (counts - self.offset) * self.gain
    }

    /// Electrons that well or converter hold: min(full well, (top − offset)·K).
    pub(super) fn most_electrons(&self) -> f64 {
        self.full_well.min(self.electrons(self.top()))
    }
}

/// A sensor whose figures make sense.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensor(pub(super) Figures);

impl Sensor {
    /// Checks the figures.
    ///
    /// # Errors
    /// [`SensorError::Figure`], [`SensorError::Offset`].
    pub fn new(figures: Figures) -> Result<Self, SensorError> {
        check([
            (Quantity::QuantumEfficiency, figures.quantum_efficiency),
            (Quantity::DarkCurrent, figures.dark_current),
            (Quantity::FullWell, figures.full_well),
            (Quantity::ReadNoise, figures.read_noise),
            (Quantity::Gain, figures.gain),
            (Quantity::Bits, f64::from(figures.bits.unwrap_or(0))),
            (Quantity::Offset, figures.offset),
            (Quantity::RelativeNoise, figures.relative_noise),
        ])?;
        let figures = Figures {
            bits: figures.bits.filter(|bits| *bits > 0),
            ..figures
        };
        if figures.offset >= figures.top() {
            return Err(SensorError::Offset {
                offset: figures.offset,
                top: figures.top(),
            });
        }
        Ok(Self(figures))
    }

    /// Its figures.
    pub fn figures(&self) -> &Figures {
        &self.0
    }
}
