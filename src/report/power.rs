//! The power study as text.

use super::axis::significant;
use super::svg::shortened;
use crate::study::Power;

/// The study as plain text of at most 80 columns.
pub fn power_table(power: &Power) -> String {
    let mut out = format!(
        "{}: what validate detects at a significance of {} ({})\n",
        power.scene,
        significant(power.significance, 2),
        power.sampler
    );
    for row in &power.rows {
        let [low, high] = row.expected;
        let within = (low..=high).contains(&row.false_alarms);
        out += &format!(
            "\n{}, {} samples, {} seeds: χ²/dof {}\n  right model rejected {} times, {} the {low} to {high} of the stated level\n",
            row.estimator,
            row.samples,
            row.seeds,
            significant(row.chi2_per_dof, 4),
            row.false_alarms,
            if within { "within" } else { "NOT WITHIN" },
        );
        for d in &row.detections {
            out += &format!(
                "  {:<34} (Φ off by {:>8})  rejected {:>4} of {}\n",
                shortened(&d.error, 34),
                significant(d.size, 2),
                d.rejected,
                row.seeds
            );
        }
        out += &format!(
            "  smallest scale error detected, median: {}\n",
            significant(row.smallest_scale, 2)
        );
    }
    out
}
