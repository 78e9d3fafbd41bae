//! The study in tasks: each one thing misplaced by one size.

use crate::lab::comparison::validation::Integration;
use crate::lab::problem::{inverted, lit, problem};
use serde::{Deserialize, Serialize};

use super::results::{Misplacement, Sensitivity, Tolerance};
use crate::lab::comparison::misplaced::{ALL, Misplaced, Size, normal};
use crate::lab::error::LabError;
use crate::lab::options::Opt;
use crate::lab::studies::loss::size_at;
use crate::lab::studies::registered::{Registered, prepared};
use crate::lab::study::Study;
use crate::matrix::Matrix;
use crate::metrics::mtf_raw;
use crate::model::{
    Differential, Effort, Extent, Fineness, Kernel, ModelError, Occlusion, Swept, converged,
    is_obstructed,
};
use crate::num::summation::tree_sum;
use crate::recovery::{Method, Options, recover};
use crate::scene::Scene;
use crate::transport::Control;

/// `phicam study tolerance`.
pub(in crate::lab) const STUDY: Registered = Registered {
    name: "tolerance",
    about: "How wrong the assumed geometry may be: table, JSON, CSV, figure",
    scene: Some("bench"),
    files: "tolerance.csv, tolerance.svg",
    options: &[
        Opt::number("noise", "Noise of the photographs, relative to each entry")
            .or("0.01")
            .rule(
                |x| x > 0.0 && x < 1.0,
                "is not a relative noise",
                "use a number between 0 and 1, e.g. 0.01",
            ),
        Opt::number(
            "mtf",
            "MTF that is wished for, of the picture's own: how well must each thing be known for it",
        )
        .or("0.9")
        .rule(
            |x| x > 0.0 && x <= 1.0,
            "is not an MTF",
            "use a number above 0, up to 1, e.g. 0.9",
        ),
    ],
    prepare: |scene, values| {
        let [noise, wished] = [values.one("noise")?, values.one("mtf")?];
        Ok(prepared(ToleranceTasks::new(scene, noise, wished)))
    },
};

/// Sizes from 1e-4 to 1 inch (or degree), three to a decade and a half.
const SIZES: [f64; 9] = [1e-4, 3e-4, 1e-3, 3e-3, 1e-2, 3e-2, 0.1, 0.3, 1.0];
/// Part of a sagitta at which a wall is as good as flat.
const NEARLY_FLAT: f64 = 1e-2;
/// Noisy photographs whose recoveries are averaged.
const DRAWS: u64 = 4;

/// Misplaces one thing after the other. A task is one thing misplaced by one size; the first has
/// everything in its place.
#[derive(Debug)]
pub struct ToleranceTasks {
    scene: Scene,
    noise: f64,
    wished: f64,
}

/// Φcam and its noisy photographs with their standard errors, pixels × spots, W.
#[derive(Debug)]
pub struct Bench {
    truth: Matrix,
    photographs: Vec<(Matrix, Matrix)>,
}

/// What a task gives.
#[derive(Debug, Serialize, Deserialize)]
pub enum Placed {
    /// Mean raw MTF with the right geometry.
    Right(Option<f64>),
    /// A misplacement; none where the scene does not allow it.
    Wrong(Option<Misplacement>),
}

impl ToleranceTasks {
    /// The study of a scene, of photographs whose noise relative to each entry is `noise`; `wished`
    /// is the MTF, of the picture's own, for which everything is to be known well enough.
    pub fn new(scene: &Scene, noise: f64, wished: f64) -> Self {
        Self {
            scene: scene.clone(),
            noise,
            wished,
        }
    }

    /// Mean raw MTF of what is recovered with the model of `assumed`.
    fn mtf(&self, bench: &Bench, assumed: &Scene) -> Result<Option<f64>, ModelError> {
        let how = (Integration::Quadrature, Effort::USUAL);
        let model = inverted(assumed, Kernel::Physical, None, Occlusion::Considered, how)?;
        let recovered = |(phi, stderr): &(Matrix, Matrix)| {
            let problem = problem(&model, phi, Some(stderr)).ok()?;
            let found = recover(Method::Joint, &problem, &Options::default()).ok()?;
            mtf_raw(found.reflectance.as_slice(), &model.albedo)
        };
        let found: Option<Vec<f64>> = bench.photographs.iter().map(recovered).collect();
        Ok(found.map(|m| tree_sum(&m) / m.len() as f64))
    }

    /// What one thing that is misplaced by `size` does; none where the scene does not allow it.
    fn wrong(
        &self,
        bench: &Bench,
        what: &Misplaced,
        size: f64,
    ) -> Result<Option<Misplacement>, LabError> {
        let Some(wrong) = what.apply(&self.scene, size) else {
            return Ok(None);
        };
        let light = |scene: &Scene| -> Result<Matrix, ModelError> {
            Ok(converged(scene, Kernel::Physical, Extent::FULL)?.phi)
        };
        let phi = light(&wrong)?;
        // A wall that bends asks what stands in the way ray by ray: it is held against itself.
        let nearly = match what.size {
            Size::Positive if is_obstructed(&self.scene) => {
                what.apply(&self.scene, NEARLY_FLAT * size)
            }
            _ => None,
        };
        let nearly = nearly.map(|scene| light(&scene)).transpose()?;
        let truth = nearly.as_ref().unwrap_or(&bench.truth);
        let scale = phi.dot(truth) / phi.norm_squared().max(f64::MIN_POSITIVE);
        Ok(Some(Misplacement {
            size: size.abs(),
            change: (&phi - truth).norm() / truth.norm(),
            after_scale: (&phi * scale - truth).norm() / truth.norm(),
            mtf: self.mtf(bench, &wrong)?,
        }))
    }
}

impl Study for ToleranceTasks {
    type Context = Bench;
    type Output = Placed;
    type Result = Tolerance;
    type Error = LabError;

    fn tasks(&self) -> usize {
        1 + ALL.len() * SIZES.len()
    }

    fn context(&self, _: Control<'_>) -> Result<Bench, LabError> {
        let truth = lit(&self.scene)?.phi;
        let photograph = |seed| {
            let mut normal = normal(seed);
            let stderr = truth.map(|x| x * self.noise);
            (truth.zip_map(&stderr, |x, s| x + s * normal()[0]), stderr)
        };
        let photographs = (0..DRAWS).map(photograph).collect();
        Ok(Bench { truth, photographs })
    }

    fn task(&self, bench: &Bench, index: usize, _: Control<'_>) -> Result<Placed, LabError> {
        let Some(at) = index.checked_sub(1) else {
            return Ok(Placed::Right(self.mtf(bench, &self.scene)?));
        };
        let what = &ALL[at / SIZES.len()];
        let size = SIZES[at % SIZES.len()] * unit(what, &self.scene).0;
        let more = self.wrong(bench, what, size)?;
        // Nothing says to which side a thing is misplaced.
        let less = match what.size {
            Size::Length | Size::Angle | Size::Percent => self.wrong(bench, what, -size)?,
            Size::Random | Size::Positive => None,
        };
        Ok(Placed::Wrong(match (more, less) {
            (Some(more), Some(less)) => Some(more.or_worse(&less)),
            (more, less) => more.or(less),
        }))
    }

    fn fits(&self, _: &Bench, index: usize, part: &Placed) -> bool {
        matches!(part, Placed::Right(_)) == (index == 0)
    }

    fn finish(&self, _: &Bench, parts: Vec<Placed>) -> Result<Tolerance, LabError> {
        let (mut right, mut placed) = (None, Vec::new());
        for part in parts {
            match part {
                Placed::Right(mtf) => right = mtf,
                Placed::Wrong(found) => placed.push(found),
            }
        }
        let divided = self.scene.hidden().flat_map(|(_, s)| s.divided(s.elements));
        let picture: Vec<f64> = divided.map(|e| e.albedo).collect();
        let mut found = Tolerance {
            scene: self.scene.name.clone(),
            scene_hash: self.scene.hash.clone(),
            noise: self.noise,
            draws: DRAWS,
            wished: self.wished,
            own: mtf_raw(&picture, &picture),
            mtf: right,
            parameters: Vec::new(),
        };
        let shown = right.filter(|_| found.shows_pattern());
        let of = |(what, own): (&Misplaced, &[Option<Misplacement>])| {
            let rows: Vec<Misplacement> = own.iter().flatten().copied().collect();
            let through = |limit: f64| falls_through(shown?, &rows, limit);
            let needed = found.limit().and_then(through);
            let lost_at = shown.and_then(|right| through(0.5 * right));
            (!rows.is_empty()).then(|| Sensitivity {
                name: what.name.to_owned(),
                unit: unit(what, &self.scene).1.to_owned(),
                by_derivative: by_derivative(&self.scene, what),
                needed,
                lost_at,
                rows,
            })
        };
        let things = ALL.iter().zip(placed.chunks(SIZES.len()));
        found.parameters = things.filter_map(of).collect();
        Ok(found)
    }
}

/// What one of [`SIZES`] is, and in which unit: a degree, or an inch in the scene's unit.
fn unit(what: &Misplaced, scene: &Scene) -> (f64, &'static str) {
    let unit = what.size.unit(scene);
    match what.size {
        Size::Angle | Size::Percent => (1.0, unit),
        Size::Length | Size::Random | Size::Positive => (scene.unit.per_inch(), unit),
    }
}

/// ‖∂Φ‖/‖Φ‖ a unit, and what the best scale leaves of it, by the derivative of the model over areas
/// and past flat figures in the way; none of what has none.
fn by_derivative(scene: &Scene, what: &Misplaced) -> Option<[f64; 2]> {
    let velocity = what.velocity(scene)?;
    let divided = scene.hidden().flat_map(|(_, s)| s.divided(s.elements));
    let albedo: Vec<f64> = divided.map(|e| e.albedo).collect();
    let [light, moved] = if is_obstructed(scene) {
        let swept = Swept::new(scene, None, &[velocity], Effort::USUAL).ok()??;
        let rate = swept.rates.into_iter().next()??;
        [swept.terms.phi(&albedo), rate.phi(&albedo)]
    } else {
        let model = Differential::new(scene, None, Fineness::Areas(1)).ok()?;
        let (terms, rate, n) = (model.terms(), model.rate(&velocity), model.elements());
        let rho = nalgebra::DVector::from_vec(albedo);
        let spots = 0..scene.laser.spots.len();
        let columns = |of: &dyn Fn(usize) -> Matrix| {
            let each: Vec<_> = spots.clone().map(|l| of(l) * &rho).collect();
            Matrix::from_columns(&each)
        };
        [
            columns(&|l| terms.frame(l, n)),
            columns(&|l| terms.frame_rate(&rate, l, n)),
        ]
    };
    let (square, dot) = (light.norm_squared(), light.dot(&moved));
    let change = moved.norm_squared();
    let left = (change - dot * dot / square).max(0.0);
    Some([(change / square).sqrt(), (left / square).sqrt()])
}

/// Where the MTF first falls through `limit`; none where it is below that with the right geometry.
/// What counts as lost is what the error takes of the MTF with the `right` one.
fn falls_through(right: f64, rows: &[Misplacement], limit: f64) -> Option<f64> {
    if right <= limit {
        return None;
    }
    let mut before = [0.0, 1.0];
    for row in rows {
        let here = [row.size, row.mtf? / right];
        if here[1] < limit / right {
            return Some(size_at([before, here], limit / right));
        }
        before = here;
    }
    None
}

#[cfg(test)]
mod tests;
