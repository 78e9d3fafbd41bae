//! Whether the hidden surface is as large as the scene has it.
//!
//! What lies beyond its edges the picture cannot show, and the place makes up for it. So the
//! photographs are fitted with the surface smaller and larger about its middle, as many elements on
//! it and the place following, and another size is told where
//!
//! > ln p′ − ln p > ln 100 · max(1, (σ_J/σ_L)²),
//!
//! by the errors that peaks are compared by ([`super::search`]).

use glam::{DAffine3, DVec3};
use serde::Serialize;

use super::LocatedPlan;
use super::frames::Seen;
use super::place::{self, Lengths, Place};
use super::search::scatter;
use crate::lab::comparison::misplaced::Misplaced;
use crate::lab::error::LabError;
use crate::scene::Scene;
use crate::transport::Control;

/// Sizes that are tried, over the scene's.
const FACTORS: [f64; 2] = [0.8, 1.25];
/// ln 100.
const LIKELIER: f64 = 4.605_170_185_988_092;
/// Steps to the place of each, and errors that a step goes where the likeliest of three places is
/// the last.
const STEPS: usize = 6;
const FAR: f64 = 4.0;
/// Errors below which a step is the last.
const NEAR: f64 = 0.1;

/// Another size of the hidden surface.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Resized {
    /// Over the scene's, about its middle.
    pub factor: f64,
    /// What is looked for, there.
    pub size: f64,
    /// ln of how much likelier the photographs are.
    pub log_likelier: f64,
}

impl LocatedPlan {
    /// The likelier of other sizes than that by which `best` was found, of errors σ_L and σ_J; none
    /// where neither is much likelier, and of several hidden surfaces.
    ///
    /// # Errors
    /// [`LabError`]: no light, or it was stopped.
    pub(super) fn resized(
        &self,
        (scene, altered): (&Scene, &Misplaced),
        (best, errors): (&Place, [Option<f64>; 2]),
        seen: Seen<'_>,
        control: Control<'_>,
    ) -> Result<Option<Resized>, LabError> {
        let mut hidden = scene.hidden();
        let (Some((_, surface)), None, [Some(error), _]) = (hidden.next(), hidden.next(), errors)
        else {
            return Ok(None);
        };
        let middle = surface.shape.at([0.5; 2]).position;
        let least = best.log_likelihood() + LIKELIER * scatter(errors);
        let mut found: Option<Resized> = None;
        for factor in FACTORS {
            let motion = DAffine3::from_translation(middle)
                * DAffine3::from_scale(DVec3::splat(factor))
                * DAffine3::from_translation(-middle);
            let Ok(resized) = scene.with_moved_hidden(&motion) else {
                continue;
            };
            let top = self.top_near((&resized, altered), (best.size, error), seen, control)?;
            let Some(top) = top.filter(|top| top.log_likelihood() > least) else {
                continue;
            };
            let log_likelier = top.log_likelihood() - best.log_likelihood();
            if found.is_none_or(|other| other.log_likelier < log_likelier) {
                found = Some(Resized {
                    factor,
                    size: top.size,
                    log_likelier,
                });
            }
        }
        Ok(found)
    }

    /// The likeliest place of `scene` that parabolas through three places `error` apart lead to.
    fn top_near(
        &self,
        (scene, altered): (&Scene, &Misplaced),
        (mut at, error): (f64, f64),
        seen: Seen<'_>,
        control: Control<'_>,
    ) -> Result<Option<Place>, LabError> {
        let lengths = Lengths::of(&self.model(scene)?.places)?;
        let mut top: Option<Place> = None;
        for _ in 0..STEPS {
            let mut three = Vec::new();
            for size in [at - error, at, at + error] {
                control.check()?;
                if let Some(there) = altered.apply(scene, size) {
                    three.extend(Place::new(
                        size,
                        &self.model(&there)?,
                        seen,
                        &lengths,
                        false,
                    )?);
                }
            }
            let likeliest = place::best(three.iter().map(Place::log_likelihood));
            let Some(k) = likeliest else { break };
            let next = match place::parabola(&three, Place::log_likelihood) {
                Some(peak) => peak.size,
                None => three[k].size + FAR * error * (three[k].size - at).signum(),
            };
            let is_near = (next - at).abs() < NEAR * error;
            let here = three.swap_remove(k);
            if top
                .as_ref()
                .is_none_or(|top| top.log_likelihood() < here.log_likelihood())
            {
                top = Some(here);
            }
            if is_near {
                break;
            }
            at = next;
        }
        Ok(top)
    }
}
