//! What a run answers, in the order in which it is asked: what was hidden, what came back, how sure
//! that is, and whether traced and modelled light agree.

use super::results::RunResults;
use super::summary::facts;
use crate::lab::finding::{Describe, Finding, Tone};
use crate::lab::recovered::chosen::beforehand;
use crate::lab::recovered::objects::RecoveredObject;
use crate::lab::recovered::recoveries::{by_surface, determined};
use crate::lab::uncertainty::certainty::Certainty;
use crate::num::digits::{figure, freedom, significant};
use crate::num::summation::root_mean_square;

/// More hidden surfaces than this are counted, not named.
const MOST_NAMED: usize = 4;
/// An element is light or dark where one of the two has more than this probability.
const DECIDED: f64 = 0.95;

/// A part of the answer.
#[derive(Clone, Debug, PartialEq)]
pub struct Claim {
    /// What it is about, in one to three words.
    pub about: &'static str,
    /// Whether it is good news.
    pub tone: Tone,
    /// The claim with its numbers, without a full stop.
    pub sentence: String,
}

impl Claim {
    fn plain(about: &'static str, sentence: String) -> Self {
        Self {
            about,
            tone: Tone::Plain,
            sentence,
        }
    }
}

/// What a run answers.
#[derive(Clone, Debug)]
pub struct Answer<'a> {
    /// Of each hidden surface the recovery that can be vouched for first; empty where nothing was
    /// recovered.
    pub pictures: Vec<&'a RecoveredObject>,
    /// Hidden, recovered, how sure; without hidden surfaces the first alone.
    pub claims: Vec<Claim>,
    /// Whether the light agrees with the model.
    pub agreement: Claim,
}

impl RunResults {
    /// The answer of the run.
    pub fn answer(&self) -> Answer<'_> {
        let groups = by_surface(&self.recovered);
        let pictures: Vec<&RecoveredObject> = groups.iter().map(|group| group[0]).collect();
        let mut claims = vec![self.hidden(&pictures)];
        if self.scene.hidden().next().is_some() {
            claims.push(recovered(self, &pictures));
        }
        if !pictures.is_empty() {
            claims.push(certainty(&pictures, Certainty::of(&self.plan)));
        }
        Answer {
            agreement: self.agrees(),
            pictures,
            claims,
        }
    }

    fn hidden(&self, pictures: &[&RecoveredObject]) -> Claim {
        let surfaces: Vec<String> = self
            .scene
            .hidden()
            .map(|(_, s)| format!("{}, {} × {} elements", s.name, s.elements[0], s.elements[1]))
            .collect();
        let named = match surfaces.len() {
            0 => "nothing".to_owned(),
            1..=MOST_NAMED => surfaces.join("; "),
            n => format!("{n} surfaces"),
        };
        let unknown = pictures.iter().any(|r| r.truth.is_none());
        let known = match (surfaces.is_empty(), unknown) {
            (true, _) => "",
            (_, true) => "; what is on it is not known",
            (_, false) => "; the scene knows what is on it",
        };
        Claim::plain("hidden", named + known)
    }

    fn agrees(&self) -> Claim {
        let mut sentence = self.verdict();
        let score = self.agreement.as_ref().and_then(|a| a.score.as_ref());
        if let (Some(agreement), Some(score)) = (&self.agreement, score) {
            if !agreement.agrees {
                sentence += &format!(". Most likely: {}", agreement.cause(score));
            }
            sentence += &format!(
                ". It could have missed deviations smaller than these, which it finds 95 times in 100: {}",
                score.detectable()
            );
        }
        Claim {
            about: "agreement",
            tone: self.tone(),
            sentence,
        }
    }
}

fn recovered(results: &RunResults, pictures: &[&RecoveredObject]) -> Claim {
    let sentence = match pictures {
        [] if results.phi.iter().all(|x| *x == 0.0) => {
            "nothing: no light reached the camera".into()
        }
        [] => "nothing".to_owned(),
        [first, ..] => {
            let named = |r: &&RecoveredObject| match pictures.len() {
                1 => distance(r),
                _ => format!("{}, {}", r.surface, distance(r)),
            };
            let each: Vec<String> = pictures.iter().take(MOST_NAMED).map(named).collect();
            format!("by {}: {}", first.method, each.join("; "))
        }
    };
    Claim::plain("recovered", sentence)
}

/// How far a picture is from the truth; without one the range of what was found.
fn distance(r: &RecoveredObject) -> String {
    if let [value] = r.reflectance[..] {
        let error = r.standard_error.as_ref();
        let error = error.map_or(String::new(), |s| format!(" ± {}", significant(s[0], 2)));
        let truth = r.truth.as_ref();
        let truth = truth.map_or(String::new(), |t| {
            format!(", truth {}", significant(t[0], 3))
        });
        return format!("reflectance {}{error}{truth}", significant(value, 3));
    }
    let named = [
        ("root mean square error", r.rmse),
        ("correlation", r.correlation),
        ("raw MTF", r.mtf_raw),
    ];
    let known = named.iter().filter_map(|(name, x)| Some((name, (*x)?)));
    let known: Vec<String> = known
        .map(|(name, x)| format!("{name} {}", figure(x, 3)))
        .collect();
    if !known.is_empty() {
        return known.join(", ");
    }
    let ends = |start, pick: fn(f64, f64) -> f64| r.reflectance.iter().copied().fold(start, pick);
    let [low, high] = [
        ends(f64::INFINITY, f64::min),
        ends(f64::NEG_INFINITY, f64::max),
    ];
    format!(
        "reflectances from {} to {}",
        figure(low, 2),
        figure(high, 2)
    )
}

/// Whether the picture explains the photographs, its error by element, and how much of it the
/// photographs determine.
fn certainty(pictures: &[&RecoveredObject], known: Certainty) -> Claim {
    let first = pictures[0];
    let (tone, fit) = match &first.fit {
        None => (
            Tone::Plain,
            "whether it fits the photographs CANNOT BE JUDGED".to_owned(),
        ),
        Some(fit) => {
            let numbers = format!(
                "χ²/dof {} over {} degrees of freedom, P {}",
                significant(fit.chi2_per_dof, 4),
                freedom(fit.dof),
                figure(fit.p, 2)
            );
            let (tone, words) = match (fit.fits, first.contradicted()) {
                (true, _) if fit.is_blind() => (
                    Tone::Plain,
                    "whether it fits the photographs CANNOT BE JUDGED",
                ),
                (true, false) if fit.is_open() => (
                    Tone::Plain,
                    "whether it fits the photographs CANNOT BE TOLD",
                ),
                (true, false) => (Tone::Good, "it fits the photographs"),
                (_, true) => (
                    Tone::Bad,
                    "it DOES NOT FIT the photographs, nor does any other",
                ),
                (false, false) => (Tone::Bad, "it DOES NOT FIT the photographs"),
            };
            (tone, format!("{words}: {numbers}"))
        }
    };
    let mut sentence = format!("{fit}. {}", error(pictures, known));
    sentence += determined(pictures).trim_end_matches('.');
    let warnings: usize = first.warnings.len();
    if warnings > 0 {
        let them = if warnings == 1 {
            "One warning"
        } else {
            "Warnings"
        };
        sentence += &format!(". {them} below");
    }
    Claim {
        about: "how sure",
        tone,
        sentence,
    }
}

/// The standard errors of all elements; of pictures of two values how many elements are decided.
fn error(pictures: &[&RecoveredObject], known: Certainty) -> String {
    let errors = pictures.iter().filter_map(|r| r.standard_error.as_ref());
    let (errors, unbounded): (Vec<f64>, Vec<f64>) =
        errors.flatten().copied().partition(|s| s.is_finite());
    let light = pictures.iter().filter_map(|r| r.light.as_ref());
    let light: Vec<f64> = light.flatten().copied().collect();
    let patterns = pictures.iter().filter_map(|r| r.patterns.as_ref());
    let mut supposed = patterns.map(|patterns| format!(" if {}", beforehand(patterns)));
    let supposed = supposed.next().unwrap_or_default();
    let mut told = Vec::new();
    if !errors.is_empty() {
        let most = errors.iter().copied().fold(0.0, f64::max);
        told.push(format!(
            "standard error {} an element (root mean square), {} at most",
            figure(root_mean_square(&errors), 2),
            figure(most, 2)
        ));
    }
    if !unbounded.is_empty() {
        told.push(format!(
            "no finite standard error of {} elements, which the photographs do not determine",
            unbounded.len()
        ));
    }
    if !light.is_empty() {
        let decided = light
            .iter()
            .filter(|p| **p > DECIDED || **p < 1.0 - DECIDED);
        told.push(format!(
            "{} of {} elements light or dark with more than {}\u{a0}% probability{supposed}",
            decided.count(),
            light.len(),
            100.0 * DECIDED
        ));
    }
    if told.is_empty() {
        let why = known.shared().map_or(String::new(), |[which, cure]| {
            format!(", for the errors of this render hang together: {which}. {cure} for them")
        });
        return format!("It states no error for an element{why}. ");
    }
    let told = told.join("; ");
    let mut letters = told.chars();
    let first = letters.next().map(|c| c.to_uppercase().to_string());
    format!("{}{}. ", first.unwrap_or_default(), letters.as_str())
}

impl Describe for Answer<'_> {
    /// The claims, one below the other.
    fn describe(&self) -> Finding {
        let rows = self.claims.iter().chain([&self.agreement]);
        Finding {
            tone: self.agreement.tone,
            tables: vec![facts(rows.map(|c| (c.about, c.sentence.clone())))],
            ..Finding::default()
        }
    }
}

#[cfg(test)]
#[path = "answer_tests.rs"]
mod tests;
