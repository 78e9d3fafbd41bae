//! What is said of a published item, and on what grounds.

use serde::{Deserialize, Serialize};

/// What a check weighs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Weight {
    /// A published number.
    Value,
    /// How a published curve runs.
    Trend,
    /// A published statement, which a computation can refute.
    Claim,
}

/// A published number, trend or statement beside what was computed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Check {
    /// What it weighs.
    pub weight: Weight,
    /// What is compared.
    pub what: String,
    /// What was published.
    pub published: String,
    /// What was computed.
    pub computed: String,
    /// When it is taken to hold.
    pub criterion: String,
    /// Whether it does.
    pub holds: bool,
}

impl Check {
    /// A published number, held where the computed one is at most `allowed` away.
    pub(in crate::lab) fn value(
        what: impl Into<String>,
        published: f64,
        computed: Option<f64>,
        allowed: f64,
    ) -> Self {
        Self {
            weight: Weight::Value,
            what: what.into(),
            published: published.to_string(),
            computed: computed.map_or("none".to_owned(), |x| format!("{x:.4}")),
            criterion: format!("within {allowed}"),
            holds: computed.is_some_and(|x| (x - published).abs() <= allowed),
        }
    }

    /// A published course of a curve.
    pub(in crate::lab) fn trend(
        what: impl Into<String>,
        published: impl Into<String>,
        computed: impl Into<String>,
        criterion: impl Into<String>,
        holds: bool,
    ) -> Self {
        Self {
            weight: Weight::Trend,
            what: what.into(),
            published: published.into(),
            computed: computed.into(),
            criterion: criterion.into(),
            holds,
        }
    }

    /// A published statement.
    pub(in crate::lab) fn claim(
        what: impl Into<String>,
        published: impl Into<String>,
        computed: impl Into<String>,
        criterion: impl Into<String>,
        holds: bool,
    ) -> Self {
        Self {
            weight: Weight::Claim,
            ..Self::trend(what, published, computed, criterion, holds)
        }
    }
}

/// The verdict on an item, a function of its checks alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// Every check holds.
    Reproduced,
    /// Every trend and statement holds, not every number.
    InTrend,
    /// Nothing of what is published can be compared, or a trend does not show.
    NotReproducible,
    /// A published statement is computed to be wrong.
    Refuted,
}

impl Verdict {
    /// Every verdict, the best first.
    pub const ALL: [Self; 4] = [
        Self::Reproduced,
        Self::InTrend,
        Self::NotReproducible,
        Self::Refuted,
    ];

    /// The verdict that `checks` come to: refuted where a statement fails; else not reproducible
    /// where there is no check or a trend fails, or numbers fail and there is no trend; else in
    /// trend where a number fails.
    pub fn of(checks: &[Check]) -> Self {
        let of = |weight| checks.iter().filter(move |c| c.weight == weight);
        let fails = |weight| of(weight).any(|c| !c.holds);
        if fails(Weight::Claim) {
            Self::Refuted
        } else if checks.is_empty() || fails(Weight::Trend) {
            Self::NotReproducible
        } else if !fails(Weight::Value) {
            Self::Reproduced
        } else if of(Weight::Trend).next().is_some() {
            Self::InTrend
        } else {
            Self::NotReproducible
        }
    }

    /// In words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Reproduced => "reproduced",
            Self::InTrend => "reproduced in trend",
            Self::NotReproducible => "not reproducible",
            Self::Refuted => "refuted",
        }
    }

    /// The verdict, how many of its checks hold, and the failed check that decided it.
    pub fn reason(self, checks: &[Check]) -> String {
        let mut failed: Vec<&Check> = checks.iter().filter(|c| !c.holds).collect();
        failed.sort_by_key(|c| match c.weight {
            Weight::Claim => 0,
            Weight::Trend => 1,
            Weight::Value => 2,
        });
        let (all, held) = (checks.len(), checks.len() - failed.len());
        let why = failed.first().map_or(String::new(), |first| {
            format!(
                "; published of {}: {}; computed: {}",
                first.what, first.published, first.computed
            )
        });
        format!("{} ({held} of {all} checks hold{why})", self.words())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn verdicts_follow_from_the_checks() {
        let value = |holds| Check::value("v", 1.0, Some(if holds { 1.01 } else { 1.2 }), 0.02);
        let trend = |holds| Check::trend("t", "", "", "", holds);
        let claim = |holds| Check::claim("c", "", "", "", holds);
        for (checks, want) in [
            (vec![], Verdict::NotReproducible),
            (vec![value(true)], Verdict::Reproduced),
            (
                vec![value(true), trend(true), claim(true)],
                Verdict::Reproduced,
            ),
            (vec![value(false), trend(true)], Verdict::InTrend),
            (vec![value(false)], Verdict::NotReproducible),
            (vec![value(true), trend(false)], Verdict::NotReproducible),
            (vec![value(true), claim(false)], Verdict::Refuted),
        ] {
            assert_eq!(Verdict::of(&checks), want, "{checks:?}");
        }
        assert!(!Check::value("none", 1.0, None, 1.0).holds);
    }
}
