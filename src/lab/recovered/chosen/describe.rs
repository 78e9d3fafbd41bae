//! What a method chose, in words.

use crate::lab::comparison::gains::{self, Gains};
use crate::lab::uncertainty::which_errors::which_errors;
use crate::num::digits::{figure, significant};
use crate::num::summation::root_mean_square;
use crate::recovery::{Choice, Estimated, Parameter, Patterns, Recovered, Sum};

/// The regularisation used and why, in words. How likely a pattern is among patterns means nothing
/// where it does not explain the photographs, so `explains` says whether that is told.
pub(in crate::lab) fn words(found: &Recovered, explains: bool) -> String {
    let solver = found.solver.as_ref().map_or(String::new(), |s| {
        format!(
            "; {} after {} iterations, gap {:.1e}",
            s.status, s.iterations, s.gap
        )
    });
    let estimated = found.nuisance.as_ref().map_or(String::new(), estimated);
    let gains = found.nuisance.as_ref().and_then(|n| n.gains.as_ref());
    let scale = match gains.and_then(|gains| gains.whole.as_ref()) {
        Some(_) => "the scale is as nearly right as stated",
        None => "the scale is right",
    };
    let patterns = match &found.patterns {
        Some(known) if explains => patterns(known, scale),
        Some(_) => "; without a probability, since it does not explain the photographs".to_owned(),
        None => String::new(),
    };
    let alike = match (found.field, found.alike) {
        (Some(field), _) => format!(
            "; what is left over is taken for errors of {} of each pixel alone and {} that \
             neighbours share over {:.0} pixels (the photographs' unit){}",
            significant(field.pixel, 2),
            significant(field.shared, 2),
            field.range,
            found.log_likelier.map_or(String::new(), |likelier| format!(
                "; {}",
                which_errors(likelier)
            ))
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

/// What is known of a pattern of two levels, first by what its picture goes by, where the `scale`
/// is as it is said to be.
fn patterns(of: &Patterns, scale: &str) -> String {
    let assumed = of.assumed();
    let known = assumed.sum.converged();
    // Levels that were given are taken for the surface's.
    let exact = match assumed.exact.filter(|_| known) {
        Some(exact) => format!("; exactly two reflectances have probability {exact:.3}"),
        None => format!("; {TWO}"),
    };
    let beforehand = beforehand(of);
    let said = if known {
        format!(
            "this pattern has probability {:.3}, {}, {}",
            assumed.pattern,
            undecided(assumed),
            levels(assumed)
        )
    } else {
        "too few draws tell how likely this pattern is".to_owned()
    };
    format!(
        "{exact}, if {scale}, and {beforehand}, {said} ({})",
        how(assumed.sum)
    ) + &otherwise(of)
}

/// What is taken for granted of patterns.
const TWO: &str = "if there are two reflectances and no more";
const EVEN: &str = "no pattern is likelier beforehand than another";
const ALIKE: &str = "neighbours may be alike, as of a board or a letter";

/// What the picture takes for granted beforehand.
pub(in crate::lab) fn beforehand(of: &Patterns) -> &'static str {
    if of.settled_if_alike { ALIKE } else { EVEN }
}

/// What the picture does not go by, where it is known.
fn otherwise(of: &Patterns) -> String {
    match of.told_if_alike() {
        Some(_) if of.settled_if_alike => {
            let said = if of.sum.converged() {
                format!("probability {:.3} and {}", of.pattern, undecided(of))
            } else {
                "a probability that too few draws tell".to_owned()
            };
            format!("; {TWO} and {EVEN}, it has {said}")
        }
        Some(alike) => format!(
            "; {TWO} and {ALIKE}, it has probability {:.3}, {}, and the mean of all patterns, beside it, has \
             a standard error of {} an element (root mean square)",
            alike.pattern,
            levels(alike),
            figure(root_mean_square(alike.deviation.as_slice()), 2)
        ),
        None => String::new(),
    }
}

fn undecided(of: &Patterns) -> String {
    let count = of.light.iter().filter(|p| (0.05..=0.95).contains(*p));
    format!("{} elements are undecided", count.count())
}

fn levels(of: &Patterns) -> String {
    let ([dark, light], [dark_error, light_error]) = (of.levels, of.level_errors);
    format!("levels {dark:.3} ± {dark_error:.3} and {light:.3} ± {light_error:.3}")
}

fn how(sum: Sum) -> String {
    match sum {
        Sum::Exhaustive => "of all patterns".to_owned(),
        Sum::Sampled {
            draws,
            listed,
            disagreement,
        } => format!(
            "{} % of them one by one and the others by {draws} draws, to within {disagreement:.2}",
            significant(100.0 * listed, 2)
        ),
    }
}

/// A parameter and why it is this one, in words; of a method without one the rank.
pub(in crate::lab) fn chosen_words(parameter: Parameter, rank: usize, choice: Choice) -> String {
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
        Choice::Averaged { .. } => ", likeliest of all that are averaged".to_owned(),
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
    words
        + &nuisance.gains.as_ref().map_or(String::new(), |found| {
            format!("; {}", gains::words(&Gains::of(found)))
        })
}
