//! Whether the photographs ask for a finer picture than the one that was taken.
//!
//! A picture of few elements is even within each of them. What is not even there, the geometry
//! takes for its own: it bends until the photographs fit. So those of twice as many elements along
//! each side are tried about the estimate, by the likelihood over all of their pictures,
//! ln p(y | θ, finer) − ln p(y | θ, own).

use serde::Serialize;

use super::descent::{Problem, State};
use super::geometry::Geometry;
use super::picture;
use crate::lab::error::LabError;
use crate::model::{Kernel, MatrixModel, Occlusion};
use crate::transport::Control;

/// Elements, and elements times pixels, beyond which no finer ones are tried.
const MOST: usize = 400;
const MOST_SIDE: usize = 1 << 22;
/// ln of how much likelier finer elements are for which the photographs ask for them.
const ASKS: f64 = 3.0;

/// What finer elements say.
#[derive(Clone, Debug, Serialize)]
pub struct FinerElements {
    /// Their numbers along u and v.
    pub elements: [usize; 2],
    /// ln of how much likelier they make the photographs, with the geometry that they find.
    pub log_likelier: f64,
    /// How far they move each unknown, in its unit; nothing where the photographs do not ask for
    /// them.
    pub moved: Vec<f64>,
}

impl FinerElements {
    /// Whether the photographs ask for them.
    pub fn is_asked(&self) -> bool {
        self.log_likelier > ASKS
    }
}

impl Problem<'_> {
    /// Those of twice as many along each side as `model` has, about `best`; none where its surfaces
    /// differ or are not divided so, or there are too many.
    pub(super) fn finer_elements(
        &self,
        model: &MatrixModel,
        best: &State,
        control: Control<'_>,
    ) -> Result<Option<FinerElements>, LabError> {
        let count = model.grids.first().map_or([0; 2], |g| g.count);
        let are_equal = model.grids.iter().all(|g| g.count == count);
        let all = 4 * model.albedo.len();
        if !are_equal || all > MOST || all * self.photographs.phi.nrows() > MOST_SIDE {
            return Ok(None);
        }
        let elements = count.map(|n| 2 * n);
        let scene = self.geometry.scene;
        let ignored = Occlusion::Ignored;
        let finer = MatrixModel::with(scene, Kernel::Physical, Some(elements), ignored)?;
        // Triangles of a mesh are not divided.
        if finer.albedo.len() != all {
            return Ok(None);
        }
        let pictures = picture::priors(&finer.places, self.is_scale_free)?;
        let finer = Problem {
            geometry: Geometry {
                elements: Some(elements),
                ..self.geometry
            },
            priors: self.priors.clone(),
            pictures: &pictures,
            ..*self
        };
        let (state, _) = finer.stage(&best.values, best.factor, control)?;
        let log_likelier = self.total(best) - finer.total(&state);
        let moved = state.values.iter().zip(&best.values).map(|(a, b)| a - b);
        let moved = if log_likelier > ASKS {
            moved.collect()
        } else {
            Vec::new()
        };
        Ok(Some(FinerElements {
            elements,
            log_likelier,
            moved,
        }))
    }
}
