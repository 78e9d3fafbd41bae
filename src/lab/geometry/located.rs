//! Where the hidden surfaces are, by photographs whose reflectances are unknown.
//!
//! The scene is altered in one respect by a size t (its hidden surfaces moved along their normal,
//! the spots or the view shifted, …). At each t the photographs have a likelihood with the
//! reflectances, their roughness and the noise all unknown ([`Fit`]); the largest is the estimate.
//! Its error is the larger of two:
//!
//! > σ_L = (−∂²ln p/∂t²)^−½,   σ_J² = (m − 1)/m Σ_l (t_(l) − t̄)²,
//!
//! by the curvature of the profile likelihood, and by leaving out one of m frames after the other
//! (jackknife; Efron and Stein, Annals of Statistics 9 (1981)). The first takes what is not
//! explained for independent noise. Where the model lacks something, neighbouring pixels err alike
//! and it is far too small; the frames still err by themselves. What both miss is light that all
//! frames share: it can be taken out ([`Common`]), and else is looked for ([`light`]); and that the
//! surface has another size than the scene says, which is tried ([`super::resized`]).

mod describe;
mod fitting;
mod found;
mod frames;
mod light;
mod likelihood;
mod mistaken;
mod order;
mod picture;
mod place;
mod resized;
mod search;

#[cfg(test)]
mod tests;

use rayon::prelude::*;

pub use found::{Bright, Grid, Likelihood, Located};
pub(super) use frames::covariance_root;
pub use mistaken::Mistaken;
pub use order::Order;
pub(super) use search::NOT_TOLD;

use super::common::Common;
use crate::lab::comparison::misplaced::{self, Misplaced};
use crate::lab::comparison::validation::Integration;
use crate::lab::error::LabError;
use crate::lab::problem::inverted;
use crate::lab::uncertainty::unexplained::{Photographs, Unexplained};
use crate::model::{Effort, ElementGrid, Kernel, MatrixModel, Occlusion};
use crate::scene::Scene;
use crate::transport::Control;
use found::Picture;
use frames::{Seen, Sides, TermsOf};
use mistaken::{Rearranged, likeliest};
use picture::Pictured;
use place::{Lengths, Place, frames_of};
use search::{FINE, Search, Stretch, not_told};

/// Why a shift is not looked for that only moves the picture.
const WITHIN_ITS_PLANE: LabError = LabError::Unsuited(
    "a shift of flat hidden surfaces within their own plane is where on them the picture lies, and photographs do not tell it from another picture; look along their normal (--what normal): the bright part of the picture says where on them it is",
);

/// What may be looked for: its name on the command line, and that of the studies.
pub const LOCATABLE: [(&str, &str); 9] = [
    ("normal", "S2 along its normal"),
    ("u", "S2 along u"),
    ("v", "S2 along v"),
    ("angle", "hinge angle"),
    ("yaw", "yaw of S2"),
    ("spots-x", "all spots, x"),
    ("spots-y", "all spots, y"),
    ("view-x", "view, x"),
    ("view-y", "view, y"),
];

/// How it is looked for.
#[derive(Clone, Copy, Debug)]
pub struct LocatedPlan {
    /// One of [`LOCATABLE`], by its name on the command line.
    pub what: &'static str,
    /// Sizes between which it is looked for, in the scene's unit or degrees.
    pub range: [f64; 2],
    /// Sizes that are tried first, at least 3.
    pub steps: usize,
    /// Elements in place of the scene's.
    pub elements: Option<[usize; 2]>,
    /// Whether things in the way are considered.
    pub occlusion: Occlusion,
    /// How the model integrates.
    pub integration: Integration,
    /// Whether there is light that all frames share, unknown in each pixel.
    pub background: bool,
    /// Random orders of the spots that are tried.
    pub orders: u64,
    /// Their seed.
    pub seed: u64,
}

impl LocatedPlan {
    /// Sizes and orders that are tried.
    pub fn work(&self) -> u64 {
        (self.steps + FINE) as u64 + self.orders
    }

    /// Looks for it in `photographs` of `scene`.
    ///
    /// # Errors
    /// [`LabError`]: there is no model, no light, nothing that could be altered, or it was stopped.
    pub fn locate(
        &self,
        scene: &Scene,
        photographs: &Unexplained<'_>,
        control: Control<'_>,
    ) -> Result<Located, LabError> {
        photographs.check()?;
        let common = (self.background).then(|| Common::new(photographs, false));
        let common = common.transpose()?;
        let photographs = &Unexplained {
            phi: common.as_ref().map_or(photographs.phi, |own| &own.phi),
            ..*photographs
        };
        let seen = Seen {
            photographs: *photographs,
            common: common.as_ref(),
        };
        let altered = self.misplaced()?;
        if altered.is_of_the_picture(scene) {
            return Err(WITHIN_ITS_PLANE);
        }
        let model = self.model(scene)?;
        if model.places.is_empty() {
            return Err(LabError::Unsuited(
                "the places of the elements are not known",
            ));
        }
        let lengths = Lengths::of(&model.places)?;
        let place = |size: f64, each_out: bool| -> Result<Option<Place>, LabError> {
            control.check()?;
            let found = match altered.apply(scene, size) {
                Some(scene) => Place::new(size, &self.model(&scene)?, seen, &lengths, each_out)?,
                None => None,
            };
            (control.progress)(1);
            Ok(found)
        };
        let sizes = |[from, to]: [f64; 2], steps: usize| {
            let size = move |k: usize| from + (to - from) * k as f64 / (steps - 1) as f64;
            (0..steps).into_par_iter().map(size)
        };
        let places = |range: [f64; 2], steps: usize, each_out: bool| {
            let found = sizes(range, steps).map(|size| place(size, each_out));
            let found: Vec<Option<Place>> = found.collect::<Result<_, _>>()?;
            Ok::<_, LabError>(found.into_iter().flatten().collect::<Vec<Place>>())
        };
        let coarse = places(self.range, self.steps, false)?;
        if coarse.is_empty() {
            let is_possible = |size| altered.apply(scene, size).is_some();
            if sizes(self.range, self.steps).any(is_possible) {
                return Err(LabError::Unsuited(
                    "too few entries count to tell a place by; leave more in",
                ));
            }
            return Err(LabError::Unsuited(
                "the scene allows no place between these two; an angle needs a hinge, and there is none where hidden surface and wall are parallel",
            ));
        }
        let search = Search {
            range: self.range,
            step: (self.range[1] - self.range[0]) / (self.steps - 1) as f64,
            places: &places,
        };
        let (found, others) = search.likeliest(&coarse)?;
        let Stretch {
            searches,
            peak,
            step,
        } = found;
        // Where a frame matters so much that without it the peak is far, a wider search is needed.
        let by_frames = searches
            .iter()
            .rev()
            .find_map(|fine| place::jackknife(fine));
        let by_frames = match by_frames {
            None if photographs.phi.ncols() > 2 => {
                place::jackknife(&places(self.range, self.steps, true)?)
            }
            found => found,
        };
        let all = || {
            coarse
                .iter()
                .chain(searches.iter().flatten())
                .chain(&others)
        };
        let best = all().max_by(|a, b| a.log_likelihood().total_cmp(&b.log_likelihood()));
        let best = best.ok_or(LabError::DARK)?;
        let log_likelihood = best.log_likelihood();
        let stated = [log_likelihood, best.fit.misfit];
        let (order, mistaken) = self.orders(scene, seen, (&lengths, stated), control)?;
        let there = altered
            .apply(scene, best.size)
            .unwrap_or_else(|| scene.clone());
        let nearby = peak.map_or(step, |peak| peak.stderr);
        let at = (best.size, nearby);
        let (light_left_out, neighbours) =
            self.light_left_out((scene, altered), at, seen, &lengths)?;
        let fit = self.fit(&there, seen, &lengths)?;
        let errors = [peak.map(|peak| peak.stderr), by_frames];
        let elsewhere = not_told(log_likelihood, &others, errors);
        let resized = self.resized((scene, altered), (best, errors), seen, control)?;
        let mut curve: Vec<&Place> = all().collect();
        curve.sort_by(|a, b| a.size.total_cmp(&b.size));
        let likelihood = |p: &&Place| Likelihood {
            size: p.size,
            log_likelihood: p.log_likelihood() - best.log_likelihood(),
            misfit: p.fit.misfit,
        };
        Ok(Located {
            scene: scene.name.clone(),
            scene_hash: scene.hash.clone(),
            what: altered.name.to_owned(),
            unit: altered.size.unit(scene).to_owned(),
            size: peak.map(|p| p.size),
            by_curvature: peak.map(|p| p.stderr),
            by_frames,
            middle: there
                .hidden()
                .next()
                .map_or([0.0; 3], |(_, s)| s.shape.at([0.5; 2]).position.to_array()),
            hidden: there.hidden().map(|(_, s)| s.name.clone()).collect(),
            curve: curve.iter().map(likelihood).collect(),
            elsewhere: elsewhere.map(|at| likelihood(&at)).collect(),
            log_likelihood,
            noise: best.fit.noise,
            elements: model.albedo.len(),
            picture: self.picture(&there, seen, &lengths)?,
            order,
            mistaken,
            resized,
            entries: photographs.counted(),
            frames: photographs.phi.ncols(),
            is_noise_known: photographs.stderr.is_some(),
            fit,
            light_left_out,
            neighbours,
            shared: photographs.certainty.shared(),
        })
    }

    fn misplaced(&self) -> Result<&'static Misplaced, LabError> {
        let name = LOCATABLE.iter().find(|(key, _)| *key == self.what);
        let found = name.and_then(|(_, name)| misplaced::ALL.iter().find(|m| m.name == *name));
        found.ok_or(LabError::Unsuited("nothing of that name can be looked for"))
    }

    fn model(&self, scene: &Scene) -> Result<MatrixModel, LabError> {
        let kernel = Kernel::Physical;
        let model = inverted(
            scene,
            kernel,
            self.elements,
            self.occlusion,
            (self.integration, Effort::USUAL),
        );
        Ok(model?)
    }

    fn picture(
        &self,
        scene: &Scene,
        seen: Seen<'_>,
        lengths: &Lengths,
    ) -> Result<Option<Picture>, LabError> {
        let model = self.model(scene)?;
        let frames = frames_of(&model, seen)?;
        let found = Pictured::new(&frames, &lengths.roots)?;
        Ok(found.map(|found| Picture {
            grids: grids(&model, &found),
            directions: found.directions,
            misfit: found.misfit,
            predicted: found.predicted,
            bright: found.bright(&model),
        }))
    }

    /// The test of the spots' order, and the order that the stated one is mistaken for, if so;
    /// elements by their centres. `stated` are the log likelihood and the misfit of the stated one.
    fn orders(
        &self,
        scene: &Scene,
        seen: Seen<'_>,
        (lengths, stated): (&Lengths, [f64; 2]),
        control: Control<'_>,
    ) -> Result<(Option<Order>, Option<Mistaken>), LabError> {
        if self.orders == 0 || seen.photographs.phi.ncols() < 2 {
            return Ok((None, None));
        }
        let model = MatrixModel::with(scene, Kernel::Physical, self.elements, self.occlusion)?;
        let element: Vec<usize> = (0..model.albedo.len()).collect();
        let terms = TermsOf::centres(&model, &element);
        let root = covariance_root(&model.places, lengths.fixed)?;
        let sides = Sides::new(seen, terms.camera)?;
        let tried = [self.orders, self.seed];
        let order = order::order(&sides, terms, &root, tried, control)?;
        let frame = [scene.camera.columns, scene.camera.rows];
        let all = Rearranged::all(frame, sides.len());
        let Some(other) = likeliest((seen, &sides), terms, &root, all)? else {
            return Ok((order, None));
        };
        let again = Self { orders: 0, ..*self };
        let quiet = Control {
            progress: &|_| (),
            ..control
        };
        let found = |own: Photographs| -> Result<[f64; 2], LabError> {
            let found = again.locate(scene, &own.unexplained(), quiet)?;
            let misfit = found.curve.iter().find(|at| at.log_likelihood == 0.0);
            let misfit = misfit.map_or(f64::INFINITY, |at| at.misfit);
            Ok([found.log_likelihood, misfit])
        };
        let stated = match other.left_over {
            None => stated,
            Some(_) => found(other.stated(&seen.photographs))?,
        };
        let turned = found(other.of(&seen.photographs))?;
        Ok((order, Mistaken::new(other.what, stated, turned)))
    }
}

/// The reflectances by surfaces, over the largest.
fn grids(model: &MatrixModel, found: &Pictured) -> Vec<Grid> {
    let largest = found.rho.amax();
    let unit = if largest > 0.0 { largest } else { 1.0 };
    let stderr = found.stderr();
    let grid = |g: &ElementGrid| Grid {
        surface: g.surface.clone(),
        count: g.count,
        values: found
            .rho
            .rows(g.first, g.len())
            .iter()
            .map(|x| x / unit)
            .collect(),
        stderr: stderr[g.first..][..g.len()]
            .iter()
            .map(|x| x / unit)
            .collect(),
    };
    model.grids.iter().map(grid).collect()
}
