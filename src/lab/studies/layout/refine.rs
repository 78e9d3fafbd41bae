//! Small moves of the spots of a layout, off the grid.

use super::design::Design;
use super::photographs::Photographs;
use super::places::Places;
use crate::lab::error::LabError;
use crate::matrix::Matrix;
use crate::transport::Control;

/// Compass search (Kolda, Lewis and Torczon 2003) over the spots in turn: each goes to the best of
/// four places a step away, along x or y, if it is allowed, apart from the others, and lowers the
/// risk. The step is `step` in the first of `rounds` rounds and halves in each. Returns the layout
/// and its triangles.
///
/// # Errors
/// [`LabError`]; that it was stopped.
pub(super) fn refined(
    design: &Design,
    photographs: &Photographs,
    places: &Places,
    mut layout: Vec<[f64; 2]>,
    (rounds, step): (usize, f64),
    control: Control<'_>,
) -> Result<Vec<[f64; 2]>, LabError> {
    let triangles = photographs.triangles(&layout, control)?;
    let of = |r: &Option<Matrix>| r.as_ref().map(|r| design.information_of(r));
    let dark = LabError::Unsuited("a spot of the layout lights nothing; use another --margin");
    let own: Option<Vec<Matrix>> = triangles.iter().map(of).collect();
    let mut own = own.ok_or(dark)?;
    let mut risk = design.risk(&design.of(own.iter()))?;
    for round in 0..rounds {
        control.check()?;
        let step = step * libm::pow(0.5, round as f64);
        let around = |k: usize| {
            let [x, y] = layout[k];
            let all = [[x + step, y], [x - step, y], [x, y + step], [x, y - step]];
            all.into_iter().map(move |place| (k, place))
        };
        let moves = (0..layout.len()).flat_map(around);
        let moves: Vec<(usize, [f64; 2])> = moves.filter(|(_, p)| places.allow(*p)).collect();
        let to: Vec<[f64; 2]> = moves.iter().map(|(_, place)| *place).collect();
        let triangles = photographs.triangles(&to, control)?;
        let information: Vec<Option<Matrix>> = triangles.iter().map(of).collect();
        for k in 0..layout.len() {
            let others = |i: &usize| *i != k;
            let rest = design.of((0..own.len()).filter(others).map(|i| &own[i]));
            for ((_, place), h) in moves.iter().zip(&information).filter(|(m, _)| m.0 == k) {
                let Some(h) = h else { continue };
                let others = (0..layout.len()).filter(others).map(|i| layout[i]);
                if !places.apart_from(*place, others) {
                    continue;
                }
                let less = design.risk(&(&rest + h))?;
                if less < risk {
                    (risk, layout[k], own[k]) = (less, *place, h.clone());
                }
            }
        }
    }
    Ok(layout)
}
