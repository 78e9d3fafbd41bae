//! Which variable of a MAT-file is read.

use super::super::array::{ArrayError, MOST_ENTRIES, unsupported};

/// Most names of variables that a message lists, and most letters of each.
const MOST_NAMES: usize = 16;
const LONGEST_NAME: usize = 64;
/// Most dimensions of a variable.
const MOST_DIMENSIONS: usize = 8;

/// The variable that is asked for by its name, or the only numeric array.
pub(super) struct Choice<'a, V> {
    /// The file, for messages.
    file: &'a str,
    wanted: Option<&'a str>,
    chosen: Option<(String, V)>,
    names: Vec<String>,
}

impl<'a, V> Choice<'a, V> {
    /// Among the variables of `file`, none of which was offered yet.
    pub(super) fn new(file: &'a str, wanted: Option<&'a str>) -> Self {
        Self {
            file,
            wanted,
            chosen: None,
            names: Vec::new(),
        }
    }

    /// Takes the variable called `name` if it is the one.
    ///
    /// # Errors
    /// [`ArrayError::Unsupported`] if another one was taken before.
    pub(super) fn offer(
        &mut self,
        name: String,
        is_numeric: bool,
        variable: V,
    ) -> Result<(), ArrayError> {
        let is_it = self.wanted.map_or(is_numeric, |wanted| wanted == name);
        if self.names.len() < MOST_NAMES {
            self.names.push(name.chars().take(LONGEST_NAME).collect());
        }
        if !is_it {
            return Ok(());
        }
        if let Some((other, _)) = &self.chosen {
            let reason = format!(
                "it holds several arrays (`{other}` and `{name}`); say which by `variable`"
            );
            return Err(unsupported(self.file, reason));
        }
        self.chosen = Some((name, variable));
        Ok(())
    }

    /// The variable with its name.
    ///
    /// # Errors
    /// [`ArrayError::Unsupported`] if none of those that were offered is the one.
    pub(super) fn made(self) -> Result<(String, V), ArrayError> {
        let reason = match self.wanted {
            Some(wanted) => format!(
                "it has no variable `{wanted}`, but {}; name one of them",
                self.names.join(", ")
            ),
            None => "it holds no numeric array; save one".to_owned(),
        };
        self.chosen.ok_or_else(|| unsupported(self.file, reason))
    }
}

/// How many entries the variable `own` of `shape` has.
///
/// # Errors
/// [`ArrayError::Unsupported`] for none, more than [`MOST_ENTRIES`], and more than 8 dimensions.
pub(super) fn entries(file: &str, own: &str, shape: &[usize]) -> Result<usize, ArrayError> {
    let count = shape.iter().try_fold(1usize, |n, l| n.checked_mul(*l));
    let count = count
        .filter(|n| (1..=MOST_ENTRIES).contains(n) && (1..=MOST_DIMENSIONS).contains(&shape.len()));
    count.ok_or_else(|| {
        let shape = shape.iter().take(MOST_DIMENSIONS).collect::<Vec<_>>();
        let reason = format!("its variable `{own}` is {shape:?}; use 1 to 2²⁷ entries");
        unsupported(file, reason)
    })
}
