//! Table 1 and Fig 11: Moore–Penrose against mrdivide.

use super::case::{Case, HALF_WIDTH, KERNELS, PIXELS, Row, published, rows};
use super::item::Item;
use super::outcome::{Outcome, Trial, stretched};
use super::sheet::{elements, finding};
use super::traced::{self, AS_RENDERED, Light, Lights, NAMES};
use crate::lab::LabError;
use crate::lab::check::Check;
use crate::lab::finding::{Finding, Gallery, Table};
use crate::model::{Kernel, Published, Stagger};
use crate::num::linalg::Tolerance;
use crate::recovery::{Method, Options, Problem, Uncertainty, recover};
use crate::transport::Control;

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
pub(super) const METHODS: [(Method, &str); 3] = [
    (Method::Pinv, "Moore–Penrose"),
    (Method::Rdivide, "mrdivide (basic solution)"),
    (Method::RdivideMinNorm, "mrdivide (least norm)"),
];
/// Two values are one where they are nearer than this.
const SAME: f64 = 2.5e-2;

/// Every number of spots under both kernels, and traced.
pub(super) fn cases() -> Vec<Case> {
    let bench = |kernel, (spots, ..): (usize, [f64; 2], f64)| {
        published(kernel, SIDE, spots / 4, HALF_WIDTH, Stagger::None)
    };
    let modelled = KERNELS
        .into_iter()
        .flat_map(|k| PRINTED.map(|p| bench(k, p)));
    let traced = PRINTED.map(|p| Case::traced("", bench(Kernel::Physical, p), BOARD));
    let modelled = modelled.map(|case: Published| Case::modelled("", case, vec![BOARD]));
    modelled.chain(traced).collect()
}

/// What each method makes of Φ formed in doubles, or of the lights.
pub(super) fn trials(case: &Case, control: Control<'_>) -> Result<Vec<Trial>, LabError> {
    let board = case.published.board(BOARD);
    let lights = if case.is_traced {
        Lights::traced(&case.published, BOARD, AS_RENDERED, control)?
    } else {
        Lights::modelled(&case.published, &board)
    };
    let options = Options {
        tolerance: Tolerance::Spacing,
        uncertainty: Uncertainty::StandardError,
        ..Options::default()
    };
    let by = |(method, _): (Method, &str)| {
        let mut trial = Trial::default();
        for light in &lights.lights {
            control.check()?;
            let problem = Problem::new(&light.phi, &lights.g23, &lights.g12, None)?;
            let recovered = recover(method, &problem, &options)?;
            trial.rank = recovered.rank;
            trial.found.push(Outcome {
                noise: Light::noise(light),
                ..Outcome::new(recovered.reflectance.as_slice().to_vec(), &board)
            });
        }
        Ok(trial)
    };
    METHODS.into_iter().map(by).collect()
}

impl Row<'_> {
    fn method(&self) -> &'static str {
        METHODS[self.way].1
    }

    /// What Table 1 and, of Moore–Penrose, Fig 11 print of this row.
    fn printed(&self) -> [Option<f64>; 2] {
        let own = PRINTED.iter().find(|p| p.0 == self.spots());
        let own = own.filter(|_| self.is(Kernel::Published));
        own.map_or([None; 2], |(_, table, figure)| {
            [
                table.get(self.way).copied(),
                (self.way == 0).then_some(*figure),
            ]
        })
    }
}

/// The rows of modelled Φ as the methods come, of traced Φ light after light.
fn ordered<'a>(cases: &'a [Case], found: &'a [Vec<Trial>]) -> Vec<Row<'a>> {
    let light = |r: &Row<'_>| NAMES.iter().position(|name| *name == r.phi);
    let of = |(case, trials): (&'a Case, &'a Vec<Trial>)| {
        let mut own = rows(std::slice::from_ref(case), std::slice::from_ref(trials));
        own.sort_by_key(|r| (light(r), r.way));
        own
    };
    cases.iter().zip(found).flat_map(of).collect()
}

/// The table.
pub(super) fn table(cases: &[Case], found: &[Vec<Trial>]) -> Table {
    Table::of(
        ordered(cases, found),
        [
            ("kernel", |r| r.kernel().into()),
            ("spots", |r| r.spots().into()),
            ("method", |r| r.method().into()),
            ("rank", |r| r.trial.rank.into()),
            ("mtf_raw", |r| r.outcome.raw.into()),
            ("mtf_normalized", |r| r.outcome.normalized.into()),
            ("smallest_value", |r| r.outcome.smallest().into()),
            ("printed", |r| r.printed()[0].into()),
            ("phi", |r| r.phi.into()),
            ("noise", |r| r.outcome.noise.into()),
        ],
    )
}

/// The item.
pub(super) fn figure(cases: &[Case], found: &[Vec<Trial>]) -> Finding {
    let rows = ordered(cases, found);
    let published: Vec<&Row<'_>> = rows.iter().filter(|r| r.is(Kernel::Published)).collect();
    let picture = |r: &Row<'_>, title: String| elements(title, SIDE, stretched(&r.outcome.values));
    let pictures = published
        .iter()
        .map(|r| picture(r, format!("{}, {} spots", r.method(), r.spots())));
    let traced = rows
        .iter()
        .filter(|r| NAMES[2..].contains(&r.phi) && r.way == 0)
        .map(|r| picture(r, format!("{}, {} spots", r.phi, r.spots())));
    let galleries = vec![
        Gallery::reflectances(
            "Recovered 2 × 2 board, published kernel, stretched to [0, 1]",
            pictures.collect(),
        ),
        Gallery::reflectances(
            "Recovered 2 × 2 board, traced Φ, physical kernel, stretched to [0, 1]",
            traced.collect(),
        ),
    ];
    // Name, printed number, raw and normalized MTF.
    let compared = published.iter().flat_map(|r| {
        let mtf = [r.outcome.raw, r.outcome.normalized];
        let both = ["Table 1", "Fig 11"].into_iter().zip(r.printed());
        both.filter_map(move |(place, printed)| {
            let what = format!("{place}: {}, {} spots", r.method(), r.spots());
            Some((what, printed?, mtf))
        })
    });
    let compared: Vec<(String, f64, [Option<f64>; 2])> = compared.collect();
    // The text calls its measure normalized; the numbers tell which convention they follow.
    let distances = [0, 1].map(|k| {
        let square = |(_, printed, mtf): &(String, f64, [Option<f64>; 2])| {
            mtf[k].map_or(1.0, |x| (x - printed) * (x - printed))
        };
        (compared.iter().map(square).sum::<f64>() / compared.len() as f64).sqrt()
    });
    let nearer = usize::from(distances[1] < distances[0]);
    let convention = CONVENTIONS[nearer];
    let check = |(what, printed, mtf): &(String, f64, [Option<f64>; 2])| {
        Check::value(
            format!("{what}, {convention} MTF"),
            *printed,
            mtf[nearer],
            SAME,
        )
    };
    let mut checks: Vec<Check> = compared.iter().map(check).collect();
    let least = published.iter().filter(|r| r.way == 0);
    let least = least
        .map(|r| r.outcome.smallest())
        .fold(f64::INFINITY, f64::min);
    checks.push(Check::claim(
        "smallest value that Moore–Penrose recovers",
        "no negative values",
        format!("{least:.4}"),
        "refuted where it is below −1e-6 (rounding of Φ makes less)",
        least >= -1e-6,
    ));
    let caption = format!(
        "Published kernel (physical in the CSV), G12 and G23 alike; 2 × 2 board at 8 × 8 elements; spots on the four sides of a square of half-width 6 in. around C, no \
         stagger; {PIXELS} × {PIXELS} pixels laid to the edges of the view; Φ formed and inverted in doubles, both methods cut at max(r, l) times the spacing of doubles \
         at σ1 or R11 (MATLAB); pictures and normalized MTF of the values stretched to [0, 1], raw MTF in the CSV. {}",
        traced::caption()
    );
    let notes = vec![
        format!(
            "The printed numbers are compared with the {convention} MTF, because they are closer \
             to it: root mean square difference {:.4} of the raw, {:.4} of the normalized MTF. \
             Table 1 and Fig 11 print different numbers for the same three cases.",
            distances[0], distances[1]
        ),
        lost(&rows),
    ];
    let title = "Moore–Penrose against mrdivide, 2 × 2 board";
    Finding {
        galleries,
        checks,
        notes,
        ..finding(
            Item::Table1,
            title,
            caption,
            table(cases, found),
            Vec::new(),
        )
    }
}

/// What becomes of the recoveries from the lights.
fn lost(rows: &[Row<'_>]) -> String {
    let said = NAMES.map(|name| {
        let most = [0, 1, 2].map(|way| {
            let own = rows.iter().filter(|r| r.phi == name && r.way == way);
            let mtf = own.map(|r| r.outcome.normalized.unwrap_or(f64::NEG_INFINITY));
            mtf.fold(f64::NEG_INFINITY, f64::max)
        });
        format!("{name} {:.3}, {:.3} and {:.3}", most[0], most[1], most[2])
    });
    format!(
        "Physical kernel, Φ of equal footprints: highest normalized MTF over the numbers of spots \
         by the three methods: {}. The inversion multiplies both the noise of the render and the \
         light that the model leaves out by σ1 over the last kept singular value.",
        said.join("; ")
    )
}
