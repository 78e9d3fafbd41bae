//! The search for the best layout.

use super::design::Design;
use super::exchange::{exchanged, rounded};
use super::found::Optimum;
use super::photographs::Photographs;
use super::places::Places;
use super::plan::Plan;
use super::refine::refined;
use super::relaxed::{of_exposures, relaxed};
use crate::lab::error::LabError;
use crate::matrix::Matrix;
use crate::transport::Control;

/// Numbers that the information of all candidates may have: 2 GB.
const MOST: f64 = 2.5e8;

/// The best layout that is found, and what none can be below.
///
/// # Errors
/// [`LabError`], also where there are not so many places.
pub(super) fn searched(
    plan: &Plan,
    photographs: &Photographs,
    places: &Places,
    control: Control<'_>,
) -> Result<Optimum, LabError> {
    let all = places.grid(plan.candidates);
    let unknowns = photographs.factor.nrows() + plan.unsure.len();
    if all.len() as f64 * (unknowns * unknowns) as f64 > MOST {
        return Err(LabError::Unsuited(
            "the candidates' information takes more than 2 GB; use fewer --candidates or --elements",
        ));
    }
    let triangles = photographs.triangles(&all, control)?;
    let lit = all.iter().zip(triangles);
    let (candidates, triangles): (Vec<[f64; 2]>, Vec<Matrix>) =
        lit.filter_map(|(place, r)| Some((*place, r?))).unzip();
    if candidates.len() < plan.count {
        return Err(LabError::Unsuited(
            "there are fewer candidates than spots; use more --candidates, a smaller --margin or a smaller --count",
        ));
    }
    let design = Design::new(&triangles, &photographs.factor)?;
    let best = relaxed(&design, plan.count, control)?;
    let start = rounded(&best.weights, &candidates, places, plan.count)?;
    let (chosen, exchanges) = exchanged(&design, &candidates, places, start, control)?;
    let on_grid = design.risk(&design.of(chosen.iter().map(|s| &design.candidates()[*s])))?;
    let layout: Vec<[f64; 2]> = chosen.iter().map(|s| candidates[*s]).collect();
    let rounds = (plan.refine, 0.5 * places.spacing(plan.candidates));
    let layout = refined(&design, photographs, places, layout, rounds, control)?;
    let lit: Vec<Matrix> = photographs
        .triangles(&layout, control)?
        .into_iter()
        .flatten()
        .collect();
    let exposures = of_exposures(&Design::new(&lit, &photographs.factor)?, control)?;
    Ok(Optimum {
        candidates,
        relaxed: best.risk,
        bound: best.bound,
        weights: best.weights,
        steps: best.steps,
        exchanges,
        on_grid,
        exposures,
        layout,
    })
}
