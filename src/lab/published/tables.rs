//! Tables 2 to 4: K between two spot lines and eight rows of the object, in the flattened
//! cross-section.

use super::item::Item;
use super::sheet::finding;
use crate::lab::check::Check;
use crate::lab::finding::{Axis, Cell, Curve, Finding, Mark, Plot, Table};
use crate::model::{flattened_k, table_distances};

/// What a table prints.
struct Printed {
    /// Distance of the lines from y = 4.375, in.
    apart: f64,
    /// K of the lower line, of the upper line and their ratio in the eight rows.
    k: [[f64; 8]; 3],
    /// Largest over smallest K of each line.
    ratios: [f64; 2],
}

/// Tables 2, 3 and 4.
const PRINTED: [Printed; 3] = [
    Printed {
        apart: 7.5,
        k: [
            [
                0.0011, 0.0013, 0.0015, 0.0017, 0.0019, 0.0021, 0.0024, 0.0026,
            ],
            [
                0.0301, 0.0227, 0.0173, 0.0134, 0.0105, 0.0084, 0.0068, 0.0055,
            ],
            [26.29, 17.21, 11.51, 7.87, 5.50, 3.93, 2.86, 2.12],
        ],
        ratios: [2.262, 5.474],
    },
    Printed {
        apart: 1.0,
        k: [
            [
                0.0059, 0.0067, 0.0075, 0.0084, 0.0091, 0.0097, 0.0101, 0.0104,
            ],
            [
                0.0113, 0.0126, 0.0137, 0.0146, 0.0151, 0.0153, 0.0152, 0.0148,
            ],
            [1.93, 1.88, 1.82, 1.75, 1.67, 1.58, 1.50, 1.41],
        ],
        ratios: [1.787, 1.354],
    },
    Printed {
        apart: 11.0,
        k: [
            [
                0.0006, 0.0007, 0.0008, 0.0009, 0.0010, 0.0011, 0.0012, 0.0013,
            ],
            [
                0.0003, 0.0002, 0.0002, 0.0001, 0.0001, 0.0001, 0.0001, 0.0001,
            ],
            [2.08, 3.02, 4.29, 5.95, 8.10, 10.83, 14.25, 18.48],
        ],
        ratios: [2.240, 3.968],
    },
];

/// One unit of the last printed digit: of K, of the ratio row, of the ratio column.
const UNITS: [f64; 3] = [1e-4, 1e-2, 1e-3];

/// K of lower and upper line and their ratio (the larger over the smaller) in the eight rows, and
/// largest over smallest of each line.
fn compute(apart: f64) -> ([[f64; 8]; 3], [f64; 2]) {
    let (rows, lower, upper) = table_distances(apart);
    let [low, high] = [lower, upper].map(|s| rows.map(|d| flattened_k(s, d)));
    let over = |k: usize| high[k] / low[k];
    let ratio = |k| {
        if over(0) > 1.0 {
            over(k)
        } else {
            1.0 / over(k)
        }
    };
    let span = |line: [f64; 8]| {
        let end = |f: fn(f64, f64) -> f64| line.into_iter().reduce(f).unwrap_or(f64::NAN);
        end(f64::max) / end(f64::min)
    };
    (
        [low, high, std::array::from_fn(ratio)],
        [span(low), span(high)],
    )
}

/// An entry of the table.
struct Entry {
    line: String,
    row: Option<usize>,
    printed: f64,
    computed: f64,
    /// One unit of the last printed digit.
    unit: f64,
}

impl Entry {
    fn check(&self) -> Check {
        let what = match self.row {
            Some(row) => format!("{}, row {row}", self.line),
            None => self.line.clone(),
        };
        Check::value(what, self.printed, Some(self.computed), self.unit)
    }
}

const LINES: [&str; 3] = ["lower line", "upper line", "ratio of the lines"];

fn entries(printed: &Printed) -> Vec<Entry> {
    let (k, ratios) = compute(printed.apart);
    let mut entries = Vec::new();
    for line in 0..3 {
        let both = printed.k[line].into_iter().zip(k[line]).enumerate();
        entries.extend(both.map(|(row, (printed, computed))| Entry {
            line: LINES[line].to_owned(),
            row: Some(row + 1),
            printed,
            computed,
            unit: UNITS[usize::from(line == 2)],
        }));
    }
    entries.extend((0..2).map(|line| Entry {
        line: format!("largest over smallest, {}", LINES[line]),
        row: None,
        printed: printed.ratios[line],
        computed: ratios[line],
        unit: UNITS[2],
    }));
    entries
}

/// Table 2, 3 or 4.
pub(super) fn figure(item: Item) -> Finding {
    let printed = &PRINTED[match item {
        Item::Table3 => 1,
        Item::Table4 => 2,
        _ => 0,
    }];
    let entries = entries(printed);
    let (at, ..) = table_distances(printed.apart);
    let mut curves = Vec::new();
    for (line, own) in entries.chunks(8).take(2).enumerate() {
        let points =
            |value: fn(&Entry) -> f64| at.iter().zip(own).map(|(d, e)| [*d, value(e)]).collect();
        curves.push(Curve::new(LINES[line], Mark::Line, points(|e| e.computed)));
        curves.push(Curve::new(
            LINES[line],
            Mark::Published,
            points(|e| e.printed),
        ));
    }
    let axes = [
        Axis::linear("distance of the row from the hinge / in.", [5.5, 10.0]),
        Axis::decades("K / in.⁻²"),
    ];
    let plot = Plot::new("K against the object row", axes, curves);
    let title = format!(
        "K of two spot lines {} in. either side of y = 4.375 in.",
        printed.apart
    );
    let caption = format!(
        "Physical kernel in the flattened cross-section, K = sin α sin β / r², law of sines in the triangle hinge, spot line, object row; hinge angle 45°, rows \
         centred at d = 6.11764 in. and every 0.5 in. from there, lines at y = 4.375 ∓ {} in.; no layout, pixels, tolerance or normalisation enter.",
        printed.apart
    );
    let checks = entries.iter().map(Entry::check).collect();
    let table = Table::of(
        entries,
        [
            ("line", |e| e.line.as_str().into()),
            ("row", |e| e.row.map_or(Cell::Number(None), Cell::from)),
            ("printed", |e| e.printed.into()),
            ("computed", |e| e.computed.into()),
        ],
    );
    Finding {
        checks,
        ..finding(item, title, caption, table, vec![plot])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// All 48 entries, the 24 ratios of lines and the 6 ratios of a line, within one unit of the
    /// last printed digit.
    #[test]
    fn every_printed_digit_is_met() {
        let all: Vec<Entry> = PRINTED.iter().flat_map(entries).collect();
        for e in &all {
            let (found, want) = (e.computed, e.printed);
            assert!(
                (found - want).abs() <= e.unit,
                "{}: {found} for {want}",
                e.line
            );
            assert!(e.check().holds);
        }
        assert_eq!(all.len(), 48 + 24 + 6);
        for (unit, count) in UNITS.into_iter().zip([48, 24, 6]) {
            assert_eq!(all.iter().filter(|e| e.unit == unit).count(), count);
        }
    }
}
