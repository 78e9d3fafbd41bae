//! Factors of the light that are known only roughly: what a recovery found of them, in numbers and
//! in words.

use serde::{Deserialize, Serialize};

use super::evidence::FIT_LEVEL;
use crate::num::digits::{figure, significant};
use crate::recovery::{self, Recovered};

/// Standard deviations by which a factor differs from what it was said to be by no chance.
const BEYOND: f64 = 3.0;

/// Factors 1 + ε of the light, as they were estimated.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Gains {
    /// ε_l of each frame.
    pub frames: Option<Deviations>,
    /// ε of all.
    pub whole: Option<Deviations>,
    /// Whether estimating them again changed nothing.
    pub settled: bool,
    /// Mean standard error of the reflectances over what it would be with these factors known.
    pub widened: Option<f64>,
}

impl Gains {
    pub(in crate::lab) fn of(found: &recovery::Gains) -> Self {
        Self {
            frames: found.frames.as_ref().map(Deviations::of),
            whole: found.whole.as_ref().map(Deviations::of),
            settled: found.settled,
            widened: found.widened,
        }
    }

    /// What is said where they are larger than stated.
    pub(in crate::lab) fn larger(&self) -> String {
        let p = self.frames.as_ref().and_then(|frames| frames.p);
        p.filter(|p| *p < FIT_LEVEL).map_or(String::new(), |p| {
            format!("; LARGER than stated (P {})", figure(p, 2))
        })
    }
}

/// Relative deviations ε of one kind.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Deviations {
    /// ε̂.
    pub size: Vec<f64>,
    /// Standard errors.
    pub standard_error: Vec<f64>,
    /// Whether these hold the picture for known.
    pub picture_given: bool,
    /// The standard deviation that was stated.
    pub known_to: f64,
    /// Probability of deviations as large, if that is right; absent where none is determined.
    pub p: Option<f64>,
}

impl Deviations {
    fn of(found: &recovery::Deviations) -> Self {
        Self {
            size: found.size.as_slice().to_vec(),
            standard_error: found.standard_error.as_slice().to_vec(),
            picture_given: found.picture_given,
            known_to: found.known_to,
            p: found.probability(),
        }
    }

    /// Largest |ε̂|.
    fn largest(&self) -> f64 {
        self.size
            .iter()
            .fold(0.0, |largest, size| largest.max(size.abs()))
    }
}

/// What was estimated of factors that are known only roughly, and what the picture loses by them.
pub(in crate::lab) fn words(of: &Gains) -> String {
    let mut words = Vec::new();
    if let Some(frames) = &of.frames {
        words.push(format!(
            "gain of a frame off 1 by up to {} % ({} of the {} % stated)",
            figure(100.0 * frames.largest(), 2),
            significant(frames.largest() / frames.known_to, 2),
            figure(100.0 * frames.known_to, 2),
        ));
    }
    if let Some(whole) = &of.whole {
        words.push(format!(
            "common factor {}{}",
            significant(1.0 + whole.size[0], 5),
            match (of.settled, whole.picture_given) {
                (true, false) => format!(" ± {}", figure(whole.standard_error[0], 2)),
                (true, true) => format!(
                    " (its error this method does not know; ± {} was stated)",
                    figure(whole.known_to, 2)
                ),
                (false, _) => ", not settled".to_owned(),
            }
        ));
    }
    if let Some(widened) = of.widened {
        words.push(format!(
            "standard errors {} times those of known factors",
            significant(widened, 3)
        ));
    }
    words.join("; ")
}

/// Factors that differ from 1 by more than they were said to, or that did not settle.
pub(in crate::lab) fn drifting(found: &Recovered) -> Option<String> {
    let gains = found.nuisance.as_ref()?.gains.as_ref()?;
    let frames = gains.frames.as_ref();
    if let Some(p) = frames
        .and_then(recovery::Deviations::probability)
        .filter(|p| *p < FIT_LEVEL)
    {
        let frames = frames?;
        let mean_square = frames.size.norm_squared() / frames.freedom();
        return Some(format!(
            "the gains of the frames are larger than was said: up to {} times --frame-gain {} (P {}). \
             Give about {}, unless something else differs from frame to frame: their order, the \
             spots, other light",
            significant(frames.largest(), 2),
            frames.known_to,
            figure(p, 2),
            figure(mean_square.sqrt(), 2),
        ));
    }
    if let Some(whole) = &gains.whole
        && whole.largest() > BEYOND
    {
        return Some(format!(
            "the photographs ask for a factor that is {} times --scale-error {} off 1. Are power, \
             aperture and unit right? Or give a larger --scale-error",
            significant(whole.largest(), 2),
            whole.known_to,
        ));
    }
    (!gains.settled).then(|| {
        format!(
            "the factors did not settle in {} steps: picture and gains may still change. Give a \
             smaller --frame-gain or --scale-error, or compare with joint-gp",
            gains.steps
        )
    })
}
