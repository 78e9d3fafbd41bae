//! What a study found, as plain values: the one vocabulary of results.
//!
//! A study decides what is best, what passes and what is said about it, and puts that into a
//! [`Finding`]. The floor above lays a finding out as text, CSV, JSON, SVG and HTML, one renderer
//! each, and adds no decision and no word of its own.

use serde::{Deserialize, Serialize};

use super::ensemble::{Estimate, Spread};

/// How a finding sounds: what colour its sentence has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Tone {
    /// Nothing was judged.
    #[default]
    Plain,
    /// What was asked holds.
    Good,
    /// It does not.
    Bad,
}

/// A result that can be shown.
pub trait Describe {
    /// The finding: what is said, tabulated and drawn.
    fn describe(&self) -> Finding;
}

/// What was found.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Finding {
    /// What was studied, on which scene.
    pub title: String,
    /// Whether it is good news.
    pub tone: Tone,
    /// The answer in one or two sentences, with its numbers.
    pub sentence: String,
    /// What else is said: assumptions, settings, what could not be seen. A paragraph each.
    pub notes: Vec<String>,
    /// The numbers.
    pub tables: Vec<Table>,
    /// Line, point and bar charts; each is one SVG file.
    pub figures: Vec<Figure>,
    /// Pictures.
    pub galleries: Vec<Gallery>,
    /// Published beside computed values.
    pub checks: Vec<Check>,
    /// Other files that it leaves: name and text.
    pub files: Vec<(String, String)>,
}

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

/// How an axis is divided.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Spacing {
    /// Evenly, at least between these ends.
    Linear([f64; 2]),
    /// Evenly between these ends; points beyond them are left out, and the figure says how many.
    Clipped([f64; 2]),
    /// By decades around the data.
    Logarithmic,
    /// One place for each name, at 0, 1, 2, …; on the axis upwards the first is on top.
    Categories(Vec<String>),
}

/// An axis. Equal ones of one direction have the same ends throughout a figure.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Axis {
    /// What it shows, with its unit.
    pub title: String,
    /// How it is divided.
    pub spacing: Spacing,
}

/// How the points of a curve are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Mark {
    /// A line through them.
    Line,
    /// A mark each.
    Points,
    /// A bar each, from the axis of categories.
    Bars,
    /// A mark each, read from the published study.
    Published,
    /// A straight line across the plot, a limit or a level: upright where its points have one x,
    /// else at the y of the first.
    Level,
}

/// Points with a name.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Curve {
    /// Its name in the legend. Curves of one name look the same in every plot of a figure.
    pub name: String,
    /// How it is drawn.
    pub mark: Mark,
    /// (x, y).
    pub points: Vec<[f64; 2]>,
    /// Standard errors of the numbers (y; of bars their lengths), drawn as whiskers; empty for
    /// none.
    pub stderr: Vec<f64>,
}

/// Curves on one pair of axes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Plot {
    /// What it shows; empty where the figure's title says all.
    pub title: String,
    /// Across and upwards.
    pub axes: [Axis; 2],
    /// Its curves.
    pub curves: Vec<Curve>,
}

/// A sheet of plots: one SVG file.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Figure {
    /// Name of its file, with `.svg`.
    pub file: String,
    /// What it shows.
    pub title: String,
    /// What is said below the title; empty for nothing.
    pub note: String,
    /// Its plots, in rows.
    pub plots: Vec<Plot>,
}

/// What the shades of a picture mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Shades {
    /// Reflectances, 0 black and 1 white.
    Reflectance,
    /// Any values, from the smallest to the largest.
    Values,
}

/// A matrix shown as a picture.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Picture {
    /// What it is.
    pub title: String,
    /// Columns and rows.
    pub size: [usize; 2],
    /// Value of column i, row j at i + j·columns; the first row is the lowest.
    pub values: Vec<f64>,
    /// What runs to the right and what upwards.
    pub axes: [String; 2],
    /// How wide what it shows is, in.
    pub width: f64,
}

/// Pictures on one scale.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Gallery {
    /// What they show.
    pub title: String,
    /// What their shades mean.
    pub shades: Shades,
    /// Unit of the values.
    pub unit: String,
    /// The pictures.
    pub pictures: Vec<Picture>,
}

pub use super::check::Check;

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

impl Plot {
    /// Curves on a pair of axes, across and upwards.
    pub fn new(title: impl Into<String>, axes: [Axis; 2], curves: Vec<Curve>) -> Self {
        Self {
            title: title.into(),
            axes,
            curves,
        }
    }
}

impl Gallery {
    /// Pictures of reflectances.
    pub fn reflectances(title: impl Into<String>, pictures: Vec<Picture>) -> Self {
        Self {
            title: title.into(),
            shades: Shades::Reflectance,
            unit: String::new(),
            pictures,
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

    /// A column of numbers with their standard errors.
    pub fn estimate(name: &str, key: &str, unit: &str, digits: usize) -> Self {
        Self {
            estimated: true,
            ..Self::number(name, key, unit, digits)
        }
    }
}

impl Figure {
    /// A sheet of plots without a note.
    pub fn new(file: impl Into<String>, title: impl Into<String>, plots: Vec<Plot>) -> Self {
        Self {
            file: file.into(),
            title: title.into(),
            note: String::new(),
            plots,
        }
    }
}

impl Axis {
    /// An even axis that reaches at least from one end to the other.
    pub fn linear(title: impl Into<String>, ends: [f64; 2]) -> Self {
        Self {
            title: title.into(),
            spacing: Spacing::Linear(ends),
        }
    }

    /// An even axis between these ends, without what lies beyond.
    pub fn clipped(title: impl Into<String>, ends: [f64; 2]) -> Self {
        Self {
            title: title.into(),
            spacing: Spacing::Clipped(ends),
        }
    }

    /// An axis by decades.
    pub fn decades(title: impl Into<String>) -> Self {
        Self {
            title: title.into(),
            spacing: Spacing::Logarithmic,
        }
    }
}

impl Curve {
    /// A curve without error bars.
    pub fn new(name: impl Into<String>, mark: Mark, points: Vec<[f64; 2]>) -> Self {
        Self {
            name: name.into(),
            mark,
            points,
            stderr: Vec::new(),
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

/// Items as one reads them: a, b and c.
pub fn listed(items: &[String]) -> String {
    match items {
        [] => "none".to_owned(),
        [one] => one.clone(),
        [all @ .., last] => format!("{} and {last}", all.join(", ")),
    }
}
