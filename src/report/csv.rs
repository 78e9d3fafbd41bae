//! A table of a finding as comma-separated values.

use crate::lab::finding::{Cell, Column, Table};
use crate::store::harmless;

/// A header line of the columns' keys, then a line a row. Numbers have all their digits; what is
/// not defined is empty. Text is in quotes, its own quotes are single ones. A column without a key
/// is left out.
pub fn finding_csv(table: &Table) -> String {
    let kept = || {
        table
            .columns
            .iter()
            .enumerate()
            .filter(|(_, c)| !c.key.is_empty())
    };
    let head: Vec<String> = kept().map(|(_, c)| head(c)).collect();
    let line = |row: &Vec<Cell>| {
        let cells: Vec<String> = kept().map(|(i, c)| cell(c, row.get(i))).collect();
        cells.join(",") + "\n"
    };
    head.join(",") + "\n" + &table.rows.iter().map(line).collect::<String>()
}

fn head(column: &Column) -> String {
    let key = &column.key;
    if column.estimated {
        format!("{key},{key}_stderr")
    } else {
        key.clone()
    }
}

fn cell(column: &Column, cell: Option<&Cell>) -> String {
    let number = |x: Option<f64>| x.map_or(String::new(), |x| format!("{x:e}"));
    let text = match cell {
        None => String::new(),
        Some(Cell::Text(text)) => format!("\"{}\"", harmless(text).replace('"', "'")),
        Some(Cell::Name(name)) => harmless(name),
        Some(Cell::Flag(yes)) => yes.to_string(),
        Some(Cell::Count(n)) => n.to_string(),
        Some(Cell::Number(x) | Cell::Share(x)) => number(*x),
        Some(Cell::Estimate { value, stderr }) => {
            return format!("{value:e},{}", number(*stderr));
        }
    };
    if column.estimated { text + "," } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_column_with_a_key_has_all_digits() {
        let third = 1.0 / 3.0;
        let estimate = |value, stderr| Cell::Estimate { value, stderr };
        let table = Table {
            columns: vec![
                Column::text("what", "what"),
                Column::text("method", "method"),
                Column::text("for people", ""),
                Column::estimate("size", "size", "W", 2),
                Column::number("", "mtf", "", 2),
                Column::text("fine", "fine"),
            ],
            rows: vec![
                vec![
                    "a \"b\", c".into(),
                    Cell::Name("pinv".to_owned()),
                    "x".into(),
                    estimate(third, Some(2e-9)),
                    None.into(),
                    true.into(),
                ],
                vec![
                    "d".into(),
                    Cell::Name("joint".to_owned()),
                    "y".into(),
                    None.into(),
                    third.into(),
                    7_usize.into(),
                ],
            ],
            ..Table::default()
        };
        assert_eq!(
            finding_csv(&table),
            format!(
                "what,method,size,size_stderr,mtf,fine\n\
                 \"a 'b', c\",pinv,{third:e},2e-9,,true\n\"d\",joint,,,{third:e},7\n"
            )
        );
    }
}
