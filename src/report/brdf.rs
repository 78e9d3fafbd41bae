//! The study of wall BRDFs as text and as a figure.

use super::axis::significant;
use super::chart::{Axis, Run, Series, legend, panel, sheet};
use crate::study::{Assumption, BrdfStudy, Quality, Ratio, Spread};

/// Every assumption: whether the light agrees with it, and what is recovered with it; then what follows in words.
pub fn brdf_table(study: &BrdfStudy) -> String {
    let albedos: Vec<String> = study
        .relay_albedo
        .iter()
        .map(|a| significant(*a, 4))
        .collect();
    let mut out = format!(
        "{}: the matrix model on a wall that is not Lambertian, light of three bounces\n\
         traced by {} with {} samples; white-sky albedo of the wall {}\n\n\
         {:<24} {:>9} {:>11} {:>11} {:>9} {:>9}\n",
        study.scene,
        study.estimator,
        study.samples,
        albedos.join(", "),
        "assumed of the wall",
        "verdict",
        "difference",
        "noise",
        "largest z",
        "scale",
    );
    for a in rows(study) {
        let g = &a.agreement;
        out += &format!(
            "{:<24} {:>9} {:>11.2e} {:>11.2e} {:>9} {:>9}\n",
            a.name,
            verdict(a),
            g.relative_difference,
            g.relative_noise,
            significant(g.largest_z, 3),
            significant(a.scale, 5),
        );
    }
    for (k, known) in study.known().qualities.iter().enumerate() {
        out += &format!(
            "\n{}, noise {} of each entry, {} draws\n{:<24} {:>17} {:>17} {:>17}\n",
            known.method,
            significant(known.noise, 2),
            study.draws,
            "assumed of the wall",
            "raw MTF",
            "correlation",
            "RMSE",
        );
        for a in rows(study) {
            let q = &a.qualities[k];
            out += &format!(
                "{:<24} {:>17} {:>17} {:>17}\n",
                a.name,
                spread(q.mtf_raw),
                spread(q.correlation),
                spread(q.rmse)
            );
            if let Some(reason) = &q.reason {
                out += &format!("  {} draws gave nothing: {reason}\n", q.failed);
            }
        }
    }
    out += "\n";
    for sentence in sentences(study) {
        out += &format!("{sentence}\n");
    }
    out
}

pub(super) fn rows(study: &BrdfStudy) -> impl Iterator<Item = &Assumption> {
    study.assumptions.iter().chain([&study.lambertian_case])
}

pub(super) fn verdict(a: &Assumption) -> &'static str {
    match a.agreement.agrees {
        true => "agrees",
        false => "rejected",
    }
}

pub(super) fn spread(s: Option<Spread>) -> String {
    let Some(s) = s else {
        return "–".to_owned();
    };
    let error = s
        .stderr
        .map_or(String::new(), |e| format!(" ± {}", significant(e, 1)));
    significant(s.mean, 4) + &error
}

fn sentences(study: &BrdfStudy) -> Vec<String> {
    let limit = study.known().agreement.significance;
    let mut out = vec![format!(
        "At a significance of {limit:e}, of what may be assumed of the wall,"
    )];
    for a in &study.assumptions {
        out.push(format!(
            "  {} {} (relative difference {:.2e}, of which noise {:.1e})",
            a.name,
            match a.agreement.agrees {
                true => "agrees with the traced light",
                false => "is rejected",
            },
            a.agreement.relative_difference,
            a.agreement.relative_noise
        ));
    }
    out.push(
        "Recovery with the known BRDF over that of a Lambertian wall of equal albedo:".to_owned(),
    );
    out.extend(study.ratios.iter().map(ratio));
    out
}

fn ratio(r: &Ratio) -> String {
    let times = |x: Option<f64>| x.map_or("–".to_owned(), |x| significant(x, 4));
    let judged = match r.reaches {
        Some(true) => "reaches it within 10 %",
        Some(false) => "DOES NOT REACH IT within 10 %",
        None => "that one recovers nothing either",
    };
    format!(
        "  {} at noise {}: raw MTF × {}, correlation × {}, RMSE × {}: {judged}",
        r.method,
        significant(r.noise, 2),
        times(r.mtf_raw),
        times(r.correlation),
        times(r.rmse),
    )
}

/// The study as comma-separated values with a header line: a line for each assumption, method and level.
pub fn brdf_csv(study: &BrdfStudy) -> String {
    let mut out = "assumed,agrees,relative_difference,relative_noise,largest_z,scale,method,noise,\
                   mtf_raw,mtf_raw_stderr,correlation,correlation_stderr,rmse,rmse_stderr,failed\n"
        .to_owned();
    let number = |x: Option<f64>| x.map_or(String::new(), |x| format!("{x:e}"));
    let both = |s: Option<Spread>| {
        let stderr = s.and_then(|s| s.stderr);
        format!("{},{}", number(s.map(|s| s.mean)), number(stderr))
    };
    for a in rows(study) {
        let g = &a.agreement;
        for q in &a.qualities {
            out += &format!(
                "\"{}\",{},{:e},{:e},{:e},{:e},{},{:e},{},{},{},{}\n",
                a.name,
                g.agrees,
                g.relative_difference,
                g.relative_noise,
                g.largest_z,
                a.scale,
                q.method,
                q.noise,
                both(q.mtf_raw),
                both(q.correlation),
                both(q.rmse),
                q.failed
            );
        }
    }
    out
}

/// The study as a figure: raw MTF and RMSE of the last method against the noise, one line an assumption, its verdict in the legend.
pub fn brdf_svg(study: &BrdfStudy) -> String {
    let method = study
        .known()
        .qualities
        .last()
        .map_or("", |q| q.method.as_str());
    let own = |a: &Assumption| -> Vec<Quality> {
        let mut own: Vec<Quality> = a
            .qualities
            .iter()
            .filter(|q| q.method == method)
            .cloned()
            .collect();
        own.sort_by(|a, b| a.noise.total_cmp(&b.noise));
        own
    };
    let line = |f: &dyn Fn(&Quality) -> Option<Spread>| -> Vec<Series> {
        rows(study)
            .map(|a| Series {
                name: format!("{} ({})", a.name, verdict(a)),
                points: own(a)
                    .iter()
                    .filter_map(|q| Some([q.noise, f(q)?.mean]))
                    .collect(),
            })
            .collect()
    };
    let noise = || {
        let levels = study.known().qualities.iter().map(|q| q.noise);
        Axis::decades(levels, "relative noise of each entry of Φcam")
    };
    let title = format!("What knowing the wall's BRDF is worth: {}", study.scene);
    let note = format!(
        "recovered by {method}; verdicts on the model's integral at a significance of {:e}",
        study.known().agreement.significance
    );
    let mut svg = sheet([940, 760], &title, &note);
    let mtf = Axis {
        run: Run::Linear,
        ends: [-0.2, 1.0],
        title: "raw MTF of the recovery".to_owned(),
    };
    let errors = line(&|q| q.rmse);
    let rmse = Axis::decades(
        errors.iter().flat_map(|s| s.points.iter().map(|p| p[1])),
        "RMSE of the reflectances",
    );
    let mtfs = line(&|q| q.mtf_raw);
    let size = [540.0, 270.0];
    panel(&mut svg, [80.0, 70.0], size, [&noise(), &mtf], &mtfs);
    panel(&mut svg, [80.0, 420.0], size, [&noise(), &rmse], &errors);
    legend(&mut svg, [644.0, 84.0], &mtfs);
    svg.raw("</svg>\n");
    svg.text
}
