//! What a model of a scene is tested on.

use std::borrow::Cow;
use std::sync::OnceLock;

use super::agreement::{Agreement, agree};
use super::evidence::{Evidence, Test};
use super::gains::Gains;
use super::measured::{Measured, ValidationError};
use super::other_light::Left;
use super::score::Derivatives;
use super::seldom::Seldom;
use crate::lab::uncertainty::certainty::{Certainty, FOLLOWS_ENTRIES};
use crate::lab::uncertainty::counted::Counted;
use crate::lab::uncertainty::refined::Refined;
use crate::matrix::Matrix;
use crate::model::{Kernel, ModelError};
use crate::num::statistics::sidak_threshold;
use crate::recovery::{Nuisance, RecoveryError};
use crate::scene::Scene;

/// Replicates from which errors are known well enough for deviations of the scene to be fitted.
pub(in crate::lab) const FEWEST: u32 = 6;

/// What of a scene its model is tested by, the same for every model of it.
pub(in crate::lab) struct Basis<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// Kernel of the model.
    pub kernel: Kernel,
    /// What the model may be off by, pixels × spots, W.
    pub bound: &'a Matrix,
    /// What of each entry is visible, where something stands in the way.
    pub share: Option<&'a Matrix>,
    /// What may be off in the scene.
    pub derivatives: Derivatives<'a>,
}

/// Photographs with what models are tested by.
pub(in crate::lab) struct Grounds<'a> {
    basis: &'a Basis<'a>,
    measured: Measured<'a>,
    refined: Refined<'a>,
    test: Test,
    seldom: OnceLock<Result<Option<Seldom>, ModelError>>,
}

impl<'a> Grounds<'a> {
    /// Standard errors from few replicates are pooled over pixels and spots where these say more;
    /// those of counts are by the light of each model.
    pub(in crate::lab) fn new(basis: &'a Basis<'a>, measured: Measured<'a>, test: Test) -> Self {
        let left_out = measured.beside.left_out;
        let refined = Refined::of(measured.phi, measured.stderr, test.known, left_out);
        let known = refined.certainty;
        Self {
            basis,
            measured,
            refined,
            test: Test { known, ..test },
            seldom: OnceLock::new(),
        }
    }

    /// The verdict on a model, W, and z of every entry. Where it is refused, and something stands
    /// in the way, with an allowance for shadows that few paths meet.
    ///
    /// # Errors
    /// [`ValidationError`].
    pub(in crate::lab) fn verdict(
        &self,
        model: &Matrix,
    ) -> Result<(Agreement, Matrix), ValidationError> {
        let stderr = self.stderr(model);
        let (mut agreement, mut z) = self.by(&stderr, model)?;
        if let (true, false, Some(share)) = (agreement.evidence, agreement.agrees, self.basis.share)
        {
            let of = || Seldom::new(self.basis.scene, self.basis.kernel, share, self.test.known);
            if let Some(seldom) = self.seldom.get_or_init(of).as_ref().map_err(Clone::clone)? {
                let (stderr, entries) = seldom.added_to(&stderr, model);
                if entries > 0 {
                    (agreement, z) = self.by(&stderr, model)?;
                    agreement.seldom = entries;
                }
            }
        }
        agreement.pooled = self.test.known.pooled();
        if self.test.known.follows_entries {
            agreement.unmodelled.push(FOLLOWS_ENTRIES.to_owned());
        }
        Ok((agreement, z))
    }

    /// Standard errors, W, by this model: those of counts are of its light, of counts of none too.
    fn stderr(&self, model: &Matrix) -> Cow<'_, Matrix> {
        let Measured { phi, beside, .. } = self.measured;
        let given = self.refined.stderr.as_ref();
        match self.test.known.counted.filter(|_| !beside.estimates()) {
            Some(counted) => Cow::Owned(counted.law.stderrs(model, (phi, given))),
            None => Cow::Borrowed(given),
        }
    }

    /// The verdict by standard errors, W.
    fn by(&self, stderr: &Matrix, model: &Matrix) -> Result<(Agreement, Matrix), ValidationError> {
        let Measured { phi, beside, .. } = self.measured;
        let evidence = Evidence {
            traced: phi,
            stderr,
            model,
            bound: Some(self.basis.bound),
            left_out: beside.left_out,
            eliminated: None,
        };
        // Below, a variance has no variance itself, and no fit a known error.
        let replicates = self.test.known.replicates;
        let derivatives = replicates.is_none_or(|n| n >= FEWEST);
        let derivatives = derivatives.then_some(&self.basis.derivatives);
        if beside.estimates() {
            return beside_other_light(evidence, self.test, &beside, derivatives);
        }
        let counts = (0..phi.len()).filter(|at| evidence.counts(*at));
        let of_model = |own: Counted| Counted::new(own.law, counts.map(|at| &stderr[at]));
        let known = Certainty {
            counted: self.test.known.counted.and_then(of_model),
            ..self.test.known
        };
        Ok(agree(evidence, Test { known, ..self.test }, derivatives))
    }
}

/// Agreement of the model with what is left of light when what is beside it was fitted and taken
/// out.
fn beside_other_light(
    evidence: Evidence<'_>,
    test: Test,
    beside: &Nuisance<'_>,
    derivatives: Option<&Derivatives<'_>>,
) -> Result<(Agreement, Matrix), ValidationError> {
    // An entry without a known error has no weight in a fit.
    let counts = |at: usize| evidence.counts(at) && evidence.stderr[at] > 0.0;
    let (rows, columns) = evidence.model.shape();
    let flags = Matrix::from_fn(rows, columns, |p, l| {
        f64::from(u8::from(!counts(p + l * rows)))
    });
    let evidence = Evidence {
        left_out: Some(&flags),
        ..evidence
    };
    if !flags.iter().any(|flag| *flag == 0.0) {
        return Ok(agree(evidence, test, None));
    }
    let Left {
        phi,
        stderr,
        scale,
        other,
        gains,
        eliminated,
    } = Left::of(&evidence, test, beside)?.ok_or(RecoveryError::TakenUp)?;
    let unseen = scale.is_some_and(|[_, _, z]| z <= sidak_threshold(test.significance, 1));
    let nothing = Matrix::from_element(rows, columns, 1.0);
    let left = Evidence {
        traced: &phi,
        stderr: &stderr,
        left_out: Some(if unseen { &nothing } else { &flags }),
        eliminated: Some(&eliminated),
        ..evidence
    };
    let known = Certainty {
        counted: test
            .known
            .counted
            .map(|own| own.over(scale.map_or(1.0, |s| s[0]))),
        ..test.known
    };
    let (mut agreement, z) = agree(left, Test { known, ..test }, derivatives);
    agreement.other_light = other;
    agreement.gains = gains.as_ref().map(Gains::of);
    if let Some([s, stderr, _]) = scale {
        (agreement.best_scale, agreement.best_scale_stderr) = (s, stderr);
    }
    Ok((agreement, z))
}
