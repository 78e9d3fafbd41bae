//! The coverage study as text.

use super::axis::significant;
use crate::study::Coverage;

/// A line a method: what its bands are, what they cover, and at what width.
pub fn coverage_table(study: &Coverage) -> String {
    let mut out = format!(
        "{}: what bands of {} % cover, {} elements, noise {} of each entry, {} seeds\n\n\
         {:<20} {:<14} {:>14} {:>9} {:>10} {:>10}\n",
        study.scene,
        significant(100.0 * study.confidence, 3),
        study.elements,
        significant(study.noise, 2),
        study.seeds,
        "method",
        "bands",
        "covered, %",
        "least, %",
        "rms bias",
        "width",
    );
    let mut reasons = String::new();
    for row in &study.rows {
        let percent = |x: Option<f64>| x.map_or("–".to_owned(), |x| format!("{:.1}", 100.0 * x));
        let plain = |x: Option<f64>| x.map_or("–".to_owned(), |x| significant(x, 2));
        let error = row
            .stderr
            .map_or(String::new(), |s| format!(" ± {:.1}", 100.0 * s));
        out += &format!(
            "{:<20} {:<14} {:>14} {:>9} {:>10} {:>10}\n",
            row.method,
            row.bands.as_deref().unwrap_or("–"),
            percent(row.covered) + &error,
            percent(row.least),
            plain(row.bias),
            plain(row.width)
        );
        if let Some(reason) = &row.reason {
            reasons += &format!("{}: {reason}\n", row.method);
        }
    }
    if !reasons.is_empty() {
        out += &format!("\n{reasons}");
    }
    out
}
