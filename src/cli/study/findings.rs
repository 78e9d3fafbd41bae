//! What a study leaves behind.

use std::path::Path;

use serde::Serialize;

use crate::cli::failure::Failure;
use crate::cli::output;
use crate::report::{self, Account, Asked};
use crate::store::write_whole;

/// A finished study as a user gets it.
pub(super) struct Findings {
    json: String,
    files: Vec<(String, String)>,
    table: String,
    account: Account,
}

impl Findings {
    /// `found` as `NAME.json`, a table for the terminal, and an account for the page.
    pub(super) fn new(
        name: &str,
        found: &impl Serialize,
        table: String,
        account: Account,
    ) -> Result<Self, Failure> {
        let json = output::json(found)?;
        Ok(Self {
            files: vec![(format!("{name}.json"), json.clone())],
            json,
            table,
            account,
        })
    }

    /// Another file of the study.
    pub(super) fn with(mut self, file: &str, text: String) -> Self {
        self.files.push((file.to_owned(), text));
        self
    }

    /// Writes the files and the page of them into `folder` and prints the table, or with `--json` the JSON.
    pub(super) fn deliver(&self, folder: &Path, asked: &Asked, json: bool) -> Result<(), Failure> {
        let page = report::study_html(&self.account, asked, &self.files);
        let page = ("report.html".to_owned(), page);
        for (file, text) in self.files.iter().chain([&page]) {
            write_whole(&folder.join(file), |w| w.write_all(text.as_bytes()))?;
        }
        output::print(if json { &self.json } else { &self.table })
    }
}
