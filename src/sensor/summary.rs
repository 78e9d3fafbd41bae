//! An exposure in a few numbers.

use serde::Serialize;

use super::expose::Exposed;
use super::exposure::{Exposure, Light};
use super::figures::Sensor;
use super::frame::Range;
use super::law::Law;

/// What photographs came to.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Summary {
    /// Pixels times spots.
    pub entries: usize,
    /// Electrons in one frame of the longest exposure, expected: mean over all entries.
    pub electrons_mean: f64,
    /// The largest of them.
    pub electrons_max: f64,
    /// Entries whose full well or converter was at its end in every exposure.
    pub saturated: usize,
    /// Entries that no frame saturates, but that every exposure brings within their noise of the
    /// end.
    pub near: usize,
    /// Entries whose counts the converter cut off below 0.
    pub floored: usize,
    /// Entries taken from each exposure time, the longest first.
    pub taken: Vec<usize>,
    /// Dark current and ambient light that stay in every entry because no dark frames were
    /// subtracted, W.
    pub pedestal: f64,
    /// Part of the variance that comes from the dark frames, mean over the entries within range: an
    /// error that all spots of a pixel have in common.
    pub common: f64,
    /// Part of the variance that is the render's own error, mean over the entries within range.
    pub render: f64,
    /// Signal (the clean flux) over standard deviation, mean over the entries within range; `None`
    /// without such entries or without noise.
    pub snr_mean: Option<f64>,
    /// The largest of them.
    pub snr_max: Option<f64>,
}

impl Summary {
    /// Sums up what `sensor` made of `light`.
    pub fn new(sensor: &Sensor, light: &Light<'_>, exposure: &Exposure, exposed: &Exposed) -> Self {
        let electrons = sensor.expected(light, exposure).electrons;
        let (pixels, spots) = light.shape();
        let within = |at: &usize| exposed.range[*at] == Range::Within;
        let counted: Vec<usize> = (0..pixels * spots).filter(within).collect();
        let snr: Vec<f64> = counted
            .iter()
            .map(|at| light.signal(at % pixels, at / pixels) / exposed.stderr[*at])
            .collect();
        let laws = Law::of(sensor.figures(), light, exposure);
        // Of the whole by the law: a stated variance is that of clipped counts, too.
        let shares = counted.iter().map(|at| {
            let (pixel, spot) = (at % pixels, at / pixels);
            let law = &laws[exposed.bracket[*at]];
            let own = light.render(pixel, spot).map_or(0.0, |(own, _)| own * own);
            let all = law.variance(light.of_laser(pixel, spot)) + own;
            [law.common(), own].map(|part| if all > 0.0 { part / all } else { 0.0 })
        });
        let [common, render] = shares.fold([0.0; 2], |sum, s| [sum[0] + s[0], sum[1] + s[1]]);
        let mean = |sum: f64| sum / counted.len().max(1) as f64;
        let noisy = exposed.stderr.iter().all(|s| *s > 0.0) && !snr.is_empty();
        Self {
            entries: pixels * spots,
            electrons_mean: electrons.mean(),
            electrons_max: electrons.max(),
            saturated: exposed.count(Range::Saturated),
            near: exposed.count(Range::Near),
            floored: exposed.count(Range::Floored),
            taken: (0..exposure.times().len())
                .map(|k| exposed.bracket.iter().filter(|b| **b == k).count())
                .collect(),
            pedestal: laws[0].pedestal(),
            common: mean(common),
            render: mean(render),
            snr_mean: noisy.then(|| snr.iter().sum::<f64>() / snr.len() as f64),
            snr_max: noisy.then(|| snr.iter().copied().fold(0.0, f64::max)),
        }
    }
}
