//! Walls that reflect in another way.

use super::{MaterialRate, PERCENT};
use crate::scene::error::{Fault, keys};
use crate::scene::material::MaterialTable;
use crate::scene::parameter::{Kind, Parameter};
use crate::scene::{Material, Scene};

/// Step of the central difference of f_r, percent: of relative error 1e-10, and of a coat about
/// 1e-3, for nodes of the quadrature of its table pass the horizon.
const STEP: f64 = 1e-3;

impl Kind {
    /// Whether it changes how surface `id` reflects.
    fn is_of_material(&self, id: usize) -> bool {
        match self {
            Self::Roughness(ids)
            | Self::Contrast(ids)
            | Self::Albedo(ids)
            | Self::Weight(ids, _) => ids.contains(&id),
            _ => false,
        }
    }

    /// A material, and a factor of its albedo, that it changes by a size; none where that leaves
    /// the range of scene files.
    fn change(&self, (material, albedo): (Material, f64), value: f64) -> Option<(Material, f64)> {
        let by = PERCENT * value;
        let material = match self {
            Self::Roughness(_) => material.with_roughness_times(1.0 + by)?,
            Self::Contrast(_) => material.with_contrast_times(1.0 + by)?,
            Self::Weight(_, part) => material.with_weight_plus(*part, by)?,
            Self::Albedo(_) => return (by > -1.0).then_some((material, albedo * (1.0 + by))),
            _ => material,
        };
        Some((material, albedo))
    }
}

/// The material of surface `id`, and a factor of its albedo, one change after the other.
fn changed<'a>(
    scene: &Scene,
    id: usize,
    changes: impl Iterator<Item = (&'a Kind, f64)>,
) -> Option<(Material, f64)> {
    let own = (scene.surfaces[id].material.clone(), 1.0);
    let mut each = changes.filter(|(kind, value)| kind.is_of_material(id) && *value != 0.0);
    each.try_fold(own, |own, (kind, value)| kind.change(own, value))
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
            if !parameters.iter().any(|p| p.kind.is_of_material(id)) {
                continue;
            }
            let each = parameters.iter().zip(values).map(|(p, x)| (&p.kind, *x));
            let within = |(_, by): &(Material, f64)| by * surface.albedo.largest() <= 1.0;
            let Some((material, by)) = changed(self, id, each).filter(within) else {
                let cause = format!("the material of `{}` leaves its range", surface.name);
                let cure = "change its roughness, index, albedo or weight by less";
                return Err(Fault::new(keys!["surface", id, "material"], cause, cure));
            };
            surface.material = material;
            surface.albedo = surface.albedo.map(|rho| rho * by);
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
                Some((changed(self, id, each)?, step))
            };
            let here = at(0.0)?;
            // The albedo that they multiply is that of the changed scene.
            let [(less, from), (more, to)] = [-STEP, STEP].map(|step| {
                let ((material, by), step) = at(step).unwrap_or_else(|| here.clone());
                ((material, by / here.0.1), step)
            });
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
            Kind::Albedo(ids) if ids.contains(&id) => table.multiply_albedo(1.0 + by),
            Kind::Weight(ids, part) if ids.contains(&id) => table.add_weight(*part, by),
            _ => {}
        }
    }
}
