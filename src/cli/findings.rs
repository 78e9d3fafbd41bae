//! What a finding leaves behind.

use std::path::Path;

use crate::cli::failure::{Failure, Outcome};
use crate::cli::output;
use crate::lab::Found;
use crate::report::{Invocation, finding_files, finding_html, finding_text};
use crate::store::harmless_json;

/// Writes the result `name` into `folder`: `NAME.json`, the tables that have a file,
/// the figures and the page of them.
pub(super) fn write(
    name: &str,
    Found { json, finding, .. }: &Found,
    folder: &Path,
    invocation: &Invocation,
) -> Result<(), Failure> {
    let mut files = vec![(format!("{name}.json"), harmless_json(json))];
    files.extend(finding_files(finding));
    let page = finding_html(finding, invocation, &files);
    files.push(("report.html".to_owned(), page));
    for (file, text) in &files {
        output::write(&folder.join(file), text)?;
    }
    Ok(())
}

/// Prints the finding, or with `print_json` the JSON. The outcome is whether traced and modelled
/// agree.
pub(super) fn tell(found: &Found, print_json: bool) -> Result<Outcome, Failure> {
    output::print(&if print_json {
        harmless_json(&found.json)
    } else {
        finding_text(&found.finding)
    })?;
    Ok(if found.agrees {
        Outcome::Done
    } else {
        Outcome::Disagreed
    })
}
