//! What is asked of the dual image.

use super::judged::{Judged, Origin, SHOWN, Way};
use super::reciprocity::{Reciprocity, SIGNIFICANCE};
use super::spectrum::participation;
use crate::lab::Agreement;
use crate::lab::check::Check;
use crate::recovery::Method;

/// A picture has recovered the board where its raw MTF is at least so large.
const RECOVERED: f64 = 0.9;

fn in_words(a: &Agreement) -> String {
    format!(
        "χ²/dof {:.4} over {} entries, largest |z| {:.2} of {:.2} allowed, best scale {:.5}",
        a.chi2_per_dof, a.entries, a.largest_z, a.z_limit, a.best_scale
    )
}

pub(super) fn checks(
    law: &Reciprocity,
    pictures: &[Judged; 3],
    found: &[Judged],
    traced: &[f64],
) -> Vec<Check> {
    let list = |j: &[&Judged]| j.iter().map(|j| j.line()).collect::<Vec<_>>().join("; ");
    let unseen = |what, pictures: &[&Judged]| {
        let criterion = format!("no |correlation| with the board is {SHOWN} or more");
        let holds = !pictures.iter().any(|j| j.shows());
        Check::trend(what, "–", list(pictures), criterion, holds)
    };
    let photographs: Vec<&Judged> = pictures.iter().collect();
    let transposed: Vec<&Judged> = found.iter().filter(|j| j.way == Way::Transpose).collect();
    // The noise of the trace is far above what `pinv` survives: without noise it is judged.
    let inverse = |j: &&Judged| match j.way {
        Way::Inverse(Method::Pinv) => j.origin == Origin::Modelled,
        Way::Inverse(_) => true,
        _ => false,
    };
    let inverses: Vec<&Judged> = found.iter().filter(inverse).collect();
    let recovered = |j: &&Judged| {
        j.shows()
            && j.measures
                .mtf_raw
                .is_some_and(|m| (RECOVERED..=1.0).contains(&m))
    };
    let limit = format!("at a significance of {SIGNIFICANCE}, by the joint standard errors");
    let told = [&law.untransposed, &law.scaleless];
    vec![
        Check::claim(
            "Tᵀ against the render with projector and camera exchanged, entry by entry",
            "c′ = T p′, c″ = Tᵀ p″",
            in_words(&law.entries),
            format!("T[p,l]/E_p = T′[l,p]/E′_l {limit}"),
            law.entries.agrees,
        ),
        Check::claim(
            "the dual image under light on every pixel against the photograph of the exchanged pair",
            "c″ = Tᵀ p″",
            in_words(&law.pictures),
            format!("the sums over the camera's pixels agree {limit}"),
            law.pictures.agrees,
        ),
        Check::trend(
            "the same test on T′ not transposed, and on Tᵀ without étendues",
            "–",
            format!(
                "χ²/dof {:.1} and {:.1}",
                law.untransposed.chi2_per_dof, law.scaleless.chi2_per_dof
            ),
            "both are rejected, so the test is able to fail",
            told.iter().all(|a| !a.agrees),
        ),
        unseen("the hidden board in primal and dual image", &photographs),
        unseen("the transpose in place of the inverse", &transposed),
        Check::trend(
            "the inverse, from the same T",
            "–",
            list(&inverses),
            format!(
                "the board is recovered by `joint` from both, by `pinv` from the noiseless one: raw MTF at least {RECOVERED}"
            ),
            inverses.iter().all(recovered),
        ),
        Check::trend(
            "T Tᵀ is not the identity",
            "–",
            format!(
                "of {} singular values the second is {:.1e} of the first; (Σσ²)²/Σσ⁴ = {:.4}",
                traced.len(),
                traced[1],
                participation(traced)
            ),
            format!(
                "(Σσ²)²/Σσ⁴ below 2; it would be {} if the transpose were the inverse",
                traced.len()
            ),
            participation(traced) < 2.0,
        ),
    ]
}
