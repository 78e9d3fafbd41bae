//! Figs 22 to 24: noise.

use rayon::prelude::*;

use super::case::{HALF_WIDTH, KERNELS, published};
use super::item::Item;
use super::outcome::{Outcome, stretched};
use super::plan::ReproducePlan;
use super::sheet::{BOTH_KERNELS, CUT, STRETCHED, VIEW, elements, finding};
use super::traced::{self, AS_RENDERED, Lights, NAMES, replicates};
use crate::lab::LabError;
use crate::lab::check::Check;
use crate::lab::deviate::normal_deviates;
use crate::lab::finding::{Axis, Cell, Curve, Finding, Gallery, Mark, Plot, Table};
use crate::matrix::Matrix;
use crate::model::{Kernel, Published, Stagger};
use crate::num::linalg::{Tolerance, pinv};
use crate::transport::{Budget, Control};

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
const PATHS: [Budget; 3] = [replicates(16), AS_RENDERED, replicates(1)];

fn bench(kernel: Kernel, side: usize) -> Published {
    published(kernel, side, PER_SIDE, HALF_WIDTH, Stagger::OneInch)
}

const HEADER: &str = "kernel,elements,noise_percent,draws,mtf_raw,mtf_raw_deviation,\
                      mtf_normalized,mtf_normalized_deviation,phi";

/// A level of noise.
struct Point {
    power: i32,
    raw: [f64; 2],
    normalized: [f64; 2],
    /// The first draw.
    first: Outcome,
}

impl Point {
    fn percent(&self) -> f64 {
        libm::exp10(f64::from(self.power))
    }
}

/// Mean and standard deviation of what is defined.
fn spread(values: &[Option<f64>]) -> [f64; 2] {
    let known: Vec<f64> = values.iter().flatten().copied().collect();
    let n = known.len() as f64;
    let mean = known.iter().sum::<f64>() / n;
    let square: f64 = known.iter().map(|x| (x - mean) * (x - mean)).sum();
    [mean, (square / (n - 1.0)).sqrt()]
}

/// Every level of noise on the board of one check an element.
fn points(
    kernel: Kernel,
    side: usize,
    plan: &ReproducePlan,
    control: Control<'_>,
) -> Result<Vec<Point>, LabError> {
    let case = bench(kernel, side);
    let board = case.board(side);
    let (phi, g23) = (case.phi(&board), case.g23());
    let inverse = pinv(&case.g12(), Tolerance::Spacing)?.matrix;
    // Linear in Φ: the deviation of each draw is recovered once for all levels.
    let exact = &phi * &inverse;
    let draw = |k: u64| {
        control.check()?;
        let seed = plan.first_seed.wrapping_add(k);
        let deviates = normal_deviates(seed, phi.nrows(), phi.ncols());
        Ok(deviates.component_mul(&phi) * &inverse)
    };
    let draws: Result<Vec<Matrix>, LabError> = (0..plan.seeds).into_par_iter().map(draw).collect();
    let draws = draws?;
    let point = |power: i32| {
        let sigma = libm::exp10(f64::from(power)) / 100.0;
        let recovered = |draw: &Matrix| {
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

/// The figure.
pub(super) fn figure(plan: &ReproducePlan, control: Control<'_>) -> Result<Finding, LabError> {
    let (mut rows, mut plots) = (Vec::new(), Vec::new());
    let (mut pictures, mut checks) = (Vec::new(), Vec::new());
    for kernel in KERNELS {
        let mut curves = Vec::new();
        for side in SIDES {
            let points = points(kernel, side, plan, control)?;
            rows.extend(points.iter().map(|p| {
                vec![
                    kernel.name().into(),
                    side.into(),
                    p.percent().into(),
                    plan.seeds.into(),
                    p.raw[0].into(),
                    p.raw[1].into(),
                    p.normalized[0].into(),
                    p.normalized[1].into(),
                    "modelled".into(),
                ]
            }));
            curves.push(Curve::new(
                format!("{side} × {side} board and elements"),
                Mark::Line,
                points
                    .iter()
                    .map(|p| [p.percent(), p.normalized[0]])
                    .collect(),
            ));
            if kernel == Kernel::Published {
                let shown = points.iter().filter(|p| SHOWN.contains(&p.power));
                pictures.extend(shown.map(|p| {
                    let title = format!("{side} × {side}, noise 1e{} %", p.power);
                    elements(title, side, stretched(&p.first.values))
                }));
                if side == 8 {
                    checks.push(needed(&points));
                }
            }
        }
        plots.push(Plot::new(
            format!("{} kernel, mean of {} draws", kernel.name(), plan.seeds),
            [
                Axis::decades("noise of each entry of Φ / %"),
                Axis::linear("normalized MTF", [0.0, 1.0]),
            ],
            curves,
        ));
    }
    let (plot, note) = trace(&mut rows, control)?;
    plots.push(plot);
    let caption = format!(
        "{BOTH_KERNELS}; board of one check an element; 120 spots on the four sides of a square \
         of half-width 6 in., staggered by 1 in.; {VIEW}; each entry of Φ times 1 + σ·N(0, 1), {} \
         draws from seed {}; {CUT}; {STRETCHED}, raw MTF in the CSV; pictures are the first draw. \
         {} In the last plot the noise is that of renders with {} paths an entry; the leftmost \
         point is the mean.",
        plan.seeds,
        plan.first_seed,
        traced::caption(),
        PATHS.map(|b| b.samples().to_string()).join(", ")
    );
    let table = Table::headed(HEADER, rows);
    Ok(Finding {
        galleries: vec![Gallery::reflectances(
            "Recovered boards, published kernel, stretched to [0, 1]",
            pictures,
        )],
        checks,
        notes: vec![note],
        ..finding(
            Item::Fig22,
            "MTF against relative noise",
            caption,
            table,
            plots,
        )
    })
}

/// Adds the rows of traced Φ; the plot of them over their own noise, and what it shows.
fn trace(rows: &mut Vec<Vec<Cell>>, control: Control<'_>) -> Result<(Plot, String), LabError> {
    let (mut curves, mut said) = (Vec::new(), Vec::new());
    for side in SIDES {
        let case = bench(Kernel::Physical, side);
        let board = case.board(side);
        // Modelled and traced, the noise of the render on both, and without it.
        let mut lines = [const { Vec::new() }; 2];
        let mut clean = [f64::NAN; 2];
        for (k, budget) in PATHS.into_iter().enumerate() {
            let trial = Lights::traced(&case, side, budget, control)?.recovered(&board)?;
            for (light, outcome) in trial.found.iter().enumerate() {
                // What does not depend on the number of paths, once.
                let is_clean = light % 2 == 0;
                if is_clean && k > 0 {
                    continue;
                }
                let percent = 100.0 * outcome.noise;
                rows.push(vec![
                    Kernel::Physical.name().into(),
                    side.into(),
                    percent.into(),
                    1_u64.into(),
                    outcome.raw.into(),
                    None.into(),
                    outcome.normalized.into(),
                    None.into(),
                    NAMES[light].into(),
                ]);
                let mtf = outcome.normalized.unwrap_or(f64::NAN);
                if is_clean {
                    clean[light / 2] = mtf;
                }
                // The mean has a noise of its own, the modelled Φ has none.
                if light > 0 {
                    lines[light / 2].push([percent, mtf]);
                }
            }
        }
        said.push(format!(
            "{side} × {side}: {:.3} and {:.3}",
            clean[0], clean[1]
        ));
        let [modelled, traced] = lines;
        for (name, line) in [
            ("traced", traced),
            ("modelled, noise of the render", modelled),
        ] {
            curves.push(Curve::new(
                format!("{side} × {side}, {name}"),
                Mark::Line,
                line,
            ));
        }
    }
    let plot = Plot::new(
        "traced in place of modelled Φ, physical kernel",
        [
            Axis::decades("standard error of Φ / %"),
            Axis::linear("normalized MTF", [-0.4, 1.0]),
        ],
        curves,
    );
    let words = format!(
        "Traced in place of modelled Φ: normalized MTF with Φ modelled for the footprints' \
         centres, without noise, and with the mean of the trace: {}. They differ by the light \
         that the model leaves out, by the extent of the elements, and by the noise that the mean \
         still has.",
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
