//! Whether what is left over at the place looks like light that the model leaves out.
//!
//! Light S a, of patterns S that all frames share and sizes a that nothing says, picture and place
//! following, would change the cost by −½ gᵀF⁻¹g. With B = ∂Aρ̂/∂t, all whitened, and Σ the
//! covariance of the picture, F and g are what B leaves of
//!
//! > (S, B)ᵀ(S, B) − (S, B)ᵀA Σ Aᵀ(S, B),   (S, B)ᵀ(y − Aρ̂),
//!
//! and without such light gᵀF⁻¹g is χ² (score test, Rao 1948). A place that takes such light up is
//! off by many of its errors, and fits.

use super::LocatedPlan;
use super::frames::{Seen, TermsOf};
use super::likelihood::Spectrum;
use super::place::{Lengths, frames_of, likeliest_length};
use crate::lab::comparison::misplaced::Misplaced;
use crate::lab::comparison::over_view::{PATTERNS, over_view};
use crate::lab::error::LabError;
use crate::lab::geometry::light_left_out::{LightLeftOut, Neighbours};
use crate::lab::uncertainty::certainty::Errors;
use crate::matrix::Matrix;
use crate::model::MatrixModel;
use crate::num::linalg::{LinalgError, product, tr_product};
use crate::scene::Scene;

impl LocatedPlan {
    /// Each kind of pattern at `size` against what is left of photographs whose errors are each
    /// entry's own, and not less the means of the frames; in units of what is left, and of how
    /// its noise varies, where none is stated; and the correlation of what is left of neighbours.
    /// Sizes so far off give ∂A/∂t: nothing is said where the scene does not allow them.
    pub(super) fn light_left_out(
        &self,
        (scene, altered): (&Scene, &Misplaced),
        (size, off): (f64, f64),
        seen: Seen<'_>,
        lengths: &Lengths,
    ) -> Result<(Vec<LightLeftOut>, Option<f64>), LabError> {
        let is_own = seen.photographs.certainty.errors == Errors::Independent;
        if seen.common.is_some() || !is_own {
            return Ok((Vec::new(), None));
        }
        let mut models = Vec::new();
        for size in [size - off, size, size + off] {
            let there = altered.apply(scene, size).map(|there| self.model(&there));
            models.extend(there.transpose()?);
        }
        let [before, here, behind] = &models[..] else {
            return Ok((Vec::new(), None));
        };
        let models = [before, here, behind];
        Ok(light(
            seen,
            (models, 2.0 * off),
            lengths,
            scene.camera.columns,
        )?)
    }
}

/// Of the model at the place, and those a little before and behind it, `apart`; `columns` of the
/// camera.
fn light(
    seen: Seen<'_>,
    ([before, here, behind], apart): ([&MatrixModel; 3], f64),
    lengths: &Lengths,
    columns: usize,
) -> Result<(Vec<LightLeftOut>, Option<f64>), LinalgError> {
    let of = &seen.photographs;
    let all = frames_of(here, seen)?.all();
    let Some((fit, root)) = likeliest_length(&all, &lengths.roots)? else {
        return Ok((Vec::new(), None));
    };
    let Some(picture) = Spectrum::new(&all, root)? else {
        return Ok((Vec::new(), None));
    };
    let rho = picture.rho(fit.lambda);
    let light = here.phi_of(rho.as_slice());
    let moved = (behind.phi_of(rho.as_slice()) - before.phi_of(rho.as_slice())) / apart;
    let own: Vec<usize> = (0..rho.len()).collect();
    let terms = TermsOf::of(here, &own).lit(&(0..of.phi.ncols()).collect::<Vec<_>>());
    let mut f = Matrix::zeros(PATTERNS + 1, PATTERNS + 1);
    let mut of_picture = Matrix::zeros(rho.len(), PATTERNS + 1);
    let mut score = Matrix::zeros(PATTERNS + 1, 1);
    let mut whole = [0.0; PATTERNS];
    let mut neighbours = Neighbours::new(PATTERNS, of.counted() as f64);
    for l in 0..of.phi.ncols() {
        let shape = light.columns(l, 1).into_owned();
        let s = over_view(&shape, columns);
        let roots = of.roots(l);
        for (k, whole) in whole.iter_mut().enumerate() {
            *whole += s.column(k).component_mul(&roots).norm_squared();
        }
        let mut s = s.insert_column(PATTERNS, 0.0);
        s.set_column(PATTERNS, &moved.column(l));
        let white = of.whitening(l)?;
        let s = white.apply(&s);
        let left = white.apply(&(of.phi.columns(l, 1) - shape));
        neighbours.add(&s.columns(0, PATTERNS).into_owned(), &left);
        f += tr_product(&s, &s);
        of_picture += tr_product(&white.apply(&terms.frame(l, rho.len())), &s);
        score += tr_product(&s, &left);
    }
    let towards = tr_product(&picture.spread(fit.lambda), &of_picture);
    f -= tr_product(&towards, &towards);
    let of_place = f.columns(PATTERNS, 1).into_owned();
    let place = &of_place / f[(PATTERNS, PATTERNS)].max(f64::MIN_POSITIVE);
    f -= product(&of_place, &place.transpose());
    score -= &place * score[PATTERNS];
    let unit = fit.noise * fit.noise * neighbours.inflation();
    let unit = of.stderr.map_or(unit, |_| 1.0);
    let left = (&(f / unit), &(score / unit), &whole.map(|x| x / unit)[..]);
    let light = LightLeftOut::of(left, |chi2, dof| of.certainty.by_noise(chi2, dof));
    Ok((light, neighbours.correlation()))
}
