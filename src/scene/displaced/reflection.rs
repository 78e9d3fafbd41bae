//! Walls that reflect in another way.

use super::{MaterialRate, PERCENT};
use crate::scene::error::{Fault, keys};
use crate::scene::material::MaterialTable;
use crate::scene::parameter::{Kind, Parameter};
use crate::scene::{Material, Scene};

/// Step of the central difference of f_r, percent: of relative error 1e-10.
const STEP: f64 = 1e-3;

impl Kind {
    /// Whether it changes how surface `id` reflects.
    fn is_of_material(&self, id: usize) -> bool {
        match self {
            Self::Roughness(ids) | Self::Contrast(ids) | Self::Weight(ids, _) => ids.contains(&id),
            _ => false,
        }
    }

    /// A material that it changes by a size; none where that leaves the range of scene files.
    fn change(&self, material: &Material, value: f64) -> Option<Material> {
        let by = PERCENT * value;
        match self {
            Self::Roughness(_) => material.with_roughness_times(1.0 + by),
            Self::Contrast(_) => material.with_contrast_times(1.0 + by),
            Self::Weight(_, part) => material.with_weight_plus(*part, by),
            _ => None,
        }
    }
}

/// The material of surface `id`, one change after the other.
fn changed<'a>(
    own: &Material,
    id: usize,
    changes: impl Iterator<Item = (&'a Kind, f64)>,
) -> Option<Material> {
    let mut each = changes.filter(|(kind, value)| kind.is_of_material(id) && *value != 0.0);
    each.try_fold(own.clone(), |material, (kind, value)| {
        kind.change(&material, value)
    })
}

impl Scene {
    /// Gives `scene` the materials that its walls have at these values.
    pub(super) fn reflect(
        &self,
        scene: &mut Self,
        parameters: &[Parameter],
        values: &[f64],
    ) -> Result<(), Fault> {
        for (id, surface) in scene.surfaces.iter_mut().enumerate() {
            let each = parameters.iter().zip(values).map(|(p, x)| (&p.kind, *x));
            surface.material = changed(&self.surfaces[id].material, id, each).ok_or_else(|| {
                let cause = format!("the material of `{}` leaves its range", surface.name);
                let cure = "change its roughness, index or weight by less";
                Fault::new(keys!["surface", id, "material"], cause, cure)
            })?;
        }
        Ok(())
    }

    /// How walls reflect per unit of parameter `k`; at the end of a range by the side within it.
    pub(super) fn material_rates(
        &self,
        parameters: &[Parameter],
        values: &[f64],
        k: usize,
    ) -> Vec<MaterialRate> {
        let rate = |id: usize| {
            let at = |step: f64| {
                let each = parameters.iter().zip(values).enumerate();
                let each = each.map(|(j, (p, x))| (&p.kind, if j == k { x + step } else { *x }));
                Some((changed(&self.surfaces[id].material, id, each)?, step))
            };
            let (less, from) = at(-STEP).or_else(|| at(0.0))?;
            let (more, to) = at(STEP).or_else(|| at(0.0))?;
            Some(MaterialRate {
                surface: id,
                ends: [less, more],
                over: to - from,
            })
        };
        let concerned =
            (0..self.surfaces.len()).filter(|id| parameters[k].kind.is_of_material(*id));
        concerned.filter_map(rate).collect()
    }
}

/// Writes what these parameters change of the material of surface `id` into its table.
pub(super) fn write_material(
    table: &mut MaterialTable,
    id: usize,
    parameters: &[Parameter],
    values: &[f64],
) {
    for (p, value) in parameters.iter().zip(values) {
        let by = PERCENT * value;
        match &p.kind {
            Kind::Roughness(ids) if ids.contains(&id) => table.multiply_roughness(1.0 + by),
            Kind::Contrast(ids) if ids.contains(&id) => table.multiply_contrast(1.0 + by),
            Kind::Weight(ids, part) if ids.contains(&id) => table.add_weight(*part, by),
            _ => {}
        }
    }
}
