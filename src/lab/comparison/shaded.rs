//! What deviations of a scene do to its light past flat figures: the shadows move too.
//!
//! > ∂Φ = Σ_j ρ_j ∂A_j

use std::collections::BTreeMap;

use super::misplaced::ALL;
use crate::matrix::Matrix;
use crate::model::{Effort, Kernel, MatrixModel, ModelError, Occlusion, Swept};
use crate::scene::{Parameter, Scene};

/// Relative change of the light with which a derivative is good enough: deviations at the edge of
/// what is seen are fitted to a tenth.
const ENOUGH: f64 = 0.01;

/// Derivatives past what stands in the way.
#[derive(Default)]
pub(super) struct Shaded {
    /// ∂Φ by name, W per unit: of all that [`ALL`] moves, of shifts, of the albedos of hidden
    /// surfaces ([`albedo_of`]), percent.
    pub rates: BTreeMap<String, Matrix>,
    /// Shifts of what stands in the way.
    pub shifts: Vec<Parameter>,
}

/// The name of an albedo.
pub(super) fn albedo_of(surface: &str) -> String {
    format!("albedo of `{surface}`")
}

impl Shaded {
    /// Of `scene` with the physical kernel; nothing where nothing stands in the way, or not all is
    /// flat.
    ///
    /// # Errors
    /// [`ModelError`].
    pub(super) fn new(scene: &Scene) -> Result<Self, ModelError> {
        let shifts = Parameter::of_occluders(scene);
        let zero = vec![0.0; shifts.len()];
        let of_shift = |(k, shift): (usize, &Parameter)| {
            (shift.name.clone(), scene.velocity(&shifts, &zero, k))
        };
        let others = ALL.iter();
        let others = others.filter_map(|m| Some((m.name.to_owned(), m.velocity(scene)?)));
        let all = others.chain(shifts.iter().enumerate().map(of_shift));
        let (names, velocities): (Vec<_>, Vec<_>) = all.unzip();
        let Some(swept) = Swept::new(scene, None, &velocities, Effort::coarse(ENOUGH))? else {
            return Ok(Self::default());
        };
        let model = MatrixModel::with(scene, Kernel::Physical, None, Occlusion::Ignored)?;
        let Some(rates) = swept.rates.into_iter().collect::<Option<Vec<_>>>() else {
            return Ok(Self::default());
        };
        let by_motion = names.into_iter().zip(rates);
        let by_motion = by_motion.map(|(name, rate)| (name, rate.phi(&model.albedo)));
        let by_albedo = model.grids.iter().map(|grid| {
            let mut own = vec![0.0; model.albedo.len()];
            let which = grid.first..grid.first + grid.len();
            own[which.clone()].copy_from_slice(&model.albedo[which]);
            (albedo_of(&grid.surface), swept.terms.phi(&own) * 0.01)
        });
        Ok(Self {
            rates: by_motion.chain(by_albedo).collect(),
            shifts,
        })
    }

    /// Whether there are any.
    pub(super) fn is_known(&self) -> bool {
        !self.rates.is_empty()
    }
}
