//! Whether the hidden surface is as large as the scene has it.
//!
//! What lies beyond its edges no picture can show, and the geometry makes up for it. So photographs
//! are fitted with the surface smaller and larger about its middle too, as many elements on it and
//! the geometry following, and another size is told where
//!
//! > ln p′ − ln p > ln 100 · max(1, (σ′/σ)²),
//!
//! σ the error by the curvature of the likelihood and σ′ by what is left of frames or blocks: where
//! that is no independent noise, logarithms of likelihoods say too much by the square of the ratio.

use glam::{DAffine3, DVec3};
use serde::Serialize;

use crate::num::digits::figure;
use crate::scene::Scene;

/// Sizes that are tried, over the scene's.
const FACTORS: [f64; 2] = [0.8, 1.25];
/// ln 100.
const LIKELIER: f64 = 4.605_170_185_988_092;
/// Another size is another place from so many standard errors of an unknown on.
const MOVED: f64 = 2.0;

/// Another size of the hidden surface.
#[derive(Clone, Debug, Serialize)]
pub struct Resized {
    /// Over the scene's, about its middle.
    pub factor: f64,
    /// What is looked for, there.
    pub values: Vec<f64>,
    /// ln of how much likelier the photographs are.
    pub log_likelier: f64,
}

/// The scenes with another size of the hidden surface; none of several.
pub(super) fn resized(scene: &Scene) -> Vec<(f64, Scene)> {
    let mut hidden = scene.hidden();
    let (Some((_, surface)), None) = (hidden.next(), hidden.next()) else {
        return Vec::new();
    };
    let middle = surface.shape.at([0.5; 2]).position;
    let by = |factor: f64| {
        let motion = DAffine3::from_translation(middle)
            * DAffine3::from_scale(DVec3::splat(factor))
            * DAffine3::from_translation(-middle);
        let scene = scene.with_moved_hidden(&motion).ok()?;
        Some((factor, scene))
    };
    FACTORS.into_iter().filter_map(by).collect()
}

impl Resized {
    /// The likelier of two.
    pub(super) fn likelier(self, other: Option<Self>) -> Self {
        match other {
            Some(other) if other.log_likelier > self.log_likelier => other,
            _ => self,
        }
    }

    /// ln of how much likelier it must be to be told, of errors whose squares are so many times
    /// those by the curvature.
    pub(super) fn least(times: f64) -> f64 {
        LIKELIER * times
    }

    /// Whether it is told, of such errors.
    pub(super) fn is_told(&self, times: f64) -> bool {
        self.log_likelier > Self::least(times)
    }

    /// Whether an unknown is elsewhere, of these estimates and standard errors.
    pub(super) fn is_elsewhere(&self, found: impl Iterator<Item = (f64, f64)>) -> bool {
        let mut each = self.values.iter().zip(found);
        each.any(|(there, (value, error))| (there - value).abs() > MOVED * error)
    }

    /// What is said of it; `there` are the unknowns.
    pub(super) fn told(&self, there: &str) -> String {
        format!(
            "With the hidden surface {} times as large about its middle the photographs are e^{} times likelier, with \
             {there}: the scene may have its size WRONG. Give it the size that it has, or one that holds all that is hidden.",
            self.factor,
            figure(self.log_likelier, 2)
        )
    }
}
