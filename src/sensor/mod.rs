//! Floor 4: the sensor, flux → electrons → counts → flux. It is applied to clean flux and is never
//! inside the tracer.
//!
//! One frame of an entry (pixel, spot), exposed for t seconds:
//!
//! | stage | law |
//! | --- | --- |
//! | electrons | N ~ Poisson(μ), μ = (ηtλ/hc)·(Φ + Φ_glare + Φ_ambient) + D·t: quantum efficiency η, dark current D; without shot noise N = μ |
//! | full well | min(N, full well) |
//! | read noise, gain | (N + σ_r·N(0, 1))/K + offset, K electrons per count |
//! | converter | rounded, and cut off at 0 and 2^bits − 1 |
//!
//! Frames of one exposure are averaged to n̄. The linearised flux is (n̄ − d̄)·K·hc/(ηtλ), W, d̄
//! the average of the *dark frames*: the same exposure without the laser, so that offset, dark
//! current and ambient light go, and glare, which is light of the laser, stays. Without dark frames
//! d̄ is the offset alone, and dark current and ambient light stay in the result. A series of
//! exposure times gives each entry the longest one in which no frame is saturated.
//!
//! Last, each finished entry is multiplied by 1 + ρ·N(0, 1): the relative noise of the published
//! simulation, which is no stage of a sensor.
//!
//! # Standard deviation
//!
//! Of every entry, without sampling ([`Sensor::expected`]), over F frames and M dark frames, in
//! electrons:
//!
//! > V = B(s²) + (s² + K²/12 − B(s²))/F + B(s_d²) + (s_d² + K²/12 − B(s_d²))/M,   s² = μ + σ_r²,   s_d² = μ_dark + σ_r²
//!
//! K²/12 is the converter's rounding, of which averaging leaves B: K²/12 without other noise,
//! nothing when s exceeds half a count (it assumes that the mean may lie anywhere between two
//! counts). With m the mean of the linearised flux its variance is V·(hc/ηtλ)²·(1 + ρ²) + ρ²m².
//!
//! Saturation is in neither: a saturated entry keeps the value at which it is cut off, and is
//! marked ([`Range`]). Choosing by what was measured leaves a bias of up to 0.4 standard deviations
//! in entries that saturate about every other time.
//!
//! A random number is a function of (seed, spot, pixel, frame). Dark frames belong to a pixel and
//! serve all spots. The numbers are others than the tracer's under the same seed.
//!
//! # Built-in sensors
//!
#![doc = include_str!("builtin.md")]

mod builtin;
mod error;
mod expose;
mod exposure;
mod figures;
mod filling;
mod glare;
mod law;
mod setup;
mod summary;

pub use builtin::summary as builtin_summary;
pub use error::SensorError;
pub use expose::{Exposed, Range};
pub use exposure::{Exposure, Light};
pub use figures::{Figures, Sensor, ShotNoise};
pub use glare::{entering_lens, glare, glare_to_signal};
pub use law::Expected;
pub use summary::Summary;
