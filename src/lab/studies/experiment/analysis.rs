//! Ways of reading the photographs.

use crate::lab::recovered::measures::Measures;
use crate::matrix::Matrix;
use crate::metrics::mtf_normalized;
use crate::model::{Kernel, MatrixModel};
use crate::recovery::{
    Method, Nuisance, Options, Problem, RecoveryError, Rule, Uncertainty, recover,
};
use crate::sensor::Exposed;

/// What is analysed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Data {
    /// The photographs as they are.
    Taken,
    /// Less photographs with the object covered, exposed in the same way and with noise of their
    /// own.
    Subtracted,
    /// Each photograph and the camera side of the model without their parts constant or linear in x
    /// and y.
    BandPassed,
}

/// What is estimated beside the reflectances.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Beside {
    Nothing,
    /// A constant of each frame.
    Constant,
    /// The strength of each frame's glare, of known pattern.
    Glare,
}

/// One way of reading the photographs.
#[derive(Clone, Copy, Debug)]
pub(super) struct Analysis {
    pub(super) name: &'static str,
    kernel: Kernel,
    method: Method,
    data: Data,
    beside: Beside,
}

/// The published analysis first; the others by how much of the glare they take away.
pub(super) const ANALYSES: [Analysis; 10] = {
    use Beside::{Constant, Glare, Nothing};
    use Data::{BandPassed, Subtracted, Taken};
    use Method::{Joint, JointTwoValued, Tikhonov};
    [
        published("published", Taken),
        published("published, background subtracted", Subtracted),
        physical(
            "tikhonov, background subtracted",
            Tikhonov,
            Subtracted,
            Nothing,
        ),
        physical("joint", Joint, Taken, Nothing),
        physical("joint, background subtracted", Joint, Subtracted, Nothing),
        physical("joint, band-passed", Joint, BandPassed, Nothing),
        physical("joint, frame constant", Joint, Taken, Constant),
        physical("joint, glare pattern", Joint, Taken, Glare),
        physical(
            "two-valued, frame constant",
            JointTwoValued,
            Taken,
            Constant,
        ),
        physical("two-valued, glare pattern", JointTwoValued, Taken, Glare),
    ]
};

const fn physical(name: &'static str, method: Method, data: Data, beside: Beside) -> Analysis {
    Analysis {
        name,
        kernel: Kernel::Physical,
        method,
        data,
        beside,
    }
}

const fn published(name: &'static str, data: Data) -> Analysis {
    Analysis {
        kernel: Kernel::Published,
        ..physical(name, Method::Pinv, data, Beside::Nothing)
    }
}

/// The models that the analyses invert, and what does not depend on the photographs.
pub(super) struct Laboratory {
    physical: MatrixModel,
    published: MatrixModel,
    /// Orthonormal images that are constant or linear in x and y, pixels × 3.
    planes: Matrix,
    filtered: Matrix,
}

impl Laboratory {
    /// For `columns` × `rows` pixels.
    pub(super) fn new(
        physical: MatrixModel,
        published: MatrixModel,
        [columns, rows]: [usize; 2],
    ) -> Self {
        let planes = planes(columns, rows);
        let filtered = without(&physical.camera_side, &planes);
        Self {
            physical,
            published,
            planes,
            filtered,
        }
    }

    /// Normalized modulation of the true picture; 1 of one that has none.
    pub(super) fn own_modulation(&self) -> f64 {
        let albedo = self.physical.albedo.as_slice();
        mtf_normalized(albedo, albedo).unwrap_or(1.0)
    }

    /// Reads `taken`, with `covered` the photographs of the covered object, and `glare` the pattern
    /// of the glare (any unit).
    pub(super) fn read(
        &self,
        analysis: &Analysis,
        taken: &Exposed,
        covered: &Exposed,
        glare: &Matrix,
    ) -> Result<Measures, RecoveryError> {
        let model = match analysis.kernel {
            Kernel::Physical => &self.physical,
            Kernel::Published => &self.published,
        };
        let (flux, stderr, camera_side) = match analysis.data {
            Data::Taken => (taken.flux.clone(), taken.stderr.clone(), &model.camera_side),
            Data::Subtracted => (
                &taken.flux - &covered.flux,
                taken
                    .stderr
                    .zip_map(&covered.stderr, |a, b| (a * a + b * b).sqrt()),
                &model.camera_side,
            ),
            // Three directions of some thousand pixels are lost: the errors of what is left are
            // practically those of the entries.
            Data::BandPassed => (
                without(&taken.flux, &self.planes),
                taken.stderr.clone(),
                &self.filtered,
            ),
        };
        let nuisance = Nuisance {
            frame_constant: analysis.beside == Beside::Constant,
            glare: (analysis.beside == Beside::Glare).then_some(glare),
            ..Nuisance::default()
        };
        // Glare that nobody took away belies the noise model, so the discrepancy principle would
        // refuse. The reflectances alone are measured.
        let options = Options {
            rule: Rule::Gcv,
            uncertainty: Uncertainty::StandardError,
            probabilities: false,
            ..Options::default()
        };
        let problem = Problem::new(&flux, camera_side, &model.laser_side, Some(&stderr))?
            .with_nuisance(nuisance)?;
        let found = recover(analysis.method, &problem, &options)?;
        Ok(Measures::of(found.reflectance.as_slice(), &model.albedo))
    }
}

/// Orthonormal basis of 1, x, y over the pixel grid.
fn planes(columns: usize, rows: usize) -> Matrix {
    let centred = |i: usize, n: usize| i as f64 - 0.5 * (n as f64 - 1.0);
    let mut images = Matrix::from_fn(columns * rows, 3, |p, k| match k {
        0 => 1.0,
        1 => centred(p % columns, columns),
        _ => centred(p / columns, rows),
    });
    for mut image in images.column_iter_mut() {
        let norm = image.norm();
        // A grid of one column or row has no slope along it.
        if norm > 0.0 {
            image /= norm;
        }
    }
    images
}

/// `images` (in columns) without their parts along `basis`.
fn without(images: &Matrix, basis: &Matrix) -> Matrix {
    images - basis * (basis.transpose() * images)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn planes_are_removed_and_nothing_else() {
        let basis = planes(5, 4);
        let gram = basis.transpose() * &basis;
        assert!((gram - Matrix::identity(3, 3)).amax() < 1e-14);
        let plane = Matrix::from_fn(20, 1, |p, _| {
            3.0 - 2.0 * (p % 5) as f64 + 0.5 * (p / 5) as f64
        });
        assert!(without(&plane, &basis).amax() < 1e-13);
        // (−1)^x is orthogonal to slopes and, over an even number of rows times an odd one of
        // columns, not to 1.
        let stripes = Matrix::from_fn(20, 1, |p, _| if (p / 5) % 2 == 0 { 1.0 } else { -1.0 });
        let left = without(&stripes, &basis);
        // Rows +1 −1 +1 −1 have the slope Σ y·s/Σ y² = (−1.5 + 0.5 + 0.5·1 − 1.5)/5 = −2/5 along y.
        let exact = Matrix::from_fn(20, 1, |p, _| stripes[p] + 0.4 * ((p / 5) as f64 - 1.5));
        assert!((left - exact).amax() < 1e-13);
    }
}
