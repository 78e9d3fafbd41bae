//! Photographs with the picture unknown: their likelihood, its slope and its curvature.
//!
//! With y = A(θ) ρ + noise, whitened, and ρ = m + R z ([`Prior`]) the picture drops out:
//!
//! > −ln p(y|θ) = ½ min_z(‖y − Aρ‖² + ‖z‖²) + ½ ln det(1 + RᵀAᵀAR)
//! > B_k = ∂_kA ρ̂,   X = (1 + RᵀHR)⁻¹ Rᵀ AᵀB,   B⊥ = B − A R X
//! > slope_k = −B⊥_kᵀ(y − Aρ̂) − X_kᵀẑ + tr(P Aᵀ∂_kA),   P = R (1 + RᵀHR)⁻¹ Rᵀ
//! > curvature F = B⊥ᵀB⊥ + XᵀX
//!
//! (variable projection, Golub and Pereyra 1973, in Kaufman's approximation; F is the information
//! that the photographs have of θ with the picture unknown).

use nalgebra::DVector;
use rayon::prelude::*;

use super::geometry::Light;
use super::picture::{Prior, white};
use crate::lab::error::LabError;
use crate::lab::geometry::common::Common;
use crate::lab::geometry::normal::Normal;
use crate::lab::uncertainty::unexplained::Unexplained;
use crate::matrix::Matrix;
use crate::num::cosines::along_cosines;
use crate::num::linalg::{Cholesky, product, tr_product};

/// Photographs whose standard errors are `factor` times the stated ones.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seen<'a> {
    pub photographs: Unexplained<'a>,
    /// Light that all frames share.
    pub common: Option<&'a Common>,
    pub factor: f64,
    /// Columns and rows of photographs that are along their cosines; none where they are as taken.
    pub cosines: Option<[usize; 2]>,
}

/// What is left with the picture at its likeliest.
#[derive(Clone, Debug)]
pub(super) struct Value {
    /// −ln p(y|θ) up to a constant.
    pub cost: f64,
    /// ‖y − Aρ̂‖² in units of the assumed noise.
    pub chi2: f64,
    /// Directions of the picture that the photographs determine.
    pub freedom: f64,
    pub count: f64,
    pub rho: DVector<f64>,
    z: DVector<f64>,
    /// Of 1 + RᵀHR.
    pub factor: Cholesky,
}

/// The same with slope and curvature.
#[derive(Clone, Debug)]
pub(super) struct Slope {
    pub slope: DVector<f64>,
    pub curvature: Matrix,
    /// B_kᵀB_k: curvature if the picture were known.
    pub known: DVector<f64>,
    /// P.
    pub covariance: Matrix,
    /// R X: −∂ρ̂/∂θ, elements × unknowns.
    pub shift: Matrix,
}

impl Seen<'_> {
    fn frames(&self) -> usize {
        self.photographs.phi.ncols()
    }

    /// Whitened columns of frame l.
    pub(super) fn white(&self, l: usize, columns: &[&Matrix]) -> Result<Vec<Matrix>, LabError> {
        let white = self.photographs.whitening(l)?;
        let each = columns.iter().map(|m| white.apply(m) / self.factor);
        Ok(each.collect())
    }

    /// Light as the photographs are.
    pub(super) fn along(&self, light: Matrix) -> Matrix {
        match self.cosines {
            Some(frame) => along_cosines(&light, frame),
            None => light,
        }
    }

    /// Whitened photograph and light of the elements in frame l.
    pub(super) fn frame(&self, light: &Light, l: usize) -> Result<[Matrix; 2], LabError> {
        let photograph = self.photographs.phi.columns(l, 1).into_owned();
        let light = self.along(light.frame(l));
        let mut both = self.white(l, &[&photograph, &light])?.into_iter();
        match (both.next(), both.next()) {
            (Some(y), Some(a)) => Ok([y, a]),
            _ => Err(LabError::DARK),
        }
    }

    /// The normal equations.
    pub(super) fn normal(&self, light: &Light) -> Result<Normal, LabError> {
        let of = |l: usize| -> Result<Normal, LabError> {
            let [y, a] = self.frame(light, l)?;
            Ok(Normal {
                h: tr_product(&a, &a),
                side: tr_product(&a, &y).column(0).into_owned(),
                square: y.norm_squared(),
                count: self.photographs.whitening(l)?.count(),
            })
        };
        let frames = (0..self.frames()).into_par_iter().map(of);
        let frames: Vec<Normal> = frames.collect::<Result<_, _>>()?;
        let mut all = Normal::sum(frames.iter(), light.elements());
        all.count -= self.common.map_or(0.0, Common::directions);
        Ok(all)
    }

    /// ‖y‖².
    pub(super) fn square(&self) -> Result<f64, LabError> {
        let of = |l: usize| -> Result<f64, LabError> {
            let photograph = self.photographs.phi.columns(l, 1).into_owned();
            let white = self.white(l, &[&photograph])?;
            Ok(white.iter().map(Matrix::norm_squared).sum())
        };
        (0..self.frames()).map(of).sum()
    }

    /// ‖y − Aρ‖².
    pub(super) fn residue(&self, light: &Light, rho: &DVector<f64>) -> Result<f64, LabError> {
        let left = |l: usize| -> Result<f64, LabError> {
            let [y, a] = self.frame(light, l)?;
            Ok((y.column(0) - a * rho).norm_squared())
        };
        let left = (0..self.frames()).into_par_iter().map(left);
        let left: Vec<f64> = left.collect::<Result<_, _>>()?;
        Ok(left.iter().sum())
    }

    /// Σ z z′ over pixels side by side, Σ (z z′)² and Σ z², z of y − Aρ.
    pub(super) fn beside(&self, light: &Light, rho: &DVector<f64>) -> Result<[f64; 3], LabError> {
        let of = |l: usize| -> Result<[f64; 3], LabError> {
            let [y, a] = self.frame(light, l)?;
            let left = y.column(0) - a * rho;
            let pairs = left.iter().zip(left.iter().skip(1));
            let [sum, squares] = pairs.fold([0.0; 2], |[sum, squares], (a, b)| {
                [sum + a * b, squares + (a * b).powi(2)]
            });
            Ok([sum, squares, left.norm_squared()])
        };
        let frames = (0..self.frames()).into_par_iter().map(of);
        let frames: Vec<[f64; 3]> = frames.collect::<Result<_, _>>()?;
        Ok(frames
            .iter()
            .fold([0.0; 3], |sum, of| std::array::from_fn(|k| sum[k] + of[k])))
    }

    /// E r² of each row, over all frames: r what picture and other light leave of y, the
    /// expectation over both. That is (y − Aρ̂)² + diag(A P Aᵀ) + what the patterns of other light
    /// take of a row.
    pub(super) fn squares(
        &self,
        light: &Light,
        prior: &Prior,
        value: &Value,
    ) -> Result<DVector<f64>, LabError> {
        let half = value.factor.forward(prior.root.transpose());
        let of = |l: usize| -> Result<DVector<f64>, LabError> {
            let [y, a] = self.frame(light, l)?;
            let left = y.column(0) - &a * &value.rho;
            let spread = product(&half, &a.transpose());
            let taken = self.photographs.whitening(l)?.leverage();
            Ok(DVector::from_fn(left.len(), |k, _| {
                left[k] * left[k] + spread.column(k).norm_squared() + taken[k]
            }))
        };
        let frames = (0..self.frames()).into_par_iter().map(of);
        let frames: Vec<DVector<f64>> = frames.collect::<Result<_, _>>()?;
        Ok(frames.iter().sum())
    }

    /// With the picture at its likeliest.
    pub(super) fn value(
        &self,
        light: &Light,
        normal: &Normal,
        prior: &Prior,
    ) -> Result<Value, LabError> {
        let mean = DVector::from_element(normal.side.len(), prior.mean);
        let gram = tr_product(&prior.root, &product(&normal.h, &prior.root));
        let factor = white(&gram)?;
        let z = factor.solve(&prior.root.tr_mul(&(&normal.side - &normal.h * &mean)));
        let rho = mean + &prior.root * &z;
        let chi2 = self.residue(light, &rho)?;
        let inverse = factor.forward(Matrix::identity(gram.nrows(), gram.nrows()));
        Ok(Value {
            cost: 0.5 * (chi2 + z.norm_squared() + factor.log_det()),
            chi2,
            freedom: gram.nrows() as f64 - inverse.norm_squared(),
            count: normal.count,
            rho,
            z,
            factor,
        })
    }

    /// Slope and curvature by all `unknowns`.
    pub(super) fn slope(
        &self,
        light: &Light,
        prior: &Prior,
        value: &Value,
        unknowns: usize,
    ) -> Result<Slope, LabError> {
        let factor = &value.factor;
        let half = factor.forward(prior.root.transpose());
        let covariance = tr_product(&half, &half);
        let first = self.columns(light, &value.rho, &covariance, unknowns)?;
        let n = light.elements();
        let mut side = Matrix::zeros(n, unknowns);
        let (mut known, mut occam) = (DVector::zeros(unknowns), DVector::zeros(unknowns));
        for own in &first {
            side += &own.side;
            known += DVector::from_fn(unknowns, |k, _| own.b.column(k).norm_squared());
            occam += &own.occam;
        }
        let towards = prior.root.tr_mul(&side);
        let mut x = Matrix::zeros(towards.nrows(), unknowns);
        for k in 0..unknowns {
            x.set_column(k, &factor.solve(&towards.column(k).into_owned()));
        }
        let shift = &prior.root * &x;
        let second = first.par_iter().enumerate();
        let second = second.map(|(l, own)| self.left_of(light, l, own, &value.rho, &shift));
        let second: Vec<Left> = second.collect::<Result<_, _>>()?;
        let mut curvature = tr_product(&x, &x);
        let mut slope = occam - x.tr_mul(&value.z);
        for own in &second {
            curvature += &own.square;
            slope -= &own.score;
        }
        Ok(Slope {
            slope,
            curvature,
            known,
            covariance,
            shift,
        })
    }

    /// B of every frame, and what it gives with A.
    pub(super) fn columns(
        &self,
        light: &Light,
        rho: &DVector<f64>,
        covariance: &Matrix,
        unknowns: usize,
    ) -> Result<Vec<Columns>, LabError> {
        let all = (0..self.frames())
            .into_par_iter()
            .map(|l| self.columns_of(light, l, rho, covariance, unknowns));
        let mut all: Vec<Columns> = all.collect::<Result<_, _>>()?;
        if let Some(common) = self.common {
            let mut b: Vec<&mut Matrix> = all.iter_mut().map(|own| &mut own.b).collect();
            common.take_out(&mut b);
        }
        Ok(all)
    }

    /// B of frame l, and what it gives with A.
    fn columns_of(
        &self,
        light: &Light,
        l: usize,
        rho: &DVector<f64>,
        covariance: &Matrix,
        unknowns: usize,
    ) -> Result<Columns, LabError> {
        let [_, a] = self.frame(light, l)?;
        let spread = product(&a, covariance);
        let mut b = Matrix::zeros(a.nrows(), unknowns);
        let mut occam = DVector::zeros(unknowns);
        for k in 0..unknowns {
            let Some(rate) = light.frame_rate(l, k) else {
                continue;
            };
            for rate in self.white(l, &[&self.along(rate)])? {
                b.set_column(k, &(&rate * rho));
                occam[k] = spread.dot(&rate);
            }
        }
        Ok(Columns {
            side: tr_product(&a, &b),
            occam,
            b,
        })
    }

    /// What is left of B in frame l where the picture follows.
    fn left_of(
        &self,
        light: &Light,
        l: usize,
        own: &Columns,
        rho: &DVector<f64>,
        shift: &Matrix,
    ) -> Result<Left, LabError> {
        let [y, a] = self.frame(light, l)?;
        let left = y.column(0) - &a * rho;
        let b = &own.b - product(&a, shift);
        Ok(Left {
            square: tr_product(&b, &b),
            score: b.tr_mul(&left),
        })
    }
}

/// B of a frame: pixels × unknowns, AᵀB, tr(P Aᵀ∂_kA). Light that all frames share is no part of A,
/// so that both are what they would be without it in B.
pub(super) struct Columns {
    pub b: Matrix,
    side: Matrix,
    occam: DVector<f64>,
}

impl Columns {
    /// AᵀB of all frames, elements × unknowns.
    pub(super) fn side(all: &[Self]) -> Matrix {
        all.iter().map(|own| &own.side).sum()
    }
}

/// B⊥ᵀB⊥ and B⊥ᵀ(y − Aρ̂) of a frame.
struct Left {
    square: Matrix,
    score: DVector<f64>,
}
