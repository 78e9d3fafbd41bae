//! Benches without noise: what is recovered, and the figures that might predict it.

use crate::lab::problem::problem;
use serde::{Deserialize, Serialize};

use super::projection::Projection;
use super::sweep::{Arrangement, Site};
use crate::lab::LabError;
use crate::metrics::mtf_raw;
use crate::model::{MatrixModel, Occlusion};
use crate::recovery::{Method, Options, recover};
use crate::transport::Control;

/// One bench with one object.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Configuration {
    /// Layout.
    pub layout: String,
    /// Spots that are there.
    pub spots: usize,
    /// Half-width or radius, in.
    pub half_width: f64,
    /// Elements a side.
    pub elements: usize,
    /// Checks a side.
    pub board: usize,
    /// Kernel.
    pub kernel: String,
    /// Directions that `pinv` keeps.
    pub rank: usize,
    /// The indicator: ‖P c‖²/‖c‖².
    pub kept: f64,
    /// Raw MTF of (C diag ρ)·P ⊘ C.
    pub projected: f64,
    /// Raw MTF of what `pinv` recovers from the noiseless Φcam.
    pub mtf: f64,
    /// σ1 over the last kept singular value.
    pub condition: f64,
    /// Smallest eigenvalue of G12·G12ᵀ over the largest, rounding included.
    pub smallest_eigenvalue: f64,
    /// The same from the singular values of G12; 0 for fewer spots than elements.
    pub smallest_square: f64,
}

/// The matrices of a board on one arrangement; none where no spot is left.
pub(super) fn model(
    site: &Site,
    arrangement: &Arrangement,
    board: usize,
) -> Result<Option<MatrixModel>, LabError> {
    let Some(scene) = site.arranged(arrangement)? else {
        return Ok(None);
    };
    let elements = Some([arrangement.elements; 2]);
    // The published inversion knows nothing of what stands in the way.
    Ok(Some(MatrixModel::with(
        &scene.with_checkerboard(board),
        arrangement.kernel,
        elements,
        Occlusion::Ignored,
    )?))
}

/// Every board on one arrangement.
pub(super) fn configurations(
    site: &Site,
    arrangement: &Arrangement,
    boards: &[usize],
    control: Control<'_>,
) -> Result<Vec<Configuration>, LabError> {
    let mut found = Vec::new();
    let mut shared: Option<Projection> = None;
    for &board in boards
        .iter()
        .filter(|b| arrangement.elements.is_multiple_of(**b))
    {
        control.check()?;
        let Some(model) = model(site, arrangement, board)? else {
            return Ok(found);
        };
        // The projector knows nothing of the object.
        let projection = match shared.take() {
            Some(p) => p,
            None => Projection::new(&model)?,
        };
        let phi = model.phi();
        let problem = problem(&model, &phi, None)?;
        let recovered = recover(Method::Pinv, &problem, &Options::default())?;
        let mtf = mtf_raw(recovered.reflectance.as_slice(), &model.albedo);
        let projected = mtf_raw(&projection.noiseless(&model), &model.albedo);
        // A board of one check has no contrast.
        if let (Some(mtf), Some(projected)) = (mtf, projected) {
            found.push(Configuration {
                layout: arrangement.layout.name().to_owned(),
                spots: model.laser_side.ncols(),
                half_width: arrangement.half_width,
                elements: arrangement.elements,
                board,
                kernel: arrangement.kernel.name().to_owned(),
                rank: projection.rank,
                kept: projection.kept(&model.albedo),
                projected,
                mtf,
                condition: projection.condition,
                smallest_eigenvalue: projection.smallest_eigenvalue,
                smallest_square: projection.smallest_square,
            });
        }
        shared = Some(projection);
    }
    Ok(found)
}
