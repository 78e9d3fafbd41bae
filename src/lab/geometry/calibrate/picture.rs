//! What is known of the hidden picture before its photographs.
//!
//! > ρ = m·1 + R z,  z ~ N(0, 1),   R Rᵀ = s² (σ² 11ᵀ + τ² k),   k_ij = exp(−|x_i − x_j|/ℓ)
//!
//! m = σ = ½ where the scale is known; where it is free m = 0, σ² = ½ (the mean square of a mean of
//! ½ ± ½) and s is the likeliest. τ and ℓ are the likeliest pair of a few.

use nalgebra::DVector;

use crate::lab::error::LabError;
use crate::lab::geometry::located::covariance_root;
use crate::lab::geometry::normal::Normal;
use crate::matrix::Matrix;
use crate::num::linalg::{Cholesky, product, svd, tr_product};
use crate::num::search::largest;

/// Standard deviations τ of a picture about its mean; more of one whose scale is free, for what is
/// bright in it may be little of it.
const SPREADS: [f64; 6] = [0.03, 0.1, 0.25, 0.5, 1.0, 2.0];
const KNOWN: usize = 4;
/// Lengths ℓ in distances of neighbours; 0 is a picture whose elements know nothing of each other.
const LENGTHS: [f64; 4] = [0.0, 1.5, 6.0, 24.0];
const HALF: f64 = 0.5;
/// Decades about the first guess in which a free scale is looked for.
const DECADES: f64 = 3.0;
/// Largest eigenvalue beside which 1 is not lost in a decomposition.
const RESOLVED: f64 = 1e13;

/// A prior of pictures.
#[derive(Clone, Debug)]
pub(super) struct Prior {
    /// m.
    pub mean: f64,
    /// R, elements × (elements + 1).
    pub root: Matrix,
    /// τ and ℓ (0: none), in the scene's unit.
    pub spread: f64,
    pub length: f64,
    /// s, 1 where the scale is known.
    pub scale: f64,
}

/// All pairs of τ and ℓ for elements at `places`, scale 1.
pub(super) fn priors(places: &[[f64; 3]], is_free: bool) -> Result<Vec<Prior>, LabError> {
    let n = places.len();
    let apart = |i: usize, j: usize| {
        let square = |k: usize| (places[i][k] - places[j][k]) * (places[i][k] - places[j][k]);
        (0..3).map(square).sum::<f64>().sqrt()
    };
    let pairs = (0..n).flat_map(|i| (0..i).map(move |j| (i, j)));
    let nearest = pairs.map(|(i, j)| apart(i, j)).filter(|d| *d > 0.0);
    let nearest = nearest.fold(f64::INFINITY, f64::min);
    let (mean, deviation) = if is_free {
        (0.0, HALF.sqrt())
    } else {
        (HALF, HALF)
    };
    let mut all = Vec::new();
    for neighbours in LENGTHS {
        let length = if nearest.is_finite() {
            neighbours * nearest
        } else {
            0.0
        };
        let own = if length > 0.0 {
            covariance_root(places, length)?
        } else {
            Matrix::identity(n, n)
        };
        let spreads = &SPREADS[..if is_free { SPREADS.len() } else { KNOWN }];
        all.extend(spreads.iter().map(|&spread| Prior {
            mean,
            root: Matrix::from_fn(n, n + 1, |i, j| {
                if j == 0 {
                    deviation
                } else {
                    spread * own[(i, j - 1)]
                }
            }),
            spread,
            length,
            scale: 1.0,
        }));
    }
    Ok(all)
}

impl Prior {
    /// The likeliest of `all`, and with a free scale its likeliest scale.
    pub(super) fn likeliest(all: &[Self], of: &Normal, is_free: bool) -> Result<Self, LabError> {
        let mut best: Option<(f64, &Self, f64)> = None;
        for prior in all {
            let (log, scale) = prior.log_evidence(of, is_free)?;
            if best.is_none_or(|(least, ..)| log > least) {
                best = Some((log, prior, scale));
            }
        }
        let (_, prior, scale) = best.ok_or(LabError::DARK)?;
        Ok(prior.scaled(scale))
    }

    /// Those of `all` that are less likely than the likeliest by no more than e^`nats`, each with
    /// its likeliest scale.
    pub(super) fn plausible(
        all: &[Self],
        of: &Normal,
        is_free: bool,
        nats: f64,
    ) -> Result<Vec<Self>, LabError> {
        let each = all.iter().map(|prior| prior.log_evidence(of, is_free));
        let each: Vec<(f64, f64)> = each.collect::<Result<_, _>>()?;
        let most = each.iter().map(|(log, _)| *log);
        let most = most.fold(f64::NEG_INFINITY, f64::max);
        let open = all
            .iter()
            .zip(each)
            .filter(|(_, (log, _))| *log > most - nats);
        Ok(open
            .map(|(prior, (_, scale))| prior.scaled(scale))
            .collect())
    }

    fn scaled(&self, scale: f64) -> Self {
        Self {
            root: &self.root * scale,
            scale,
            ..self.clone()
        }
    }

    /// ln p(y) up to a constant, and the scale with which it is largest.
    fn log_evidence(&self, of: &Normal, is_free: bool) -> Result<(f64, f64), LabError> {
        let ones = DVector::from_element(of.side.len(), self.mean);
        let light = &of.h * &ones;
        let square = of.square - 2.0 * of.side.dot(&ones) + ones.dot(&light);
        let side = self.root.tr_mul(&(&of.side - light));
        let gram = tr_product(&self.root, &product(&of.h, &self.root));
        if !is_free {
            let white = white(&gram)?;
            let z = white.solve(&side);
            return Ok((-0.5 * (square - side.dot(&z) + white.log_det()), 1.0));
        }
        let found = svd(&gram)?;
        let g = found.u.tr_mul(&side);
        let log = |scale: f64| {
            let s2 = scale * scale;
            let each = found.sigma.iter().zip(&g);
            let (mut fit, mut occam) = (square, 0.0);
            for (mu, g) in each {
                fit -= g * g * s2 / (1.0 + s2 * mu);
                occam += libm::log1p(s2 * mu);
            }
            -0.5 * (fit + occam)
        };
        let grey = of.h.sum() * HALF * HALF;
        let guess = (of.square / grey.max(f64::MIN_POSITIVE)).sqrt();
        let reach = libm::pow(10.0, DECADES);
        // Beyond it 1 + s²μ loses the 1.
        let most = (RESOLVED / found.sigma[0].max(f64::MIN_POSITIVE)).sqrt();
        let (scale, log) = largest(guess / reach, (guess * reach).min(most.max(guess)), log);
        Ok((log, scale))
    }
}

/// The factor of 1 + `gram`.
pub(super) fn white(gram: &Matrix) -> Result<Cholesky, LabError> {
    let mut all = gram.clone();
    (0..all.nrows()).for_each(|i| all[(i, i)] += 1.0);
    Cholesky::new(&all).ok_or(LabError::TOO_FINE)
}
