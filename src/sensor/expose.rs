//! The chain itself: electrons, counts, and back to a flux.

use rayon::prelude::*;

use super::error::SensorError;
use super::exposure::{Exposure, Light};
use super::figures::{Figures, Sensor, ShotNoise};
use super::law::Law;
use crate::matrix::Matrix;
use crate::num::stream::{Key, Sampling, Stream};

/// Parts the random numbers of a sensor from those of the tracer under the same seed.
const OWN: u64 = 0x7365_6e73_6f72;
/// The block of the numbers that are not of one frame.
const FINISHED: u32 = u32::MAX;

/// Where the counts of an entry lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Range {
    /// Between the ends: the value means what it says.
    Within,
    /// The full well or the highest count was reached in a frame: the value is too low.
    Saturated,
    /// The converter cut off counts below 0 in a frame: the value is too high. A larger offset
    /// prevents it.
    Floored,
}

/// Photographs as a sensor takes them.
#[derive(Clone, Debug, PartialEq)]
pub struct Exposed {
    /// Linearised flux, pixels × spots, W.
    pub flux: Matrix,
    /// Its standard deviation by the law of the exposure that was used, W; that of a saturated
    /// entry means nothing.
    pub stderr: Matrix,
    /// Mean counts over the frames, pixels × spots, for each exposure time, the longest first.
    pub counts: Vec<Matrix>,
    /// Which exposure time each entry was taken from, 0 the longest; at pixel + spot·pixels.
    pub bracket: Vec<usize>,
    /// Where the counts of each entry lie; at pixel + spot·pixels.
    pub range: Vec<Range>,
}

impl Exposed {
    /// Entries of the given range.
    pub fn count(&self, range: Range) -> usize {
        self.range.iter().filter(|r| **r == range).count()
    }
}

/// The mean over the frames of one exposure.
#[derive(Clone, Copy, Debug)]
struct Reading {
    counts: f64,
    range: Range,
}

/// A column of [`Exposed`].
struct Column {
    /// Flux, its standard deviation, exposure and range of each pixel.
    entries: Vec<(f64, f64, usize, Range)>,
    /// Mean counts of each exposure time.
    counts: Vec<Vec<f64>>,
}

impl Sensor {
    /// Photographs `light`. The same seed gives the same bits, whatever the threads.
    ///
    /// Each frame of each entry has random numbers of its own; the frames without laser are taken
    /// once for each pixel and serve all spots, so that their error is common to a row.
    ///
    /// # Errors
    /// [`SensorError::Overflow`] where there are more electrons than a number holds,
    /// [`SensorError::Unbounded`] where what comes out is infinite.
    pub fn expose(
        &self,
        light: &Light<'_>,
        exposure: &Exposure,
        seed: u64,
    ) -> Result<Exposed, SensorError> {
        let (pixels, spots) = light.shape();
        let laws = Law::of(self.figures(), light, exposure);
        if !laws[0].electrons(light.brightest()).is_finite() {
            let time = exposure.times()[0];
            return Err(SensorError::Overflow { time });
        }
        let chain = Chain {
            figures: self.figures(),
            exposure,
            laws: &laws,
            seed: seed ^ OWN,
        };
        let dark: Vec<Vec<Reading>> = (0..pixels)
            .into_par_iter()
            .map(|pixel| chain.dark(pixel))
            .collect();
        let columns: Vec<Column> = (0..spots)
            .into_par_iter()
            .map(|spot| chain.column(light, spot, &dark))
            .collect();
        let entries = || columns.iter().flat_map(|c| &c.entries);
        let matrix =
            |values: &mut dyn Iterator<Item = f64>| Matrix::from_iterator(pixels, spots, values);
        refuse_infinities(Exposed {
            flux: matrix(&mut entries().map(|e| e.0)),
            stderr: matrix(&mut entries().map(|e| e.1)),
            counts: (0..laws.len())
                .map(|k| matrix(&mut columns.iter().flat_map(|c| c.counts[k].iter().copied())))
                .collect(),
            bracket: entries().map(|e| e.2).collect(),
            range: entries().map(|e| e.3).collect(),
        })
    }
}

fn refuse_infinities(exposed: Exposed) -> Result<Exposed, SensorError> {
    let pixels = exposed.flux.nrows();
    let mut entries = exposed.flux.iter().zip(&exposed.stderr);
    let Some(at) = entries.position(|(x, s)| !(x.is_finite() && s.is_finite())) else {
        return Ok(exposed);
    };
    Err(SensorError::Unbounded {
        pixel: at % pixels,
        spot: at / pixels,
        flux: exposed.flux[at],
        stderr: exposed.stderr[at],
    })
}

/// A sensor at work.
struct Chain<'a> {
    figures: &'a Figures,
    exposure: &'a Exposure,
    laws: &'a [Law],
    seed: u64,
}

impl Chain<'_> {
    /// All entries of one photograph.
    fn column(&self, light: &Light<'_>, spot: usize, dark: &[Vec<Reading>]) -> Column {
        let pixels = light.shape().0;
        let mut column = Column {
            entries: Vec::with_capacity(pixels),
            counts: vec![Vec::with_capacity(pixels); self.laws.len()],
        };
        for (pixel, dark) in dark.iter().enumerate() {
            let flux = light.of_laser(pixel, spot);
            let readings: Vec<Reading> = (self.laws.iter().zip(0..))
                .map(|(law, k)| {
                    let frames = self.exposure.frames();
                    self.average(law.electrons(flux), frames, k, spot as u32, pixel)
                })
                .collect();
            for (counts, reading) in column.counts.iter_mut().zip(&readings) {
                counts.push(reading.counts);
            }
            column
                .entries
                .push(self.entry(flux, &readings, dark, spot as u32, pixel));
        }
        column
    }

    /// Linearises the longest exposure that is not saturated: value, standard deviation, exposure,
    /// range.
    fn entry(
        &self,
        flux: f64,
        readings: &[Reading],
        dark: &[Reading],
        spot: u32,
        pixel: usize,
    ) -> (f64, f64, usize, Range) {
        let range = |k: usize| match (readings[k].range, dark[k].range) {
            (Range::Saturated, _) | (_, Range::Saturated) => Range::Saturated,
            (Range::Floored, _) | (_, Range::Floored) => Range::Floored,
            _ => Range::Within,
        };
        let fits = (0..readings.len()).find(|k| range(*k) != Range::Saturated);
        let k = fits.unwrap_or(readings.len() - 1);
        let law = &self.laws[k];
        let electrons = (readings[k].counts - dark[k].counts) * self.figures.gain;
        let factor = match self.figures.relative_noise {
            0.0 => 1.0,
            rho => 1.0 + rho * self.stream(spot, pixel, FINISHED).normal(),
        };
        let value = electrons / law.response * factor;
        (value, law.deviation(flux), k, range(k))
    }

    /// The frames of a pixel without laser, for each exposure time; the offset where there are
    /// none.
    fn dark(&self, pixel: usize) -> Vec<Reading> {
        let frames = self.exposure.dark_frames();
        let none = Reading {
            counts: self.figures.offset,
            range: Range::Within,
        };
        (self.laws.iter().zip(0..))
            .map(|(law, k)| match frames {
                0 => none,
                _ => self.average(law.dark, frames, k, Key::ALL_SPOTS, pixel),
            })
            .collect()
    }

    /// The mean of `frames` frames of exposure `k` with `mean` electrons each.
    fn average(&self, mean: f64, frames: u32, k: u32, spot: u32, pixel: usize) -> Reading {
        let mut sum = 0.0;
        let mut range = Range::Within;
        for frame in 0..frames {
            let mut stream = self.stream(spot, pixel, k * frames + frame);
            let (counts, found) = self.frame(mean, &mut stream);
            sum += counts;
            if found != Range::Within && range != Range::Saturated {
                range = found;
            }
        }
        Reading {
            counts: sum / f64::from(frames),
            range,
        }
    }

    /// One frame: electrons, well, read noise, gain, converter.
    fn frame(&self, mean: f64, stream: &mut Stream) -> (f64, Range) {
        let figures = self.figures;
        let electrons = match figures.shot_noise {
            ShotNoise::Poisson => stream.poisson(mean),
            ShotNoise::None => mean,
        };
        let kept = electrons.min(figures.full_well);
        let noise = match figures.read_noise {
            0.0 => 0.0,
            sigma => sigma * stream.normal(),
        };
        let analog = (kept + noise) / figures.gain + figures.offset;
        if figures.bits.is_none() {
            let full = electrons > kept;
            return (
                analog,
                if full {
                    Range::Saturated
                } else {
                    Range::Within
                },
            );
        }
        let rounded = analog.round();
        let top = figures.top();
        let range = if electrons > kept || rounded >= top {
            Range::Saturated
        } else if rounded < 0.0 {
            Range::Floored
        } else {
            Range::Within
        };
        (rounded.clamp(0.0, top), range)
    }

    fn stream(&self, spot: u32, pixel: usize, block: u32) -> Stream {
        let key = Key {
            seed: self.seed,
            spot,
            pixel: pixel as u32,
            block,
        };
        Stream::new(Sampling::Pcg, key)
    }
}
