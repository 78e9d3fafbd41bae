//! The indicator study as text and as figures.

use super::axis::significant;
use super::chart::{Axis, Run, Series, legend, scatter, sheet};
use crate::study::{Coefficients, Configuration, Indicator, NoisyOutcome};

/// The study as plain text: every figure's correlation with the measured raw MTF, without noise and under noise.
pub fn indicator_table(study: &Indicator) -> String {
    let mut out = format!(
        "{}: what predicts the raw MTF of `pinv`, {} configurations\n\
         largest difference of projected object and recovery: {}\n\n{}",
        study.scene,
        study.configurations.len(),
        significant(study.identity, 2),
        coefficients(&study.coefficients)
    );
    for n in &study.noisy {
        out += &format!(
            "\nunder noise, {}: {} points predicted",
            n.method, n.compared
        );
        if n.compared > 0 {
            out += &format!(
                ", {} within three standard errors of {} draws (largest {}, p {})",
                n.within_three,
                study.seeds,
                significant(n.largest_z, 3),
                significant(n.largest_p, 2)
            );
        }
        out += "\n";
        for (count, why) in [
            (
                n.undefined,
                "left out: the spread of W + B is above a tenth of its mean",
            ),
            (
                n.without_covariance,
                "without a prediction: the method states no covariance",
            ),
            (n.failed, "without a result: the method refused"),
        ] {
            if count > 0 {
                out += &format!("  {count} {why}\n");
            }
        }
        if n.compared > 1 {
            out += &coefficients(&n.coefficients);
        }
    }
    out
}

fn coefficients(all: &[Coefficients]) -> String {
    let number = |x: Option<f64>| x.map_or("–".to_owned(), |x| format!("{x:.6}"));
    let mut out = format!(
        "{:<34} {:>9} {:>9} {:>7}\n",
        "", "Pearson", "Spearman", "of"
    );
    for c in all {
        out += &format!(
            "{:<34} {:>9} {:>9} {:>7}\n",
            c.indicator,
            number(c.pearson),
            number(c.spearman),
            c.configurations
        );
    }
    out
}

/// Every configuration without noise as comma-separated values with a header line.
pub fn indicator_csv(study: &Indicator) -> String {
    let mut out = "layout,spots,half_width,elements,board,kernel,rank,kept,projected,mtf,condition,smallest_eigenvalue,smallest_square\n".to_owned();
    for c in &study.configurations {
        out += &format!(
            "\"{}\",{},{},{},{},{},{},{:e},{:e},{:e},{:e},{:e},{:e}\n",
            c.layout,
            c.spots,
            c.half_width,
            c.elements,
            c.board,
            c.kernel,
            c.rank,
            c.kept,
            c.projected,
            c.mtf,
            c.condition,
            c.smallest_eigenvalue,
            c.smallest_square
        );
    }
    out
}

/// Every point under noise as comma-separated values with a header line.
pub fn indicator_noise_csv(study: &Indicator) -> String {
    let mut out = "configuration,method,noise,outcome,kept,predicted,predicted_deviation,spread,measured,measured_deviation,draws,z\n".to_owned();
    for p in &study.points {
        let rest = match &p.outcome {
            NoisyOutcome::Compared(c) => format!(
                "compared,{:e},{:e},{:e},{:e},{:e},{},{},{:e}",
                c.kept,
                c.mean,
                c.deviation,
                c.spread,
                c.measured.mean,
                c.measured
                    .deviation
                    .map_or(String::new(), |d| format!("{d:e}")),
                c.measured.draws,
                c.z
            ),
            NoisyOutcome::Undefined { spread } => format!("undefined,,,,{spread:e},,,,"),
            NoisyOutcome::NoCovariance => "no covariance,,,,,,,,".to_owned(),
            NoisyOutcome::Failed { .. } => "failed,,,,,,,,".to_owned(),
        };
        out += &format!("{},{},{:e},{rest}\n", p.configuration, p.method, p.noise);
    }
    out
}

/// The study as a figure: measured raw MTF against the indicator, the condition number and the smallest eigenvalue, and under noise against the closed form.
pub fn indicator_svg(study: &Indicator) -> String {
    let title = format!("What predicts the raw MTF of pinv: {}", study.scene);
    let mut svg = sheet([900, 860], &title, "");
    let measured = |title: &str| Axis {
        run: Run::Linear,
        ends: [-0.2, 1.2],
        title: title.to_owned(),
    };
    let mtf = measured("raw MTF without noise");
    let dots = |f: &dyn Fn(&Configuration) -> f64| {
        let points = study.configurations.iter().map(|c| [f(c), c.mtf]);
        vec![Series {
            name: String::new(),
            points: points.collect(),
        }]
    };
    let size = [340.0, 300.0];
    let kept = measured("‖P c‖² / ‖c‖²");
    let mut beyond = scatter(
        &mut svg,
        [80.0, 60.0],
        size,
        [&kept, &mtf],
        &dots(&|c| c.kept),
    );
    let condition = Axis::decades(
        study.configurations.iter().map(|c| c.condition),
        "condition number σ1/σk",
    );
    beyond += scatter(
        &mut svg,
        [520.0, 60.0],
        size,
        [&condition, &mtf],
        &dots(&|c| c.condition),
    );
    let eigenvalue = |c: &Configuration| c.smallest_eigenvalue.abs();
    let axis = Axis::decades(
        study.configurations.iter().map(eigenvalue),
        "|smallest eigenvalue of G12·G12ᵀ| / largest",
    );
    beyond += scatter(
        &mut svg,
        [80.0, 470.0],
        size,
        [&axis, &mtf],
        &dots(&eigenvalue),
    );
    let noisy: Vec<Series> = study
        .noisy
        .iter()
        .map(|n| Series {
            name: n.method.clone(),
            points: study
                .points
                .iter()
                .filter(|p| p.method == n.method)
                .filter_map(|p| match &p.outcome {
                    NoisyOutcome::Compared(c) => Some([c.mean, c.measured.mean]),
                    _ => None,
                })
                .collect(),
        })
        .collect();
    let axes = [
        &measured("predicted mean MTF under noise"),
        &measured("measured mean MTF"),
    ];
    beyond += scatter(&mut svg, [520.0, 470.0], size, axes, &noisy);
    legend(&mut svg, [536.0, 486.0], &noisy);
    let note = match beyond {
        0 => "every point lies within the axes".to_owned(),
        n => format!("{n} points lie beyond the axes; all are in the tables"),
    };
    svg.text([16.0, 46.0], "class=\"remark\" fill=\"#6b6b6b\"", &note);
    svg.raw("</svg>\n");
    svg.text
}
