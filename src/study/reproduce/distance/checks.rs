//! What is asked of the distance of the spot lines.

use super::At;
use crate::study::reproduce::Check;

/// Two values are one where they are nearer than this.
const SAME: f64 = 2.5e-2;

fn normalized(curve: &[At], half_width: f64) -> Option<f64> {
    let at = curve.iter().find(|a| a.half_width == half_width)?;
    at.outcome.normalized
}

/// Whole inches and 7.5 in., the distances that are spoken of.
fn spoken_of(a: &&At) -> bool {
    a.half_width.fract() == 0.0 || a.half_width == 7.5
}

fn highest<'a>(curve: impl Iterator<Item = &'a At>) -> Option<(&'a At, f64)> {
    let found = curve.filter_map(|a| Some((a, a.outcome.normalized?)));
    found.max_by(|a, b| a.1.total_cmp(&b.1))
}

/// What half inches add.
pub(super) fn finer(curve: &[At]) -> String {
    let Some((a, most)) = highest(curve.iter()) else {
        return "No normalized MTF is defined.".to_owned();
    };
    format!(
        "In steps of half an inch the highest normalized MTF without stagger, published kernel, is {most:.4} at {} in.; its rank of {} rests on a singular value of {:.2} \
         times the cut, the next one is {:.2} times the cut.",
        a.half_width, a.rank, a.last, a.nearest
    )
}

pub(super) fn without(curve: &[At]) -> Vec<Check> {
    let most = highest(curve.iter().filter(spoken_of));
    let (at, most) = most.map_or((f64::NAN, f64::NAN), |(a, most)| (a.half_width, most));
    vec![
        Check::trend(
            "half-width of the highest normalized MTF, no stagger, at whole inches and 7.5 in.",
            "7.5 in.",
            format!("{at} in. ({most:.4})"),
            "the highest computed value is at 7.5 in., published kernel",
            at == 7.5,
        ),
        Check::value(
            "normalized MTF at 5 in., no stagger",
            0.4731,
            normalized(curve, 5.0),
            SAME,
        ),
        Check::trend(
            "highest normalized MTF, no stagger, at whole inches and 7.5 in.",
            "none above 0.6",
            format!("{most:.4}"),
            "at most 0.6 plus 0.025",
            most <= 0.6 + SAME,
        ),
    ]
}

pub(super) fn with(plain: &[At], staggered: &[At]) -> Vec<Check> {
    let higher = staggered
        .iter()
        .zip(plain)
        .filter(|(s, p)| s.outcome.normalized > p.outcome.normalized)
        .count();
    vec![
        Check::value(
            "normalized MTF at 5 in., stagger",
            1.0,
            normalized(staggered, 5.0),
            1e-3,
        ),
        Check::value(
            "normalized MTF at 5 in., no stagger",
            0.4731,
            normalized(plain, 5.0),
            SAME,
        ),
        Check::trend(
            "distances at which stagger gives the higher normalized MTF",
            "stagger is better",
            format!("{higher} of {}", plain.len()),
            "more than half of them",
            2 * higher > plain.len(),
        ),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Kernel, Stagger};
    use crate::num::linalg::Tolerance;
    use crate::study::reproduce::Watch;
    use crate::study::reproduce::distance::curve;
    use std::sync::atomic::AtomicBool;

    /// What the published text says of Figs 17 and 20 where the published code is followed.
    #[test]
    fn the_best_distance_and_the_stagger_are_as_published() {
        let stop = AtomicBool::new(false);
        let curve = |stagger| {
            curve(
                Kernel::Published,
                stagger,
                Tolerance::Spacing,
                Watch::new(&stop),
            )
            .unwrap()
        };
        let (plain, staggered) = (curve(Stagger::None), curve(Stagger::OneInch));
        let (best, _) = highest(plain.iter().filter(spoken_of)).unwrap();
        assert_eq!(best.half_width, 7.5);
        assert!(normalized(&staggered, 5.0).unwrap() >= 0.999);
    }
}
