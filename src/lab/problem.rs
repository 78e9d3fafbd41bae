//! The inverse problem of a matrix model.

use crate::lab::comparison::validation::Integration;
use crate::lab::error::LabError;
use crate::matrix::Matrix;
use crate::model::{
    Converged, Effort, ElementGrid, Extent, Factors, Kernel, MatrixModel, ModelError, Occlusion,
    converged, element_grids,
};
use crate::recovery::{Problem, RecoveryError, Terms};
use crate::scene::Scene;

/// Elements whose light is integrated: of more, each is so small that its centre does, and its
/// terms would take four times the memory.
pub const MOST_INTEGRATED: usize = 1024;

/// The model by which photographs of `scene` are inverted. By quadrature the light of each of up to
/// 1024 elements is integrated over its area, footprints and spots ([`MatrixModel::over_areas`])
/// with this effort, with the physical kernel; the published one is that of the centres.
///
/// # Errors
/// Those of [`MatrixModel::new`] and [`MatrixModel::over_areas`].
pub fn inverted(
    scene: &Scene,
    kernel: Kernel,
    elements: Option<[usize; 2]>,
    occlusion: Occlusion,
    (integration, effort): (Integration, Effort),
) -> Result<MatrixModel, ModelError> {
    let grids = element_grids(scene, elements)?;
    let count: usize = grids.iter().map(ElementGrid::len).sum();
    if integrated(kernel, count, integration) == Integration::Quadrature {
        MatrixModel::over_areas(scene, kernel, elements, occlusion, effort)
    } else {
        MatrixModel::with(scene, kernel, elements, occlusion)
    }
}

/// How so many elements are integrated where this is asked for ([`inverted`]).
pub(super) fn integrated(kernel: Kernel, count: usize, asked: Integration) -> Integration {
    match kernel {
        Kernel::Physical if count <= MOST_INTEGRATED => asked,
        _ => Integration::Centres,
    }
}

/// The light of the model that a study compares with, integrated until it has converged.
///
/// # Errors
/// Those of [`converged`]; [`LabError::DARK`]: of darkness nothing can be compared.
pub(super) fn lit(scene: &Scene) -> Result<Converged, LabError> {
    let found = converged(scene, Kernel::Physical, Extent::FULL)?;
    if found.phi.amax() > 0.0 {
        Ok(found)
    } else {
        Err(LabError::DARK)
    }
}

/// Photographs Φ, pixels × spots, W, with their standard errors where these are known, to be
/// inverted by `model`: with the terms of its elements where it has them.
///
/// # Errors
/// Those of [`Problem::new`].
pub(crate) fn problem<'a>(
    model: &'a MatrixModel,
    phi: &'a Matrix,
    stderr: Option<&'a Matrix>,
) -> Result<Problem<'a>, RecoveryError> {
    let product = Problem::new(phi, &model.camera_side, &model.laser_side, stderr)?;
    match &model.factors {
        None => Ok(product),
        Some(Factors { terms, .. }) => product.with_terms(Terms {
            c: &terms.camera,
            d: &terms.laser,
            element: &terms.element,
        }),
    }
}
