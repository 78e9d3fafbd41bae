//! What a finding leaves behind.

use std::path::Path;

use crate::cli::failure::{Failure, Outcome};
use crate::cli::output;
use crate::lab::Found;
use crate::report::{Invocation, finding_files, finding_html, finding_text};
use crate::store::harmless_json;
use crate::store::write_whole;

/// Writes the result `name` into `folder`: `NAME.json`, the tables that have a file,
/// the figures and the page of them. Prints the finding, or with `print_json` the JSON. The
/// outcome is whether traced and modelled agree.
pub(super) fn deliver(
    name: &str,
    Found {
        json,
        finding,
        agrees,
    }: &Found,
    folder: &Path,
    invocation: &Invocation,
    print_json: bool,
) -> Result<Outcome, Failure> {
    let json = &harmless_json(json);
    let mut files = vec![(format!("{name}.json"), json.clone())];
    files.extend(finding_files(finding));
    let page = finding_html(finding, invocation, &files);
    files.push(("report.html".to_owned(), page));
    for (file, text) in &files {
        write_whole(&folder.join(file), |w| w.write_all(text.as_bytes()))?;
    }
    let text = finding_text(finding);
    output::print(if print_json { json } else { &text })?;
    Ok(if *agrees {
        Outcome::Done
    } else {
        Outcome::Disagreed
    })
}
