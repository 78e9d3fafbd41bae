//! The camera's view moving with the laser spot, against the view that stays.
//!
//! The published work has an older configuration in which spot and view shift together over the wall, and a later one, used everywhere else in this crate, with a view that stays.
//! The text at hand gives no measures of the older one. The natural layout is taken: a view of the same size at a constant offset from the spot, spots where the later configuration
//! has them, as many photographs and as many pixels in each. Several offsets are computed, so that the answer does not hang on one,
//! and a fixed view that covers as much of the wall, so that motion and coverage can be told apart.
//! What is computed is in [`system`]: every photograph has a G23 of its own, and ρ is found by least squares over all rows at once; of the fixed view by the same way.

mod checks;
mod layout;
mod modelled;
mod system;
#[cfg(test)]
mod tests;
mod traced;

use super::figure::{computed, decades, elements, linear};
use super::{Cell, FigureCurve, Gallery, Item, Plot, ReproducePlan, Reproduction, Shades};
use crate::model::Kernel;
use modelled::Configuration;
pub(super) use modelled::Modelled;
use traced::Photographs;
pub(super) use traced::Seen;

/// Pixels of the camera and elements of the board, a side.
const PIXELS: usize = 8;
const ELEMENTS: usize = 8;
/// Checks a side.
const BOARDS: [usize; 2] = [2, 4];
/// Scenes and the half-widths of their squares of spots, in.; the first is traced too.
const HALF_WIDTHS: [(&str, f64); 2] = [("bench", 3.0), ("thesis", 6.0)];
/// A board is kept where the raw MTF is at least this.
const KEPT: f64 = 0.9;

/// A board of `checks` a side on the elements, the first check dark.
fn board(checks: usize) -> Vec<f64> {
    let light =
        |at: usize| (at % ELEMENTS * checks / ELEMENTS + at / ELEMENTS * checks / ELEMENTS) % 2;
    (0..ELEMENTS * ELEMENTS)
        .map(|at| light(at) as f64)
        .collect()
}

/// How many configurations are modelled.
pub(super) fn modelled_cases() -> usize {
    modelled::cases().len()
}

/// How many are traced.
pub(super) const TRACED_CASES: usize = traced::CASES.len();

/// The figure, from what was modelled and what was traced.
pub(super) fn figure(
    plan: &ReproducePlan,
    modelled: Vec<Modelled>,
    traced: Vec<Seen>,
) -> Reproduction {
    let modelled = modelled::configurations(modelled);
    let traced = traced::photographs(traced);
    let mut rows: Vec<Vec<Cell>> = modelled.iter().flat_map(modelled_rows).collect();
    rows.extend(traced.iter().map(|t| traced_row(t, &modelled)));
    let pictures = BOARDS.iter().flat_map(|checks| {
        let own = traced.iter().filter(|t| t.checks == *checks);
        own.map(move |t| {
            let title = format!("{checks} × {checks} board, {}", t.view.name());
            elements(title, ELEMENTS, t.recovered.clone())
        })
    });
    Reproduction {
        item: Item::MovingView,
        title: "The camera's view moving with the laser spot, against the view that stays"
            .to_owned(),
        caption: format!(
            "Layout of the moving view: the published text gives none; here a view of 3.25 × 3.25 in. as the fixed one has, its centre at a constant offset from the spot, as the legend says. Both: \
             120 spots on the four sides of a square of half-width 3 in. (scene `bench`) or 6 in. (`thesis`) around C, staggered by 1 in.; {PIXELS} × {PIXELS} pixels by the centres of equal footprints; \
             wall extended by 4 in.; {ELEMENTS} × {ELEMENTS} elements, by their centres where modelled and by {} × {} points each where traced. Every pixel of every photograph is a row of one least-squares system, Φ[p,l] = Σ_j G23_l[p,j] ρ_j G12[j,l] in absolute units, \
             for both views alike; recovered by `joint` (0 ≤ ρ ≤ 1), rows weighted by their errors. Modelled: physical kernel in the figure, both in the CSV; each entry times 1 + σ·N(0, 1), {} draws from seed \
             {}. Traced: half-width 3 in., {} paths for each pixel and spot, independent, Sobol' points, seed {}, with the noise of the render. Raw MTF, not stretched; effective rank: directions of ρ whose \
             standard error is below 1; contrast error: standard error of the mean of the light less that of the dark elements by unbounded least squares.",
            traced::POINTS,
            traced::POINTS,
            modelled::draws(plan),
            plan.first_seed,
            super::photographs::REPLICATES * traced::SIZE,
            plan.first_seed
        ),
        columns: [
            "photographs",
            "half_width_in",
            "kernel",
            "view",
            "board",
            "condition",
            "noise",
            "effective_rank",
            "contrast_error",
            "mtf_raw",
            "rmse",
        ]
        .map(str::to_owned)
        .to_vec(),
        rows,
        plots: plots(&modelled),
        galleries: vec![Gallery {
            title: "Traced and recovered by joint, half-width 3 in.".to_owned(),
            shades: Shades::Reflectance,
            unit: String::new(),
            pictures: pictures.collect(),
        }],
        checks: checks::checks(&modelled, &traced),
        notes: notes(&modelled, &traced),
    }
}

fn modelled_rows(c: &Configuration) -> Vec<Vec<Cell>> {
    let row = |course: &modelled::Course, p: &modelled::Point| {
        vec![
            "modelled".into(),
            c.half_width.into(),
            c.kernel.name().into(),
            Cell::Text(c.view.name()),
            course.checks.into(),
            c.condition().into(),
            p.noise.into(),
            p.effective_rank.into(),
            p.contrast_error.into(),
            p.mtf.into(),
            None.into(),
        ]
    };
    let courses = c.courses.iter();
    courses
        .flat_map(|course| course.points.iter().map(move |p| row(course, p)))
        .collect()
}

fn traced_row(t: &Photographs, modelled: &[Configuration]) -> Vec<Cell> {
    let half_width = HALF_WIDTHS[0].1;
    let own = |c: &&Configuration| c.half_width == half_width && c.view == t.view && is_physical(c);
    vec![
        "traced".into(),
        half_width.into(),
        Kernel::Physical.name().into(),
        Cell::Text(t.view.name()),
        t.checks.into(),
        modelled
            .iter()
            .find(own)
            .map(Configuration::condition)
            .into(),
        t.noise.into(),
        t.effective_rank.into(),
        t.contrast_error.into(),
        t.mtf.into(),
        t.rmse.into(),
    ]
}

fn is_physical(c: &Configuration) -> bool {
    c.kernel == Kernel::Physical
}

fn plots(modelled: &[Configuration]) -> Vec<Plot> {
    let mut plots = Vec::new();
    for (_, half_width) in HALF_WIDTHS {
        let own: Vec<&Configuration> = modelled
            .iter()
            .filter(|c| is_physical(c) && c.half_width == half_width)
            .collect();
        let curves = |f: &dyn Fn(&Configuration) -> Vec<[f64; 2]>| -> Vec<FigureCurve> {
            own.iter().map(|c| computed(c.view.name(), f(c))).collect()
        };
        plots.push(Plot {
            title: format!("singular values, half-width {half_width} in."),
            axes: [linear("k", [0.0, 64.0]), decades("σk / σ1")],
            curves: curves(&|c| {
                let sigma = c.sigma.iter().enumerate();
                sigma
                    .map(|(k, s)| [(k + 1) as f64, s / c.sigma[0]])
                    .collect()
            }),
        });
        for checks in BOARDS {
            plots.push(Plot {
                title: format!("{checks} × {checks} board, half-width {half_width} in."),
                axes: [
                    decades("relative noise of each entry of Φ"),
                    linear("raw MTF of joint", [-0.2, 1.0]),
                ],
                curves: curves(&|c| {
                    let course = c.courses.iter().find(|course| course.checks == checks);
                    let points = course.iter().flat_map(|course| &course.points);
                    points.filter_map(|p| Some([p.noise, p.mtf?])).collect()
                }),
            });
        }
    }
    plots
}

/// What each view is good for, in numbers.
fn notes(modelled: &[Configuration], traced: &[Photographs]) -> Vec<String> {
    let mut notes = Vec::new();
    for (_, half_width) in HALF_WIDTHS {
        let own: Vec<&Configuration> = modelled
            .iter()
            .filter(|c| is_physical(c) && c.half_width == half_width)
            .collect();
        let line = |c: &&Configuration| {
            let borne = |course: &modelled::Course| {
                course
                    .borne()
                    .map_or("none".to_owned(), |noise| format!("{noise:.1e}"))
            };
            format!(
                "{}: condition {:.1e}, noise borne {}",
                c.view.name(),
                c.condition(),
                c.courses
                    .iter()
                    .map(borne)
                    .collect::<Vec<_>>()
                    .join(" and ")
            )
        };
        notes.push(format!(
            "Half-width {half_width} in., physical kernel, modelled; the noise at which the raw MTF of the 2 × 2 and of the 4 × 4 board falls below {KEPT}, at most the loudest tried, {:.1e}: {}.",
            modelled::loudest(),
            own.iter().map(line).collect::<Vec<_>>().join("; ")
        ));
    }
    let line = |t: &Photographs| {
        let mtf = t.mtf.map_or("none".to_owned(), |m| format!("{m:.3}"));
        format!(
            "{} × {} board, {}: noise {:.1e}, effective rank {}, raw MTF {mtf}",
            t.checks,
            t.checks,
            t.view.name(),
            t.noise,
            t.effective_rank
        )
    };
    notes.push(
        "The fixed view over all that the moving one covers (as many pixels, each as much larger; modelled only, for the spots are in it) parts the gain: what it bears more than the \
         fixed view is the gain of coverage, what it still lacks of the moving one that of the motion."
            .to_owned(),
    );
    notes.push(format!(
        "Traced, at equal paths; this noise is louder than what any view bears on the 4 × 4 board: {}.",
        traced.iter().map(line).collect::<Vec<_>>().join("; ")
    ));
    notes.push(
        "What the fixed view has before the moving one is not precision but that Φ is a product: one G12 belongs to all pixels, so that one pseudo-inverse of it, without \
         knowing G23, turns all photographs into images of the object (the published method), and that the camera need not be pointed anew. A photograph of the moving view has one column of G12 to itself, \
         whose pseudo-inverse has rank 1."
            .to_owned(),
    );
    notes
}
