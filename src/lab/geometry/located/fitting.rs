//! Whether noise alone leaves what the likeliest reflectances at the place do not explain.
//!
//! Of photographs whose noise is stated, with weights w,
//!
//! > χ² = Σ z²,   z = √w (Φ − Aρ̂ − other light),   of n − Σ_i μ_i/(μ_i + λ) − 1 degrees of freedom,
//!
//! refutes the place below the probability at which a calibration is refuted, unless it does not by
//! the entries less what the last steps of the model's integrals move ([`Factors::moved`]).

use super::LocatedPlan;
use super::frames::Seen;
use super::likelihood::Spectrum;
use super::place::{Lengths, frames_of, likeliest_length};
use crate::lab::comparison::evidence::FIT_LEVEL;
use crate::lab::error::LabError;
use crate::lab::recovered::fit::Fit;
use crate::matrix::Matrix;
use crate::model::Factors;
use crate::num::linalg::LinalgError;
use crate::scene::Scene;

impl LocatedPlan {
    /// The fit of the likeliest reflectances of `scene`; none where no noise is stated.
    pub(super) fn fit(
        &self,
        scene: &Scene,
        seen: Seen<'_>,
        lengths: &Lengths,
    ) -> Result<Option<Fit>, LabError> {
        let (of, known) = (&seen.photographs, seen.photographs.certainty);
        if of.stderr.is_none() {
            return Ok(None);
        }
        let model = self.model(scene)?;
        let all = frames_of(&model, seen)?.all();
        let Some((likeliest, root)) = likeliest_length(&all, &lengths.roots)? else {
            return Ok(None);
        };
        let Some(picture) = Spectrum::new(&all, root)? else {
            return Ok(None);
        };
        let rho = picture.rho(likeliest.lambda);
        let [left, roots] = left_over(seen, &model.phi_of(rho.as_slice()))?;
        let dof = (all.count - picture.freedom(likeliest.lambda) - 1.0).max(1.0);
        let by_noise = |left: &Matrix| known.by_noise(left.norm_squared(), dof);
        let is_refuted = by_noise(&left) < FIT_LEVEL;
        let steps = |own: &&Factors| is_refuted && !own.steps.is_empty();
        let within = model.factors.as_ref().filter(steps).map(|own| {
            let off = own.bound(rho.as_slice()).component_mul(&roots);
            left.zip_map(&off, |x, off| x - x.clamp(-off, off))
        });
        let entries = of.counted();
        Ok(Some(Fit {
            chi2_per_dof: left.norm_squared() / dof,
            dof,
            p: by_noise(&left),
            entries,
            left_out: left.len() - entries,
            level: FIT_LEVEL,
            fits: by_noise(within.as_ref().unwrap_or(&left)) >= FIT_LEVEL,
            within_integration: within.map(|rest| rest.norm_squared() / dof),
            outlier: None,
            pooled: known.pooled(),
            neighbours: None,
            with_light: None,
        }))
    }
}

/// What this `light`, pixels × spots, W, and other light leave, and √w. Without other light counts
/// have the errors of this light, not those of their noisy entries.
fn left_over(seen: Seen<'_>, light: &Matrix) -> Result<[Matrix; 2], LinalgError> {
    let of = &seen.photographs;
    let is_alone = of.patterns.is_none() && seen.common.is_none();
    let (mut left, mut roots) = (Vec::new(), light.clone());
    for l in 0..of.phi.ncols() {
        let shape = light.column(l).into_owned();
        let rest = of.phi.columns(l, 1) - light.columns(l, 1);
        let own = if is_alone {
            of.roots_of(l, &shape)
        } else {
            of.roots(l)
        };
        roots.set_column(l, &own);
        left.push(if is_alone {
            rest.component_mul(&roots.columns(l, 1))
        } else {
            of.whitening(l)?.apply(&rest)
        });
    }
    if let Some(common) = seen.common {
        common.take_out(&mut left.iter_mut().collect::<Vec<_>>());
    }
    let left: Vec<_> = left.iter().map(|own| own.column(0)).collect();
    Ok([Matrix::from_columns(&left), roots])
}
