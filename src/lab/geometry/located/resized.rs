//! The place with another size of the hidden surface.

use rayon::prelude::*;

use super::LocatedPlan;
use super::frames::Seen;
use super::place::{self, Lengths, Place};
use super::search::scatter;
use crate::lab::comparison::misplaced::Misplaced;
use crate::lab::error::LabError;
use crate::lab::geometry::resized::{Resized, resized};
use crate::scene::Scene;
use crate::transport::Control;

/// Steps to the place, and errors that a step goes where the likeliest of three places is the last.
const STEPS: usize = 6;
const FAR: f64 = 4.0;
/// Errors below which a step is the last, and ln p by which a parabola may tell its peak too low.
const NEAR: f64 = 0.1;
const ROUGH: f64 = 1.0;

impl LocatedPlan {
    /// The likelier of other sizes than that by which `best` was found, of errors σ_L and σ_J; none
    /// where neither is much likelier.
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
        let [Some(error), _] = errors else {
            return Ok(None);
        };
        let mut found: Option<Resized> = None;
        for (factor, scene) in resized(scene) {
            let least = best.log_likelihood() + Resized::least(scatter(errors));
            let near = (best.size, error, least);
            let top = self.top_near((&scene, altered), near, seen, control)?;
            let Some(top) = top else { continue };
            let other = Resized {
                factor,
                values: vec![top.size],
                log_likelier: top.log_likelihood() - best.log_likelihood(),
            };
            found = Some(other.likelier(found));
        }
        Ok(found.filter(|other| other.is_told(scatter(errors))))
    }

    /// The likeliest place of `scene` that parabolas through three places `error` apart lead to, as
    /// long as its ln p may be more than `least`.
    fn top_near(
        &self,
        (scene, altered): (&Scene, &Misplaced),
        (mut at, error, least): (f64, f64, f64),
        seen: Seen<'_>,
        control: Control<'_>,
    ) -> Result<Option<Place>, LabError> {
        let lengths = Lengths::of(&self.model(scene)?.places)?;
        let mut top: Option<Place> = None;
        for _ in 0..STEPS {
            let place = |size: f64| -> Result<Option<Place>, LabError> {
                control.check()?;
                let Some(there) = altered.apply(scene, size) else {
                    return Ok(None);
                };
                let model = self.model(&there)?;
                Ok(Place::new(size, &model, seen, &lengths, false)?)
            };
            let sizes = [at - error, at, at + error];
            let three = sizes.into_par_iter().map(place);
            let three: Vec<Option<Place>> = three.collect::<Result<_, _>>()?;
            let mut three: Vec<Place> = three.into_iter().flatten().collect();
            let likeliest = place::best(three.iter().map(Place::log_likelihood));
            let Some(k) = likeliest else { break };
            let (next, is_near) = match place::parabola(&three, Place::log_likelihood) {
                Some(peak) => {
                    let off = (peak.size - three[k].size) / peak.stderr;
                    let height = three[k].log_likelihood() + 0.5 * off * off;
                    let is_low = height < least - ROUGH;
                    (peak.size, is_low || (peak.size - at).abs() < NEAR * error)
                }
                None => {
                    let side = (three[k].size - at).signum();
                    (three[k].size + FAR * error * side, false)
                }
            };
            let here = three.swap_remove(k);
            let is_higher = |top: &Place| top.log_likelihood() < here.log_likelihood();
            if top.as_ref().is_none_or(is_higher) {
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
