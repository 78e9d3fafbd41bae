//! Which deviation of the scene explains the difference? Rao's score test on the model's
//! derivatives, a parameter at a time.
//!
//! Each is fitted as a [`Residual`] says, and its θ̂ over its error tested.
//!
//! Where other light or the scale was fitted first ([`Eliminated`](super::eliminated::Eliminated)),
//! d is what that leaves of ∂model/∂θ.
//!
//! The likeliest causes of a difference are then followed as far as the model bends, and where the
//! picture is unknown it is fitted beside them ([`picture`]).

mod deviation;
mod followed;
mod likely;
mod picture;

use std::borrow::Cow;
use std::ops::Range;

use serde::{Deserialize, Serialize};

use super::evidence::{Evidence, Test};
use super::residual::{Residual, Weights};
use crate::matrix::Matrix;
use crate::num::statistics::{normal_two_sided, sidak_p, sidak_threshold};
pub use deviation::{Derivatives, Deviation, Parameter};
pub(super) use likely::Remaining;
use likely::{Causes, whole};
pub use picture::{ElementLight, PictureFit};

/// All parameters, each fitted alone.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Score {
    /// |z| that the parameters of the scene may have, and those of single spots.
    pub limits: [f64; 2],
    /// Parameters of the scene.
    pub deviations: Vec<Deviation>,
    /// Parameters of single spots.
    pub spots: Vec<Deviation>,
    /// The most likely cause first: of the parameters beyond their limits, and within what a scene
    /// can have, the one that leaves the least χ², the best few followed to where they leave it.
    /// Then all that explain the difference as well, after whose fit the first is not missed at
    /// 1 %.
    pub likely: Vec<Deviation>,
    /// The picture of a refused model, if it is unknown: all its reflectances fitted together.
    #[serde(default)]
    pub picture: Option<PictureFit>,
    /// Parameters that change nothing or that the scene does not allow.
    pub untested: Vec<String>,
    /// Whether all were fitted as if shadows stayed where they are: those of spheres, meshes and on
    /// curved surfaces are not followed.
    #[serde(default)]
    pub shadows_stay: bool,
}

/// What is not tested of measured light: the picture is taken as the scene has it, and light goes
/// by the square of a spot's size, which has no slope at a point.
pub(in crate::lab) const SIZE_OF_SPOTS: &str = "whether the spots, taken for points, have a size";
pub(in crate::lab) const SINGLE_ELEMENTS: &str = "the reflectance of single elements";

impl Score {
    /// Whether a parameter is beyond its limit.
    pub fn rejects(&self) -> bool {
        self.all().any(|d| self.is_beyond(d))
    }

    fn all(&self) -> impl Iterator<Item = &Deviation> {
        self.deviations.iter().chain(&self.spots)
    }

    fn is_beyond(&self, d: &Deviation) -> bool {
        d.z.abs() > self.limits[usize::from(d.spot.is_some())]
    }
}

/// Share of the significance level of each family: the scene's parameters, and the spots'.
const FAMILIES: f64 = 0.5;

/// Sizes that are tried, each so many times the last at most, until as much as this of what the
/// straight model needs is fitted of it.
const TRIES: usize = 6;
const MOST_LARGER: f64 = 8.0;
const ENOUGH: f64 = 0.97;

/// Fits every parameter, at `significance` for all together.
pub(super) fn score(
    evidence: Evidence<'_>,
    test: Test,
    significance: f64,
    derivatives: &Derivatives<'_>,
    remaining: Remaining<'_>,
) -> Score {
    let residual = Residual::new(evidence, test, Weights::Least);
    let spots = evidence.model.ncols();
    let parameters = derivatives.parameters;
    let single = parameters.iter().filter(|p| p.each_spot.is_some()).count() * spots;
    let share = [FAMILIES, 1.0 - FAMILIES].map(|f| f * significance);
    let mut found = Score {
        limits: [
            sidak_threshold(share[0], parameters.len() as u64),
            sidak_threshold(share[1], single as u64),
        ],
        ..Score::default()
    };
    let of: Vec<Option<Matrix>> = (0..parameters.len()).map(|k| (derivatives.of)(k)).collect();
    for (index, (parameter, d)) in parameters.iter().zip(&of).enumerate() {
        let fit = |spot: Option<usize>, limit: f64, family: usize, name: &str| {
            let (d, columns) = left_of(&evidence, d.as_ref()?, spot)?;
            let fit = residual.fit(&d, &columns)?;
            Some(Deviation {
                name: name.to_owned(),
                unit: parameter.unit.clone(),
                value: fit.value,
                stderr: fit.stderr,
                bias: fit.bias,
                z: fit.z(),
                p: sidak_p(normal_two_sided(fit.z()), family as u64),
                detectable: fit.detectable(limit),
                reach: parameter.reach,
                chi2_per_dof: if derivatives.are_named {
                    (remaining.after)(fit.value, &d, &columns)
                } else {
                    f64::NAN
                },
                // Albedos act on all photographs.
                same: spot.map_or_else(|| parameter.same.clone(), |_| Vec::new()),
                spot,
                is_followed: false,
            })
        };
        match fit(None, found.limits[0], parameters.len(), &parameter.name) {
            Some(mut deviation) => {
                if derivatives.bends && derivatives.are_named {
                    let (d, _) = d.as_ref().and_then(|d| left_of(&evidence, d, None)).unzip();
                    let response = |size: f64| {
                        let [change, _] = (derivatives.moved)(index, size)?;
                        Some(residual.response(d.as_deref()?, &evidence.left_of(change)?))
                    };
                    deviation.detectable = either_way(deviation.detectable, response);
                }
                found.deviations.push(deviation);
            }
            None => found.untested.push(parameter.name.clone()),
        }
        for (spot, name) in (0..spots).filter_map(|l| Some((l, parameter.each_spot.as_ref()?))) {
            let own = fit(Some(spot), found.limits[1], single, name);
            found.spots.extend(own);
        }
    }
    if !derivatives.are_named {
        return found;
    }
    let causes = Causes {
        residual: &residual,
        test,
        derivatives,
        of: &of,
        remaining,
    };
    let all: Vec<&Deviation> = found.all().collect();
    let beyond = all.iter().copied().filter(|d| found.is_beyond(d)).collect();
    let (likely, best) = causes.likely(&all, beyond);
    found.likely = likely;
    if remaining.is_refused || found.rejects() {
        found.picture = causes.picture(best.as_ref());
    }
    found
}

/// The smallest deviation of either sign that is fitted as `straight`, which the straight model
/// needs: light that bends or steps on the way may answer one side less, or later. `response` is
/// what is fitted of a deviation.
fn either_way(straight: f64, response: impl Fn(f64) -> Option<f64>) -> f64 {
    let mut size = straight;
    for _ in 0..TRIES {
        let [Some(back), Some(forth)] = [-size, size].map(&response) else {
            break;
        };
        let least = forth.min(-back);
        if least.is_nan() || least >= ENOUGH * straight {
            break;
        }
        size *= (straight / least.max(0.0)).min(MOST_LARGER);
    }
    size
}

/// What is fitted of a derivative, and the spots where it is not 0; none if what was fitted first
/// leaves nothing of it.
fn left_of<'a>(
    evidence: &Evidence<'_>,
    d: &'a Matrix,
    spot: Option<usize>,
) -> Option<(Cow<'a, Matrix>, Range<usize>)> {
    let all = 0..d.ncols();
    match evidence.eliminated {
        None => Some((Cow::Borrowed(d), spot.map_or(all, |l| l..l + 1))),
        Some(_) => Some((Cow::Owned(whole(evidence, d, spot)?), all)),
    }
}
