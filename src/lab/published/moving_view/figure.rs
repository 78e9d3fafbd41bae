//! The item.

use super::super::item::Item;
use super::super::plan::ReproducePlan;
use super::super::sheet::{elements, finding};
use super::super::traced::REPLICATES;
use super::checks::checks;
use super::layout::{BOARDS, ELEMENTS, HALF_WIDTHS, KEPT, PIXELS, View};
use super::modelled::{self, Configuration, Course, Modelled, Models};
use super::traced::{self, Seen, Traces};
use crate::lab::finding::{Axis, Curve, Finding, Gallery, Mark, Plot, Table};
use crate::model::Kernel;

/// How many configurations are modelled, and how many cases traced.
pub(in super::super) fn pieces() -> [usize; 2] {
    [modelled::cases().len(), traced::CASES.len()]
}

/// The item, from what was modelled and what was traced.
pub(in super::super) fn figure(
    plan: &ReproducePlan,
    modelled: Vec<Modelled>,
    traced: Vec<Seen>,
) -> Finding {
    let models: Vec<(Configuration, Modelled)> =
        modelled::cases().into_iter().zip(modelled).collect();
    let traces: Vec<((usize, View), Seen)> = traced::CASES.into_iter().zip(traced).collect();
    let pictures = BOARDS.into_iter().flat_map(|checks| {
        let own = traces.iter().filter(move |((own, _), _)| *own == checks);
        own.map(move |((_, view), seen)| {
            let title = format!("{checks} × {checks} board, {}", view.name());
            elements(title, ELEMENTS, seen.recovered.clone())
        })
    });
    let caption = format!(
        "Layout of the moving view: the published text gives none; here a view of 3.25 × 3.25 in. as the fixed one has, its centre at a constant offset from the spot, as the legend says. Both: \
         120 spots on the four sides of a square of half-width 3 in. (scene `bench`) or 6 in. (`thesis`) around C, staggered by 1 in.; {PIXELS} × {PIXELS} pixels by the centres of equal footprints; \
         wall extended by 4 in.; {ELEMENTS} × {ELEMENTS} elements, by their centres where modelled and by {0} × {0} points each where traced. Every pixel of every photograph is a row of one least-squares system, Φ[p,l] = Σ_j G23_l[p,j] ρ_j G12[j,l] in absolute units, \
         for both views alike; recovered by `joint` (0 ≤ ρ ≤ 1), rows weighted by their errors. Modelled: physical kernel in the figure, both in the CSV; each entry times 1 + σ·N(0, 1), {1} draws from seed \
         {2}. Traced: half-width 3 in., {3} paths for each pixel and spot, independent, Sobol' points, seed {2}, with the noise of the render. Raw MTF, not stretched; effective rank: directions of ρ whose \
         standard error is below 1; contrast error: standard error of the mean of the light less that of the dark elements by unbounded least squares.",
        traced::POINTS,
        modelled::draws(plan),
        plan.first_seed,
        REPLICATES * traced::SIZE
    );
    let galleries = vec![Gallery::reflectances(
        "Traced and recovered by joint, half-width 3 in.",
        pictures.collect(),
    )];
    let title = "A camera view that moves with the laser spot, against a fixed view";
    let table = table(&models, &traces);
    Finding {
        galleries,
        checks: checks(&models, &traces),
        notes: notes(&models, &traces),
        ..finding(Item::MovingView, title, caption, table, plots(&models))
    }
}

const HEADER: &str = "photographs,half_width_in,kernel,view,board,condition,noise,effective_rank,\
                      contrast_error,mtf_raw,rmse";

fn table(models: &Models, traces: &Traces) -> Table {
    let mut rows = Vec::new();
    for (case, found) in models {
        for (course, p) in found.courses.iter().flat_map(Course::each) {
            rows.push(vec![
                "modelled".into(),
                case.half_width.into(),
                case.kernel.name().into(),
                case.view.name().into(),
                course.checks.into(),
                found.condition().into(),
                p.noise.into(),
                p.effective_rank.into(),
                p.contrast_error.into(),
                p.mtf.into(),
                None.into(),
            ]);
        }
    }
    let half_width = HALF_WIDTHS[0].1;
    for ((board, view), seen) in traces {
        let same = |c: &Configuration| c.is_physical(half_width) && c.view == *view;
        let modelled = models.iter().find(|(c, _)| same(c));
        rows.push(vec![
            "traced".into(),
            half_width.into(),
            Kernel::Physical.name().into(),
            view.name().into(),
            (*board).into(),
            modelled.map(|(_, m)| m.condition()).into(),
            seen.noise.into(),
            seen.effective_rank.into(),
            seen.contrast_error.into(),
            seen.mtf.into(),
            seen.rmse.into(),
        ]);
    }
    Table::headed(HEADER, rows)
}

/// Those of the physical kernel and a half-width.
fn physical(models: &Models, half_width: f64) -> impl Iterator<Item = &(Configuration, Modelled)> {
    models
        .iter()
        .filter(move |(c, _)| c.is_physical(half_width))
}

fn plots(models: &Models) -> Vec<Plot> {
    let mut plots = Vec::new();
    for (_, half_width) in HALF_WIDTHS {
        let curves = |points: &dyn Fn(&Modelled) -> Vec<[f64; 2]>| {
            let own = physical(models, half_width);
            own.map(|(c, found)| Curve::new(c.view.name(), Mark::Line, points(found)))
                .collect()
        };
        plots.push(Plot::new(
            format!("singular values, half-width {half_width} in."),
            [Axis::linear("k", [0.0, 64.0]), Axis::decades("σk / σ1")],
            curves(&|found| {
                let sigma = found.sigma.iter().enumerate();
                let point = |(k, s): (usize, &f64)| [(k + 1) as f64, s / found.sigma[0]];
                sigma.map(point).collect()
            }),
        ));
        plots.extend(BOARDS.map(|checks| {
            Plot::new(
                format!("{checks} × {checks} board, half-width {half_width} in."),
                [
                    Axis::decades("relative noise of each entry of Φ"),
                    Axis::linear("raw MTF of joint", [-0.2, 1.0]),
                ],
                curves(&|found| {
                    let own = found.courses.iter().filter(|c| c.checks == checks);
                    let points = own.flat_map(|course| &course.points);
                    points.filter_map(|p| Some([p.noise, p.mtf?])).collect()
                }),
            )
        }));
    }
    plots
}

/// What each view is good for, in numbers.
fn notes(models: &Models, traces: &Traces) -> Vec<String> {
    let modelled = HALF_WIDTHS.map(|(_, half_width)| {
        let line = |(c, found): &(Configuration, Modelled)| {
            let borne = |course: &Course| {
                let noise = course.borne();
                noise.map_or("none".to_owned(), |noise| format!("{noise:.1e}"))
            };
            format!(
                "{}: condition {:.1e}, noise borne {}",
                c.view.name(),
                found.condition(),
                found
                    .courses
                    .iter()
                    .map(borne)
                    .collect::<Vec<_>>()
                    .join(" and ")
            )
        };
        format!(
            "Half-width {half_width} in., physical kernel, modelled; the noise at which the raw \
             MTF of the 2 × 2 and of the 4 × 4 board falls below {KEPT}, at most the highest \
             level tried, {:.1e}: {}.",
            modelled::loudest(),
            physical(models, half_width)
                .map(line)
                .collect::<Vec<_>>()
                .join("; ")
        )
    });
    let line = |((checks, view), seen): &((usize, View), Seen)| {
        let mtf = seen.mtf.map_or("none".to_owned(), |m| format!("{m:.3}"));
        format!(
            "{checks} × {checks} board, {}: noise {:.1e}, effective rank {}, raw MTF {mtf}",
            view.name(),
            seen.noise,
            seen.effective_rank
        )
    };
    let mut notes = modelled.to_vec();
    notes.push(
        "The wide fixed view covers all that the moving one covers, with as many pixels, each \
         larger; it is modelled only, because the spots lie in it. It separates two gains: the \
         noise that it bears beyond the fixed view is the gain of coverage, and what the moving \
         view bears beyond that is the gain of motion."
            .to_owned(),
    );
    notes.push(format!(
        "Traced, at equal paths; this noise is higher than any view bears on the 4 × 4 board: {}.",
        traces.iter().map(line).collect::<Vec<_>>().join("; ")
    ));
    notes.push(
        "The advantage of the fixed view is not precision but that Φ is a product: all pixels \
         share one G12, so one pseudo-inverse of it turns all photographs into images of the \
         object without G23 (the published method). The camera also need not be pointed anew. A \
         photograph of the moving view has only one column of G12, whose pseudo-inverse has rank \
         1."
        .to_owned(),
    );
    notes
}
