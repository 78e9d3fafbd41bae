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
//! d̄ is the offset alone, and dark current and ambient light stay in the result.
//!
//! Before the F frames of a spot one more is taken at each exposure time, the *metering frame*.
//! Each entry is taken from the longest exposure in which this frame stays eight of its standard
//! deviations below full well and highest count. It is no part of n̄: what chooses the exposure,
//! and what the standard deviation is estimated from, has no error in common with the value.
//! (Chosen by n̄ itself, entries that saturate about every other time are low by up to 0.4 standard
//! deviations; weighted by a σ from n̄ itself, a mean is low by an electron.) An entry that even
//! the shortest exposure brings nearer to the end is marked ([`Range::Near`]), and so is one whose
//! metering frame, or whose dark frames, are so near to 0 counts. A saturated entry keeps the value
//! at which it is cut off, and is marked ([`Range::Saturated`]).
//!
//! Last, each finished entry is multiplied by 1 + ρ·N(0, 1): the relative noise of the published
//! simulation, which is no stage of a sensor.
//!
//! # Standard deviation
//!
//! By the law of the exposure at the true flux ([`Sensor::expected`], [`Stated::Oracle`]), over F
//! frames and M dark frames, in electrons:
//!
//! > V = B(s²) + (s² + K²/12 − B(s²))/F + B(s_d²) + (s_d² + K²/12 − B(s_d²))/M,   s² = μ + σ_r²,   s_d² = μ_dark + σ_r²
//!
//! K²/12 is the converter's rounding, of which averaging leaves B: K²/12 without other noise,
//! nothing when s exceeds half a count (it assumes that the mean may lie anywhere between two
//! counts). With m the mean of the linearised flux its variance is V·(hc/ηtλ)²·(1 + ρ²) + ρ²m².
//!
//! A laboratory does not know the true flux. From counts alone ([`Stated::Counts`]):
//!
//! * once, pairs of frames of even light at eight levels, and without light, give the offset, the
//!   variance v_b of a frame without light and the slope 1/K of variance over counts
//!   ([`PhotonTransfer`]);
//! * the variance of a frame is then v_b + (n − offset)/K, in counts², n that of the metering
//!   frame; that of a dark frame the same of the mean dark count over all pixels (an average over
//!   pixels that are equal here). They take the place of s² + K²/12 and s_d² + K²/12 above; K, η
//!   and t still turn counts into W.
//!
//! Data are weighted by 1/σ², so that σ² is made to have the right mean there: σ² = V̂ + Var V̂/V̂.
//! Of one frame that adds one electron². Then χ²/dof is 1 within 0.02 down to no light at all with
//! every built-in sensor (tests). What remains: without read noise the mean of 1/σ² is (1 −
//! e^−μ)/μ, so that χ²/dof is 1 − e^−μ where μ is an electron or two; a sensor whose noise is below
//! 0.3 counts shows in v_b only what its offset lets through the rounding; and pixels are equal, as
//! no real ones are.
//!
//! The render's own standard error is added in quadrature where it is given
//! ([`Light::with_render_error`]); of n replicates its variance is known to 2/(n − 1), which enters
//! Var V̂.
//!
//! A random number is a function of (seed, spot, pixel, frame). Dark frames belong to a pixel and
//! serve all spots. The numbers are others than the tracer's under the same seed.
//!
//! # Built-in sensors
//!
#![doc = include_str!("builtin.md")]

mod builtin;
mod deviation;
mod error;
mod expose;
mod exposure;
mod figures;
mod filling;
mod frame;
mod glare;
mod law;
mod photon_transfer;
mod setup;
mod summary;

pub use builtin::summary as builtin_summary;
pub use deviation::Stated;
pub use error::SensorError;
pub use expose::Exposed;
pub use exposure::{Exposure, Light};
pub use figures::{Figures, Sensor, ShotNoise};
pub use frame::Range;
pub use glare::{entering_lens, glare, glare_to_signal};
pub use law::Expected;
pub use photon_transfer::PhotonTransfer;
pub use summary::Summary;
