//! Do two matrices agree within the error bars of one of them?

use serde::{Deserialize, Serialize};

use super::eliminated::Eliminated;
use super::evidence::{Evidence, Test};
use super::gains::Gains;
use super::residual::{Residual, Weights};
use super::score::{Derivatives, Remaining, Score, score};
use crate::lab::uncertainty::certainty::Errors;
use crate::lab::uncertainty::with_light::WithLight;
use crate::matrix::Matrix;
use crate::num::statistics::{chi_square_sf, normal_two_sided, sidak_p, sidak_threshold};
use crate::num::summation::mean_and_stderr;

/// Share of a model that its integration may leave out, beyond which agreement is no evidence.
pub(in crate::lab) const VAGUE: f64 = 0.5;

/// One entry of Φcam, traced and modelled.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Entry {
    /// Pixel index.
    pub pixel: usize,
    /// Spot index.
    pub spot: usize,
    /// Traced flux, W.
    pub traced: f64,
    /// Modelled flux, W.
    pub modelled: f64,
    /// Standard normal deviate of the difference.
    pub z: f64,
}

/// What the model may be off by in an entry.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct EntryBound {
    /// Pixel index.
    pub pixel: usize,
    /// Spot index.
    pub spot: usize,
    /// Bound over |modelled|; at most 1.
    pub relative: f64,
}

/// Traced against modelled Φcam.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Agreement {
    /// Whether there is evidence, and every test passes at the significance level.
    pub agrees: bool,
    /// Whether anything was compared: an entry that is not left out, and that is lit.
    pub evidence: bool,
    /// `physical` or `published`.
    pub kernel: String,
    /// How the model integrates: `centres` or `quadrature`.
    pub integration: String,
    /// Points of the hidden surfaces at which the model asks what stands in the way; `None` if it
    /// does not ask.
    pub occlusion: Option<usize>,
    /// Replicates as from which the standard errors are known, where those of few were pooled over
    /// pixels and spots; `None` where they are as they were given.
    #[serde(default)]
    pub pooled: Option<u32>,
    /// Entries whose standard errors were enlarged by what shadows add that few paths meet; 0 where
    /// the model is not refused without.
    #[serde(default)]
    pub seldom: usize,
    /// Family-wise error rate of the verdict.
    pub significance: f64,
    /// Entries compared.
    pub entries: usize,
    /// Entries left out: their error is untrusted, or traced and modelled they are dark.
    pub left_out: usize,
    /// Whether they are of a render.
    #[serde(default)]
    pub is_rendered: bool,
    /// Directions of the entries that other light and the scale took, fitted first.
    #[serde(default)]
    pub fitted: usize,
    /// Other light that was fitted and taken out, over all light: relative Frobenius norm.
    #[serde(default)]
    pub other_light: f64,
    /// Whether the scale was fitted first: it is `best_scale`.
    #[serde(default)]
    pub is_scale_free: bool,
    /// Factors of the light that are known only roughly, as they were found; their prior is part of
    /// the test. `None` where none were asked for.
    #[serde(default)]
    pub gains: Option<Gains>,
    /// Σ z² over the entries less `fitted`: 1 on average if the model is right.
    pub chi2_per_dof: f64,
    /// Independent degrees of freedom of that mean.
    pub dof: f64,
    /// Its upper tail probability.
    pub chi2_p: f64,
    /// Largest |z|.
    pub largest_z: f64,
    /// Largest |z| that the significance level allows for this many entries (Šidák).
    pub z_limit: f64,
    /// Probability of a |z| as large among all entries (Šidák).
    pub largest_p: f64,
    /// Correlation of z² with ln of the modelled light, where it is more than chance.
    #[serde(default)]
    pub with_light: Option<f64>,
    /// Relative Frobenius difference ‖traced − modelled‖/‖modelled‖.
    pub relative_difference: f64,
    /// What the traced standard error alone makes of that: ‖stderr‖/‖modelled‖.
    pub relative_noise: f64,
    /// Discretisation bound of the model, relative Frobenius norm.
    pub relative_discretisation: f64,
    /// The entry with the largest bound of the model relative to it; `None` where none is stated.
    pub worst_bound: Option<EntryBound>,
    /// Best single scale of the model: traced ≈ scale · modelled (least squares, unweighted).
    pub best_scale: f64,
    /// Its standard error, by what the errors share.
    pub best_scale_stderr: f64,
    /// χ²/dof of each pixel; `None` where all its entries are left out.
    pub pixels: Vec<Option<f64>>,
    /// χ²/dof of each spot.
    pub spots: Vec<Option<f64>>,
    /// The parameters of the scene, each fitted alone; `None` where none were given.
    pub score: Option<Score>,
    /// The entries with the largest |z|.
    pub worst: Vec<Entry>,
    /// Light that the frames may hold and the model does not, in words.
    #[serde(default)]
    pub unmodelled: Vec<String>,
    /// Occluders that send on light which the model does not have, by name.
    #[serde(default)]
    pub sent_on: Option<String>,
}

/// Entries listed by name.
const WORST: usize = 10;

/// The significance level of each test, where deviations of the scene are tested or not.
pub(in crate::lab) fn share(significance: f64, deviations: bool) -> f64 {
    significance / if deviations { 3.0 } else { 2.0 }
}

/// Compares entry by entry. Returns the verdict (with empty `kernel` and `integration`) and the z
/// of every entry, 0 for one that is left out.
///
/// The deviate of an entry is t = (traced − model)/stderr, Student-distributed with `replicates` −
/// 1 degrees of freedom, and z the standard normal deviate of the same tail probability. A stated
/// `bound` of the model is taken off |traced − model| first. Two tests share the significance level
/// equally, three where there are `derivatives`:
///
/// * the largest |z| against the Šidák limit for all entries, where these are of counts as of a
///   skewed law ([`Counted`](crate::lab::uncertainty::counted::Counted));
/// * χ² = Σz². Under [`Errors::WithinRows`] the z of a row move together, but rows are independent:
///   the scatter of the row sums tells how many independent entries Σz² amounts to (Satterthwaite),
///   between the number of rows and that of entries. Under [`Errors::Everywhere`] it counts as one
///   entry's: whatever the correlations, the mean of z² exceeds a limit this far out less often
///   than a single z² does;
/// * the score tests of the parameters of the scene ([`Score`]): half of their share is for all of
///   these, half for those of single spots, each against its Šidák limit.
///
/// Entries whose standard error is 0 (light that never varies) are compared to rounding, and those
/// that are dark in both besides are left out. Where every entry is, there is no evidence and no
/// agreement; nor where what was fitted first has as many unknowns as there are entries, nor where
/// nothing speaks against a model of which half may be its integration.
pub fn agree(
    evidence: Evidence<'_>,
    test: Test,
    derivatives: Option<&Derivatives<'_>>,
) -> (Agreement, Matrix) {
    let (rows, columns) = evidence.model.shape();
    let deviate = |at: usize, model: f64| deviate(&evidence, test, at, model);
    let each = Matrix::from_fn(rows, columns, |p, l| {
        let at = p + l * rows;
        if evidence.counts(at) {
            deviate(at, evidence.model[at])
        } else {
            0.0
        }
    });
    let z = each.zip_map(evidence.stderr, |z, s| test.known.of_counts(z, s));
    let counted: Vec<usize> = (0..z.len()).filter(|i| evidence.counts(*i)).collect();
    let entries = counted.len();
    let lit = |i: &usize| evidence.traced[*i] != 0.0 || evidence.model[*i] != 0.0;
    let fitted = evidence.eliminated.map_or(0, Eliminated::freedom);
    let evident = counted.iter().any(lit) && entries > fitted;
    let largest = z.amax();
    let squares = each.norm_squared();
    let free = entries.saturating_sub(fitted).max(1) as f64;
    let chi2_per_dof = squares / free;
    let dof = match test.known.errors {
        Errors::Independent => test.known.of_chi2(free),
        Errors::WithinRows => effective_freedom(&each, entries) * free / entries.max(1) as f64,
        Errors::Everywhere => 1.0,
    };
    let chi2_p = chi_square_sf(chi2_per_dof * dof, dof);
    let share = share(test.significance, derivatives.is_some());
    let largest_p = sidak_p(normal_two_sided(largest), entries as u64);
    let remaining = |theta: f64, d: &Matrix, columns: &std::ops::Range<usize>| {
        let own = columns.start * rows..columns.end * rows;
        let own = own.filter(|i| evidence.counts(*i));
        let change = own.map(|i| {
            let after = deviate(i, evidence.model[i] + theta * d[i]);
            after * after - each[i] * each[i]
        });
        (squares + change.sum::<f64>()) / free
    };
    let is_refused = chi2_p < share || largest_p < share;
    let remaining = Remaining {
        after: &remaining,
        entries: free,
        is_refused,
    };
    let score = derivatives
        .filter(|_| evident)
        .map(|d| score(evidence, test, share, d, remaining));
    let scored = score.as_ref().is_none_or(|s| !s.rejects());
    let passes = !is_refused && scored;
    // Of what counts, relative to the model's norm. To a dark model everything is unbounded, but
    // nothing remains nothing.
    let norm = |f: &dyn Fn(usize) -> f64| counted.iter().map(|i| f(*i).powi(2)).sum::<f64>().sqrt();
    let modelled = norm(&|i| evidence.model[i]);
    let relative = |x: f64| if x > 0.0 { x / modelled } else { 0.0 };
    let discretisation = relative(norm(&|i| evidence.bound(i)));
    // Against a model that is known to its half nothing speaks, and nothing speaks for it.
    let evident = evident && !(passes && discretisation > VAGUE);
    let scale = Residual::new(evidence, test, Weights::Alike).fit(evidence.model, &(0..columns));
    let agreement = Agreement {
        agrees: evident && passes,
        evidence: evident,
        kernel: String::new(),
        integration: String::new(),
        occlusion: None,
        pooled: None,
        seldom: 0,
        significance: test.significance,
        entries,
        left_out: z.len() - entries,
        is_rendered: test.known.paths.is_some(),
        fitted,
        other_light: 0.0,
        is_scale_free: evidence.eliminated.is_some_and(Eliminated::is_scale_free),
        gains: None,
        chi2_per_dof,
        dof,
        chi2_p,
        largest_z: largest,
        z_limit: sidak_threshold(share, entries as u64),
        largest_p,
        with_light: counted
            .iter()
            .fold(WithLight::default(), |mut sums, i| {
                sums.add(evidence.model[*i], each[*i] * each[*i]);
                sums
            })
            .correlation()
            .filter(|_| test.known.errors == Errors::Independent),
        relative_difference: relative(norm(&|i| evidence.traced[i] - evidence.model[i])),
        relative_noise: relative(norm(&|i| evidence.stderr[i])),
        relative_discretisation: discretisation,
        worst_bound: worst_bound(&evidence, &counted),
        best_scale: 1.0 + scale.map_or(0.0, |s| s.value),
        best_scale_stderr: scale.map_or(0.0, |s| s.stderr),
        pixels: (0..rows)
            .map(|p| mean_square(&evidence, &each, (0..columns).map(|l| p + l * rows)))
            .collect(),
        spots: (0..columns)
            .map(|l| mean_square(&evidence, &each, l * rows..(l + 1) * rows))
            .collect(),
        score,
        worst: worst(&z, &evidence),
        unmodelled: Vec::new(),
        sent_on: None,
    };
    (agreement, z)
}

/// Standard normal deviate of an entry from `model`, W.
fn deviate(evidence: &Evidence<'_>, test: Test, at: usize, model: f64) -> f64 {
    let difference = evidence.traced[at] - model;
    let beyond = (difference.abs() - evidence.bound(at)).max(0.0);
    if beyond == 0.0 {
        return 0.0;
    }
    let scale = evidence.stderr[at].max(evidence.rounding(at));
    test.known.normal(beyond / scale).copysign(difference)
}

/// Mean z² of those of some entries that count.
fn mean_square(
    evidence: &Evidence<'_>,
    z: &Matrix,
    entries: impl Iterator<Item = usize>,
) -> Option<f64> {
    let counted = entries.filter(|i| evidence.counts(*i)).map(|i| z[i] * z[i]);
    let (sum, n) = counted.fold((0.0, 0.0), |(sum, n), x| (sum + x, n + 1.0));
    (n > 0.0).then(|| sum / n)
}

/// The entry with the largest bound relative to itself.
fn worst_bound(evidence: &Evidence<'_>, counted: &[usize]) -> Option<EntryBound> {
    evidence.bound?;
    let relative = |i: &usize| match evidence.bound(*i) {
        0.0 => 0.0,
        b => (b / evidence.model[*i].abs()).min(1.0),
    };
    let all = counted.iter().map(|i| (*i, relative(i)));
    let (at, relative) = all.reduce(|a, b| if b.1 > a.1 { b } else { a })?;
    let rows = evidence.model.nrows();
    Some(EntryBound {
        pixel: at % rows,
        spot: at / rows,
        relative,
    })
}

/// Fewer rows than this do not tell their own scatter.
const ENOUGH_ROWS: usize = 16;

fn effective_freedom(z: &Matrix, entries: usize) -> f64 {
    let sums: Vec<f64> = z.row_iter().map(|r| r.norm_squared()).collect();
    freedom_of_rows(&sums, entries)
}

/// ν such that Σz² has the mean and the variance of (entries/ν)·χ²_ν if the model is right: ν =
/// 2·entries²/Var Σz², the variance estimated from the scatter of the `sums` over each row. With
/// too few rows, their number, which is the least it can be.
pub(in crate::lab) fn freedom_of_rows(sums: &[f64], entries: usize) -> f64 {
    let (rows, entries) = (sums.len() as f64, entries.max(1) as f64);
    if sums.len() < ENOUGH_ROWS {
        return rows;
    }
    let (_, stderr) = mean_and_stderr(sums);
    let variance = stderr * stderr * rows * rows;
    if variance > 0.0 {
        (2.0 * entries * entries / variance).clamp(rows.min(entries), entries)
    } else {
        rows
    }
}

/// The entries with the largest |z|, largest first.
fn worst(z: &Matrix, evidence: &Evidence<'_>) -> Vec<Entry> {
    let mut order: Vec<usize> = (0..z.len()).filter(|i| evidence.counts(*i)).collect();
    order.sort_by(|a, b| z[*b].abs().total_cmp(&z[*a].abs()).then(a.cmp(b)));
    let entry = |i: usize| Entry {
        pixel: i % z.nrows(),
        spot: i / z.nrows(),
        traced: evidence.traced[i],
        modelled: evidence.model[i],
        z: z[i],
    };
    order.into_iter().take(WORST).map(entry).collect()
}

#[cfg(test)]
mod tests;
