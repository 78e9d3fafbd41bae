//! What is said of the rules that choose a parameter.

use crate::recovery::{Method, Rule};

/// The way out by another rule, of the methods that have one.
pub(super) fn other_rules(method: Method) -> &'static str {
    match method {
        Method::JointTv => "or ",
        _ => "choose by a rule that needs none (gcv, l-curve), or ",
    }
}

/// Why a rule has no answer.
pub(super) fn no_answer(rule: Rule) -> &'static str {
    match rule {
        Rule::LCurve => "the L-curve has no corner, it nowhere turns by as much as π/8",
        Rule::Gcv => "no spot is left to predict",
        Rule::Discrepancy => "no residual is as the noise makes it",
    }
}

/// What to use in its place.
pub(super) fn other_than(rule: Rule) -> &'static str {
    match rule {
        Rule::LCurve => "discrepancy (give the standard errors of phi) or gcv (needs none)",
        Rule::Gcv => "discrepancy (give the standard errors of phi)",
        Rule::Discrepancy => "gcv",
    }
}
