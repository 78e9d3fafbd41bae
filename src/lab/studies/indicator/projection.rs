//! What a laser side lets through: its projector, and the figures that the published study looked
//! at instead.

use crate::lab::recovered::inversion::{noiseless, smallest_eigenvalue};
use crate::matrix::Matrix;
use crate::model::MatrixModel;
use crate::num::linalg::{LinalgError, Tolerance, cut, svd};

/// The laser side of one bench.
pub(super) struct Projection {
    /// U_k of the projector P = G12·G12⁺ = U_k U_kᵀ over the k directions that `pinv` keeps,
    /// elements × k.
    kept: Matrix,
    /// k.
    pub(super) rank: usize,
    /// ‖G12‖₂·‖G12⁺‖₂ = σ1/σ_k, over the last *kept* singular value.
    pub(super) condition: f64,
    /// Algebraically smallest eigenvalue of G12·G12ᵀ formed in doubles, over the largest: where G12
    /// is numerically rank deficient, rounding noise of either sign.
    pub(super) smallest_eigenvalue: f64,
    /// (σ_r/σ1)² from the singular values of G12 itself, which that eigenvalue would be without
    /// rounding; 0 for fewer spots than elements.
    pub(super) smallest_square: f64,
}

impl Projection {
    /// Of D = `model.laser_side`, which is G12 up to a scale where the elements are equal and the
    /// wall is.
    pub(super) fn new(model: &MatrixModel) -> Result<Self, LinalgError> {
        let d = &model.laser_side;
        let laser = svd(d)?;
        let sigma = laser.sigma.as_slice();
        let (rank, _) = cut(sigma, d.nrows(), d.ncols(), Tolerance::Auto)?;
        let last = if d.nrows() > d.ncols() {
            0.0
        } else {
            sigma[d.nrows() - 1] / sigma[0]
        };
        Ok(Self {
            kept: laser.u.columns(0, rank).into_owned(),
            rank,
            condition: sigma[0] / sigma[rank.max(1) - 1],
            smallest_eigenvalue: smallest_eigenvalue(d)?,
            smallest_square: last * last,
        })
    }

    /// ‖P c‖²/‖c‖² of the pattern c = ρ − mean ρ.
    pub(super) fn kept(&self, albedo: &[f64]) -> f64 {
        let mean = albedo.iter().sum::<f64>() / albedo.len() as f64;
        let pattern =
            nalgebra::DVector::from_iterator(albedo.len(), albedo.iter().map(|x| x - mean));
        self.kept.tr_mul(&pattern).norm_squared() / pattern.norm_squared()
    }

    /// What `pinv` recovers from the noiseless Φcam, (C diag ρ)·P ⊘ C averaged over the pixels,
    /// without Φcam.
    pub(super) fn noiseless(&self, model: &MatrixModel) -> Vec<f64> {
        noiseless(&model.camera_side, &model.albedo, &self.kept)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Kernel;
    use crate::recovery::{Method, Options, Problem, recover};
    use crate::scene::Scene;

    fn model(scene: &str, elements: usize, kernel: Kernel) -> MatrixModel {
        let scene = Scene::load(scene).unwrap().with_checkerboard(2);
        MatrixModel::new(&scene, kernel, Some([elements; 2])).unwrap()
    }

    /// The identity that the indicator rests on. Φcam carries rounding of eps, which D⁺ multiplies
    /// by the condition: far from the rank cut both sides agree to that.
    #[test]
    fn the_noiseless_recovery_is_the_projected_object() {
        for kernel in [Kernel::Physical, Kernel::Published] {
            for elements in [2, 4] {
                let model = model("thesis", elements, kernel);
                let projection = Projection::new(&model).unwrap();
                let phi = model.phi();
                let problem =
                    Problem::new(&phi, &model.camera_side, &model.laser_side, None).unwrap();
                let found = recover(Method::Pinv, &problem, &Options::default()).unwrap();
                let bound = 100.0 * f64::EPSILON * projection.condition;
                assert!(bound < 1e-4, "{bound:e}");
                for (a, b) in projection
                    .noiseless(&model)
                    .iter()
                    .zip(found.reflectance.iter())
                {
                    assert!((a - b).abs() < bound, "{elements}: {a} {b}, {bound:e}");
                }
            }
        }
    }

    /// Fewer spots than elements: P has the trace of its rank, takes the pattern apart as
    /// Pythagoras says, and the eigenvalue is zero but for rounding.
    #[test]
    fn a_deficient_side_is_a_projector_all_the_same() {
        let scene = Scene::load("thesis").unwrap().with_checkerboard(2);
        let few = scene
            .with_spots_at(&[[1.0, 2.0], [8.0, 3.0], [4.0, 9.0]])
            .unwrap();
        let model = MatrixModel::new(&few, Kernel::Physical, Some([4, 4])).unwrap();
        let found = Projection::new(&model).unwrap();
        assert_eq!(found.rank, 3);
        let p = &(&found.kept * found.kept.transpose());
        assert!((p.trace() - 3.0).abs() < 1e-12 && (p * p - p).norm() < 1e-12);
        let pattern = nalgebra::DVector::from_iterator(16, model.albedo.iter().map(|x| x - 0.5));
        let lost = (&pattern - p * &pattern).norm_squared() / pattern.norm_squared();
        assert!((found.kept(&model.albedo) + lost - 1.0).abs() < 1e-12);
        assert!(found.smallest_eigenvalue.abs() < 1e-14);
        assert_eq!(found.smallest_square, 0.0);
    }

    /// 2 × 2 elements have full rank: the three figures are one.
    #[test]
    fn the_smallest_eigenvalue_is_the_square_of_the_last_singular_value() {
        let model = model("thesis", 2, Kernel::Physical);
        let found = Projection::new(&model).unwrap();
        assert_eq!(found.rank, 4);
        assert!((found.smallest_eigenvalue / found.smallest_square - 1.0).abs() < 1e-6);
        assert!((found.condition * found.condition * found.smallest_square - 1.0).abs() < 1e-9);
    }
}
