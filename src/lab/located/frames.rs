//! Photographs as normal equations of the reflectances, frame by frame.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use crate::lab::normal::Normal;
use crate::lab::unexplained::Unexplained;
use crate::matrix::Matrix;
use crate::model::MatrixModel;
use crate::num::linalg::{LinalgError, columns_times, svd, tr_product};

/// Terms of a model: Φ = Σ_s ρ_element(s) · camera\[·,s\] · laser\[s,·\].
#[derive(Clone, Copy, Debug)]
pub(super) struct TermsOf<'a> {
    /// Pixels × terms.
    pub camera: &'a Matrix,
    /// Terms × spots.
    pub laser: &'a Matrix,
    /// Element of each term.
    pub element: &'a [usize],
    /// Number of elements.
    pub elements: usize,
}

impl<'a> TermsOf<'a> {
    /// Each element by its centre; `element` is 0, 1, ….
    pub(super) fn centres(model: &'a MatrixModel, element: &'a [usize]) -> Self {
        Self {
            camera: &model.camera_side,
            laser: &model.laser_side,
            element,
            elements: element.len(),
        }
    }
}

/// What a frame says of the camera's side alone: weighted, without the patterns.
#[derive(Clone, Debug)]
pub(super) struct Side {
    /// Cᵀ W C, terms × terms.
    gram: Matrix,
    /// Cᵀ W Φ_l.
    side: DVector<f64>,
    square: f64,
    count: f64,
}

impl Side {
    /// Of frame l.
    fn new(of: &Unexplained<'_>, camera: &Matrix, l: usize) -> Result<Self, LinalgError> {
        let white = of.whitening(l)?;
        let seen = white.apply(camera);
        let light = white.apply(&of.phi.columns(l, 1).into_owned());
        Ok(Self {
            gram: tr_product(&seen, &seen),
            side: tr_product(&seen, &light).column(0).into_owned(),
            square: light.norm_squared(),
            count: white.count(),
        })
    }

    /// Of every frame.
    pub(super) fn all(of: &Unexplained<'_>, camera: &Matrix) -> Result<Vec<Self>, LinalgError> {
        let frames = (0..of.phi.ncols()).into_par_iter();
        frames.map(|l| Self::new(of, camera, l)).collect()
    }

    /// The frame, if it was lit as column `spot` of the laser's side says.
    pub(super) fn lit(&self, terms: TermsOf<'_>, spot: usize) -> Normal {
        let d = terms.laser.column(spot);
        let n = terms.elements;
        let (mut h, mut side) = (DMatrix::zeros(n, n), DVector::zeros(n));
        for (s, &j) in terms.element.iter().enumerate() {
            side[j] += d[s] * self.side[s];
            for (t, &k) in terms.element.iter().enumerate() {
                h[(k, j)] += d[t] * self.gram[(t, s)] * d[s];
            }
        }
        Normal {
            h,
            side,
            square: self.square,
            count: self.count,
        }
    }
}

/// What every frame says, lit as the model says.
pub(super) fn normals(
    of: &Unexplained<'_>,
    terms: TermsOf<'_>,
) -> Result<Vec<Normal>, LinalgError> {
    let frames = (0..of.phi.ncols()).into_par_iter();
    frames
        .map(|l| Ok(Side::new(of, terms.camera, l)?.lit(terms, l)))
        .collect()
}

/// K^½ of the exponential covariance K = exp(−|x_i − x_j|/ℓ) of the elements' places:
/// K = root · rootᵀ.
///
/// # Errors
/// [`LinalgError`].
pub(in crate::lab) fn covariance_root(
    places: &[[f64; 3]],
    length: f64,
) -> Result<Matrix, LinalgError> {
    let n = places.len();
    let distance = |i: usize, j: usize| {
        let square = |k: usize| (places[i][k] - places[j][k]) * (places[i][k] - places[j][k]);
        (0..3).map(square).sum::<f64>().sqrt()
    };
    let found = svd(&Matrix::from_fn(n, n, |i, j| {
        libm::exp(-distance(i, j) / length)
    }))?;
    let roots: Vec<f64> = found.sigma.iter().map(|s| s.sqrt()).collect();
    Ok(columns_times(found.u, &roots))
}
