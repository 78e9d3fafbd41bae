//! The chain itself: electrons, counts, and back to a flux.

use rayon::prelude::*;

use super::deviation::{Counted, Stated};
use super::error::SensorError;
use super::exposure::{Exposure, Light};
use super::figures::{Figures, Sensor};
use super::frame::Range;
use super::law::Law;
use crate::matrix::Matrix;
use crate::num::stream::{Key, Sampling, Stream};

/// Parts the random numbers of a sensor from those of the tracer under the same seed.
const OWN: u64 = 0x7365_6e73_6f72;
/// The block of the numbers that are not of one frame.
const FINISHED: u32 = u32::MAX;
/// The first block of the metering frames, one for each exposure time.
const METERING: u32 = 1 << 31;

/// Photographs as a sensor takes them.
#[derive(Clone, Debug, PartialEq)]
pub struct Exposed {
    /// Linearised flux, pixels × spots, W.
    pub flux: Matrix,
    /// Its standard deviation as it was asked for, W; that of a saturated entry means nothing.
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

/// What the metering frames of an entry say.
#[derive(Clone, Copy, Debug)]
struct Metered {
    /// The longest exposure that they leave room in above, or else the shortest.
    bracket: usize,
    /// Counts of the metering frame of that exposure.
    counts: f64,
    /// Whether they leave none above, or below.
    is_near: bool,
}

/// Frames without laser.
struct Dark {
    /// Of each pixel, for each exposure time.
    readings: Vec<Vec<Reading>>,
    /// Mean counts over the pixels, for each exposure time.
    levels: Vec<f64>,
    /// Whether these stay above 0 counts, noise included; so where there are no dark frames.
    clears: Vec<bool>,
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
    /// A metering frame of each exposure time goes before the frames of each entry. It chooses the
    /// exposure time and, with [`Stated::Counts`], the standard deviation; being no part of the
    /// mean, it leaves that without bias.
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
        stated: Stated,
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
            light,
            exposure,
            laws: &laws,
            stated,
            seed: seed ^ OWN,
        };
        let readings: Vec<Vec<Reading>> = (0..pixels)
            .into_par_iter()
            .map(|pixel| chain.dark(pixel))
            .collect();
        let level = |k: usize| readings.iter().map(|r| r[k].counts).sum::<f64>() / pixels as f64;
        let levels: Vec<f64> = (0..laws.len()).map(level).collect();
        let clears = |level: &f64| {
            exposure.dark_frames() == 0 || self.figures().clears(self.figures().electrons(*level))
        };
        let dark = Dark {
            readings,
            clears: levels.iter().map(clears).collect(),
            levels,
        };
        let columns: Vec<Column> = (0..spots)
            .into_par_iter()
            .map(|spot| chain.column(spot, &dark))
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
    light: &'a Light<'a>,
    exposure: &'a Exposure,
    laws: &'a [Law],
    stated: Stated,
    seed: u64,
}

impl Chain<'_> {
    /// All entries of one photograph.
    fn column(&self, spot: usize, dark: &Dark) -> Column {
        let pixels = self.light.shape().0;
        let mut column = Column {
            entries: Vec::with_capacity(pixels),
            counts: vec![Vec::with_capacity(pixels); self.laws.len()],
        };
        for pixel in 0..pixels {
            let flux = self.light.of_laser(pixel, spot);
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
                .push(self.entry(&readings, dark, spot, pixel));
        }
        column
    }

    /// The longest exposure whose metering frame leaves room for the noise of those that follow.
    fn meter(&self, flux: f64, spot: u32, pixel: usize) -> Metered {
        let mut found = Metered {
            bracket: 0,
            counts: self.figures.offset,
            is_near: true,
        };
        for (law, k) in self.laws.iter().zip(0..) {
            let mut stream = self.stream(spot, pixel, METERING + k);
            let (counts, range) = self.figures.frame(law.electrons(flux), &mut stream);
            let electrons = self.figures.electrons(counts);
            let fits = range != Range::Saturated && self.figures.fits(electrons);
            found = Metered {
                bracket: k as usize,
                counts,
                is_near: !(fits && self.figures.clears(electrons)),
            };
            if fits {
                break;
            }
        }
        found
    }

    /// Linearises the metered exposure: value, standard deviation, exposure, range.
    fn entry(
        &self,
        readings: &[Reading],
        dark: &Dark,
        spot: usize,
        pixel: usize,
    ) -> (f64, f64, usize, Range) {
        let flux = self.light.of_laser(pixel, spot);
        let metered = self.meter(flux, spot as u32, pixel);
        let k = metered.bracket;
        let (reading, own) = (readings[k], dark.readings[pixel][k]);
        let range = match (reading.range, own.range) {
            (Range::Saturated, _) | (_, Range::Saturated) => Range::Saturated,
            (Range::Floored, _) | (_, Range::Floored) => Range::Floored,
            _ if metered.is_near || !dark.clears[k] => Range::Near,
            _ => Range::Within,
        };
        let law = &self.laws[k];
        let electrons = (reading.counts - own.counts) * self.figures.gain;
        let factor = match self.figures.relative_noise {
            0.0 => 1.0,
            rho => 1.0 + rho * self.stream(spot as u32, pixel, FINISHED).normal(),
        };
        let counted = Counted {
            metered: metered.counts,
            dark: own.counts,
            dark_level: dark.levels[k],
        };
        let variance = self.stated.variance(law, counted, flux);
        let deviation = variance.with_render(self.light, pixel, spot).deviation();
        (electrons / law.response * factor, deviation, k, range)
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
            let (counts, found) = self.figures.frame(mean, &mut stream);
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
