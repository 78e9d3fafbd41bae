//! Figs 17, 18, 20, 21: the distance of the spot lines from C.

use super::case::{Case, KERNELS, Row, curve, published, rows};
use super::item::Item;
use super::outcome::{Trial, stretched};
use super::sheet::{BOTH_KERNELS, CUT, STRETCHED, VIEW, elements, finding, square};
use super::substitution;
use super::traced;
use crate::lab::check::Check;
use crate::lab::finding::{Axis, Curve, Finding, Gallery, Mark, Plot, Shades, Table};
use crate::model::{Kernel, Stagger};

/// Checks and elements a side.
const SIDE: usize = 8;
/// Spots a side: 100 in all.
const PER_SIDE: usize = 25;
/// Where curves start and end, in half inches.
const HALVES: std::ops::RangeInclusive<usize> = 2..=28;
/// Distances of the pictures, in.
const SHOWN: [f64; 5] = [1.0, 5.0, 6.0, 7.5, 11.0];
/// Distances at which light is traced, in.
const TRACED: [f64; 8] = [1.0, 3.0, 5.0, 6.0, 7.5, 9.0, 11.0, 14.0];
/// Two values are one where they are nearer than this.
const SAME: f64 = 2.5e-2;
/// Layouts with their names; Fig 17 has the first of two, Fig 20 both.
const LAYOUTS: [(Stagger, &str); 2] =
    [(Stagger::None, "no stagger"), (Stagger::OneInch, "stagger")];

fn layouts(item: Item) -> &'static [(Stagger, &'static str)] {
    if item == Item::Fig17 {
        &LAYOUTS[..1]
    } else {
        &LAYOUTS
    }
}

/// Curves over the distance under both kernels, and a few distances traced.
pub(super) fn cases(item: Item) -> Vec<Case> {
    let mut cases = Vec::new();
    for kernel in KERNELS {
        for &(stagger, label) in layouts(item) {
            cases.extend(HALVES.map(|half| {
                let case = published(kernel, SIDE, PER_SIDE, 0.5 * half as f64, stagger);
                Case::modelled(label, case, vec![SIDE])
            }));
        }
    }
    for &(stagger, label) in layouts(item) {
        cases.extend(TRACED.map(|half_width| {
            let case = published(Kernel::Physical, SIDE, PER_SIDE, half_width, stagger);
            Case::traced(label, case, SIDE)
        }));
    }
    cases
}

/// The modelled rows of one curve.
fn one<'a>(rows: &'a [Row<'a>], kernel: Kernel, label: &str) -> Vec<&'a Row<'a>> {
    let own = |r: &&Row<'_>| !r.case.is_traced && r.is(kernel) && r.case.label == label;
    rows.iter().filter(own).collect()
}

/// The figure of either item.
pub(super) fn figure(item: Item, cases: &[Case], found: &[Vec<Trial>]) -> Finding {
    let rows = rows(cases, found);
    let (mut normalized, mut raw, mut pictures) = (Vec::new(), Vec::new(), Vec::new());
    for kernel in KERNELS {
        for (_, layout) in layouts(item) {
            let own = one(&rows, kernel, layout);
            let name = format!("{} kernel, {layout}", kernel.name());
            let line = |y| curve(&name, own.iter().copied(), |r| r.half_width(), y);
            normalized.push(line(|o| o.normalized));
            raw.push(line(|o| o.raw));
            if kernel == Kernel::Published {
                let shown = own.iter().filter(|r| SHOWN.contains(&r.half_width()));
                pictures.extend(shown.map(|r| {
                    let title = format!("{} in., {layout}", r.half_width());
                    elements(title, SIDE, stretched(&r.outcome.values))
                }));
            }
        }
    }
    let [plain, staggered] = LAYOUTS.map(|l| one(&rows, Kernel::Published, l.1));
    let mut known = vec![[5.0, 0.4731]];
    let mut galleries = vec![
        Gallery::reflectances(
            "Recovered 8 × 8 board, published kernel, stretched to [0, 1]",
            pictures,
        ),
        substitution::gallery(&rows, &SHOWN),
    ];
    let (title, spots, checks);
    if item == Item::Fig17 {
        title = "MTF against the distance of the spot lines from C, no stagger";
        spots = "no stagger";
        checks = without_stagger(&plain);
    } else {
        title = "MTF against the distance of the spot lines from C, with and without stagger";
        spots = "without stagger and by turns on, 1 in. inside and 1 in. outside its lines";
        checks = with_stagger(&plain, &staggered);
        known.push([5.0, 1.0]);
        galleries.push(contours());
    }
    normalized.push(Curve::new("printed in the text", Mark::Published, known));
    let across = || Axis::linear("half-width of the square of spots / in.", [0.0, 15.0]);
    let upwards = |title| Axis::linear(title, [0.0, 1.0]);
    let plots = vec![
        Plot::new(
            "normalized MTF (published convention)",
            [across(), upwards("normalized MTF")],
            normalized,
        ),
        Plot::new("raw MTF", [across(), upwards("raw MTF")], raw),
        substitution::plot(&rows, across(), |r| r.half_width()),
    ];
    let notes = vec![finer(&plain), substitution::words(&rows)];
    let caption = format!(
        "{BOTH_KERNELS}; 8 × 8 board at 8 × 8 elements; 100 spots on the four sides of a square \
         around C, {spots}; {VIEW}; {CUT}; {STRETCHED}, raw MTF beside it; noiseless, by the \
         projector. {}",
        traced::caption()
    );
    let table = Table::of(
        &rows,
        [
            ("kernel", |r| r.kernel().into()),
            ("layout", |r| r.case.label.into()),
            ("half_width_in", |r| r.half_width().into()),
            ("rank", |r| r.trial.rank.into()),
            ("last_kept_over_cut", |r| r.trial.around[0].into()),
            ("first_cut_over_cut", |r| r.trial.around[1].into()),
            ("mtf_raw", |r| r.outcome.raw.into()),
            ("mtf_normalized", |r| r.outcome.normalized.into()),
            ("phi", |r| r.phi.into()),
            ("noise", |r| r.outcome.noise.into()),
        ],
    );
    Finding {
        galleries,
        checks,
        notes,
        ..finding(item, title, caption, table, plots)
    }
}

/// Fig 21: G12 of two corner elements over the wall around C.
fn contours() -> Gallery {
    let (side, reach) = (61, 7.5);
    let corners = KERNELS
        .into_iter()
        .flat_map(|k| [[0, 0], [7, 7]].map(|c| (k, c)));
    let picture = |(kernel, [i, j]): (Kernel, [usize; 2])| {
        let case = published(kernel, SIDE, 2, reach, Stagger::None);
        let values = case.g12_over(i + SIDE * j, reach, side);
        let title = format!("{} kernel, element ({}, {})", kernel.name(), i + 1, j + 1);
        square(title, side, values, ["x", "y"], 2.0 * reach)
    };
    Gallery {
        title: "G12 of two corner elements over the wall, 7.5 in. either side of C".to_owned(),
        shades: Shades::Values,
        unit: "G12 / in.⁻²".to_owned(),
        pictures: corners.map(picture).collect(),
    }
}

fn normalized(curve: &[&Row<'_>], half_width: f64) -> Option<f64> {
    let at = curve.iter().find(|r| r.half_width() == half_width)?;
    at.outcome.normalized
}

/// Whole inches and 7.5 in., the distances that the published text names.
fn is_named(r: &&&Row<'_>) -> bool {
    r.half_width().fract() == 0.0 || r.half_width() == 7.5
}

fn highest<'a>(curve: impl Iterator<Item = &'a &'a Row<'a>>) -> Option<(&'a Row<'a>, f64)> {
    let found = curve.filter_map(|r| Some((*r, r.outcome.normalized?)));
    found.max_by(|a, b| a.1.total_cmp(&b.1))
}

/// What half inches add.
fn finer(curve: &[&Row<'_>]) -> String {
    let Some((r, most)) = highest(curve.iter()) else {
        return "No normalized MTF is defined.".to_owned();
    };
    format!(
        "In steps of half an inch the highest normalized MTF without stagger, published kernel, is {most:.4} at {} in.; its rank of {} rests on a singular value of {:.2} \
         times the cut, the next one is {:.2} times the cut.",
        r.half_width(),
        r.trial.rank,
        r.trial.around[0],
        r.trial.around[1]
    )
}

/// The normalized MTF at 5 in. without stagger.
fn at_five_inches(plain: &[&Row<'_>]) -> Check {
    Check::value(
        "normalized MTF at 5 in., no stagger",
        0.4731,
        normalized(plain, 5.0),
        SAME,
    )
}

fn without_stagger(curve: &[&Row<'_>]) -> Vec<Check> {
    let most = highest(curve.iter().filter(is_named));
    let (at, most) = most.map_or((f64::NAN, f64::NAN), |(r, most)| (r.half_width(), most));
    vec![
        Check::trend(
            "half-width of the highest normalized MTF, no stagger, at whole inches and 7.5 in.",
            "7.5 in.",
            format!("{at} in. ({most:.4})"),
            "the highest computed value is at 7.5 in., published kernel",
            at == 7.5,
        ),
        at_five_inches(curve),
        Check::trend(
            "highest normalized MTF, no stagger, at whole inches and 7.5 in.",
            "none above 0.6",
            format!("{most:.4}"),
            "at most 0.6 plus 0.025",
            most <= 0.6 + SAME,
        ),
    ]
}

fn with_stagger(plain: &[&Row<'_>], staggered: &[&Row<'_>]) -> Vec<Check> {
    let both = staggered.iter().zip(plain);
    let higher = both.filter(|(s, p)| s.outcome.normalized > p.outcome.normalized);
    let (higher, all) = (higher.count(), plain.len());
    vec![
        Check::value(
            "normalized MTF at 5 in., stagger",
            1.0,
            normalized(staggered, 5.0),
            1e-3,
        ),
        at_five_inches(plain),
        Check::trend(
            "distances at which stagger gives the higher normalized MTF",
            "stagger is better",
            format!("{higher} of {all}"),
            "more than half of them",
            2 * higher > all,
        ),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::transport::Control;

    /// What the published text says of Figs 17 and 20 where the published code is followed.
    #[test]
    fn the_best_distance_and_the_stagger_are_as_published() {
        let own = |c: &Case| !c.is_traced && c.published.kernel == Kernel::Published;
        let cases: Vec<Case> = cases(Item::Fig20).into_iter().filter(own).collect();
        let trials = |c: &Case| c.trials(Control::none()).unwrap();
        let found: Vec<Vec<Trial>> = cases.iter().map(trials).collect();
        let rows = rows(&cases, &found);
        let [plain, staggered] = LAYOUTS.map(|l| one(&rows, Kernel::Published, l.1));
        let (best, _) = highest(plain.iter().filter(is_named)).unwrap();
        assert_eq!(best.half_width(), 7.5);
        assert!(normalized(&staggered, 5.0).unwrap() >= 0.999);
    }
}
