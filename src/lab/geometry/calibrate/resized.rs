//! The geometry with another size of the hidden surface.

use super::descent::Problem;
use super::field::End;
use super::geometry::Geometry;
use super::{CalibrationPlan, picture};
use crate::lab::error::LabError;
use crate::lab::geometry::resized::{Resized, resized};
use crate::model::{Kernel, MatrixModel, Occlusion};
use crate::transport::Control;

impl CalibrationPlan {
    /// The likelier of other sizes, searched from `best` at its noise; none where there is none, or
    /// it is not looked for.
    ///
    /// # Errors
    /// [`LabError`]: no light, or it was stopped.
    pub(super) fn resized(
        &self,
        problem: &Problem<'_>,
        best: &End,
        control: Control<'_>,
    ) -> Result<Option<Resized>, LabError> {
        let mut found: Option<Resized> = None;
        if !problem.is_looked_around() {
            return Ok(None);
        }
        for (factor, scene) in resized(problem.geometry.scene) {
            let ignored = Occlusion::Ignored;
            let model = MatrixModel::with(&scene, Kernel::Physical, self.elements, ignored)?;
            let pictures = picture::priors(&model.places, self.is_scale_free)?;
            let other = Problem {
                geometry: Geometry {
                    scene: &scene,
                    ..problem.geometry
                },
                pictures: &pictures,
                priors: problem.priors.clone(),
                ..*problem
            };
            if other.geometry.refused(&best.state.values).is_some() {
                continue;
            }
            let end = self.end(&other, &best.state.values, best.state.factor, control)?;
            let other = Resized {
                factor,
                log_likelier: best.total - end.total,
                values: end.state.values,
            };
            found = Some(other.likelier(found));
        }
        Ok(found)
    }
}
