//! What no unbiased recovery undercuts.

use crate::lab::problem::problem;
use rayon::prelude::*;

use super::stage::Stage;
use crate::model::MatrixModel;
use crate::recovery::cramer_rao;

/// √(tr CRB/r) at each level: the least root mean square error, over elements and draws, of
/// unbiased recoveries from independent errors of the level's standard error. `None` where there is
/// none: the sensor has no noise, or directions are lost in f64.
///
/// A relative error s that all entries share adds s² ρρᵀ to the bound of the entries' own errors:
/// with the scale known to s beforehand, of a picture ρ.
///
/// Where the levels change the size of the standard errors alone, the bound is proportional to it
/// and computed once.
pub(super) fn bounds(stage: &Stage, model: &MatrixModel, levels: &[f64]) -> Vec<Option<f64>> {
    let bound = |level: f64| {
        let stderr = stage.stderr(level).ok()?;
        let problem = problem(model, &stage.exact, Some(&stderr)).ok()?;
        let errors = cramer_rao(&problem).ok()?.standard_error;
        let shared = stage.axis.scale_error(level).unwrap_or(0.0);
        let picture: f64 = model.albedo.iter().map(|x| x * x).sum();
        let mean = (errors.norm_squared() + shared * shared * picture) / errors.len() as f64;
        mean.is_finite().then(|| mean.sqrt())
    };
    let size = |level: &f64| stage.axis.size(*level);
    match levels
        .first()
        .and_then(|first| Some((*first, size(first)?)))
    {
        Some((first, own)) => {
            let one = bound(first).map(|b| b / own);
            levels.iter().map(|l| Some(one? * size(l)?)).collect()
        }
        None => levels.par_iter().map(|level| bound(*level)).collect(),
    }
}
