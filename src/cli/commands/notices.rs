//! `phicam notices`: the licences of phicam and of what it is linked with.

use crate::cli::Outcome;
use crate::cli::failure::Failure;
use crate::cli::output;

/// Of the crates, as `python/notices.py` collects them.
const CRATES: &str = include_str!("third_party.txt");
/// Of the libraries in the pages.
const PAGES: &str = include_str!("../../report/page/vendor/LICENSES.txt");

pub(in crate::cli) fn execute() -> Result<Outcome, Failure> {
    let own = "phicam is free under the MIT licence or the Apache licence 2.0, as you like.";
    output::draw(&format!("{own}\n\n{CRATES}\n{PAGES}"))?;
    Ok(Outcome::Done)
}
