//! A layout of whole spots: rounded weights, then exchanges.

use rayon::prelude::*;

use super::design::Design;
use super::places::Places;
use crate::lab::error::LabError;
use crate::matrix::Matrix;
use crate::transport::Control;

/// Candidates that are tried in the place of one spot.
const TRIED: usize = 12;
/// Relative fall of the risk below which an exchange is not worth it.
const WORTH: f64 = 1e-7;

/// The `count` candidates of the largest weights that are apart from each other; among equals the
/// first.
///
/// # Errors
/// [`LabError::Unsuited`] where there are not so many.
pub(super) fn rounded(
    weights: &[f64],
    candidates: &[[f64; 2]],
    places: &Places,
    count: usize,
) -> Result<Vec<usize>, LabError> {
    let mut order: Vec<usize> = (0..weights.len()).collect();
    order.sort_by(|a, b| weights[*b].total_cmp(&weights[*a]).then(a.cmp(b)));
    let mut chosen: Vec<usize> = Vec::new();
    for s in order {
        if chosen.len() == count {
            break;
        }
        let taken = chosen.iter().map(|t| candidates[*t]);
        if places.apart_from(candidates[s], taken) {
            chosen.push(s);
        }
    }
    if chosen.len() < count {
        return Err(LabError::Unsuited(
            "not so many spots fit on the wall; use more --candidates, a smaller --apart or --margin, or a smaller --count",
        ));
    }
    Ok(chosen)
}

/// Exchanges one spot for one candidate as long as the risk falls (Fedorov 1972): spots in the
/// order of what the layout loses without them, and for each the candidates of the steepest fall
/// without it. Returns the layout, in the order of the candidates, and the number of exchanges.
///
/// # Errors
/// Those of [`Design::risk`]; that it was stopped.
pub(super) fn exchanged(
    design: &Design,
    candidates: &[[f64; 2]],
    places: &Places,
    mut chosen: Vec<usize>,
    control: Control<'_>,
) -> Result<(Vec<usize>, usize), LabError> {
    let all = design.candidates();
    let most = 10 * chosen.len();
    let mut exchanges = 0;
    'better: while exchanges < most {
        let a = design.of(chosen.iter().map(|s| &all[*s]));
        let risk = design.risk(&a)?;
        let without = |k: usize| -> Result<(f64, usize, Matrix), LabError> {
            let others = chosen.iter().enumerate().filter(|(i, _)| *i != k);
            let a = design.of(others.map(|(_, s)| &all[*s]));
            Ok((design.risk(&a)?, k, a))
        };
        let lost: Result<Vec<_>, LabError> =
            (0..chosen.len()).into_par_iter().map(without).collect();
        let mut lost = lost?;
        lost.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        for (without, k, a) in lost {
            control.check()?;
            let gains = design.gains(&a)?;
            // No candidate lowers the risk by more than its slope.
            let may = |s: &usize| without - gains[*s] < risk * (1.0 - WORTH);
            let free = |s: &usize| {
                let others = chosen.iter().enumerate().filter(|(i, _)| *i != k);
                places.apart_from(candidates[*s], others.map(|(_, t)| candidates[*t]))
            };
            let new = |s: &usize| !chosen.contains(s);
            let fit = (0..all.len()).filter(|s| may(s) && new(s) && free(s));
            let mut order: Vec<usize> = fit.collect();
            order.sort_by(|a, b| gains[*b].total_cmp(&gains[*a]).then(a.cmp(b)));
            order.truncate(TRIED);
            let with = |s: usize| -> Result<(f64, usize), LabError> {
                Ok((design.risk(&(&a + &all[s]))?, s))
            };
            let tried: Result<Vec<_>, LabError> = order.into_par_iter().map(with).collect();
            let best = tried?
                .into_iter()
                .min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            if let Some((less, s)) = best
                && less < risk * (1.0 - WORTH)
            {
                chosen[k] = s;
                exchanges += 1;
                continue 'better;
            }
        }
        break;
    }
    chosen.sort_unstable();
    Ok((chosen, exchanges))
}

#[cfg(test)]
mod tests {
    use super::super::design::tests::{tied, triangles};
    use super::*;
    use crate::scene::Scene;

    /// Of 10 candidates of two elements, the layout of 3 is the best of all 120, and keeps apart
    /// where it must.
    #[test]
    fn a_small_layout_is_the_best_of_all() {
        let all = triangles(10, (1, 2), 0.3);
        let design = Design::new(&all, &tied(2)).unwrap();
        let candidates: Vec<[f64; 2]> = (0..10).map(|k| [f64::from(k), 0.0]).collect();
        let scene = Scene::load("bench").unwrap();
        let risk = |some: &[usize]| {
            let a = design.of(some.iter().map(|s| &design.candidates()[*s]));
            design.risk(&a).unwrap()
        };
        for apart in [0.0, 2.0] {
            let places = Places::new(&scene, 0.1, apart);
            // Far from the best: the first that are allowed.
            let start = rounded(&[0.1; 10], &candidates, &places, 3).unwrap();
            let found = exchanged(&design, &candidates, &places, start, Control::none());
            let (found, _) = found.unwrap();
            let mut least = f64::INFINITY;
            for a in 0..10usize {
                for b in 0..a {
                    for c in 0..b {
                        if (a - b) as f64 >= apart && (b - c) as f64 >= apart {
                            least = least.min(risk(&[a, b, c]));
                        }
                    }
                }
            }
            let near = found.windows(2).any(|p| ((p[1] - p[0]) as f64) < apart);
            assert!(!near, "{found:?}");
            assert!(
                (risk(&found) / least - 1.0).abs() < 1e-9,
                "{found:?} {least}"
            );
        }
        let places = Places::new(&scene, 0.1, 5.0);
        let refused = rounded(&[0.1; 10], &candidates, &places, 3).unwrap_err();
        assert!(refused.to_string().contains("--apart"), "{refused}");
    }
}
