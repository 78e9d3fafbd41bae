//! The ledger's numbers are those of the code.

use super::case::{Case, published};
use super::table1;
use crate::lab::finding::Cell;
use crate::model::{Kernel, PixelGrid, Published, Stagger};
use crate::transport::Control;

const LEDGER: &str = include_str!("ledger.md");

fn case(half_width: f64, per_side: usize) -> Published {
    published(Kernel::Published, 8, per_side, half_width, Stagger::None)
}

#[test]
fn spots_leave_the_wall_as_told() {
    for (half_width, told) in [(6.0, "56 %"), (7.5, "81 %")] {
        let spots = case(half_width, 1000).spots();
        let off = |[x, y]: &&[f64; 2]| !(0.0..=11.5).contains(x) || !(0.0..=15.5).contains(y);
        let share = spots.iter().filter(off).count() as f64 / spots.len() as f64;
        assert_eq!(format!("{:.0} %", 100.0 * share), told);
        assert!(LEDGER.contains(told));
    }
    let top = |h: f64| {
        case(h, 3)
            .spots()
            .iter()
            .map(|s| s[1])
            .fold(f64::MIN, f64::max)
    };
    assert!(top(11.12) < 15.5 && top(11.13) > 15.5 && LEDGER.contains("11.13 in."));
}

#[test]
fn kernel_and_grid_differ_as_told() {
    let own = case(6.0, 30);
    let board = own.board(2);
    let phi = own.phi(&board);
    let physical = Published {
        kernel: Kernel::Physical,
        ..own
    };
    let light = physical.phi(&board);
    let kernel = (&phi - &light).norm() / light.norm();
    let told = format!("misses that of `physical` by {:.0} %", 100.0 * kernel);
    assert!(LEDGER.contains(&told), "{told}");
    let centres = Published {
        grid: PixelGrid::Centres,
        ..own
    };
    let grid = (centres.phi(&board) - &phi).norm() / phi.norm();
    let told = format!("Φ of the two differs by {:.1} %", 100.0 * grid);
    assert!(LEDGER.contains(&told), "{told}");
}

#[test]
fn table_1_is_as_told() {
    let cases: Vec<Case> = table1::cases()
        .into_iter()
        .filter(|c| !c.is_traced)
        .collect();
    let made = |case: &Case| table1::trials(case, Control::none()).unwrap();
    let found: Vec<_> = cases.iter().map(made).collect();
    let found = table1::table(&cases, &found);
    let number = |row: usize, column: usize| match found.rows[row][column] {
        Cell::Number(Some(x)) => x,
        ref other => panic!("{other:?}"),
    };
    let told = format!("they are {:.3} and {:.3}", number(3, 4), number(3, 5));
    assert!(LEDGER.contains(&told), "{told}");
    let told = [(0, 80), (3, 400), (6, 4000)]
        .map(|(row, spots)| format!("{:.2} at {spots}", number(row, 6)).replace('-', "−"));
    assert!(LEDGER.contains(&told.join(", ")), "{told:?}");
}
