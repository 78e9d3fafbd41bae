//! A recovered surface.

use serde::Serialize;

use crate::lab::recovered::chosen::{Beside, Chosen};
use crate::lab::recovered::fit::Fit;
use crate::matrix::Matrix;
use crate::recovery::{Patterns, Solver};

/// A recovered hidden surface.
#[derive(Clone, Debug, Serialize)]
pub struct RecoveredObject {
    /// Name of the hidden surface.
    pub surface: String,
    /// Method.
    pub method: String,
    /// Elements along u and v.
    pub elements: [usize; 2],
    /// Recovered reflectance of element iu + iv·nu.
    pub reflectance: Vec<f64>,
    /// True albedo of the elements; absent, as all that is measured against it, where the scene
    /// does not know it.
    pub truth: Option<Vec<f64>>,
    /// (White − Black)/(White + Black); absent if the truth has no contrast.
    pub mtf_raw: Option<f64>,
    /// The same after stretching the recovered values to [0, 1].
    pub mtf_normalized: Option<f64>,
    /// Pearson correlation with the truth.
    pub correlation: Option<f64>,
    /// Root mean square error against the truth; with a free scale both in units of their brightest
    /// element.
    pub rmse: Option<f64>,
    /// Parameter used and why, in words.
    pub parameter: String,
    /// The same in numbers.
    pub choice: Chosen,
    /// How the solver ended; absent where none iterates.
    pub solver: Option<Solver>,
    /// What was estimated beside the reflectances; absent where nothing was asked for.
    pub estimated: Option<Beside>,
    /// Of the picture that is expected to be the nearest to the truth, which assumption makes the
    /// photographs likelier, and by how much; absent of the other methods.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub likelier: Option<String>,
    /// ln of how likely its method's assumption makes the photographs, over the numbers that fit
    /// them best; absent for methods that do not know.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub log_evidence: Option<f64>,
    /// Probability of each element to be light, of `joint-two-valued`, by what its picture goes by
    /// ([`Patterns::assumed`]).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub light: Option<Vec<f64>>,
    /// Mean of each element's level over all patterns of `joint-two-valued` where neighbours may be
    /// alike, and the standard deviation about it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub alike: Option<[Vec<f64>; 2]>,
    /// What is known of pattern and levels, all surfaces together.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub patterns: Option<Patterns>,
    /// Bands around the reflectances, where they were asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bands: Option<ObjectBands>,
    /// Standard error of each reflectance; absent without a noise model and under bounds.
    pub standard_error: Option<Vec<f64>>,
    /// What regularisation alone adds to the truth, (R − 1) ρ with ρ the scene's; absent under
    /// bounds and with a free scale.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bias: Option<Vec<f64>>,
    /// Directions that the method resolves: trace of its resolution matrix.
    pub effective_rank: f64,
    /// How many of the elements of all surfaces the photographs determine at their noise, whatever
    /// the method; absent where the noise is not known.
    pub determined: Option<f64>,
    /// Share of each element that they determine, 0 to 1
    /// ([`recovery::determined`](crate::recovery::determined())); absent
    /// likewise.
    pub determined_share: Option<Vec<f64>>,
    /// Elements of all surfaces.
    pub unknowns: usize,
    /// Whether all surfaces together explain the photographs; absent where that cannot be judged.
    pub fit: Option<Fit>,
    /// The same of the best reflectances between 0 and 1 that there are: whether photographs and
    /// model belong together, whatever the method. Absent where it is not known.
    pub best_fit: Option<Fit>,
    /// What speaks against believing it, each with its cure.
    pub warnings: Vec<String>,
    /// Covariance of its elements (rows) with those of all hidden surfaces (columns, in file
    /// order).
    #[serde(skip)]
    pub covariance: Option<Matrix>,
    /// Its rows of the resolution matrix: what each of its elements shows of the elements of all
    /// hidden surfaces.
    #[serde(skip)]
    pub resolution: Option<Matrix>,
}

/// Intervals of the elements of a recovered surface.
#[derive(Clone, Debug, Serialize)]
pub struct ObjectBands {
    /// Probability that each alone shall cover.
    pub confidence: f64,
    /// What they are: `gaussian`, each element alone, or `simultaneous`, all elements together.
    pub kind: String,
    /// Lower limits.
    pub lower: Vec<f64>,
    /// Upper limits.
    pub upper: Vec<f64>,
}

impl RecoveredObject {
    /// Whether the photographs refute the model: no reflectances between 0 and 1 explain them.
    pub fn contradicted(&self) -> bool {
        self.best_fit.as_ref().is_some_and(|best| !best.fits)
    }

    /// What is known of each element beside its reflectance, with its name.
    #[cfg(feature = "cli")]
    pub(crate) fn beside_it(&self) -> Vec<(&'static str, &Vec<f64>)> {
        let alike = self.alike.as_ref();
        let [mean, error] = [0, 1].map(|k| alike.map(|alike| &alike[k]));
        [
            ("standard error", self.standard_error.as_ref()),
            ("probability to be light", self.light.as_ref()),
            ("mean where neighbours may be alike", mean),
            ("standard error of that mean", error),
        ]
        .into_iter()
        .filter_map(|(name, values)| Some((name, values?)))
        .collect()
    }
}
