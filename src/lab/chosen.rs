//! What a recovery chose and found beside the reflectances, in words and as numbers with all their
//! digits.

use std::collections::BTreeMap;

use serde::Serialize;

use super::gains::{self, Gains};
use crate::num::digits::significant;
use crate::recovery::{Choice, Estimated, Method, Parameter, Patterns, Recovered, Sum};

/// A parameter, why it is this one, and what a run needs to take the same again.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Chosen {
    /// `rank`, `damping`, `tv`, `spread and length` or `levels`; absent for a method without
    /// parameter.
    pub parameter: Option<&'static str>,
    /// Its value or values, as the option of this name takes them.
    pub value: Vec<f64>,
    /// What chose it: `given`, `discrepancy`, `evidence`, `averaged`, `estimated`, `gcv`, `l-curve`
    /// or `tolerance`; absent where nothing was chosen.
    pub rule: Option<&'static str>,
    /// What the rule went by, each by its name; see [`Choice`].
    pub measures: BTreeMap<&'static str, f64>,
    /// The option of `phicam recover` that takes the same again; absent where none does.
    pub repeat: Option<String>,
}

/// How an iterative solver ended.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Ended {
    /// In words.
    pub status: String,
    /// Iterations.
    pub iterations: u32,
    /// Active-set steps after them.
    pub refinements: usize,
    /// ½ Σ w (Φ − C diag(ρ) D)², less what no ρ can change: ½ χ² where the weights are those of the
    /// noise. With the penalty of `joint-tv`.
    pub objective: f64,
    /// Upper bound on its distance from the minimum.
    pub gap: f64,
}

/// What was estimated beside the reflectances; each is there if it was asked for.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Beside {
    /// s of s C diag(ρ) D, in the photographs' unit per W of the model.
    pub scale: Option<f64>,
    /// b_l, W, of each frame.
    pub frame_constant: Option<Vec<f64>>,
    /// f_kl, W per unit of the pattern: of each pattern in each frame.
    pub frame_patterns: Option<Vec<Vec<f64>>>,
    /// a_p, W, of each pixel.
    pub background: Option<Vec<f64>>,
    /// g_l, W per unit of the pattern, of each frame.
    pub glare: Option<Vec<f64>>,
    /// Factors that were said to be known roughly.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gains: Option<Gains>,
}

/// What is known of a pattern of two levels.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Probable {
    /// Probability of the pattern that was recovered, its levels exact.
    pub pattern: f64,
    /// Probability that the elements do not differ from their levels; 1 where these were given.
    pub exact: f64,
    /// The likeliest standard deviation by which they do, if they do.
    pub spread: f64,
    /// Means of dark and light level.
    pub levels: [f64; 2],
    /// Their standard deviations.
    pub level_errors: [f64; 2],
    /// Largest difference of an element's probability between halves of the sampling; absent where
    /// all patterns were summed.
    pub disagreement: Option<f64>,
    /// Whether the probabilities are to be believed.
    pub converged: bool,
}

impl Probable {
    /// Of a recovery of two levels.
    pub fn of(found: &Recovered) -> Option<Self> {
        found.patterns.as_ref().map(|p| Self {
            pattern: p.pattern,
            exact: p.exact,
            spread: p.spread,
            levels: p.levels,
            level_errors: p.level_errors,
            disagreement: match p.sum {
                Sum::Exhaustive => None,
                Sum::Sampled { disagreement, .. } => Some(disagreement),
            },
            converged: p.sum.converged(),
        })
    }
}

impl Chosen {
    /// Of a recovery.
    pub fn of(found: &Recovered) -> Self {
        let (parameter, value) = match found.parameter {
            Parameter::None => (None, Vec::new()),
            Parameter::Rank(k) => (Some("rank"), vec![k as f64]),
            Parameter::Damping(lambda) => (Some("damping"), vec![lambda]),
            Parameter::TotalVariation(lambda) => (Some("tv"), vec![lambda]),
            Parameter::GaussianProcess { spread, length } => {
                (Some("spread and length"), vec![spread, length])
            }
            Parameter::Levels(levels) => (Some("levels"), levels.to_vec()),
        };
        let (rule, mut measures) = went_by(found.choice);
        match found.field {
            Some(field) => measures.extend([
                ("error of a pixel alone", field.pixel),
                ("error that neighbours share", field.shared),
                ("pixels over which", field.range),
            ]),
            None => measures.extend(found.alike.map(|pixels| ("pixels alike", pixels))),
        }
        // The rank of the methods that only drop what is lost in rounding is no option of theirs.
        let option = match found.parameter {
            Parameter::Rank(_) => found.method == Method::Tsvd,
            Parameter::GaussianProcess { .. } => false,
            _ => true,
        };
        let own = parameter.filter(|_| option);
        let each = value.iter().map(|x| match found.parameter {
            Parameter::Rank(k) => k.to_string(),
            _ => format!("{x:e}"),
        });
        let each = each.collect::<Vec<_>>().join(",");
        let repeat = own.map(|name| format!("--{name} {each}"));
        Self {
            parameter,
            value,
            rule,
            measures,
            repeat,
        }
    }
}

/// The rule and what it went by.
fn went_by(choice: Choice) -> (Option<&'static str>, BTreeMap<&'static str, f64>) {
    let (rule, measures) = match choice {
        Choice::Given => ("given", vec![]),
        Choice::Discrepancy {
            residual,
            target,
            limit,
        } => (
            "discrepancy",
            vec![("residual", residual), ("target", target), ("limit", limit)],
        ),
        Choice::Evidence {
            deviance,
            residual,
            patches,
        } => (
            "evidence",
            vec![
                ("deviance", deviance),
                ("residual", residual),
                ("patches", patches as f64),
            ],
        ),
        Choice::Averaged => ("averaged", vec![]),
        Choice::Estimated => ("estimated", vec![]),
        Choice::Gcv {
            residual,
            freedom,
            predicted,
        } => (
            "gcv",
            vec![
                ("residual", residual),
                ("freedom", freedom),
                ("predicted", predicted),
            ],
        ),
        Choice::LCurve {
            residual,
            penalty,
            turn,
        } => (
            "l-curve",
            vec![("residual", residual), ("penalty", penalty), ("turn", turn)],
        ),
        Choice::Tolerance { cutoff } => ("tolerance", vec![("cutoff", cutoff)]),
        Choice::None => return (None, BTreeMap::new()),
    };
    (Some(rule), measures.into_iter().collect())
}

impl Ended {
    /// Of a recovery by an iterative solver.
    pub fn of(found: &Recovered) -> Option<Self> {
        found.solver.as_ref().map(|s| Self {
            status: s.status.clone(),
            iterations: s.iterations,
            refinements: s.refinements,
            objective: s.objective,
            gap: s.gap,
        })
    }
}

impl Beside {
    /// Of a recovery that estimated something.
    pub fn of(found: &Recovered) -> Option<Self> {
        found.nuisance.as_ref().map(|n| Self {
            scale: n.scale,
            frame_constant: n.frame_constant.as_ref().map(|v| v.as_slice().to_vec()),
            frame_patterns: n
                .frame_patterns
                .as_ref()
                .map(|m| m.row_iter().map(|r| r.iter().copied().collect()).collect()),
            background: n.background.as_ref().map(|v| v.as_slice().to_vec()),
            glare: n.glare.as_ref().map(|v| v.as_slice().to_vec()),
            gains: n.gains.as_ref().map(Gains::of),
        })
    }
}

/// The regularisation used and why, in words. How likely a pattern is among patterns means nothing
/// where it does not explain the photographs, so `explains` says whether that is told.
pub(super) fn words(found: &Recovered, explains: bool) -> String {
    let solver = found.solver.as_ref().map_or(String::new(), |s| {
        format!(
            "; {} after {} iterations, gap {:.1e}",
            s.status, s.iterations, s.gap
        )
    });
    let estimated = found.nuisance.as_ref().map_or(String::new(), estimated);
    let patterns = match &found.patterns {
        Some(known) if explains => patterns(known),
        Some(_) => "; without a probability, since it does not explain the photographs".to_owned(),
        None => String::new(),
    };
    let alike = match (found.field, found.alike) {
        (Some(field), _) => format!(
            "; what is left over is taken for errors of {} of each pixel alone and {} that \
             neighbours share over {:.0} pixels (the photographs' unit)",
            significant(field.pixel, 2),
            significant(field.shared, 2),
            field.range
        ),
        (None, Some(pixels)) => {
            format!("; what is left over is taken for noise that {pixels:.0} pixels share")
        }
        (None, None) => String::new(),
    };
    chosen_words(found.parameter, found.rank, found.choice)
        + &solver
        + &patterns
        + &alike
        + &estimated
}

/// What is known of a pattern of two levels.
fn patterns(of: &Patterns) -> String {
    let how = match of.sum {
        Sum::Exhaustive => "of all patterns".to_owned(),
        Sum::Sampled {
            draws,
            listed,
            disagreement,
        } => format!(
            "{} % of them one by one and the others by {draws} draws, to within {disagreement:.2}",
            significant(100.0 * listed, 2)
        ),
    };
    let undecided = of.light.iter().filter(|p| (0.05..=0.95).contains(*p));
    // Levels that were given are taken for the surface's.
    let exact = if of.spread > 0.0 {
        format!(
            "; exactly two reflectances have probability {:.3}",
            of.exact
        )
    } else {
        "; if there are two reflectances and no more".to_owned()
    };
    format!(
        "{exact}, and if the scale is right, this pattern has probability {:.3}, {} elements are \
         undecided, levels {:.3} ± {:.3} and {:.3} ± {:.3} ({how})",
        of.pattern,
        undecided.count(),
        of.levels[0],
        of.level_errors[0],
        of.levels[1],
        of.level_errors[1],
    )
}

/// A parameter and why it is this one, in words; of a method without one the rank.
pub(super) fn chosen_words(parameter: Parameter, rank: usize, choice: Choice) -> String {
    let what = match parameter {
        Parameter::None => format!("rank {rank}"),
        Parameter::Rank(k) => format!("{k} singular directions"),
        Parameter::Damping(lambda) => format!("damping {lambda:.2e} of σ1"),
        Parameter::TotalVariation(lambda) => format!("total variation {lambda:.2e} of σ1²"),
        Parameter::GaussianProcess { spread, length } => {
            format!("spread {}, length {length:.3}", sized(spread, 3))
        }
        Parameter::Levels([dark, light]) => format!("levels {dark:.3} and {light:.3}"),
    };
    let why = match choice {
        Choice::Given => ", as given".to_owned(),
        Choice::Discrepancy {
            residual, target, ..
        } => {
            format!(
                ", by the discrepancy principle (residual {residual:.3e} W, noise {target:.3e} W)"
            )
        }
        Choice::Evidence {
            residual, patches, ..
        } => {
            format!(", by the evidence (χ² {residual:.1}, {patches} patches)")
        }
        Choice::Averaged => ", likeliest of all that are averaged".to_owned(),
        Choice::Estimated => ", estimated".to_owned(),
        Choice::Gcv {
            freedom, predicted, ..
        } => {
            format!(
                ", by generalised cross-validation (entries predicted to {predicted:.3e} W, {freedom:.1} degrees of freedom left)"
            )
        }
        Choice::LCurve { residual, turn, .. } => {
            format!(", at the corner of the L-curve (residual {residual:.3e} W, turn {turn:.2})")
        }
        Choice::Tolerance { cutoff } => format!(", cut at {cutoff:.2e}"),
        Choice::None => String::new(),
    };
    what + &why
}

/// A number with so many decimals; far from 1 with as many digits.
fn sized(value: f64, decimals: usize) -> String {
    if (1e-3..1e6).contains(&value.abs()) {
        format!("{value:.decimals$}")
    } else {
        format!("{value:.decimals$e}")
    }
}

/// What was estimated beside the reflectances, in words: means over frames or pixels.
fn estimated(nuisance: &Estimated) -> String {
    let mut words = String::new();
    let terms = [
        ("frame constant", &nuisance.frame_constant, " W"),
        ("background", &nuisance.background, " W"),
        ("glare", &nuisance.glare, ""),
    ];
    for (name, values, unit) in terms {
        if let Some(values) = values {
            words += &format!("; {name} {:.3e}{unit} on average", values.mean());
        }
    }
    if let Some(strengths) = &nuisance.frame_patterns {
        words += &format!("; {} patterns in each frame", strengths.nrows());
    }
    if let Some(scale) = nuisance.scale {
        words += &format!(
            "; scale {} (the photographs' unit per W of the model)",
            sized(scale, 4)
        );
    }
    words + &nuisance.gains.as_ref().map_or(String::new(), gains::words)
}
