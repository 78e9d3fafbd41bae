//! A table of a finding as people read it: text in the units and digits of its columns.

use crate::lab::finding::{Cell, Column, Table};
use crate::num::digits::{figure, perhaps};

/// What of a table is shown to people.
pub(super) struct Cells {
    /// Heads of the columns; none where no column has one.
    pub heads: Option<Vec<String>>,
    /// Whether a column holds words, which stand on the left; numbers stand on the right.
    pub words: Vec<bool>,
    /// A text for each column.
    pub rows: Vec<Vec<String>>,
    /// Of the shares among them how large they are, relative to the largest of their column.
    pub shares: Vec<Vec<Option<f64>>>,
}

impl Cells {
    /// The columns of `table` that are not in its file alone.
    pub(super) fn of(table: &Table) -> Self {
        let own = |c: &Column| !c.name.is_empty() || c.key.is_empty();
        let shown: Vec<usize> = (0..table.columns.len())
            .filter(|i| own(&table.columns[*i]))
            .collect();
        let pick = |row: &Vec<Cell>| {
            let text = |i: &usize| shown_cell(&table.columns[*i], row.get(*i));
            shown.iter().map(text).collect()
        };
        let share = |row: &Vec<Cell>, i: &usize| match row.get(*i) {
            Some(Cell::Share(share)) => share.filter(|x| x.is_finite()),
            _ => None,
        };
        let largest = |i: &usize| {
            let shares = table.rows.iter().filter_map(|row| share(row, i));
            shares.fold(f64::MIN_POSITIVE, f64::max)
        };
        let relative = |row: &Vec<Cell>| {
            let one = |i: &usize| Some(share(row, i)? / largest(i));
            shown.iter().map(one).collect()
        };
        let heads: Vec<String> = shown.iter().map(|i| head(&table.columns[*i])).collect();
        let word = |row: &Vec<Cell>, i: usize| {
            matches!(
                row.get(i),
                None | Some(Cell::Text(_) | Cell::Name(_) | Cell::Flag(_))
            )
        };
        let words = |i: &usize| table.rows.iter().all(|row| word(row, *i));
        Self {
            heads: heads.iter().any(|h| !h.is_empty()).then_some(heads),
            words: shown.iter().map(words).collect(),
            rows: table.rows.iter().map(pick).collect(),
            shares: table.rows.iter().map(relative).collect(),
        }
    }
}

/// The name of a column with its unit.
fn head(column: &Column) -> String {
    if column.unit.is_empty() {
        column.name.clone()
    } else {
        format!("{}, {}", column.name, column.unit)
    }
}

fn shown_cell(column: &Column, cell: Option<&Cell>) -> String {
    match cell {
        None => String::new(),
        Some(Cell::Text(text) | Cell::Name(text)) => text.clone(),
        Some(Cell::Flag(yes)) => if *yes { "yes" } else { "no" }.to_owned(),
        Some(Cell::Count(n)) => n.to_string(),
        Some(Cell::Number(x)) => perhaps(*x, column.digits),
        Some(Cell::Share(None)) => "unknown".to_owned(),
        Some(Cell::Share(Some(x))) => format!("{} %", figure(100.0 * x, column.digits)),
        Some(Cell::Estimate { value, stderr }) => {
            let error = stderr.map_or(String::new(), |s| format!(" ± {}", figure(s, 2)));
            figure(*value, column.digits) + &error
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_have_their_digits_units_and_sides() {
        let estimate = |value, stderr| Cell::Estimate { value, stderr };
        let table = Table {
            columns: vec![
                Column::text("cause", "cause"),
                Column::estimate("size", "size", "W", 3),
                Column::number("", "hidden", "", 3),
                Column::text("in the sum", "in_sum"),
                Column::number("z", "z", "", 2),
            ],
            rows: vec![
                vec![
                    "a".into(),
                    estimate(1.25e-7, Some(3e-9)),
                    1.0.into(),
                    true.into(),
                    None.into(),
                ],
                vec!["b".into(), estimate(0.5, None), 2.0.into(), false.into()],
            ],
            ..Table::default()
        };
        let cells = Cells::of(&table);
        assert_eq!(
            cells.heads.unwrap(),
            ["cause", "size, W", "in the sum", "z"]
        );
        assert_eq!(cells.words, [true, false, true, false]);
        assert_eq!(cells.rows[0], ["a", "1.25 × 10⁻⁷ ± 3.0 × 10⁻⁹", "yes", "–"]);
        assert_eq!(cells.rows[1], ["b", "0.500", "no", ""]);
    }
}
