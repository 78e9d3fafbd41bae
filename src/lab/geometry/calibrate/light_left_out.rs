//! Whether what is left over looks like light that the model leaves out, and how far such light
//! moves the geometry.
//!
//! Light S a, of patterns S that all frames share and sizes a that nothing says, picture and
//! geometry following, would change the cost by −½ gᵀF⁻¹g, all whitened:
//!
//! > g = Sᵀ(y − Aρ̂),   F = SᵀS − SᵀA P AᵀS − SᵀB⊥ (F_θ + Λ)⁻¹ B⊥ᵀS
//!
//! and without such light gᵀF⁻¹g is χ² (score test, Rao 1948). χ² of all entries hardly sees it: a
//! geometry that takes it up is off by many of its errors, and fits. To first order light S a that
//! is there moves the estimate and raises the least of χ² with its priors by
//!
//! > δθ = (F_θ + Λ)⁻¹ B⊥ᵀS a,   δχ² = aᵀF a

use nalgebra::DVector;

use super::descent::{Problem, State};
use super::geometry::Light;
use super::posterior::Columns;
use crate::lab::comparison::over_view::{PATTERNS, over_view};
use crate::lab::error::LabError;
use crate::lab::geometry::light_left_out::{LightLeftOut, Neighbours};
use crate::lab::uncertainty::certainty::Errors;
use crate::matrix::Matrix;
use crate::num::linalg::{Cholesky, product, tr_product};

/// Even light, over the mean light, whose effect is told.
const PERCENT: f64 = 0.01;

/// SᵀS, AᵀS and B⊥ᵀS, g, the squares of S before other light took any, the mean of the light that
/// is found, W, and how neighbours hang together.
pub(super) struct Sums {
    own: Matrix,
    light: Matrix,
    geometry: Matrix,
    score: Matrix,
    whole: Vec<f64>,
    mean: f64,
    neighbours: Neighbours,
}

/// What 1 % of the mean light does that every entry has and the model leaves out.
pub(super) struct EvenLight {
    /// δθ.
    pub moved: DVector<f64>,
    /// δχ².
    pub chi2: f64,
}

impl Sums {
    /// F.
    fn information(&self, best: &State, information: &Cholesky) -> Matrix {
        let towards = information.forward(self.geometry.clone());
        let picture = product(&best.slope.covariance, &self.light);
        &self.own - tr_product(&self.light, &picture) - tr_product(&towards, &towards)
    }
}

impl Problem<'_> {
    /// Each kind of pattern against what is left of photographs whose noise is each entry's own and
    /// not along cosines; where it is not stated, in units of how it varies. Nothing where light
    /// that all frames share is estimated.
    pub(super) fn light_left_out(
        &self,
        best: &State,
        sums: &Sums,
        information: &Cholesky,
    ) -> Vec<LightLeftOut> {
        let known = self.photographs.certainty;
        let is_own = known.errors == Errors::Independent;
        if !is_own || self.cosines.is_some() || self.common.is_some() {
            return Vec::new();
        }
        let unit = sums.neighbours.inflation();
        let unit = self.photographs.stderr.map_or(unit, |_| 1.0);
        let f = sums.information(best, information) / unit;
        let whole: Vec<f64> = sums.whole.iter().map(|own| own / unit).collect();
        let left = (&f, &(&sums.score / unit), &whole[..]);
        LightLeftOut::of(left, |chi2, dof| known.by_noise(chi2, dof))
    }

    /// What 1 % of even light does; none where other light is estimated.
    pub(super) fn even_light(
        &self,
        best: &State,
        sums: &Sums,
        information: &Cholesky,
    ) -> Option<EvenLight> {
        if self.common.is_some() || self.photographs.patterns.is_some() {
            return None;
        }
        let size = PERCENT * sums.mean;
        let f = sums.information(best, information);
        Some(EvenLight {
            moved: information.solve(&(sums.geometry.column(0) * size)),
            chi2: f[(0, 0)] * size * size,
        })
    }

    /// At the estimate.
    pub(super) fn sums(
        &self,
        best: &State,
        (light, b): (&Light, &[Columns]),
    ) -> Result<Sums, LabError> {
        let seen = self.seen(best.factor);
        let (rho, columns) = (&best.value.rho, self.geometry.scene.camera.columns);
        let (n, all) = (light.elements(), PATTERNS);
        let mut sums = Sums {
            own: Matrix::zeros(all, all),
            light: Matrix::zeros(n, all),
            geometry: Matrix::zeros(self.unknowns(), all),
            score: Matrix::zeros(all, 1),
            whole: vec![0.0; all],
            mean: 0.0,
            neighbours: Neighbours::new(all, best.value.count),
        };
        let frames = b.len() as f64;
        for (l, own) in b.iter().enumerate() {
            let [y, a] = seen.frame(light, l)?;
            let b = &own.b - product(&a, &best.slope.shift);
            let shape = light.frame(l) * rho;
            let shape = Matrix::from_column_slice(shape.len(), 1, shape.as_slice());
            sums.mean += shape.mean() / frames;
            let s = seen.along(over_view(&shape, columns));
            let roots = self.photographs.roots(l);
            for (k, whole) in sums.whole.iter_mut().enumerate() {
                let each = s.column(k).component_mul(&roots);
                *whole += each.norm_squared() / (best.factor * best.factor);
            }
            for s in seen.white(l, &[&s])? {
                sums.own += tr_product(&s, &s);
                sums.light += tr_product(&a, &s);
                sums.geometry += tr_product(&b, &s);
                let left = &y - &a * Matrix::from_column_slice(n, 1, rho.as_slice());
                sums.score += tr_product(&s, &left);
                sums.neighbours.add(&s, &left);
            }
        }
        Ok(sums)
    }
}
