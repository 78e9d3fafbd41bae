//! A generalised inverse as a sum over singular directions, each with a filter factor.
//!
//! > D^# = Σ_i f_i v_i s_iᵀ
//!
//! with orthonormal v_i in the space of the spots. Of D = U Σ Vᵀ itself v_i are its right singular
//! vectors and s_i = u_i/σ_i; a penalty other than the norm of X has directions of its own.

use nalgebra::DMatrix;

use crate::num::linalg::{Svd, rows_times, tr_product};

/// The directions, in the order in which they are kept.
pub(super) struct Spectrum {
    /// v_i as rows, k × l, orthonormal.
    pub(super) data: DMatrix<f64>,
    /// D v_i as rows, k × r.
    pub(super) image: DMatrix<f64>,
    /// s_i as rows, k × r.
    pub(super) solution: DMatrix<f64>,
    /// Singular values of the directions after the free ones, descending; those beyond k were
    /// dropped.
    pub(super) sigma: Vec<f64>,
    /// How many directions come first that no penalty reaches.
    pub(super) free: usize,
}

impl Spectrum {
    /// Of D itself, its first `rank` directions.
    pub(super) fn of(laser: &Svd, rank: usize) -> Self {
        let left = |factor: &dyn Fn(f64) -> f64| {
            DMatrix::from_fn(rank, laser.u.nrows(), |i, j| {
                laser.u[(j, i)] * factor(laser.sigma[i])
            })
        };
        Spectrum {
            data: laser.vt.rows(0, rank).into_owned(),
            image: left(&|s| s),
            solution: left(&|s| 1.0 / s),
            sigma: laser.sigma.as_slice().to_vec(),
            free: 0,
        }
    }

    /// Directions in all.
    pub(super) fn len(&self) -> usize {
        self.data.nrows()
    }

    /// Singular values that are filtered.
    pub(super) fn filtered(&self) -> &[f64] {
        &self.sigma[..self.len() - self.free]
    }

    /// Filter factors σ²/(σ² + λ²); 1 for the free directions.
    pub(super) fn damped(&self, lambda: f64) -> Vec<f64> {
        let damped = |s: &f64| 1.0 / (1.0 + (lambda / s) * (lambda / s));
        let free = std::iter::repeat_n(1.0, self.free);
        free.chain(self.filtered().iter().map(damped)).collect()
    }

    /// Filter factors of a truncation after `kept` directions.
    pub(super) fn truncated(&self, kept: usize) -> Vec<f64> {
        (0..self.len())
            .map(|i| f64::from(u8::from(i < kept)))
            .collect()
    }

    /// V and S of D^# = Vᵀ S, from the filter factors of the first directions.
    pub(super) fn factors(&self, filter: &[f64]) -> (DMatrix<f64>, DMatrix<f64>) {
        let data = self.data.rows(0, filter.len()).into_owned();
        (data, self.weighted(filter))
    }

    /// D D^#, r × r.
    pub(super) fn product(&self, filter: &[f64]) -> DMatrix<f64> {
        let image = self.image.rows(0, filter.len()).into_owned();
        tr_product(&image, &self.weighted(filter))
    }

    fn weighted(&self, filter: &[f64]) -> DMatrix<f64> {
        rows_times(self.solution.rows(0, filter.len()).into_owned(), filter)
    }
}
