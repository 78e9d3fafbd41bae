//! What a recovery chose and found beside the reflectances, in words and as numbers with all their
//! digits.

mod describe;

use std::collections::BTreeMap;

use serde::Serialize;

use crate::lab::comparison::gains::Gains;
use crate::recovery::{Choice, Method, Parameter, Recovered};
pub(in crate::lab) use describe::{beforehand, chosen_words, words};

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
        measures.extend(
            found
                .log_likelier
                .map(|x| ("ln likelier than noise of pixels alone", x)),
        );
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
        Choice::Averaged {
            if_unalike,
            if_uneven,
        } => {
            let unalike =
                if_unalike.map(|times| ("errors if neighbours are not alike, times", times));
            let uneven = if_uneven.into_iter().flat_map(|[p, times]| {
                [
                    ("probability of one reflectance", p),
                    ("errors if it is not one, times", times),
                ]
            });
            ("averaged", unalike.into_iter().chain(uneven).collect())
        }
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
