//! The method that goes furthest.

use serde::Serialize;

use super::axis::NoiseAxis;
use super::curve::{Held, NoiseCurve, Point, Reach};
use super::picture::Picture;

/// Of one object and its elements the method that holds its mean raw MTF at or above the first of
/// [`LIMITS`](super::LIMITS) up to the loudest noise; of equals the one with the smaller root mean
/// square error there.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Best {
    /// The object: checks a side, or `own`.
    #[serde(rename = "board")]
    pub picture: Picture,
    /// Elements a side of the recovery.
    pub elements: usize,
    /// The method; none where no method reaches the limit at the quietest level.
    pub method: Option<String>,
    /// The level up to which it holds.
    pub level: Option<f64>,
    /// How far the scatter of the draws may move it ([`NoiseCurve::held_within`]).
    pub within: Option<[Option<Held>; 2]>,
    /// Whether it falls there.
    pub reach: Option<Reach>,
    /// Root mean square error at that level, over elements and draws; between two levels its
    /// logarithm is interpolated.
    pub rmse: Option<f64>,
    /// The same over the bound of Cramér and Rao.
    pub rmse_over_bound: Option<f64>,
}

/// The best of the `curves` of one object.
pub(super) fn best(
    axis: &NoiseAxis,
    (picture, elements): (Picture, usize),
    curves: &[NoiseCurve],
) -> Best {
    let own = curves
        .iter()
        .filter(|c| (c.picture, c.elements) == (picture, elements));
    let found = own
        .filter_map(|c| {
            let held = c.held?;
            let at = |of| between(axis, &c.points, held, of);
            let rmse = at(|p| p.rmse_over_draws);
            let bound = at(|p| p.cramer_rao);
            Some((c, held, rmse, rmse.and_then(|e| Some(e / bound?))))
        })
        // The first of equals stays.
        .reduce(|best, next| {
            let further = axis.quiet_first(next.1.level, best.1.level);
            let error = |e: Option<f64>| e.unwrap_or(f64::INFINITY);
            let nearer = error(next.2).total_cmp(&error(best.2));
            if further.then(nearer.reverse()).is_gt() {
                next
            } else {
                best
            }
        });
    Best {
        picture,
        elements,
        method: found.map(|(c, ..)| c.method.clone()),
        level: found.map(|(_, held, ..)| held.level),
        within: found.and_then(|(c, ..)| c.held_within),
        reach: found.map(|(_, held, ..)| held.reach),
        rmse: found.and_then(|f| f.2),
        rmse_over_bound: found.and_then(|f| f.3),
    }
}

/// An error at a level between those studied: it goes with a power of the level where it is noise,
/// and where ever more draws fail, as its square then goes with what is lost of the modulation.
fn between(
    axis: &NoiseAxis,
    points: &[Point],
    held: Held,
    of: fn(&Point) -> Option<f64>,
) -> Option<f64> {
    if let Some(p) = points.iter().find(|p| p.level == held.level) {
        return of(p);
    }
    let pair = points.windows(2).find(|w| {
        let (a, b) = (w[0].level - held.level, w[1].level - held.level);
        a * b < 0.0
    })?;
    let [a, b] = [of(&pair[0])?, of(&pair[1])?];
    let t = axis.fraction([pair[0].level, pair[1].level], held.level);
    // Where no draw errs its square, as what is lost, counts as a hundredth.
    let a = if a > 0.0 { a } else { 0.1 * b };
    let value = libm::exp((1.0 - t) * libm::log(a) + t * libm::log(b));
    value.is_finite().then_some(value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lab::studies::noise::curve::{LIMITS, Lost};

    fn curve(method: &str, held: Option<(f64, Reach)>, errors: [f64; 2]) -> NoiseCurve {
        let point = |level, error: f64| Point {
            rmse_over_draws: Some(error),
            ..Point::of(level, &[], Some(10.0 * level))
        };
        NoiseCurve {
            picture: Picture::Board(2),
            elements: 8,
            method: method.to_owned(),
            integration: "centres".to_owned(),
            mtf_of_truth: [1.0; 2],
            points: vec![point(1e-4, errors[0]), point(1e-2, errors[1])],
            lost_raw: [Lost::Unknown; LIMITS.len()],
            lost_normalized: [Lost::Unknown; LIMITS.len()],
            held: held.map(|(level, reach)| Held { level, reach }),
            held_within: None,
        }
    }

    /// By hand: 1e-3 is half way from 1e-4 to 1e-2; the error there √(0.01 · 0.09) = 0.03, the
    /// bound, ten times the level, 0.01. From none on, which counts as 0.009, it is √0.00081.
    #[test]
    fn the_furthest_wins_and_of_equals_the_nearest() {
        let curves = [
            curve("never", None, [1.0, 1.0]),
            curve("early", Some((1e-4, Reach::Falls)), [0.001, 0.001]),
            curve("coarse", Some((1e-3, Reach::Falls)), [0.04, 0.09]),
            curve("fine", Some((1e-3, Reach::AtLeast)), [0.01, 0.09]),
        ];
        let found = best(&NoiseAxis::Relative, (Picture::Board(2), 8), &curves);
        assert_eq!(found.method.as_deref(), Some("fine"));
        assert_eq!(
            (found.level, found.reach),
            (Some(1e-3), Some(Reach::AtLeast))
        );
        assert!((found.rmse.unwrap() / 0.03 - 1.0).abs() < 1e-12);
        assert!((found.rmse_over_bound.unwrap() / 3.0 - 1.0).abs() < 1e-12);
        let exact = [curve("exact", Some((1e-3, Reach::Falls)), [0.0, 0.09])];
        let found = best(&NoiseAxis::Relative, (Picture::Board(2), 8), &exact);
        assert!((found.rmse.unwrap() / 0.00081f64.sqrt() - 1.0).abs() < 1e-12);
        // Where few photons are loud the one that does with least wins.
        assert_eq!(
            best(&NoiseAxis::Photons, (Picture::Board(2), 8), &curves)
                .method
                .as_deref(),
            Some("early")
        );
        assert_eq!(
            best(&NoiseAxis::Relative, (Picture::Board(4), 8), &curves).method,
            None
        );
    }
}
