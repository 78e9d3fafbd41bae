//! The standard deviation that photographs are stated with.

use super::exposure::Light;
use super::law::Law;
use super::photon_transfer::PhotonTransfer;

/// Where the stated standard deviation of a photograph comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stated {
    /// The law of the exposure at the true flux, which no laboratory knows.
    Oracle,
    /// The counts of the metering frame and of the dark frames, and the noise that such counts had
    /// in the calibration.
    Counts(PhotonTransfer),
}

/// A variance, and how well it is known.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Variance {
    /// W².
    value: f64,
    /// Its own variance as a part of `value`, W².
    uncertain: f64,
}

/// What was counted of an entry beside its frames.
#[derive(Clone, Copy, Debug)]
pub(super) struct Counted {
    /// In the metering frame.
    pub metered: f64,
    /// In the dark frames of this pixel, on average.
    pub dark: f64,
    /// In the dark frames of all pixels, on average.
    pub dark_level: f64,
}

impl Stated {
    /// Variance of the linearised flux of an entry, W².
    pub(super) fn variance(&self, law: &Law, counted: Counted, flux: f64) -> Variance {
        match self {
            Self::Oracle => Variance {
                value: law.variance(flux),
                uncertain: 0.0,
            },
            Self::Counts(transfer) => of_counts(law, transfer, counted),
        }
    }
}

/// As [`Law::variance`], of what was counted.
fn of_counts(law: &Law, transfer: &PhotonTransfer, counted: Counted) -> Variance {
    // W per count.
    let unit = law.figures.gain / law.response;
    let frame = transfer.variance(counted.metered);
    let dark = match law.dark_frames {
        0 => 0.0,
        frames => law.averaged_counts(transfer.variance(counted.dark_level), frames),
    };
    let frames = law.averaged_counts(frame, law.frames);
    let relative = law.figures.relative_noise * law.figures.relative_noise;
    let metered = (counted.metered - counted.dark) * unit;
    let value = unit * unit * (frames + dark) * (1.0 + relative) + relative * metered * metered;
    // The metering frame's counts have the variance `frame`, times slope²/F² in the stated one.
    let one = unit * unit * transfer.slope * transfer.slope / f64::from(law.frames);
    let share = unit * unit * frame / f64::from(law.frames) / value;
    Variance {
        value,
        uncertain: if value > 0.0 { one * share } else { one },
    }
}

impl Variance {
    /// With the render's own standard error.
    pub(super) fn with_render(self, light: &Light<'_>, pixel: usize, spot: usize) -> Self {
        let Some((stderr, freedom)) = light.render(pixel, spot) else {
            return self;
        };
        let own = stderr * stderr;
        let value = self.value + own;
        if value <= 0.0 {
            return self;
        }
        let uncertain = self.uncertain * self.value / value + 2.0 * own * own / (freedom * value);
        Self { value, uncertain }
    }

    /// Standard deviation, W. Data are weighted by 1/σ², whose mean is 1/V·(1 + Var V̂/V²) for an
    /// estimate V̂ of the variance V; V̂ + Var V̂/V̂ makes it 1/V to that order. For Poisson counts
    /// this is σ² = N + 1, with the mean (1 − e^−μ)/μ of 1/σ².
    pub(super) fn deviation(self) -> f64 {
        (self.value + self.uncertain).sqrt()
    }
}
