//! Figs 22 to 24: noise.

use rayon::prelude::*;

use super::figure::{computed, decades, elements, linear};
use super::inversion::{Outcome, published};
use super::spots::HALF_WIDTH;
use super::traced::{self, AS_RENDERED, MODELLED, NAMES, Traced};
use super::{
    Cell, Check, Gallery, Item, Plot, ReproduceError, ReproducePlan, Reproduction, Shades, Watch,
};
use crate::model::{Kernel, Stagger};
use crate::num::linalg::{Tolerance, pinv};
use crate::study::deviate::normal_deviates;
use crate::transport::Budget;

/// Elements and checks a side.
const SIDES: [usize; 3] = [2, 4, 8];
/// 120 spots in all.
const PER_SIDE: usize = 30;
/// Powers of ten of the noise, percent.
const POWERS: std::ops::RangeInclusive<i32> = -13..=2;
/// A board is kept where the mean normalized MTF is at least this.
const KEPT: f64 = 0.9;
/// Powers of the pictures.
const SHOWN: [i32; 5] = [-10, -8, -6, -2, 1];

/// Paths an entry of what is traced, from the least noise to the most.
const PATHS: [Budget; 3] = [
    Budget {
        blocks: 32,
        size: 16,
    },
    AS_RENDERED,
    Budget {
        blocks: 32,
        size: 1,
    },
];

struct Point {
    power: i32,
    normalized: [f64; 2],
    raw: [f64; 2],
    first: Outcome,
}

/// Mean and standard deviation of what is defined.
fn spread(values: &[Option<f64>]) -> [f64; 2] {
    let known: Vec<f64> = values.iter().flatten().copied().collect();
    let n = known.len() as f64;
    let mean = known.iter().sum::<f64>() / n;
    let square: f64 = known.iter().map(|x| (x - mean) * (x - mean)).sum();
    [mean, (square / (n - 1.0)).sqrt()]
}

fn curve(
    kernel: Kernel,
    side: usize,
    plan: &ReproducePlan,
    watch: Watch<'_>,
) -> Result<Vec<Point>, ReproduceError> {
    let case = published(kernel, side, PER_SIDE, HALF_WIDTH, Stagger::OneInch);
    let board = case.board(side);
    let (phi, g23) = (case.phi(&board), case.g23());
    let inverse = pinv(&case.g12(), Tolerance::Spacing)?.matrix;
    // Linear in Φ: the deviation of each draw is recovered once for all levels.
    let exact = &phi * &inverse;
    let draws: Vec<_> = (0..plan.seeds)
        .into_par_iter()
        .map(|k| {
            watch.go_on()?;
            let seed = plan.first_seed.wrapping_add(k);
            let deviates = normal_deviates(seed, phi.nrows(), phi.ncols());
            Ok(deviates.component_mul(&phi) * &inverse)
        })
        .collect::<Result<_, ReproduceError>>()?;
    let point = |power: i32| {
        let sigma = libm::exp10(f64::from(power)) / 100.0;
        let recovered = |draw: &crate::matrix::Matrix| {
            let x = (&exact + draw * sigma).component_div(&g23);
            Outcome::new(x.row_mean().iter().copied().collect(), &board)
        };
        let outcomes: Vec<Outcome> = draws.iter().map(recovered).collect();
        let of =
            |f: fn(&Outcome) -> Option<f64>| spread(&outcomes.iter().map(f).collect::<Vec<_>>());
        Some(Point {
            power,
            normalized: of(|o| o.normalized),
            raw: of(|o| o.raw),
            first: outcomes.into_iter().next()?,
        })
    };
    Ok(POWERS.filter_map(point).collect())
}

pub(super) fn figure(
    plan: &ReproducePlan,
    watch: Watch<'_>,
) -> Result<Reproduction, ReproduceError> {
    let (mut rows, mut plots, mut pictures, mut checks) =
        (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for kernel in [Kernel::Published, Kernel::Physical] {
        let mut lines = Vec::new();
        for side in SIDES {
            let points = curve(kernel, side, plan, watch)?;
            for p in &points {
                rows.push(vec![
                    kernel.name().into(),
                    side.into(),
                    libm::exp10(f64::from(p.power)).into(),
                    (plan.seeds as usize).into(),
                    p.raw[0].into(),
                    p.raw[1].into(),
                    p.normalized[0].into(),
                    p.normalized[1].into(),
                    MODELLED.into(),
                ]);
            }
            let line = points
                .iter()
                .map(|p| [libm::exp10(f64::from(p.power)), p.normalized[0]]);
            lines.push(computed(
                format!("{side} × {side} board and elements"),
                line.collect(),
            ));
            if kernel == Kernel::Published {
                for p in points.iter().filter(|p| SHOWN.contains(&p.power)) {
                    let title = format!("{side} × {side}, noise 1e{} %", p.power);
                    pictures.push(elements(title, side, p.first.stretched()));
                }
                if side == 8 {
                    checks.push(needed(&points));
                }
            }
        }
        plots.push(Plot {
            title: format!("{} kernel, mean of {} draws", kernel.name(), plan.seeds),
            axes: [
                decades("noise of each entry of Φ / %"),
                linear("normalized MTF", [0.0, 1.0]),
            ],
            curves: lines,
        });
    }
    let (plot, note) = trace(&mut rows, watch)?;
    plots.push(plot);
    Ok(Reproduction {
        item: Item::Fig22,
        title: "MTF against relative noise".to_owned(),
        caption: format!(
            "Published and physical kernel (G12 and G23 alike); board of one check an element; 120 spots on the four sides of a square of half-width 6 in., staggered by 1 in.; \
             16 × 16 pixels laid to the edges of the view; each entry of Φ times 1 + σ·N(0, 1), {} draws from seed {}; Moore–Penrose inverse in doubles cut at \
             max(r, l)·eps(σ1), eps the spacing of doubles at σ1 (MATLAB); normalized MTF of the values stretched to [0, 1], raw MTF in the CSV; pictures are the first draw. {} In the last plot the render's own noise is the noise, {} paths an entry; the leftmost point is the mean.",
            plan.seeds,
            plan.first_seed,
            traced::caption(),
            PATHS.map(|b| b.samples().to_string()).join(", ")
        ),
        columns: [
            "kernel",
            "elements",
            "noise_percent",
            "draws",
            "mtf_raw",
            "mtf_raw_deviation",
            "mtf_normalized",
            "mtf_normalized_deviation",
            "phi",
        ]
        .map(str::to_owned)
        .to_vec(),
        rows,
        plots,
        galleries: vec![Gallery {
            title: "Recovered boards, published kernel, stretched to [0, 1]".to_owned(),
            shades: Shades::Reflectance,
            unit: String::new(),
            pictures,
        }],
        checks,
        notes: vec![note],
    })
}

/// Adds the rows of traced Φ; the plot of them over their own noise, and what it shows.
fn trace(rows: &mut Vec<Vec<Cell>>, watch: Watch<'_>) -> Result<(Plot, String), ReproduceError> {
    let (mut curves, mut said) = (Vec::new(), Vec::new());
    for side in SIDES {
        let case = published(
            Kernel::Physical,
            side,
            PER_SIDE,
            HALF_WIDTH,
            Stagger::OneInch,
        );
        let board = case.board(side);
        let mut lines = [const { Vec::new() }; 2];
        let mut clean = [f64::NAN; 2];
        for (k, budget) in PATHS.into_iter().enumerate() {
            let traced = Traced::new(&case, side, budget, watch)?;
            let (_, found) = traced.recovered(&board)?;
            for (light, r) in found.iter().enumerate() {
                let name = NAMES[light];
                // What does not depend on the number of paths, once.
                let once = [NAMES[0], NAMES[2]].contains(&name);
                if once && k > 0 {
                    continue;
                }
                let percent = 100.0 * r.noise;
                rows.push(vec![
                    Kernel::Physical.name().into(),
                    side.into(),
                    percent.into(),
                    1.into(),
                    r.outcome.raw.into(),
                    None.into(),
                    r.outcome.normalized.into(),
                    None.into(),
                    name.into(),
                ]);
                let mtf = r.outcome.normalized.unwrap_or(f64::NAN);
                match once {
                    true => clean[light / 2] = mtf,
                    false => lines[light / 2].push([percent, mtf]),
                }
                if name == NAMES[2] {
                    lines[1].push([percent, mtf]);
                }
            }
        }
        said.push(format!(
            "{side} × {side}: {:.3} and {:.3}",
            clean[0], clean[1]
        ));
        let [modelled, traced] = lines;
        curves.push(computed(format!("{side} × {side}, traced"), traced));
        curves.push(computed(
            format!("{side} × {side}, modelled, noise of the render"),
            modelled,
        ));
    }
    let plot = Plot {
        title: "traced in place of modelled Φ, physical kernel".to_owned(),
        axes: [
            decades("standard error of Φ / %"),
            linear("normalized MTF", [-0.4, 1.0]),
        ],
        curves,
    };
    let words = format!(
        "Traced in place of modelled Φ: normalized MTF with Φ modelled for the footprints' centres, without noise, and with the mean of the trace: {}. What parts them is \
         what the model leaves out of light, elements that are no points, and what noise the mean is left with.",
        said.join("; ")
    );
    Ok((plot, words))
}

fn needed(points: &[Point]) -> Check {
    let kept = points.iter().take_while(|p| p.normalized[0] >= KEPT).last();
    Check::trend(
        "loudest noise that leaves the 8 × 8 board, by decades",
        "1e-8 to 1e-10 %",
        kept.map_or("none".to_owned(), |p| format!("1e{} %", p.power)),
        format!(
            "mean normalized MTF at least {KEPT} there, published kernel, and the decade is one of the published ones"
        ),
        kept.is_some_and(|p| (-10..=-8).contains(&p.power)),
    )
}
