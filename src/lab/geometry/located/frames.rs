//! Photographs as normal equations of the reflectances, frame by frame.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use crate::lab::geometry::common::Common;
use crate::lab::geometry::normal::Normal;
use crate::lab::uncertainty::unexplained::Unexplained;
use crate::matrix::Matrix;
use crate::model::{Factors, MatrixModel, Terms};
use crate::num::linalg::{LinalgError, columns_times, rows_times, svd, tr_product};

/// A frame with this share of a pixel's weight leaves the others nothing to tell its light by.
const ALONE: f64 = 1.0 - 1e-9;

/// Photographs, and the light that all frames share, unknown in each pixel, if any.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seen<'a> {
    /// Less their means where such light is taken out.
    pub photographs: Unexplained<'a>,
    /// These means.
    pub common: Option<&'a Common>,
}

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

    /// As the model of an albedo of 1 has them; `own` is 0, 1, ….
    pub(super) fn of(model: &'a MatrixModel, own: &'a [usize]) -> Self {
        match &model.factors {
            Some(Factors { terms, .. }) => Self {
                camera: &terms.camera,
                laser: &terms.laser,
                element: &terms.element,
                elements: own.len(),
            },
            None => Self::centres(model, own),
        }
    }

    /// With matrices of its own, each frame lit as column `spots` of the laser's side says.
    pub(super) fn lit(self, spots: &[usize]) -> Terms {
        Terms {
            camera: self.camera.clone(),
            laser: self.laser.select_columns(spots),
            element: self.element.to_vec(),
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

/// What all frames say of the camera's side alone.
#[derive(Debug)]
pub(super) struct Sides<'a> {
    each: Vec<Side>,
    common: Option<&'a Common>,
}

impl<'a> Sides<'a> {
    /// Of every frame.
    pub(super) fn new(seen: Seen<'a>, camera: &Matrix) -> Result<Self, LinalgError> {
        let of = &seen.photographs;
        let frames = (0..of.phi.ncols()).into_par_iter();
        let each = frames.map(|l| Side::new(of, camera, l));
        Ok(Self {
            each: each.collect::<Result<_, _>>()?,
            common: seen.common,
        })
    }

    /// Number of frames.
    pub(super) fn len(&self) -> usize {
        self.each.len()
    }

    /// All frames, each lit as the column of the laser's side behind it says. Of light A, means Ā,
    /// AᵀWA − ĀᵀWĀ is left beside what all share, W the sums of each pixel's weights.
    pub(super) fn lit(&self, frames: &[(usize, usize)], terms: TermsOf<'_>) -> Normal {
        let lit = frames
            .iter()
            .map(|(l, spot)| self.each[*l].lit(terms, *spot));
        let lit: Vec<Normal> = lit.collect();
        let mut all = Normal::sum(lit.iter(), terms.elements);
        if let Some(common) = self.common {
            let mut spots = vec![0; frames.len()];
            for (l, spot) in frames {
                spots[*l] = *spot;
            }
            let mean = terms.lit(&spots).mean(common.shares(), terms.elements);
            let mean = rows_times(mean, common.roots().as_slice());
            all.h -= tr_product(&mean, &mean);
            all.count -= common.directions();
        }
        all
    }
}

/// What the photographs say of the reflectances, lit as the model says.
#[derive(Debug)]
pub(super) struct Frames {
    /// Each frame: that without which the others are left.
    pub each: Vec<Normal>,
    /// What is to be added to them where they share a light.
    shared: Option<Normal>,
    elements: usize,
}

impl Frames {
    /// Beside a light that all frames share, a direction of each pixel, there remain of x_l, √w
    /// times the light of frame l, with s_l = w_l/Σ_k w_k
    ///
    /// > x̃_l = x_l − √s_l Σ_k √s_k x_k,   Σ_l x̃_l x̃_lᵀ,   and without frame m that less
    /// > x̃_m x̃_mᵀ/(1 − s_m).
    ///
    /// The last is frame m as the others predict it, in units of the error of that.
    ///
    /// # Errors
    /// [`LinalgError`].
    pub(super) fn new(seen: Seen<'_>, terms: TermsOf<'_>) -> Result<Self, LinalgError> {
        let (of, elements) = (&seen.photographs, terms.elements);
        let frames = (0..of.phi.ncols()).into_par_iter();
        let Some(common) = seen.common else {
            let each = frames.map(|l| Ok(Side::new(of, terms.camera, l)?.lit(terms, l)));
            return Ok(Self {
                each: each.collect::<Result<_, _>>()?,
                shared: None,
                elements,
            });
        };
        let shares = common.shares();
        let terms = terms.lit(&(0..of.phi.ncols()).collect::<Vec<_>>());
        let mean = terms.mean(shares, elements);
        let both = |l: usize| {
            let mut columns = (terms.frame(l, elements) - &mean).insert_column(elements, 0.0);
            columns.set_column(elements, &of.phi.column(l));
            let told = shares.column(l).map(|s| if s < ALONE { s } else { 0.0 });
            let scale = of
                .roots(l)
                .zip_map(&told, |root, s| root / (1.0 - s).sqrt());
            let scale = scale.zip_map(&told, |x, s| if s > 0.0 { x } else { 0.0 });
            let predicted = rows_times(columns, scale.as_slice());
            let count = told.iter().filter(|s| **s > 0.0).count() as f64;
            let own = Normal::of(&predicted, count);
            let part = rows_times(predicted, told.map(f64::sqrt).as_slice());
            (own, Normal::of(&part, 0.0))
        };
        let (each, parts): (Vec<Normal>, Vec<Normal>) = frames.map(both).unzip();
        let parts = Normal::sum(parts.iter(), elements);
        let several = |row: &_| -> bool {
            let most = nalgebra::Matrix::max(row);
            most > 0.0 && most < ALONE
        };
        let shared = Normal {
            h: -parts.h,
            side: -parts.side,
            square: -parts.square,
            count: -(shares.row_iter().filter(several).count() as f64),
        };
        Ok(Self {
            each,
            shared: Some(shared),
            elements,
        })
    }

    /// All frames.
    pub(super) fn all(&self) -> Normal {
        Normal::sum(self.each.iter().chain(&self.shared), self.elements)
    }

    /// All but one, each left out in turn.
    pub(super) fn all_but_one(&self) -> impl Iterator<Item = Normal> + '_ {
        (0..self.each.len()).map(|out| {
            let others = self.each[..out].iter().chain(&self.each[out + 1..]);
            Normal::sum(others.chain(&self.shared), self.elements)
        })
    }
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
