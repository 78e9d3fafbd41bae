//! The light that is photographed, and how long.

use super::error::{SensorError, check};
use crate::matrix::Matrix;
use crate::num::units::photon_energy;
use crate::scene::{MOST_BRACKETS, Quantity};

/// The light that falls on the sensor.
#[derive(Clone, Copy, Debug)]
pub struct Light<'a> {
    signal: &'a Matrix,
    glare: Option<&'a Matrix>,
    render: Option<(&'a Matrix, f64)>,
    ambient: f64,
    wavelength: f64,
}

impl<'a> Light<'a> {
    /// The clean flux `signal` (pixels × spots, W) of light of `wavelength` (m).
    ///
    /// # Errors
    /// [`SensorError::Flux`], [`SensorError::Wavelength`].
    pub fn new(signal: &'a Matrix, wavelength: f64) -> Result<Self, SensorError> {
        if !(wavelength > 0.0 && wavelength.is_finite()) {
            return Err(SensorError::Wavelength(wavelength));
        }
        Self::refuse(signal)?;
        Ok(Self {
            signal,
            glare: None,
            render: None,
            ambient: 0.0,
            wavelength,
        })
    }

    /// With scattered light of the laser (pixels × spots, W), see [`glare`](super::glare()).
    ///
    /// # Errors
    /// [`SensorError::Shape`], [`SensorError::Flux`].
    pub fn with_glare(self, glare: &'a Matrix) -> Result<Self, SensorError> {
        self.fits(glare)?;
        Ok(Self {
            glare: Some(glare),
            ..self
        })
    }

    /// With the standard error of the signal (pixels × spots, W, 0 or more) as the render has it
    /// from `replicates`: the stated standard deviations then hold against the light itself, not
    /// against this render of it.
    ///
    /// # Errors
    /// [`SensorError::Shape`], [`SensorError::Flux`].
    pub fn with_render_error(
        self,
        stderr: &'a Matrix,
        replicates: u32,
    ) -> Result<Self, SensorError> {
        self.fits(stderr)?;
        let freedom = f64::from(replicates.max(2) - 1);
        Ok(Self {
            render: Some((stderr, freedom)),
            ..self
        })
    }

    /// With ambient light, W into each pixel, as if of the laser's wavelength. It is there without
    /// the laser too.
    ///
    /// # Errors
    /// [`SensorError::Figure`].
    pub fn with_ambient(self, ambient: f64) -> Result<Self, SensorError> {
        check([(Quantity::Ambient, ambient)])?;
        Ok(Self { ambient, ..self })
    }

    /// Refuses what is not of the signal's shape, or negative.
    fn fits(&self, other: &Matrix) -> Result<(), SensorError> {
        if other.shape() != self.signal.shape() {
            return Err(SensorError::Shape {
                expected: self.signal.shape(),
                found: other.shape(),
            });
        }
        Self::refuse(other)
    }

    fn refuse(flux: &Matrix) -> Result<(), SensorError> {
        let wrong = flux.iter().position(|x| !(*x >= 0.0 && x.is_finite()));
        wrong.map_or(Ok(()), |at| {
            Err(SensorError::Flux {
                pixel: at % flux.nrows(),
                spot: at / flux.nrows(),
                value: flux[at],
            })
        })
    }

    /// Pixels and spots.
    pub fn shape(&self) -> (usize, usize) {
        self.signal.shape()
    }

    /// The signal alone, W.
    pub(super) fn signal(&self, pixel: usize, spot: usize) -> f64 {
        self.signal[(pixel, spot)]
    }

    /// Standard error of the signal in the render, W, and the degrees of freedom it has.
    pub(super) fn render(&self, pixel: usize, spot: usize) -> Option<(f64, f64)> {
        let (stderr, freedom) = self.render?;
        Some((stderr[(pixel, spot)], freedom))
    }

    /// Signal and glare: what is there with the laser only, W.
    pub(super) fn of_laser(&self, pixel: usize, spot: usize) -> f64 {
        self.signal(pixel, spot) + self.glare.map_or(0.0, |g| g[(pixel, spot)])
    }

    /// The most that is there with the laser only, W.
    pub(super) fn brightest(&self) -> f64 {
        let (pixels, spots) = self.shape();
        let entries = (0..spots).flat_map(|spot| (0..pixels).map(move |pixel| (pixel, spot)));
        entries
            .map(|(pixel, spot)| self.of_laser(pixel, spot))
            .fold(0.0, f64::max)
    }

    /// What is there without the laser, W into each pixel.
    pub(super) fn ambient(&self) -> f64 {
        self.ambient
    }

    /// Photons per joule.
    pub(super) fn photons_per_joule(&self) -> f64 {
        1.0 / photon_energy(self.wavelength)
    }
}

/// How frames are taken.
#[derive(Clone, Debug, PartialEq)]
pub struct Exposure {
    times: Vec<f64>,
    frames: u32,
    dark_frames: u32,
}

impl Exposure {
    /// `frames` frames of each of the exposure times (s), and as many times `dark_frames` without
    /// the laser.
    ///
    /// # Errors
    /// [`SensorError::NoTime`], [`SensorError::ManyTimes`], [`SensorError::Figure`].
    pub fn new(times: &[f64], frames: u32, dark_frames: u32) -> Result<Self, SensorError> {
        match times.len() {
            0 => return Err(SensorError::NoTime),
            1..=MOST_BRACKETS => {}
            many => return Err(SensorError::ManyTimes(many)),
        }
        let figures = [
            (Quantity::Frames, f64::from(frames)),
            (Quantity::DarkFrames, f64::from(dark_frames)),
        ];
        let exposures = times.iter().map(|time| (Quantity::Exposure, *time));
        check(exposures.chain(figures))?;
        let mut times = times.to_vec();
        times.sort_by(|a, b| b.total_cmp(a));
        Ok(Self {
            times,
            frames,
            dark_frames,
        })
    }

    /// Exposure times, s, the longest first.
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// Frames averaged at each time.
    pub fn frames(&self) -> u32 {
        self.frames
    }

    /// Frames without laser averaged and subtracted at each time; 0: only the offset is subtracted.
    pub fn dark_frames(&self) -> u32 {
        self.dark_frames
    }
}
