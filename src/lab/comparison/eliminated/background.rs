//! An image that is the same in all frames, taken out together with the patterns of each.
//!
//! Of weighted light z the image takes Q a, Q\[(p,l),p\] = √w\[p,l\], each column over its norm.
//! With F z what the patterns leave, both leave
//!
//! > F (z − Q a),   Qᵀ F Q a = Qᵀ F z,
//!
//! by conjugate gradients: where weights are a product of one by pixel and one by spot, all
//! eigenvalues of Qᵀ F Q are 0 or 1, and one step is exact. What the patterns of all frames hold
//! too has eigenvalue 0 and is no part of the right side.

use nalgebra::DVector;

use crate::matrix::Matrix;

/// Residual of the equations over the light, below which they are solved. What has eigenvalue 0 is
/// rounding there, and must not be solved for.
const SOLVED: f64 = 1e-13;
/// Steps at most.
const STEPS: usize = 500;

/// Weighted light to what the patterns leave of it.
type Beside<'a> = &'a dyn Fn(&Matrix) -> Matrix;

/// The image.
#[derive(Debug)]
pub(super) struct Background {
    /// Q: √w over its norm in each row.
    unit: Matrix,
}

impl Background {
    /// By √w of each entry.
    pub(super) fn new(roots: &Matrix) -> Self {
        let mut unit = roots.clone();
        for mut row in unit.row_iter_mut() {
            let norm = row.norm();
            if norm > 0.0 {
                row /= norm;
            }
        }
        Self { unit }
    }

    /// 1 of each pixel that is seen, 0 of the others.
    pub(super) fn seen(&self) -> DVector<f64> {
        let seen = |p: usize| f64::from(u8::from(self.unit.row(p).amax() > 0.0));
        DVector::from_fn(self.unit.nrows(), |p, _| seen(p))
    }

    /// Pixels that are seen.
    pub(super) fn pixels(&self) -> usize {
        self.seen().iter().filter(|x| **x > 0.0).count()
    }

    /// What image and patterns leave of what the patterns leave.
    pub(super) fn beside(&self, left: Matrix, patterns: Beside<'_>) -> Matrix {
        let image = self.image(&left, patterns);
        left - patterns(&self.light(&image))
    }

    /// a.
    fn image(&self, left: &Matrix, patterns: Beside<'_>) -> DVector<f64> {
        let mut image = DVector::zeros(self.unit.nrows());
        let mut residual = self.of_pixels(left);
        let mut direction = residual.clone();
        let mut square = residual.norm_squared();
        let least = SOLVED * SOLVED * left.norm_squared();
        for _ in 0..STEPS {
            if square <= least {
                break;
            }
            let turned = self.of_pixels(&patterns(&self.light(&direction)));
            let curvature = direction.dot(&turned);
            let step = square / curvature;
            image.axpy(step, &direction, 1.0);
            residual.axpy(-step, &turned, 1.0);
            let next = residual.norm_squared();
            direction = &residual + direction * (next / square);
            square = next;
        }
        image
    }

    /// Q a.
    fn light(&self, image: &DVector<f64>) -> Matrix {
        Matrix::from_fn(self.unit.nrows(), self.unit.ncols(), |p, l| {
            self.unit[(p, l)] * image[p]
        })
    }

    /// Qᵀ z.
    fn of_pixels(&self, light: &Matrix) -> DVector<f64> {
        let rows = self.unit.row_iter().zip(light.row_iter());
        DVector::from_iterator(light.nrows(), rows.map(|(q, z)| q.dot(&z)))
    }
}
