//! Traced Φcam against the matrix model of its scene.

use crate::matrix::Matrix;
use crate::model::{Extent, Kernel, MatrixModel, ModelError, converged};
use crate::scene::Scene;

use super::agreement::{Agreement, Evidence, Test, agree};

/// How the model integrates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Integration {
    /// Elements, pixels and spots by their centres; how far that is from the integral is the bound
    /// of each entry.
    Centres,
    /// Converged quadrature over elements, footprints and spots; the bound is what its last
    /// refinement changed.
    Quadrature,
}

impl Integration {
    /// The name used on the command line and in the files of a run.
    pub fn name(self) -> &'static str {
        match self {
            Self::Centres => "centres",
            Self::Quadrature => "quadrature",
        }
    }
}

/// Why nothing can be validated.
#[derive(Debug, thiserror::Error, PartialEq)]
pub enum ValidationError {
    /// The scene has no model.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// Traced and modelled matrices differ in shape.
    #[error(
        "the traced matrix is {found_rows} × {found_columns}, but the scene has {rows} pixels and {columns} spots \
         (give the scene that was rendered)"
    )]
    Shape {
        /// Pixels of the scene.
        rows: usize,
        /// Spots of the scene.
        columns: usize,
        /// Rows given.
        found_rows: usize,
        /// Columns given.
        found_columns: usize,
    },
}

/// A verdict with what it rests on.
#[derive(Clone, Debug)]
pub struct Validation {
    /// The verdict.
    pub agreement: Agreement,
    /// z of every entry, pixels × spots.
    pub z: Matrix,
    /// The model that was tested, W.
    pub model: Matrix,
}

/// Tests `traced` (pixels × spots, W) with its standard error against the model of `scene`.
///
/// # Errors
/// [`ValidationError`] if nothing is hidden, or the shapes do not fit.
pub fn validate(
    scene: &Scene,
    traced: &Matrix,
    stderr: &Matrix,
    kernel: Kernel,
    integration: Integration,
    test: Test,
) -> Result<Validation, ValidationError> {
    let (rows, columns) = (scene.camera.pixels(), scene.laser.spots.len());
    for (found_rows, found_columns) in [traced.shape(), stderr.shape()] {
        if (found_rows, found_columns) != (rows, columns) {
            return Err(ValidationError::Shape {
                rows,
                columns,
                found_rows,
                found_columns,
            });
        }
    }
    let integral = converged(scene, kernel, Extent::FULL)?;
    let (model, bound) = match integration {
        Integration::Quadrature => (integral.phi, integral.bound),
        Integration::Centres => {
            let centres = MatrixModel::new(scene, kernel, None)?.phi();
            let bound = (&centres - integral.phi).abs() + integral.bound;
            (centres, bound)
        }
    };
    let evidence = Evidence {
        traced,
        stderr,
        model: &model,
        bound: Some(&bound),
    };
    let (mut agreement, z) = agree(evidence, test);
    kernel.name().clone_into(&mut agreement.kernel);
    integration.name().clone_into(&mut agreement.integration);
    Ok(Validation {
        agreement,
        z,
        model,
    })
}
