//! The `[sensor]` table: how the clean flux is to be photographed. What it means stands on the
//! floor of the sensor.

use std::str::FromStr;

use serde::{Deserialize, Serialize};

use super::error::{Fault, keys};
use super::quantity::Quantity;
use crate::num::named::{Named, named};

named! {
    /// A sensor that is built in.
    #[derive(Clone, Copy, Debug, Deserialize, Serialize, PartialEq, Eq)]
    #[serde(rename_all = "kebab-case")]
    pub enum SensorModel {
        /// Without any noise or limit.
        Ideal = "ideal",
        /// A cooled scientific CCD.
        Ccd = "ccd",
        /// An ordinary digital single-lens reflex camera.
        Dslr = "dslr",
        /// An industrial CMOS camera.
        MachineVision = "machine-vision",
    }
}

impl FromStr for SensorModel {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        Self::by_name(name).ok_or_else(|| {
            let names = Self::ALL.map(Self::name).join(", ");
            format!("there is no built-in sensor `{name}`\n  cure: use one of {names}")
        })
    }
}

/// How scattered light is spread over the image.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, PartialEq)]
#[serde(rename_all = "lowercase")]
pub enum Spread {
    /// Every pixel gets the same.
    Uniform,
    /// ∝ 1/(1 + (d/d0)²), d the distance from the image of the spot on the view's plane, d0 this
    /// length.
    Falloff(f64),
}

/// Veiling glare: a part of the light that comes from the spot straight into the lens is scattered
/// over the image.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Glare {
    /// Part of the flux entering the lens, 0 to 1.
    pub fraction: f64,
    /// Where it goes.
    pub spread: Spread,
}

/// What a scene file says of the sensor and its exposure; `None` where it says nothing. Every value
/// is in its [`Quantity`]'s range.
#[derive(Clone, Debug, Default, Deserialize, Serialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct SensorSettings {
    /// The built-in sensor that the other figures change.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub model: Option<SensorModel>,
    /// Electrons per photon.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub quantum_efficiency: Option<f64>,
    /// Electrons per second and pixel.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dark_current: Option<f64>,
    /// Electrons a pixel can hold.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub full_well: Option<f64>,
    /// Electrons, root mean square.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub read_noise: Option<f64>,
    /// Electrons per count.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gain: Option<f64>,
    /// Bits of the converter; 0 for none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bits: Option<u32>,
    /// Counts of a pixel without electrons.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub offset: Option<f64>,
    /// Standard deviation of the factor on each finished entry.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub relative_noise: Option<f64>,
    /// Whether photons and dark electrons come at random.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shot_noise: Option<bool>,
    /// Exposure time, s.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub exposure: Option<f64>,
    /// Frames averaged.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub frames: Option<u32>,
    /// Frames without laser, averaged and subtracted.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dark_frames: Option<u32>,
    /// Exposure times in place of one, s.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub brackets: Option<Vec<f64>>,
    /// Ambient light, W into each pixel.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ambient: Option<f64>,
    /// Veiling glare.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub glare: Option<Glare>,
}

/// Most exposure times of one series.
pub const MOST_BRACKETS: usize = 16;

impl SensorSettings {
    /// The settings of a scene, checked.
    pub(super) fn checked(self) -> Result<Self, Fault> {
        self.check().map_err(|f| f.within(keys!["sensor"]))?;
        Ok(self)
    }

    fn check(&self) -> Result<(), Fault> {
        let number = |quantity: Quantity, value: Option<f64>| Some((quantity, value?));
        let whole = |quantity, value: Option<u32>| number(quantity, value.map(f64::from));
        let given = [
            number(Quantity::QuantumEfficiency, self.quantum_efficiency),
            number(Quantity::DarkCurrent, self.dark_current),
            number(Quantity::FullWell, self.full_well),
            number(Quantity::ReadNoise, self.read_noise),
            number(Quantity::Gain, self.gain),
            whole(Quantity::Bits, self.bits),
            number(Quantity::Offset, self.offset),
            number(Quantity::RelativeNoise, self.relative_noise),
            number(Quantity::Exposure, self.exposure),
            whole(Quantity::Frames, self.frames),
            whole(Quantity::DarkFrames, self.dark_frames),
            number(Quantity::Ambient, self.ambient),
        ];
        for (quantity, value) in given.into_iter().flatten() {
            check(quantity, value)?;
        }
        if let Some(Glare { fraction, spread }) = self.glare {
            check(Quantity::GlareFraction, fraction).map_err(|f| f.within(keys!["glare"]))?;
            if let Spread::Falloff(d0) = spread {
                check(Quantity::GlareFalloff, d0)
                    .map_err(|f| f.within(keys!["glare", "spread"]))?;
            }
        }
        let Some(times) = &self.brackets else {
            return Ok(());
        };
        let refuse = |cause, cure: &str| Err(Fault::new(keys!["brackets"], cause, cure));
        if !(1..=MOST_BRACKETS).contains(&times.len()) {
            let cause = format!("brackets has {} exposure times", times.len());
            return refuse(cause, &format!("give 1 to {MOST_BRACKETS}"));
        }
        let is_wrong = |t: &&f64| Quantity::Exposure.refuses(**t).is_some();
        if let Some(t) = times.iter().find(is_wrong) {
            let cause = format!("brackets has the exposure time {t} s");
            return refuse(cause, "give positive times in s");
        }
        if self.exposure.is_some() {
            let cause = "both `exposure` and `brackets` are given".to_owned();
            return refuse(
                cause,
                "keep one: brackets are the exposure times of a series",
            );
        }
        Ok(())
    }
}

fn check(quantity: Quantity, value: f64) -> Result<(), Fault> {
    let Some(range) = quantity.refuses(value) else {
        return Ok(());
    };
    let key = quantity.key();
    let cause = format!("{key} = {value}");
    Err(Fault::new(keys![key], cause, format!("use {range}")))
}

#[cfg(test)]
mod tests;
