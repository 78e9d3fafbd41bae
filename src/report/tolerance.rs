//! The tolerance study as text and as a figure.

use super::axis::significant;
use super::chart::{Axis, Run, Series, legend, panel, sheet};
use crate::study::{Sensitivity, Tolerance};

/// The study as plain text of at most 80 columns: for each thing the change of Φcam per unit where it is small, the size at which
/// the pattern is lost, and the MTF at three sizes.
pub fn tolerance_table(study: &Tolerance) -> String {
    let mtf = |m: Option<f64>| m.map_or("–".to_owned(), |m| significant(m, 3));
    let mut out = format!(
        "{}: how wrong the assumed geometry may be, noise {} of each entry\n\
         MTF of `joint` with the right geometry: {}\n\n\
         {:<26} {:>12} {:>12} {:>14}\n{:<26} {:>12} {:>12} {:>14}\n",
        study.scene,
        significant(study.noise, 2),
        mtf(study.mtf),
        "what is off",
        "dΦ/Φ a unit",
        "after scale",
        "pattern lost",
        "",
        "",
        "",
        "(MTF halved)",
    );
    for p in &study.parameters {
        let slope = |f: &dyn Fn(&crate::study::Misplacement) -> f64| {
            p.rows
                .first()
                .map_or("–".to_owned(), |r| significant(f(r) / r.size, 2))
        };
        let lost = match (p.lost_at, p.rows.last()) {
            (Some(size), _) => format!("{} {}", significant(size, 2), p.unit),
            (None, Some(last))
                if last
                    .mtf
                    .is_some_and(|m| study.mtf.is_some_and(|r| m >= 0.5 * r)) =>
            {
                format!("> {} {}", significant(last.size, 2), p.unit)
            }
            _ => "–".to_owned(),
        };
        out += &format!(
            "{:<26} {:>12} {:>12} {:>14}\n",
            p.name,
            slope(&|r| r.change),
            slope(&|r| r.after_scale),
            lost
        );
    }
    out
}

/// The study as comma-separated values with a header line.
pub fn tolerance_csv(study: &Tolerance) -> String {
    let mut out = "what,unit,size,change,after_scale,mtf\n".to_owned();
    for p in &study.parameters {
        for r in &p.rows {
            let mtf = r.mtf.map_or(String::new(), |m| format!("{m:e}"));
            out += &format!(
                "\"{}\",{},{:e},{:e},{:e},{mtf}\n",
                p.name, p.unit, r.size, r.change, r.after_scale
            );
        }
    }
    out
}

/// The study as a figure: change of Φcam, and MTF of the recovery, against the size of each misplacement.
pub fn tolerance_svg(study: &Tolerance) -> String {
    let unit = study
        .parameters
        .iter()
        .map(|p| p.unit.as_str())
        .find(|u| *u != "deg")
        .unwrap_or("");
    let rows = || study.parameters.iter().flat_map(|p| &p.rows);
    let size = || {
        Axis::decades(
            rows().map(|r| r.size),
            format!("size of the error ({unit}; hinge angle: degrees)"),
        )
    };
    let line = |f: &dyn Fn(&crate::study::Misplacement) -> Option<f64>| -> Vec<Series> {
        let points = |p: &Sensitivity| {
            p.rows
                .iter()
                .filter_map(|r| Some([r.size, f(r)?]))
                .collect()
        };
        study
            .parameters
            .iter()
            .map(|p| Series {
                name: p.name.clone(),
                points: points(p),
            })
            .collect()
    };
    let title = format!("How wrong the assumed geometry may be: {}", study.scene);
    let note = format!(
        "photographs with {} relative noise, recovered by joint",
        significant(study.noise, 2)
    );
    let mut svg = sheet([900, 760], &title, &note);
    let change = Axis::decades(rows().map(|r| r.change), "‖ΔΦcam‖ / ‖Φcam‖");
    let mtf = Axis {
        run: Run::Linear,
        ends: [-0.2, 1.0],
        title: "raw MTF of the recovery".to_owned(),
    };
    let changes = line(&|r| Some(r.change));
    panel(
        &mut svg,
        [80.0, 70.0],
        [560.0, 270.0],
        [&size(), &change],
        &changes,
    );
    panel(
        &mut svg,
        [80.0, 420.0],
        [560.0, 270.0],
        [&size(), &mtf],
        &line(&|r| r.mtf),
    );
    legend(&mut svg, [664.0, 84.0], &changes);
    svg.raw("</svg>\n");
    svg.text
}
