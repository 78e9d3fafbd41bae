//! Factors of the light that are known to a standard deviation.
//!
//! With g_l what the free terms leave of √w s M in frame l, the factors add the light
//! Σ_l (ε + ε_l) g_l (ε ε_l is left out), ε ~ N(0, σ_s²) and ε_l ~ N(0, σ_g²): noise of covariance
//! G R Rᵀ Gᵀ beside that of the entries, which is 1. With Rᵀ Gᵀ G R = E Λ Eᵀ,
//!
//! > (1 + G R Rᵀ Gᵀ)^(−½) = 1 − G R E f(Λ) Eᵀ Rᵀ Gᵀ,   f(λ) = 1/(√(1+λ) (1 + √(1+λ))),
//!
//! makes all noise alike; the factors are ε = R ζ, ζ ~ N(0, 1) beforehand and
//! N((1+Λ)⁻¹ Rᵀ Gᵀ z, (1+Λ)⁻¹) after.

use nalgebra::DVector;

use crate::matrix::Matrix;
use crate::num::linalg::{LinalgError, svd};
use crate::recovery::{Deviations, Gains};

/// The factors.
#[derive(Debug)]
pub(super) struct Factors {
    /// √w s M, pixels × spots.
    light: Matrix,
    /// R, spots × factors: one of each frame, then that of all.
    prior: Matrix,
    /// Eᵀ and Λ.
    turn: Matrix,
    lambda: DVector<f64>,
    /// σ_g and σ_s.
    known_to: [Option<f64>; 2],
}

impl Factors {
    /// Of `light`, √w s M, by σ_g and σ_s, one of which is there; `free` says what the free terms
    /// leave.
    pub(super) fn new(
        light: Matrix,
        known_to: [Option<f64>; 2],
        free: &dyn Fn(&Matrix) -> Matrix,
    ) -> Result<Self, LinalgError> {
        let spots = light.ncols();
        let [of_frames, of_all] = known_to;
        let own = if of_frames.is_some() { spots } else { 0 };
        let prior = Matrix::from_fn(spots, own + usize::from(of_all.is_some()), |l, k| {
            match (of_frames, of_all) {
                (Some(sigma), _) if k == l => sigma,
                (_, Some(sigma)) if k == own => sigma,
                _ => 0.0,
            }
        });
        let mut gram = Matrix::zeros(spots, spots);
        for l in 0..spots {
            let mut frame = Matrix::zeros(light.nrows(), spots);
            frame.set_column(l, &light.column(l));
            let left = free(&frame);
            let along = light.column_iter().zip(left.column_iter());
            gram.set_column(
                l,
                &DVector::from_iterator(spots, along.map(|(a, b)| a.dot(&b))),
            );
        }
        let gram = (&gram + gram.transpose()) * 0.5;
        let found = svd(&(prior.transpose() * gram * &prior))?;
        Ok(Self {
            light,
            prior,
            turn: found.vt,
            lambda: found.sigma,
            known_to,
        })
    }

    /// Eᵀ Rᵀ Gᵀ z.
    fn along(&self, z: &Matrix) -> DVector<f64> {
        let frames = self.light.column_iter().zip(z.column_iter());
        let along = DVector::from_iterator(z.ncols(), frames.map(|(a, b)| a.dot(&b)));
        &self.turn * (self.prior.transpose() * along)
    }

    /// What the free terms leave of light, with the factors as noise like that of the entries.
    pub(super) fn as_noise(&self, z: Matrix, free: &dyn Fn(&Matrix) -> Matrix) -> Matrix {
        let root = |lambda: f64| (1.0 + lambda).sqrt();
        let f = self
            .lambda
            .map(|lambda| 1.0 / (root(lambda) * (1.0 + root(lambda))));
        let sizes = &self.prior * (self.turn.transpose() * f.component_mul(&self.along(&z)));
        let mut taken = self.light.clone();
        for (mut frame, size) in taken.column_iter_mut().zip(&sizes) {
            frame *= *size;
        }
        z - free(&taken)
    }

    /// ‖Rᵀ Gᵀ z‖², of z that the free terms leave.
    pub(super) fn variance(&self, z: &Matrix) -> f64 {
        self.along(z).norm_squared()
    }

    /// The factors that z speaks for, what the free terms leave of √w (Φ − s M).
    pub(super) fn found(&self, z: &Matrix) -> Gains {
        let shrunk = self.lambda.map(|lambda| 1.0 / (1.0 + lambda));
        let size = self.turn.transpose() * shrunk.component_mul(&self.along(z));
        let variance = |k: usize| {
            let own = self.turn.column(k).into_iter().zip(&shrunk);
            own.map(|(e, s)| e * e * s).sum::<f64>()
        };
        let of = |from: usize, count: usize, sigma: f64| Deviations {
            size: size.rows(from, count).into_owned() * sigma,
            standard_error: DVector::from_fn(count, |k, _| sigma * variance(from + k).sqrt()),
            known_to: sigma,
            picture_given: false,
        };
        let last = size.len() - 1;
        let [of_frames, of_all] = self.known_to;
        Gains {
            frames: of_frames.map(|sigma| of(0, z.ncols(), sigma)),
            whole: of_all.map(|sigma| of(last, 1, sigma)),
            steps: 1,
            settled: true,
            widened: None,
        }
    }
}
