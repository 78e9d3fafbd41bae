//! Tables 2 to 4: K between two spot lines and eight rows of the object, in the flattened cross-section.

use super::figure::{computed, decades, linear, published};
use super::{Check, Item, Plot, Reproduction};
use crate::model::{flattened_k, table_distances};

/// What a table prints.
pub(super) struct Printed {
    /// Distance of the lines from y = 4.375, in.
    pub(super) apart: f64,
    /// K of the lower line, of the upper line and their ratio in the eight rows.
    pub(super) k: [[f64; 8]; 3],
    /// Largest over smallest K of each line.
    pub(super) ratios: [f64; 2],
}

/// Tables 2, 3 and 4.
pub(super) const PRINTED: [Printed; 3] = [
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
pub(super) const UNITS: [f64; 3] = [1e-4, 1e-2, 1e-3];

/// K of lower and upper line and their ratio (the larger over the smaller) in the eight rows, and largest over smallest of each line.
pub(super) fn compute(apart: f64) -> ([[f64; 8]; 3], [f64; 2]) {
    let (rows, lower, upper) = table_distances(apart);
    let [low, high] = [lower, upper].map(|s| rows.map(|d| flattened_k(s, d)));
    let over = |k: usize| high[k] / low[k];
    let ratio = std::array::from_fn(|k| {
        if over(0) > 1.0 {
            over(k)
        } else {
            1.0 / over(k)
        }
    });
    let span = |line: [f64; 8]| {
        let end = |f: fn(f64, f64) -> f64| line.into_iter().reduce(f).unwrap_or(f64::NAN);
        end(f64::max) / end(f64::min)
    };
    ([low, high, ratio], [span(low), span(high)])
}

pub(super) fn table(item: Item, printed: &Printed) -> Reproduction {
    let (k, ratios) = compute(printed.apart);
    let names = ["lower line", "upper line", "ratio of the lines"];
    let (mut rows, mut checks) = (Vec::new(), Vec::new());
    for line in 0..3 {
        let (unit, name) = (UNITS[usize::from(line == 2)], names[line]);
        for (row, (want, found)) in printed.k[line].into_iter().zip(k[line]).enumerate() {
            rows.push(vec![
                name.into(),
                (row + 1).into(),
                want.into(),
                found.into(),
            ]);
            checks.push(Check::value(
                format!("{name}, row {}", row + 1),
                want,
                Some(found),
                unit,
            ));
        }
    }
    for line in 0..2 {
        let name = format!("largest over smallest, {}", names[line]);
        let (want, found) = (printed.ratios[line], ratios[line]);
        rows.push(vec![
            name.as_str().into(),
            None.into(),
            want.into(),
            found.into(),
        ]);
        checks.push(Check::value(name, want, Some(found), UNITS[2]));
    }
    let (at, ..) = table_distances(printed.apart);
    let points = |line: &[f64; 8]| at.iter().zip(line).map(|(d, k)| [*d, *k]).collect();
    let mut curves = Vec::new();
    for line in 0..2 {
        curves.push(computed(names[line], points(&k[line])));
        curves.push(published(names[line], points(&printed.k[line])));
    }
    Reproduction {
        item,
        title: format!(
            "K of two spot lines {} in. either side of y = 4.375 in.",
            printed.apart
        ),
        caption: format!(
            "Physical kernel in the flattened cross-section, K = sin α sin β / r², law of sines in the triangle hinge, spot line, object row; hinge angle 45°, rows \
             centred at d = 6.11764 in. and every 0.5 in. from there, lines at y = 4.375 ∓ {} in.; no layout, pixels, tolerance or normalisation enter.",
            printed.apart
        ),
        columns: ["line", "row", "printed", "computed"]
            .map(str::to_owned)
            .to_vec(),
        rows,
        plots: vec![Plot {
            title: "K against the object row".to_owned(),
            axes: [
                linear("distance of the row from the hinge / in.", [5.5, 10.0]),
                decades("K / in.⁻²"),
            ],
            curves,
        }],
        galleries: Vec::new(),
        checks,
        notes: Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// All 48 entries, the 24 ratios of lines and the 6 ratios of a line, within one unit of the last printed digit.
    #[test]
    fn every_printed_digit_is_met() {
        let mut counted = 0;
        for printed in &PRINTED {
            let (k, ratios) = compute(printed.apart);
            for line in 0..3 {
                let unit = UNITS[usize::from(line == 2)];
                for (row, (want, found)) in printed.k[line].into_iter().zip(k[line]).enumerate() {
                    assert!(
                        (found - want).abs() <= unit,
                        "{}: {line} {row}: {found} for {want}",
                        printed.apart
                    );
                    counted += 1;
                }
            }
            for (found, want) in ratios.iter().zip(printed.ratios) {
                assert!(
                    (found - want).abs() <= UNITS[2],
                    "{}: {found} for {want}",
                    printed.apart
                );
                counted += 1;
            }
        }
        assert_eq!(counted, 48 + 24 + 6);
    }
}
