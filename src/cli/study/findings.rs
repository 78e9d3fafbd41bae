//! What a study leaves behind.

use std::path::Path;

use serde::Serialize;

use crate::cli::failure::Failure;
use crate::cli::output;
use crate::store::write_whole;

/// A finished study as a user gets it.
pub(super) struct Findings {
    json: String,
    files: Vec<(String, String)>,
    table: String,
}

impl Findings {
    /// `found` as `NAME.json`, and a table for the terminal.
    pub(super) fn new(name: &str, found: &impl Serialize, table: String) -> Result<Self, Failure> {
        let json = output::json(found)?;
        Ok(Self {
            files: vec![(format!("{name}.json"), json.clone())],
            json,
            table,
        })
    }

    /// Another file of the study.
    pub(super) fn with(mut self, file: &str, text: String) -> Self {
        self.files.push((file.to_owned(), text));
        self
    }

    /// Writes the files into `folder` and prints the table, or with `--json` the JSON.
    pub(super) fn deliver(&self, folder: &Path, json: bool) -> Result<(), Failure> {
        for (file, text) in &self.files {
            write_whole(&folder.join(file), |w| w.write_all(text.as_bytes()))?;
        }
        output::print(if json { &self.json } else { &self.table })
    }
}
