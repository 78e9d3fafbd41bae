//! Photographs as normal equations of the reflectances, frame by frame.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use crate::matrix::Matrix;
use crate::num::linalg::{LinalgError, columns_times, product, svd, tr_product};

/// Directions of the patterns that are weaker than this part of the strongest are none.
const DEPENDENT: f64 = 1e-12;

/// Photographs whose reflectances are unknown.
#[derive(Clone, Copy, Debug)]
pub struct Unexplained<'a> {
    /// Φcam, pixels × spots, W.
    pub phi: &'a Matrix,
    /// Its standard errors up to a common factor, the same shape; all alike where they are unknown.
    pub stderr: Option<&'a Matrix>,
    /// Entries that do not count, the same shape: those that are not 0.
    pub left_out: Option<&'a Matrix>,
    /// Patterns of other light, pixels × patterns, each with a strength of its own in each frame.
    pub patterns: Option<&'a Matrix>,
}

impl Unexplained<'_> {
    /// √w of each pixel of frame l: 1/σ, 0 where the entry does not count or nothing is known of its
    /// error.
    fn roots(&self, l: usize) -> DVector<f64> {
        let root = |p: usize| match self.stderr.map(|s| s[(p, l)]) {
            _ if self.left_out.is_some_and(|flags| flags[(p, l)] != 0.0) => 0.0,
            None => 1.0,
            Some(sigma) if sigma > 0.0 => 1.0 / sigma,
            Some(_) => 0.0,
        };
        DVector::from_fn(self.phi.nrows(), |p, _| root(p))
    }

    /// Entries that count.
    pub(super) fn counted(&self) -> usize {
        let of_frame = |l: usize| self.roots(l).iter().filter(|q| **q > 0.0).count();
        (0..self.phi.ncols()).map(of_frame).sum()
    }

    /// Orthonormal directions of the weighted patterns, pixels × directions.
    fn directions(&self, roots: &DVector<f64>) -> Result<Matrix, LinalgError> {
        let none = Matrix::zeros(roots.len(), 0);
        let Some(patterns) = self.patterns.filter(|f| f.ncols() > 0) else {
            return Ok(none);
        };
        let lengths: Vec<f64> = patterns.column_iter().map(|f| f.amax()).collect();
        let weighted = Matrix::from_fn(patterns.nrows(), patterns.ncols(), |p, k| {
            roots[p] * patterns[(p, k)] / if lengths[k] > 0.0 { lengths[k] } else { 1.0 }
        });
        if weighted.amax() == 0.0 {
            return Ok(none);
        }
        let found = svd(&weighted)?;
        let strong = found
            .sigma
            .iter()
            .take_while(|s| **s > DEPENDENT * found.sigma[0]);
        let kept = strong.count();
        Ok(found.u.columns(0, kept).into_owned())
    }
}

/// What frame l says of the reflectances ρ, other light being whatever fits best:
/// ‖√w (Φ_l − C diag(d_l) ρ)‖² = s − 2 hᵀρ + ρᵀHρ.
#[derive(Clone, Debug)]
pub(super) struct Frame {
    /// H, elements × elements.
    pub h: Matrix,
    /// h.
    pub side: DVector<f64>,
    /// s: what the patterns leave of the frame.
    pub square: f64,
    /// Entries that count, less the directions of the patterns.
    pub count: f64,
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
        let roots = of.roots(l);
        let directions = of.directions(&roots)?;
        let without = |m: Matrix| {
            let once = |m: Matrix| &m - product(&directions, &tr_product(&directions, &m));
            if directions.ncols() == 0 {
                m
            } else {
                once(once(m))
            }
        };
        let seen = without(Matrix::from_fn(roots.len(), camera.ncols(), |p, s| {
            roots[p] * camera[(p, s)]
        }));
        let light = without(Matrix::from_fn(roots.len(), 1, |p, _| {
            roots[p] * of.phi[(p, l)]
        }));
        let counted = roots.iter().filter(|q| **q > 0.0).count();
        Ok(Self {
            gram: tr_product(&seen, &seen),
            side: tr_product(&seen, &light).column(0).into_owned(),
            square: light.norm_squared(),
            count: counted as f64 - directions.ncols() as f64,
        })
    }

    /// Of every frame.
    pub(super) fn all(of: &Unexplained<'_>, camera: &Matrix) -> Result<Vec<Self>, LinalgError> {
        let frames = (0..of.phi.ncols()).into_par_iter();
        frames.map(|l| Self::new(of, camera, l)).collect()
    }

    /// The frame, if it was lit as column `spot` of the laser's side says.
    pub(super) fn lit(&self, terms: TermsOf<'_>, spot: usize) -> Frame {
        let d = terms.laser.column(spot);
        let n = terms.elements;
        let (mut h, mut side) = (DMatrix::zeros(n, n), DVector::zeros(n));
        for (s, &j) in terms.element.iter().enumerate() {
            side[j] += d[s] * self.side[s];
            for (t, &k) in terms.element.iter().enumerate() {
                h[(k, j)] += d[t] * self.gram[(t, s)] * d[s];
            }
        }
        Frame {
            h,
            side,
            square: self.square,
            count: self.count,
        }
    }
}

impl Frame {
    /// Of every frame, lit as the model says.
    pub(super) fn all(of: &Unexplained<'_>, terms: TermsOf<'_>) -> Result<Vec<Self>, LinalgError> {
        let frames = (0..of.phi.ncols()).into_par_iter();
        frames
            .map(|l| Ok(Side::new(of, terms.camera, l)?.lit(terms, l)))
            .collect()
    }

    /// All of `frames` but one, each left out in turn.
    pub(super) fn all_but_one(frames: &[Self], elements: usize) -> impl Iterator<Item = Self> + '_ {
        (0..frames.len()).map(move |out| {
            let others = frames.iter().enumerate().filter(move |(l, _)| *l != out);
            Self::sum(others.map(|(_, frame)| frame), elements)
        })
    }

    /// What the reflectances do not explain of it: s − 2 hᵀρ + ρᵀHρ.
    pub(super) fn left(&self, rho: &DVector<f64>) -> f64 {
        self.square - 2.0 * self.side.dot(rho) + rho.dot(&(&self.h * rho))
    }

    /// All of `frames` together.
    pub(super) fn sum<'a>(frames: impl Iterator<Item = &'a Self>, elements: usize) -> Self {
        let nothing = Self {
            h: DMatrix::zeros(elements, elements),
            side: DVector::zeros(elements),
            square: 0.0,
            count: 0.0,
        };
        frames.fold(nothing, |mut all, frame| {
            all.h += &frame.h;
            all.side += &frame.side;
            all.square += frame.square;
            all.count += frame.count;
            all
        })
    }
}

/// K^½ of the exponential covariance K = exp(−|x_i − x_j|/ℓ) of the elements' places:
/// K = root · rootᵀ.
///
/// # Errors
/// [`LinalgError`].
pub(super) fn covariance_root(places: &[[f64; 3]], length: f64) -> Result<Matrix, LinalgError> {
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
