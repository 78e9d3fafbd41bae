//! A render, a recovery and a whole run in words and tables.

use super::aim::AIM;
use super::results::RunResults;
use crate::lab::comparison::agreement::Agreement;
use crate::lab::finding::{Cell, Column, Describe, Finding, Place, Table, Tone};
use crate::lab::recovered::recoveries::{recoveries, warnings};
use crate::lab::uncertainty::tails::Tails;
use crate::matrix::Matrix;
use crate::num::digits::figure;
use crate::scene::Scene;
use crate::transport::tails::UNLIT;
use crate::transport::{Plan, Traced};

/// A table without heads: what is told, and what is told of it.
pub(super) fn facts(rows: impl IntoIterator<Item = (&'static str, String)>) -> Table {
    Table {
        columns: vec![Column::text("", ""), Column::text("", "")],
        rows: rows
            .into_iter()
            .map(|(key, text)| vec![key.into(), text.into()])
            .collect(),
        ..Table::default()
    }
}

/// A part of the whole, in words.
pub(super) fn percent(x: f64) -> String {
    format!("{}\u{a0}%", figure(100.0 * x, 3))
}

impl RunResults {
    /// What the agreement test says, or why there is none.
    pub fn verdict(&self) -> String {
        match (&self.agreement, &self.model) {
            (Some(agreement), _) => agreement.verdict(),
            (None, Some(_)) => "traced light was not compared with the model".to_owned(),
            (None, None) => "no model to compare with: the scene hides nothing".to_owned(),
        }
    }

    /// Whether that is good news.
    pub fn tone(&self) -> Tone {
        self.agreement.as_ref().map_or(Tone::Plain, Agreement::tone)
    }

    /// ‖standard error‖/‖Φcam‖ of the entries that light was met for; `None` where there is none.
    pub fn relative_stderr(&self) -> Option<f64> {
        relative_stderr(&self.phi, &self.stderr, &self.tails)
    }

    /// Scene, settings, flux with its precision, the test and times.
    pub fn facts(&self) -> Table {
        let precision = self.relative_stderr();
        let rendered = rendered(
            &self.scene,
            &self.plan,
            (&self.phi, precision, &self.tails),
            &self.bounces,
        );
        let agreement = self.agreement.iter().flat_map(Agreement::facts);
        let total: f64 = self.times.iter().map(|t| t.1).sum();
        let each = self.times.iter();
        let each = each.map(|(stage, t)| format!("{stage} {}\u{a0}s", figure(*t, 2)));
        let each = each.collect::<Vec<_>>().join(", ");
        let time = ("time", format!("{}\u{a0}s: {each}", figure(total, 2)));
        let time = (!self.times.is_empty()).then_some(time);
        facts(rendered.into_iter().chain(agreement).chain(time))
    }

    /// The flux by the number of surfaces that its light met.
    pub fn light_by_surfaces(&self) -> Table {
        let row = |(n, share): &(u32, f64)| vec![u64::from(*n).into(), Cell::Share(Some(*share))];
        Table {
            columns: vec![
                Column::text("surfaces met", ""),
                Column::number("share of the flux", "", "", 3),
            ],
            rows: self.bounces.iter().map(row).collect(),
            place: Place::Page,
            ..Table::default()
        }
    }

    /// Shares of ‖modelled Φcam‖: the measured difference, its part along the model (a scale) and
    /// across it (a pattern), and what is known of the causes: noise of the path tracer, the
    /// model's discretisation, light that met more surfaces than the model counts. None without a
    /// verdict.
    ///
    /// With s the best scale, traced − modelled = (traced − s·modelled) + (s − 1)·modelled, and
    /// both parts are orthogonal: their squares add up.
    pub fn difference(&self) -> Option<Table> {
        let a = self.agreement.as_ref()?;
        let scale = (a.best_scale - 1.0).abs();
        let pattern = a.relative_difference.powi(2) - scale.powi(2);
        let beyond = self.bounces.iter().filter(|(n, _)| *n > 3);
        let beyond: f64 = beyond.map(|(_, share)| share).sum();
        let (beyond, how) = if self.scene.max_bounces > 3 {
            (
                Some(beyond),
                "share of the traced flux; the model has three surfaces",
            )
        } else {
            (None, "not traced: the scene's max_bounces leaves it out")
        };
        let rows = [
            (
                "measured: ‖traced − modelled‖",
                Some(a.relative_difference),
                "",
            ),
            (
                "of it a scale that all entries share",
                Some(scale),
                "best single scale less 1",
            ),
            (
                "of it a pattern",
                Some(pattern.max(0.0).sqrt()),
                "what the best scale leaves",
            ),
            (
                "expected: noise of the path tracer",
                Some(a.relative_noise),
                "‖standard error‖",
            ),
            (
                "at most: what the model's integration leaves out",
                Some(a.relative_discretisation),
                "stated bound of the model; next to nothing by quadrature",
            ),
            ("light that met more than three surfaces", beyond, how),
        ];
        Some(Table {
            columns: vec![
                Column::text("what", ""),
                Column::number("share", "", "", 3),
                Column::text("how it is known", ""),
            ],
            rows: rows
                .map(|(what, share, how)| vec![what.into(), Cell::Share(share), how.into()])
                .to_vec(),
            place: Place::Page,
            ..Table::default()
        })
    }
}

impl Describe for RunResults {
    /// What stands below the [answer](Self::answer): warnings, every recovery, then how it was
    /// done.
    fn describe(&self) -> Finding {
        Finding {
            tone: self.tone(),
            notes: warnings(&self.recovered),
            tables: recoveries(&self.recovered)
                .into_iter()
                .chain([self.facts()])
                .collect(),
            ..Finding::default()
        }
    }
}

/// What a render left: flux and precision, `seconds` of wall time.
pub fn describe_render(scene: &Scene, plan: &Plan, traced: &Traced, seconds: f64) -> Finding {
    let total = traced.flux.sum();
    let share = |m: &Matrix| if total > 0.0 { m.sum() / total } else { 0.0 };
    let bounces: Vec<(u32, f64)> = (1..).zip(traced.bounces.iter().map(share)).collect();
    let precision = relative_stderr(&traced.flux, &traced.stderr, &traced.tails);
    let mut told = rendered(
        scene,
        plan,
        (&traced.flux, precision, &traced.tails),
        &bounces,
    );
    told.push(("time", format!("{}\u{a0}s", figure(seconds, 2))));
    Finding {
        tables: vec![facts(told)],
        ..Finding::default()
    }
}

/// ‖σ‖/‖Φ‖. Entries for which no light was met have an upper bound in place of σ, which takes no
/// part; they are counted as such. `None` where there is no light.
fn relative_stderr(flux: &Matrix, stderr: &Matrix, tails: &Matrix) -> Option<f64> {
    let met = |(sigma, code): (&f64, &f64)| (*code as u32 & UNLIT == 0).then_some(sigma * sigma);
    let variance: f64 = stderr.iter().zip(tails.iter()).filter_map(met).sum();
    let norm = flux.norm();
    (norm > 0.0).then(|| variance.sqrt() / norm)
}

/// What would bring a relative standard error down to [`AIM`]: it falls like 1/√samples, or faster.
/// The estimator is named too, for samples alone would be those of another.
fn cure(stderr: f64, plan: &Plan) -> String {
    if stderr <= AIM {
        return String::new();
    }
    let samples = plan.budget.samples() as f64 * (stderr / AIM).powi(2);
    let samples = (samples as u64).next_power_of_two();
    format!(
        "; `--estimator {} --samples {samples}` makes that {} or less",
        plan.estimator,
        percent(AIM)
    )
}

/// Scene, settings, flux with its relative standard error, and what share of it met how many
/// surfaces.
fn rendered(
    scene: &Scene,
    plan: &Plan,
    (phi, precision, tails): (&Matrix, Option<f64>, &Matrix),
    bounces: &[(u32, f64)],
) -> Vec<(&'static str, String)> {
    let hash: String = scene.hash.chars().take(12).collect();
    let noise = precision.map_or(String::new(), |e| {
        format!(", standard error {}{}", percent(e), cure(e, plan))
    });
    let mut told = vec![
        (
            "scene",
            format!(
                "{} ({hash}), {} pixels × {} spots",
                scene.name,
                phi.nrows(),
                phi.ncols()
            ),
        ),
        (
            "rendered",
            format!(
                "{}, {}, {} samples in {} blocks, seed {}",
                plan.estimator,
                plan.sampling,
                plan.budget.samples(),
                plan.budget.blocks,
                plan.seed
            ),
        ),
        (
            "flux",
            format!(
                "{}\u{a0}W over all pixels and spots{noise}",
                figure(phi.sum(), 3)
            ),
        ),
        ("error bars", Tails::of(tails).sentence()),
    ];
    if !bounces.is_empty() {
        let share = |(n, share): &(u32, f64)| format!("{n} surfaces {}", percent(*share));
        let shares: Vec<String> = bounces.iter().map(share).collect();
        told.push(("light by path", shares.join(", ")));
    }
    told
}

#[cfg(test)]
mod tests;
