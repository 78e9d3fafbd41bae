//! What can be wrong with a recovery.

mod rules;

use super::{Method, Rule};
use crate::num::control::Stopped;
use crate::num::linalg::LinalgError;
use crate::num::quadratic::QuadraticError;
use rules::{no_answer, other_rules, other_than};

/// Why nothing was recovered.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RecoveryError {
    /// Matrices that do not belong together.
    #[error(
        "{name} is {found_rows} × {found_columns}, but {rows} × {columns} is needed; \
         phi is pixels × spots, c pixels × elements, d elements × spots, all of the same bench"
    )]
    Shape {
        /// Which matrix.
        name: &'static str,
        /// Rows needed.
        rows: usize,
        /// Columns needed.
        columns: usize,
        /// Rows given.
        found_rows: usize,
        /// Columns given.
        found_columns: usize,
    },
    /// A relative standard deviation without meaning.
    #[error(
        "{name} known to {value} has no meaning; give a standard deviation relative to 1, above 0 and at most 1, e.g. 0.05"
    )]
    RelativeDeviation {
        /// Of which factor.
        name: &'static str,
        /// What was given.
        value: f64,
    },
    /// A scale both known roughly and free.
    #[error(
        "a scale that is free is not known to any error; leave out the scale's error, or the free scale"
    )]
    ScaleTwice,
    /// No entry counts.
    #[error("every entry of phi is left out; leave some in")]
    NothingCounts,
    /// An entry is NaN or infinite.
    #[error(
        "{name}[{row}, {column}] is {value}; photographs and model must be finite, so render or repair that entry first"
    )]
    NotFinite {
        /// Which matrix.
        name: &'static str,
        /// Row, from 0.
        row: usize,
        /// Column, from 0.
        column: usize,
        /// The entry.
        value: f64,
    },
    /// Entries whose squares no number holds.
    #[error(
        "{name} has entries of the size {value:e}, whose squares leave the range of numbers; give them in the unit that they are documented in"
    )]
    OutOfScale {
        /// Which matrix.
        name: &'static str,
        /// The largest entry of it, or the least standard error.
        value: f64,
    },
    /// A standard error below zero.
    #[error(
        "the standard error of pixel {pixel}, spot {spot} is {value} W; standard errors are never negative, so check which file was given"
    )]
    NegativeStandardError {
        /// Row, from 0.
        pixel: usize,
        /// Column, from 0.
        spot: usize,
        /// The entry, W.
        value: f64,
    },
    /// More elements than the joint methods or `tikhonov-gradient` can hold.
    #[error(
        "{elements} elements are more than the {most} that this method can hold; use fewer (--elements), or pinv"
    )]
    TooManyElements {
        /// Elements of the model.
        elements: usize,
        /// The limit.
        most: usize,
    },
    /// A pixel that cannot see an element, where the method divides.
    #[error(
        "the model says that pixel {pixel} receives nothing from element {element}, and {method} divides by it; \
         use joint, which does not divide"
    )]
    Unseen {
        /// The method's name.
        method: Method,
        /// Row of C, from 0.
        pixel: usize,
        /// Column of C, from 0.
        element: usize,
    },
    /// Nothing of the model is left to invert.
    #[error(
        "the {side} has rank zero, so no photograph could tell elements apart; check that light reaches the hidden surface, and that photographs and their standard errors are in W"
    )]
    RankZero {
        /// Which side of the model.
        side: &'static str,
    },
    /// Patterns of other light could be all of the model's.
    #[error(
        "other light of this form could be all of the model's light, and nothing is left to tell (fit less: a \
         polynomial of a lower degree, fewer patterns, no background)"
    )]
    TakenUp,
    /// A parameter without meaning.
    #[error("{name} = {value} has no meaning for {method}; {cure}")]
    BadParameter {
        /// The method's name.
        method: Method,
        /// The parameter.
        name: &'static str,
        /// What was given.
        value: f64,
        /// What would do.
        cure: &'static str,
    },
    /// No noise model and no parameter.
    #[error(
        "{method} needs to know the noise to choose its {parameter}; give the standard error of phi (phi.stderr.npy), \
         {}give the {parameter} yourself", other_rules(*method)
    )]
    NoNoiseModel {
        /// The method's name.
        method: Method,
        /// What would have to be given.
        parameter: &'static str,
    },
    /// A noise model that says there is no noise.
    #[error(
        "every standard error is zero, and {method} chooses its {parameter} by how much noise there is; give the true standard error of phi, \
         {}give the {parameter} yourself", other_rules(*method)
    )]
    NoNoise {
        /// The method's name.
        method: Method,
        /// What would have to be given.
        parameter: &'static str,
    },
    /// A rule that has no answer for these data.
    #[error(
        "the {rule} rule finds no {parameter} for {method}: {}; choose by {}, or give the {parameter} yourself",
        no_answer(*rule), other_than(*rule)
    )]
    Undecided {
        /// The method's name.
        method: Method,
        /// The rule.
        rule: Rule,
        /// What would have to be given.
        parameter: &'static str,
    },
    /// An inverse that does not exist.
    #[error(
        "{method} does not exist: the laser side ({elements} elements × {spots} spots) has numerical rank {rank} where {needed} is needed; \
         use {}, or pinv, which needs no full rank",
        if spots < elements { "as many spots as elements or more for the right inverse" } else { "fewer elements for the right inverse" }
    )]
    NotFullRank {
        /// The method's name.
        method: Method,
        /// Numerical rank of D.
        rank: usize,
        /// The rank needed.
        needed: usize,
        /// Rows of D.
        elements: usize,
        /// Columns of D.
        spots: usize,
    },
    /// Grids that are not those of the elements.
    #[error(
        "the element grids hold {covered} elements (each at least one), but the model has {elements}; give nu and nv of every hidden surface in order"
    )]
    Grids {
        /// Elements of the grids.
        covered: usize,
        /// Elements of the model.
        elements: usize,
    },
    /// A method that compares neighbours was told of none.
    #[error(
        "{method} compares neighbouring elements and knows of none; give element grids of which one has more than one element, \
         or use tikhonov"
    )]
    NoGrids {
        /// The method's name.
        method: Method,
    },
    /// Nothing was photographed.
    #[error(
        "every entry of phi is zero: no light reached the camera, so there is nothing to recover; check the laser, the albedos and that the right file was given"
    )]
    Dark,
    /// The discrepancy principle has no answer: the data lie further from the model than the noise
    /// allows.
    #[error(
        "even with the least regularisation the residual is {residual:.3e} W where the noise allows {limit:.3e} W: the standard errors \
         are too small or the model does not describe these photographs; correct either, or give the {parameter} yourself"
    )]
    NoiseUnderstated {
        /// Frobenius norm of the residual, W.
        residual: f64,
        /// The largest norm that the noise explains, W.
        limit: f64,
        /// What would have to be given.
        parameter: &'static str,
    },
    /// The same of weighted joint residuals.
    #[error(
        "even with the least regularisation the weighted residual is {residual:.3e} where the noise allows {limit:.3e}: the standard errors \
         are too small or the model does not describe these photographs; correct either, or give the total variation's weight yourself"
    )]
    JointNoiseUnderstated {
        /// ‖R ρ − d‖², in variances of the noise.
        residual: f64,
        /// The largest that the noise explains.
        limit: f64,
    },
    /// The discrepancy principle has no answer: the data are no more than noise.
    #[error(
        "the photographs ({signal:.3e} W in all) do not rise above their noise ({limit:.3e} W), so there is nothing to recover; \
         take more samples, or give the {parameter} yourself"
    )]
    NoSignal {
        /// Frobenius norm of Φ, W.
        signal: f64,
        /// The norm that noise alone explains, W.
        limit: f64,
        /// What would have to be given.
        parameter: &'static str,
    },
    /// Something that the method cannot do.
    #[error("{method} {what}; {cure}")]
    NotForMethod {
        /// The method's name.
        method: Method,
        /// What it cannot do, or lacks.
        what: &'static str,
        /// What would do.
        cure: &'static str,
    },
    /// A free scale, and nothing to scale.
    #[error(
        "with a free scale the brightest element is the unit, but no element comes out bright (the largest is {largest:.1e}); \
         check that the photographs hold light of the hidden surface, or give the scale"
    )]
    NoScale {
        /// The largest estimate of s ρ.
        largest: f64,
    },
    /// It was stopped from outside before it was finished.
    #[error("stopped before it was finished, so there is no picture of it; recover again for one")]
    Stopped(#[from] Stopped),
    /// A decomposition failed.
    #[error(transparent)]
    Linalg(#[from] LinalgError),
    /// The bounded solver failed.
    #[error(transparent)]
    Quadratic(#[from] QuadraticError),
}

impl RecoveryError {
    /// No direction of the joint operator is above rounding.
    pub(super) const NO_DIRECTION: Self = Self::RankZero {
        side: "model C, D as a whole",
    };
}
