//! Table 1 and Fig 11: Moore–Penrose against mrdivide.

use serde::{Deserialize, Serialize};

use super::figure::elements;
use super::inversion::{Outcome, PIXELS, published};
use super::spots::HALF_WIDTH;
use super::traced::{self, AS_RENDERED, Light, MODELLED, NAMES, Traced};
use super::{Cell, Check, Gallery, Item, Picture, ReproduceError, Reproduction, Shades, Watch};
use crate::model::{Kernel, Stagger};
use crate::num::linalg::Tolerance;
use crate::recovery::{Method, Options, Problem, Uncertainty, recover};

/// Elements a side, checks a side.
const SIDE: usize = 8;
const BOARD: usize = 2;
/// Spots in all, and what Table 1 prints for both methods, Fig 11 for the first.
const PRINTED: [(usize, [f64; 2], f64); 3] = [
    (80, [0.9714, 0.9208], 0.9604),
    (400, [0.9772, 0.9822], 0.9569),
    (4000, [0.9578, 0.9705], 0.9438),
];
const CONVENTIONS: [&str; 2] = ["raw", "normalized"];
const METHODS: [(Method, &str); 3] = [
    (Method::Pinv, "Moore–Penrose"),
    (Method::Rdivide, "mrdivide (basic solution)"),
    (Method::RdivideMinNorm, "mrdivide (least norm)"),
];
/// Two values are one where they are nearer than this.
const SAME: f64 = 2.5e-2;

/// What a method makes of Φ, as it travels.
#[derive(Debug, Serialize, Deserialize)]
pub struct Made {
    rank: usize,
    outcome: Outcome,
}

/// What the methods make of the lights.
#[derive(Debug, Serialize, Deserialize)]
pub struct Lights {
    /// Relative noise of each light, in the order of [`NAMES`].
    noises: Vec<f64>,
    /// Light by light what each method makes of it.
    made: Vec<Vec<Made>>,
}

/// What the three methods make of modelled Φ.
#[derive(Default)]
pub(super) struct Inverted {
    /// Rows of the table, three methods for each number of spots, published kernel first.
    pub(super) rows: Vec<Vec<Cell>>,
    pictures: Vec<Picture>,
    /// What is compared, the printed number, and the raw and normalized MTF.
    compared: Vec<(String, f64, [Option<f64>; 2])>,
    /// The smallest values that Moore–Penrose recovers.
    least: Vec<f64>,
}

/// Kernels and numbers of spots of what is modelled.
pub(super) fn modelled() -> Vec<(Kernel, usize)> {
    let kernels = [Kernel::Published, Kernel::Physical].into_iter();
    kernels
        .flat_map(|k| PRINTED.map(|(spots, ..)| (k, spots)))
        .collect()
}

/// Numbers of spots of what is traced.
pub(super) const TRACED: [usize; 3] = [PRINTED[0].0, PRINTED[1].0, PRINTED[2].0];

/// Whether `made` may be what the methods make of one Φ.
pub(super) fn fits(made: &[Made]) -> bool {
    let whole = |m: &Made| m.outcome.values.len() == SIDE * SIDE;
    made.len() == METHODS.len() && made.iter().all(whole)
}

impl Lights {
    /// Whether it may be what the methods make of the lights.
    pub(super) fn fits(&self) -> bool {
        [self.noises.len(), self.made.len()] == [NAMES.len(); 2]
            && self.made.iter().all(|m| fits(m))
    }
}

fn made(
    problem: &Problem<'_>,
    board: &[f64],
    watch: Watch<'_>,
) -> Result<Vec<Made>, ReproduceError> {
    let by = |(method, _): (Method, &str)| {
        watch.go_on()?;
        let found = recover(method, problem, &options())?;
        Ok(Made {
            rank: found.rank,
            outcome: Outcome::new(found.reflectance.as_slice().to_vec(), board),
        })
    };
    METHODS.into_iter().map(by).collect()
}

/// Modelled Φ.
pub(super) fn model(
    (kernel, spots): (Kernel, usize),
    watch: Watch<'_>,
) -> Result<Vec<Made>, ReproduceError> {
    let case = published(kernel, SIDE, spots / 4, HALF_WIDTH, Stagger::None);
    let board = case.board(BOARD);
    let (phi, c, d) = (case.phi(&board), case.g23(), case.g12());
    made(&Problem::new(&phi, &c, &d, None)?, &board, watch)
}

/// Traced Φ, and what belongs to it.
pub(super) fn trace(spots: usize, watch: Watch<'_>) -> Result<Lights, ReproduceError> {
    let case = published(Kernel::Physical, SIDE, spots / 4, HALF_WIDTH, Stagger::None);
    let board = case.board(BOARD);
    let traced = Traced::new(&case, BOARD, AS_RENDERED, watch)?;
    let of = |light: &Light| {
        let problem = Problem::new(&light.phi, &traced.g23, &traced.g12, None)?;
        made(&problem, &board, watch)
    };
    Ok(Lights {
        noises: traced.lights.iter().map(Light::noise).collect(),
        made: traced.lights.iter().map(of).collect::<Result<_, _>>()?,
    })
}

fn options() -> Options {
    Options {
        tolerance: Tolerance::Spacing,
        uncertainty: Uncertainty::StandardError,
        ..Options::default()
    }
}

/// What is told of modelled Φ, from what the methods made of it.
pub(super) fn inverted(found: &[Vec<Made>]) -> Inverted {
    let mut inverted = Inverted::default();
    for ((i, (kernel, spots)), made) in modelled().into_iter().enumerate().zip(found) {
        let (_, table, figure) = PRINTED[i % PRINTED.len()];
        for (k, ((method, name), Made { rank, outcome })) in
            METHODS.into_iter().zip(made).enumerate()
        {
            let least = outcome.values.iter().copied().fold(f64::INFINITY, f64::min);
            let own = (kernel == Kernel::Published)
                .then_some(())
                .and(table.get(k).copied());
            inverted.rows.push(vec![
                kernel.name().into(),
                spots.into(),
                name.into(),
                (*rank).into(),
                outcome.raw.into(),
                outcome.normalized.into(),
                least.into(),
                own.into(),
                MODELLED.into(),
                0.0.into(),
            ]);
            if kernel == Kernel::Physical {
                continue;
            }
            inverted.pictures.push(elements(
                format!("{name}, {spots} spots"),
                SIDE,
                outcome.stretched(),
            ));
            let conventions = [outcome.raw, outcome.normalized];
            if let Some(printed) = own {
                let what = format!("Table 1: {name}, {spots} spots");
                inverted.compared.push((what, printed, conventions));
            }
            if method == Method::Pinv {
                let what = format!("Fig 11: {name}, {spots} spots");
                inverted.compared.push((what, figure, conventions));
                inverted.least.push(least);
            }
        }
    }
    inverted
}

/// The table, from what the methods made of modelled and traced Φ.
pub(super) fn table(found: &[Vec<Made>], lights: &[Lights]) -> Reproduction {
    let Inverted {
        mut rows,
        pictures,
        compared,
        least,
    } = inverted(found);
    let (lost, shown) = traced(&mut rows, lights);
    // The text calls its measure normalized; which convention the numbers follow is for the numbers to say.
    let distance = |k: usize| {
        let square = |(_, printed, found): &(String, f64, [Option<f64>; 2])| {
            found[k].map_or(1.0, |x| (x - printed) * (x - printed))
        };
        (compared.iter().map(square).sum::<f64>() / compared.len() as f64).sqrt()
    };
    let distances = [distance(0), distance(1)];
    let nearer = usize::from(distances[1] < distances[0]);
    let mut checks: Vec<Check> = compared
        .iter()
        .map(|(what, printed, found)| {
            Check::value(
                format!("{what}, {} MTF", CONVENTIONS[nearer]),
                *printed,
                found[nearer],
                SAME,
            )
        })
        .collect();
    let least = least.iter().copied().fold(f64::INFINITY, f64::min);
    checks.push(Check::claim(
        "smallest value that Moore–Penrose recovers",
        "no negative values",
        format!("{least:.4}"),
        "refuted where it is below −1e-6 (rounding of Φ makes less)",
        least >= -1e-6,
    ));
    Reproduction {
        item: Item::Table1,
        title: "Moore–Penrose against mrdivide, 2 × 2 board".to_owned(),
        caption: format!(
            "Published kernel (physical in the CSV), G12 and G23 alike; 2 × 2 board at 8 × 8 elements; spots on the four sides of a square of half-width 6 in. around C, no \
             stagger; {PIXELS} × {PIXELS} pixels laid to the edges of the view; Φ formed and inverted in doubles, both methods cut at max(r, l) times the spacing of doubles \
             at σ1 or R11 (MATLAB); pictures and normalized MTF of the values stretched to [0, 1], raw MTF in the CSV. {}",
            traced::caption()
        ),
        columns: [
            "kernel",
            "spots",
            "method",
            "rank",
            "mtf_raw",
            "mtf_normalized",
            "smallest_value",
            "printed",
            "phi",
            "noise",
        ]
        .map(str::to_owned)
        .to_vec(),
        rows,
        plots: Vec::new(),
        galleries: [
            ("published kernel", pictures),
            ("traced Φ, physical kernel", shown),
        ]
        .map(|(what, pictures)| Gallery {
            title: format!("Recovered 2 × 2 board, {what}, stretched to [0, 1]"),
            shades: Shades::Reflectance,
            unit: String::new(),
            pictures,
        })
        .to_vec(),
        checks,
        notes: vec![
            format!(
                "The printed numbers are compared with the {} MTF, which they are nearer to: root mean square difference {:.4} of the raw, {:.4} of the normalized MTF. \
             Table 1 and Fig 11 print different numbers for the same three cases.",
                CONVENTIONS[nearer], distances[0], distances[1]
            ),
            lost,
        ],
    }
}

/// Adds the rows of traced Φ; says what becomes of the recoveries and shows those by Moore–Penrose.
fn traced(rows: &mut Vec<Vec<Cell>>, found: &[Lights]) -> (String, Vec<Picture>) {
    let mut pictures = Vec::new();
    let mut most = [[f64::NEG_INFINITY; METHODS.len()]; NAMES.len()];
    for (spots, Lights { noises, made }) in TRACED.into_iter().zip(found) {
        for (((light, most), noise), made) in NAMES.iter().zip(&mut most).zip(noises).zip(made) {
            for (((method, name), most), Made { rank, outcome }) in
                METHODS.into_iter().zip(most).zip(made)
            {
                let least = outcome.values.iter().copied().fold(f64::INFINITY, f64::min);
                *most = most.max(outcome.normalized.unwrap_or(f64::NEG_INFINITY));
                rows.push(vec![
                    Kernel::Physical.name().into(),
                    spots.into(),
                    name.into(),
                    (*rank).into(),
                    outcome.raw.into(),
                    outcome.normalized.into(),
                    least.into(),
                    None.into(),
                    (*light).into(),
                    (*noise).into(),
                ]);
                if method == Method::Pinv && light.starts_with("traced") {
                    let title = format!("{light}, {spots} spots");
                    pictures.push(elements(title, SIDE, outcome.stretched()));
                }
            }
        }
    }
    let said = NAMES
        .iter()
        .zip(most)
        .map(|(name, most)| format!("{name} {:.3}, {:.3} and {:.3}", most[0], most[1], most[2]));
    let words = format!(
        "Physical kernel, Φ of equal footprints: highest normalized MTF over the numbers of spots by the three methods: {}. What the model leaves out of traced light and \
         the noise of the render are multiplied by σ1 over the last kept singular value.",
        said.collect::<Vec<_>>().join("; ")
    );
    (words, pictures)
}
