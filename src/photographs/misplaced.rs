//! Photographs that do not lie where marks, camera and view have them.

use super::lens::Lens;
use super::mapping::{Fitted, Mapping, Mark, OddMark};
use crate::num::digits::figure;
use crate::num::statistics::fisher_sf;
use crate::scene::Camera;

/// Error of a mark, px, above which it was not read where it is.
const MISREAD: f64 = 1.0;
/// Part of the marks' error that is left to the others without one that is to be blamed.
const ODD: f64 = 0.3;
/// How far off, px, and how improbably, one among others that lie well is told too.
const LONE: f64 = 0.5;
const SELDOM: f64 = 1e-3;
/// How far from square the pixels of a view without marks may be.
const STRETCH: f64 = 0.02;
/// Part by which a camera's distance from the wall may be off before its watts are.
const ELSEWHERE: f64 = 0.05;
/// Part of the view over which a mapping's direction is taken.
const STEP: f64 = 1e-3;

/// That marks show the wall as only a mirror would: right and up on it, seen from the camera, are
/// right and down in a photograph, whose rows are counted from the top.
pub(super) fn mirrored(mapping: &Mapping, camera: &Camera) -> Option<String> {
    let at = |x: f64, y: f64| mapping.pixel([0.5 + x, 0.5 + y]);
    let (here, right, up) = (at(0.0, 0.0)?, at(STEP, 0.0)?, at(0.0, STEP)?);
    let along = |to: [f64; 2]| [to[0] - here[0], to[1] - here[1]];
    let ([a, b], [c, d]) = (along(right), along(up));
    let view = &camera.view;
    let facing = view.u().cross(view.v());
    let front = facing.dot(camera.position - view.at([0.5; 2]).position);
    ((a * d - b * c) * front > 0.0).then(|| {
        "the marks show the wall as in a mirror, which no camera on its side of it sees: check the order of their pixels and places, and whether the photographs are mirrored".to_owned()
    })
}

/// That marks do not lie where any mapping has them; or one of n of which the others' mapping knows
/// better. With S the squares of all and S′ those of the others, each mark of two numbers and a
/// mapping of eight,
///
/// > (S − S′)/2 / (S′/(2n − 10)) ~ F(2, 2n − 10),   the largest of n.
pub(super) fn misread(fitted: &Fitted, marks: &[Mark], lens: Option<Lens>) -> Option<String> {
    let error = fitted.mark_error?;
    let n = marks.len() as f64;
    let odd = Mapping::odd_mark(marks, lens).filter(|odd| odd.others < ODD * error);
    let is_lone = |odd: &OddMark| {
        let freedom = 2.0 * n - 10.0;
        let others = odd.others * odd.others;
        let own = 0.5 * (error * error * (freedom + 2.0) - others * freedom);
        odd.off > LONE && (others == 0.0 || n * fisher_sf(own / others, 2.0, freedom) < SELDOM)
    };
    if error <= MISREAD && !odd.as_ref().is_some_and(is_lone) {
        return None;
    }
    let which = match odd {
        Some(odd) => format!(
            "; without the {}. of the list, {} px from where the others have it, these lie {} px off: check its pixel and place",
            odd.at + 1,
            figure(odd.off, 2),
            figure(odd.others, 2)
        ),
        None => ", and no single one explains it: check the pixels and places of all".to_owned(),
    };
    Some(format!(
        "the marks lie {} px off where the mapping has them{which}, and the scene's camera and lens; what that moves \
         of the light is in no standard error",
        figure(error, 2)
    ))
}

/// That a mark was found where the photographs of this size have no pixel.
pub(super) fn outside(marks: &[Mark], size: [usize; 2]) -> Option<String> {
    let is_within = |mark: &Mark| {
        let mut axes = mark.pixel.into_iter().zip(size);
        axes.all(|(x, n)| (-0.5..=n as f64 - 0.5).contains(&x))
    };
    let at = marks.iter().position(|mark| !is_within(mark))?;
    let [u, v] = marks[at].pixel;
    Some(format!(
        "the {}. of the marks, at pixel ({u}, {v}), is outside of the photographs of {} × {} px: check its pixel, columns first",
        at + 1,
        size[0],
        size[1]
    ))
}

/// That camera matrix and marks have the camera at another distance from the wall than the scene.
pub(super) fn elsewhere(mapping: &Mapping, camera: &Camera) -> Option<String> {
    let view = &camera.view;
    let unit = view.u().cross(view.v()).length().sqrt();
    let own = unit * mapping.pose()?.height;
    let due = view.normal().dot(camera.position - view.corner()).abs();
    (libm::log(own / due).abs() > libm::log(1.0 + ELSEWHERE)).then(|| {
        format!(
            "the camera matrix and the marks have the camera {} from the wall, camera.position {}: if both are one camera, \
             fx and fy are not of photographs of this size, or camera.position is off; `watts` rests on both",
            figure(own, 3),
            figure(due, 3)
        )
    })
}

/// That a view of these sides fills a rectangle of `extent`, px, of another shape.
pub(super) fn stretched([columns, rows]: [f64; 2], [u, v]: [f64; 2]) -> Option<String> {
    let ratio = (u / columns) / (v / rows);
    (libm::log(ratio).abs() > libm::log(1.0 + STRETCH)).then(|| {
        format!(
            "without marks the scene's view, {u} wide and {v} high, fills {columns} × {rows} px: its pixels are {} times as wide as high; if the camera's are square, mend camera.view or give `crop` or marks",
            figure(ratio, 3)
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Marks of a perspective, one of twelve of which is read 30 or 150 px beside its place: it is
    /// named, though the mapping is drawn to it. With all where they are nothing is said, and where
    /// two are off none is blamed.
    #[test]
    fn a_mark_that_was_misread_is_named() {
        let place = |k: usize| [0.2 + 0.3 * (k % 4) as f64, 0.1 + 0.4 * (k / 4) as f64];
        let marks = |off: f64, odd: &[usize]| -> Vec<Mark> {
            (0..12)
                .map(|k| {
                    let [x, y] = place(k);
                    let w = 1.0 + 0.2 * x + 0.1 * y;
                    let beside = if odd.contains(&k) { off } else { 0.0 };
                    Mark {
                        pixel: [(100.0 + 300.0 * x) / w + beside, (900.0 - 400.0 * y) / w],
                        wall: [x, y],
                    }
                })
                .collect()
        };
        let told = |off, odd: &[usize]| {
            let marks = marks(off, odd);
            misread(&Mapping::from_marks(&marks, None).unwrap(), &marks, None)
        };
        assert_eq!(told(0.0, &[6]), None);
        // Of 1.5 px all together lie less than 1 px off.
        for k in 0..12 {
            for off in [1.5, 30.0, 150.0] {
                let words = told(off, &[k]).unwrap();
                let name = format!("without the {}. of the list, {off}", k + 1);
                assert!(words.contains(&name), "{words}");
            }
        }
        let words = told(30.0, &[2, 7]).unwrap();
        assert!(words.contains("no single one"), "{words}");
        assert_eq!(outside(&marks(0.0, &[]), [400, 901]), None);
        let words = outside(&marks(0.0, &[]), [400, 800]).unwrap();
        assert!(words.contains("the 1. of the marks"), "{words}");
    }

    /// Pixels of a view of 3 × 2 that fills 300 × 200 px are square, of 4 × 2 a third wider.
    #[test]
    fn a_stretched_view_is_told() {
        assert_eq!(stretched([300.0, 200.0], [3.0, 2.0]), None);
        let told = stretched([300.0, 200.0], [4.0, 2.0]).unwrap();
        assert!(told.contains("1.33 times as wide as high"), "{told}");
    }
}
