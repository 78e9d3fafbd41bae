//! Items with traced Φcam in place of the modelled one.

use serde::{Deserialize, Serialize};

use super::figure::{computed, elements, linear};
use super::traced::{AS_RENDERED, NAMES, Recovery, Traced};
use super::{FigureAxis, FigureCurve, Gallery, Plot, ReproduceError, Shades, Watch};
use crate::model::Published;

/// A board is told where its normalized MTF is at least this.
const TOLD: f64 = 0.5;

/// What is traced: name of its curve, place on it, geometry, checks a side.
pub(super) struct Case {
    pub(super) curve: &'static str,
    pub(super) x: f64,
    pub(super) published: Published,
    pub(super) checks: usize,
}

/// A case, recovered from each light.
#[derive(Debug, Serialize, Deserialize)]
pub struct Trial {
    pub(super) rank: usize,
    /// The last singular value that is kept, and the first that is not, over the cut.
    pub(super) around: [f64; 2],
    /// σ1 over the last that is kept.
    condition: f64,
    /// How far the traced mean is from the model, relative.
    difference: f64,
    /// In the order of [`NAMES`].
    pub(super) found: Vec<Recovery>,
}

/// Traces and recovers a case.
pub(super) fn trial(case: &Case, watch: Watch<'_>) -> Result<Trial, ReproduceError> {
    let traced = Traced::new(&case.published, case.checks, AS_RENDERED, watch)?;
    let (inverse, found) = traced.recovered(&case.published.board(case.checks))?;
    let sigma = |k: usize| inverse.sigma.get(k).copied().unwrap_or(0.0);
    let last = sigma(inverse.rank.saturating_sub(1));
    Ok(Trial {
        rank: inverse.rank,
        around: [last, sigma(inverse.rank)].map(|s| s / inverse.cutoff),
        condition: sigma(0) / last,
        difference: traced.difference(),
        found,
    })
}

impl Trial {
    /// Whether it may be one of `case`.
    pub(super) fn fits(&self, case: &Case) -> bool {
        let elements = case.published.elements * case.published.elements;
        let whole = |r: &Recovery| r.outcome.values.len() == elements;
        self.found.len() == NAMES.len() && self.found.iter().all(whole)
    }
}

/// Normalized MTF of every light over `across`.
pub(super) fn plot(trials: &[(Case, Trial)], across: FigureAxis) -> Plot {
    let mut names: Vec<&str> = trials.iter().map(|(case, _)| case.curve).collect();
    names.dedup();
    let curve = |light: usize, name: &str| -> FigureCurve {
        let own = trials.iter().filter(|(case, _)| case.curve == name);
        let points = own.filter_map(|(case, t)| Some([case.x, t.found[light].outcome.normalized?]));
        computed(format!("{}, {name}", NAMES[light]), points.collect())
    };
    Plot {
        title: "traced in place of modelled Φ, physical kernel".to_owned(),
        axes: [across, linear("normalized MTF", [-0.4, 1.0])],
        curves: (0..NAMES.len())
            .flat_map(|light| names.iter().map(move |name| (light, *name)))
            .map(|(light, name)| curve(light, name))
            .collect(),
    }
}

/// What both traced lights come to at the places `shown`.
pub(super) fn gallery(trials: &[(Case, Trial)], shown: &[f64]) -> Gallery {
    let own = trials.iter().filter(|(case, _)| shown.contains(&case.x));
    let of = |(case, t): &(Case, Trial)| {
        let picture = |light: usize| {
            let title = format!("{} in., {}, {}", case.x, case.curve, NAMES[light]);
            let values = t.found[light].outcome.stretched();
            elements(title, case.published.elements, values)
        };
        [2, 3].map(picture)
    };
    Gallery {
        title: "Recovered from traced Φ, physical kernel, stretched to [0, 1]".to_owned(),
        shades: Shades::Reflectance,
        unit: String::new(),
        pictures: own.flat_map(of).collect(),
    }
}

/// What becomes of the recovery, and of what.
pub(super) fn words(trials: &[(Case, Trial)]) -> String {
    let told = |light: usize| {
        let mtf = |(_, t): &&(Case, Trial)| t.found[light].outcome.normalized;
        trials.iter().filter(|t| mtf(t) >= Some(TOLD)).count()
    };
    let most = |f: fn(&Trial) -> f64| trials.iter().map(|(_, t)| f(t)).fold(0.0, f64::max);
    format!(
        "Traced in place of modelled Φ: of {} cases {} reach a normalized MTF of {TOLD} with Φ modelled for the footprints' centres, {} with the noise of the render put on it, \
         {} with the mean of the trace and {} with Φ as rendered. The mean is up to {:.1e} of Φ away from the model, which takes elements at their centres, \
         with a standard error of up to {:.1e}; the noise of the render is up to {:.1e}. The inverse multiplies both by up to σ1/σk = {:.1e}.",
        trials.len(),
        told(0),
        told(1),
        told(2),
        told(3),
        most(|t| t.difference),
        most(|t| t.found[2].noise),
        most(|t| t.found[3].noise),
        most(|t| t.condition)
    )
}
