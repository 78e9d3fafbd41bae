//! The place with another size of the hidden surface.

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
/// Errors below which a step is the last.
const NEAR: f64 = 0.1;

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
            let top = self.top_near((&scene, altered), (best.size, error), seen, control)?;
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
                    let model = self.model(&there)?;
                    three.extend(Place::new(size, &model, seen, &lengths, false)?);
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
