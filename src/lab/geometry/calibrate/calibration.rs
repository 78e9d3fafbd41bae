//! What a calibration finds.

use serde::Serialize;

use super::{AtEdge, Beforehand, Direction, Elsewhere, FinerElements, Identified, Profile, Stage};
use crate::lab::geometry::light_left_out::LightLeftOut;
use crate::lab::geometry::located::Grid;
use crate::lab::geometry::resized::Resized;
use crate::matrix::Matrix;
use crate::recovery::ErrorField;

/// Of a prior's variance what is always counted as told: an error is known to no better.
const LEAST: f64 = 0.01;

/// An unknown, as it was found.
#[derive(Clone, Debug, Serialize)]
pub struct Calibrated {
    /// Its name.
    pub name: String,
    /// Its unit.
    pub unit: String,
    /// Standard deviation known beforehand.
    pub prior: Option<f64>,
    /// The estimate, from what the scene says.
    pub value: f64,
    /// Its standard error.
    pub stderr: f64,
    /// By the curvature alone.
    pub by_curvature: f64,
    /// By the slopes of frames, where more than noise is left.
    pub by_frames: Option<f64>,
    /// By those of blocks of pixels.
    pub by_blocks: Option<f64>,
    /// By the priors of the picture that the photographs do not exclude.
    pub by_pictures: f64,
    /// How far a finer rule of integration would move it: a part of the error where light is
    /// integrated, told where it is taken by centres.
    pub by_rule: Option<f64>,
    /// How far finer elements of the picture move it, where the photographs ask for them: a part of
    /// the error.
    pub by_elements: Option<f64>,
    /// How far even light of 1 % of the mean that the model leaves out moves it; absent where other
    /// light is estimated. No part of the error.
    pub by_even_light: Option<f64>,
    /// Variance by what is no noise: other pictures, a finer rule where light is integrated, finer
    /// elements.
    pub beside_noise: f64,
    /// What the photographs tell of it at the start.
    pub identified: Identified,
    /// Its profile; absent of gains and of more than twelve parameters.
    pub profile: Option<Profile>,
}

impl Calibrated {
    /// How far the estimate is from 0, over the standard deviation that what was known lets expect:
    /// it is drawn there, √(prior² − error²). 0 where nothing was known.
    pub(super) fn off(&self) -> f64 {
        self.prior.map_or(0.0, |prior| {
            let known = prior * prior;
            let own = (known - self.by_curvature * self.by_curvature).max(LEAST * known);
            self.value.abs() / (own + self.beside_noise).sqrt()
        })
    }
}

/// How far the starts led to one place.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Starts {
    /// How many.
    pub tried: usize,
    /// Those that ended where the best one did.
    pub agree: usize,
}

/// The calibrated scene.
#[derive(Clone, Debug, Serialize)]
pub struct Calibration {
    /// Name of the scene.
    pub scene: String,
    /// Its hash.
    pub scene_hash: String,
    /// Geometric parameters, then gains.
    pub found: Vec<Calibrated>,
    /// Whether light is integrated: then what a finer rule moves is counted in the errors.
    pub is_integrated: bool,
    /// What elements of half the size say; absent where they were not tried: of more than 100
    /// elements or large photographs, surfaces of different numbers, meshes.
    pub finer_elements: Option<FinerElements>,
    /// Combinations that the photographs alone do not tell.
    pub untold: Vec<Direction>,
    /// The parameters together against what was known beforehand; absent where nothing was, and
    /// where of no direction that was known the photographs tell enough.
    pub beforehand: Option<Beforehand>,
    /// What light that the model leaves out would explain of what is left over; nothing where that
    /// is not asked: of noise that is not stated or that entries share, and of light that all
    /// frames share and that is estimated.
    pub light_left_out: Vec<LightLeftOut>,
    /// By how much the least χ² rises with even light of 1 % of the mean; absent likewise.
    pub even_light_chi2: Option<f64>,
    /// What is left of the brightest percent of entries over their noise, on average; absent of
    /// noise that is not stated and where light that all frames share is estimated.
    pub brightest: Option<f64>,
    /// Replicates as from which the stated noise is known, pooled over pixels and spots where these
    /// are few; absent where it is known or not stated.
    pub replicates: Option<u32>,
    /// How many times too small the errors are for that, where it is much.
    pub too_small: Option<f64>,
    /// Which entries share their errors, where they do, and what gives each its own.
    pub shared: Option<[&'static str; 2]>,
    /// Whether the stated noise follows from the noisy entries, and what light to expect in these
    /// is not known.
    pub follows_entries: bool,
    /// Correlation of what is left of neighbouring pixels, where the noise is stated and it is more
    /// than chance: then errors are those by frames and blocks too.
    pub neighbours: Option<f64>,
    /// Estimated noise over the stated one (1 where it is stated), or W.
    pub noise: f64,
    /// χ² over degrees of freedom at that noise.
    pub misfit: f64,
    /// The same by a finer rule of integration, the unknowns moved as that asks.
    pub finer_misfit: Option<f64>,
    /// Probability of as large a one by noise alone; absent where the noise is not known.
    pub finer_p: Option<f64>,
    /// Degrees of freedom.
    pub dof: f64,
    /// Probability of so bad a fit by noise alone; absent where the noise is not stated.
    pub p: Option<f64>,
    /// The errors that what is left over is taken for, in place of noise of single pixels.
    pub field: Option<ErrorField>,
    /// ln of how much likelier the photographs are with these errors, each with its own geometry.
    pub log_likelier: Option<f64>,
    /// ‖what is not explained‖/‖what other light leaves‖, weighted by the stated noise.
    pub left: f64,
    /// Estimated scale of all light; 1 where it is known.
    pub scale: f64,
    /// τ of the likeliest prior of pictures, by which the geometry was found.
    pub spread: f64,
    /// ℓ of it, in the scene's unit; 0 for elements that know nothing of each other.
    pub length: f64,
    /// The best start's way through the noises.
    pub stages: Vec<Stage>,
    /// Whether the last stage ended by itself.
    pub is_settled: bool,
    /// Unknowns that an edge of the scene holds there; their errors do not know it.
    pub held: Vec<AtEdge>,
    /// The starts.
    pub starts: Starts,
    /// Whether other places and sizes of the surface were looked for beside the starts.
    pub is_looked_around: bool,
    /// Other places that the photographs do not tell from this one.
    pub elsewhere: Vec<Elsewhere>,
    /// Another size of the hidden surface by which they are much likelier.
    pub resized: Option<Resized>,
    /// The picture, the mean over all priors by their evidence, as of `joint-gp` by this geometry;
    /// errors of the geometry included.
    pub grids: Vec<Grid>,
    /// Its standard errors with the geometry given, in the order of the grids.
    pub stderr_given: Vec<f64>,
    /// Covariance of the elements of all grids, those of the geometry included; none of so many
    /// elements that there is none with the geometry given.
    #[serde(skip)]
    pub covariance: Option<Matrix>,
    /// Directions of the picture that the photographs determine.
    pub directions: f64,
    /// What speaks against believing the errors of the picture, each with its cure.
    pub picture_warnings: Vec<String>,
    /// Correlation with the scene's own picture and MTF raw, where that is known.
    pub correlation: Option<f64>,
    /// The same.
    pub mtf_raw: Option<f64>,
    /// SHA-256 of the calibrated scene's file, so that it is told if that is changed.
    pub scene_sha256: String,
    /// The calibrated scene as a file.
    #[serde(skip)]
    pub toml: String,
}
