//! Tables of typed cells.

use serde::{Deserialize, Serialize};

use crate::lab::ensemble::{Estimate, Spread};

/// Where a table is shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Place {
    /// On the terminal and on the page.
    #[default]
    Everywhere,
    /// On the page alone.
    Page,
    /// In its CSV file alone.
    File,
}

/// A table of typed cells.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Table {
    /// What it shows.
    pub caption: String,
    /// Name of its CSV file, if it has one.
    pub file: Option<String>,
    /// Where it is shown beside that.
    pub place: Place,
    /// Its columns.
    pub columns: Vec<Column>,
    /// Its rows, a cell for each column.
    pub rows: Vec<Vec<Cell>>,
    /// What is said below; empty for nothing.
    pub note: String,
}

/// A column of a table. Without a name it is in the file alone, without a key it is for people
/// alone; in a table without a file a column that has neither has no head.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Column {
    /// Its head for people.
    pub name: String,
    /// Its head in a CSV file: lower case with underscores.
    pub key: String,
    /// Whether it holds estimates: in a CSV file it then takes two columns, `key` and `key_stderr`.
    pub estimated: bool,
    /// Unit of its numbers; empty for none.
    pub unit: String,
    /// Significant digits shown to people. Files have all digits.
    pub digits: usize,
}

/// An entry of a table.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Cell {
    /// Words. A CSV file has them in quotes.
    Text(String),
    /// A name of the program's own, without spaces and commas: an estimator, a method. A CSV file
    /// has it as it is.
    Name(String),
    /// Yes or no; in a CSV file true or false.
    Flag(bool),
    /// A whole number.
    Count(u64),
    /// A number; none where it is not defined.
    Number(Option<f64>),
    /// A share of a whole, 0 to 1, which people read in percent; none where it is not known.
    Share(Option<f64>),
    /// A number with its standard error, where that is known.
    Estimate {
        /// The number.
        value: f64,
        /// Its standard error.
        stderr: Option<f64>,
    },
}

/// What a column says of an item.
pub type CellOf<T> = fn(&T) -> Cell;

impl Table {
    /// A table with a row for each item, from its columns and what each says of an item. A column
    /// given by its key alone is [`Column::keyed`].
    pub fn of<T, C: Into<Column>, const N: usize>(
        items: impl IntoIterator<Item = T>,
        columns: [(C, CellOf<T>); N],
    ) -> Self {
        let (columns, cells): (Vec<C>, Vec<_>) = columns.into_iter().unzip();
        let row = |item: T| cells.iter().map(|cell| cell(&item)).collect();
        Self {
            columns: columns.into_iter().map(Into::into).collect(),
            rows: items.into_iter().map(row).collect(),
            ..Self::default()
        }
    }

    /// A table of `rows` under the keys of a header line, `first,second,…`.
    pub fn headed(header: &str, rows: Vec<Vec<Cell>>) -> Self {
        Self {
            columns: header.split(',').map(Column::keyed).collect(),
            rows,
            ..Self::default()
        }
    }

    /// A table for people.
    pub fn new(
        caption: impl Into<String>,
        columns: Vec<Column>,
        rows: impl IntoIterator<Item = Vec<Cell>>,
    ) -> Self {
        Self {
            caption: caption.into(),
            columns,
            rows: rows.into_iter().collect(),
            ..Self::default()
        }
    }

    /// The same with what is said below it.
    pub fn noted(self, note: impl Into<String>) -> Self {
        Self {
            note: note.into(),
            ..self
        }
    }

    /// A table that is in its CSV file alone, below these keys.
    pub fn of_file(
        file: &str,
        keys: impl IntoIterator<Item = impl AsRef<str>>,
        rows: impl IntoIterator<Item = Vec<Cell>>,
    ) -> Self {
        let column = |key| Column::text("", AsRef::as_ref(&key));
        Self {
            file: Some(file.to_owned()),
            place: Place::File,
            ..Self::new("", keys.into_iter().map(column).collect(), rows)
        }
    }
}

impl Column {
    /// A column of words or whole numbers.
    pub fn text(name: &str, key: &str) -> Self {
        Self::number(name, key, "", 0)
    }

    /// A column of numbers with their unit and the significant digits shown to people.
    pub fn number(name: &str, key: &str, unit: &str, digits: usize) -> Self {
        Self {
            name: name.to_owned(),
            key: key.to_owned(),
            estimated: false,
            unit: unit.to_owned(),
            digits,
        }
    }

    /// A column of words or numbers under the key of its file. People read the key with spaces, and
    /// four significant digits.
    pub fn keyed(key: &str) -> Self {
        Self::number(&key.replace('_', " "), key, "", 4)
    }

    /// With what it says of an item.
    pub fn of<T>(self, cell: CellOf<T>) -> (Self, CellOf<T>) {
        (self, cell)
    }

    /// A column of numbers with their standard errors.
    pub fn estimate(name: &str, key: &str, unit: &str, digits: usize) -> Self {
        Self {
            estimated: true,
            ..Self::number(name, key, unit, digits)
        }
    }
}

impl From<&str> for Column {
    fn from(key: &str) -> Self {
        Self::keyed(key)
    }
}

impl Cell {
    /// A name of the program's own.
    pub fn name(name: &str) -> Self {
        Self::Name(name.to_owned())
    }

    /// A mean with its standard error.
    pub fn spread(spread: Option<Spread>) -> Self {
        let estimate = |s: Spread| Self::Estimate {
            value: s.mean,
            stderr: s.stderr,
        };
        spread.map_or(Self::Number(None), estimate)
    }
}

impl From<&String> for Cell {
    fn from(text: &String) -> Self {
        Self::Text(text.clone())
    }
}

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}

impl From<String> for Cell {
    fn from(text: String) -> Self {
        Self::Text(text)
    }
}

impl From<usize> for Cell {
    fn from(count: usize) -> Self {
        Self::Count(count as u64)
    }
}

impl From<u64> for Cell {
    fn from(count: u64) -> Self {
        Self::Count(count)
    }
}

impl From<bool> for Cell {
    fn from(yes: bool) -> Self {
        Self::Flag(yes)
    }
}

impl From<f64> for Cell {
    fn from(number: f64) -> Self {
        Self::Number(Some(number))
    }
}

impl From<Estimate> for Cell {
    fn from(Estimate { value, stderr }: Estimate) -> Self {
        let stderr = Some(stderr);
        Self::Estimate { value, stderr }
    }
}

impl From<Option<f64>> for Cell {
    fn from(number: Option<f64>) -> Self {
        Self::Number(number)
    }
}
