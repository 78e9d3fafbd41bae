//! How wrong may the assumed geometry be?
//!
//! The bench stands as the scene says; the model that inverts its photographs is of a bench that is slightly off. Photographs
//! are the converged three-bounce integral with relative normal noise; the method is `joint`.

mod misplaced;

use misplaced::{Misplaced, normal};
use serde::{Deserialize, Serialize};

use super::task::Division;
use crate::matrix::Matrix;
use crate::metrics::mtf_raw;
use crate::model::{Extent, Kernel, MatrixModel, ModelError, converged};
use crate::num::summation::tree_sum;
use crate::recovery::{Method, Options, Problem, recover};
use crate::scene::Scene;
use crate::transport::Control;

/// What a misplacement of one size does.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Misplacement {
    /// Degrees, or the scene's unit of length.
    pub size: f64,
    /// ‖Φ(misplaced) − Φ‖/‖Φ‖.
    pub change: f64,
    /// The same after the best single scale.
    pub after_scale: f64,
    /// Mean raw MTF of the recovery with the misplaced model; absent where the object has no contrast.
    pub mtf: Option<f64>,
}

/// One thing that is assumed wrongly.
#[derive(Clone, Debug, Serialize)]
pub struct Sensitivity {
    /// What.
    pub name: String,
    /// Unit of the sizes: `deg` or the scene's.
    pub unit: String,
    /// By growing size. Sizes that the scene does not allow (a spot off the wall) are left out.
    pub rows: Vec<Misplacement>,
    /// The size at which the MTF falls to half of that without error; absent if it does not, or was lost before.
    pub lost_at: Option<f64>,
}

/// The study of a scene.
#[derive(Clone, Debug, Serialize)]
pub struct Tolerance {
    /// Name of the scene.
    pub scene: String,
    /// Its hash.
    pub scene_hash: String,
    /// Noise of the photographs, relative to each entry.
    pub noise: f64,
    /// Raw MTF with the right geometry.
    pub mtf: Option<f64>,
    /// Each thing.
    pub parameters: Vec<Sensitivity>,
}

/// Sizes from 1e-4 to 1 inch (or degree), three to a decade and a half.
const SIZES: [f64; 9] = [1e-4, 3e-4, 1e-3, 3e-3, 1e-2, 3e-2, 0.1, 0.3, 1.0];
/// Noisy photographs whose recoveries are averaged.
const DRAWS: u64 = 4;

/// Misplaces one thing after the other. A task is one thing misplaced by one size; the first has everything in its place.
#[derive(Debug)]
pub struct ToleranceTasks {
    scene: Scene,
    noise: f64,
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
    /// The study of a scene, of photographs whose noise relative to each entry is `noise`.
    pub fn new(scene: &Scene, noise: f64) -> Self {
        Self {
            scene: scene.clone(),
            noise,
        }
    }

    /// Mean raw MTF of what is recovered with the model of `assumed`.
    fn mtf(&self, bench: &Bench, assumed: &Scene) -> Result<Option<f64>, ModelError> {
        let model = MatrixModel::new(assumed, Kernel::Physical, None)?;
        let recovered = |(phi, stderr): &(Matrix, Matrix)| {
            let problem =
                Problem::new(phi, &model.camera_side, &model.laser_side, Some(stderr)).ok()?;
            let found = recover(Method::Joint, &problem, &Options::default()).ok()?;
            mtf_raw(found.reflectance.as_slice(), &model.albedo)
        };
        let found: Option<Vec<f64>> = bench.photographs.iter().map(recovered).collect();
        Ok(found.map(|m| tree_sum(&m) / m.len() as f64))
    }

    fn misplaced(
        &self,
        Bench { truth, .. }: &Bench,
        what: Misplaced,
        size: f64,
    ) -> Result<Option<(Scene, Misplacement)>, ModelError> {
        // A misplacement that the wall does not allow is no misplacement of this bench.
        let Ok(Some(wrong)) = what.apply(&self.scene, size) else {
            return Ok(None);
        };
        let phi = converged(&wrong, Kernel::Physical, Extent::FULL)?.phi;
        let scale = phi.dot(truth) / phi.norm_squared().max(f64::MIN_POSITIVE);
        let misplacement = Misplacement {
            size,
            change: (&phi - truth).norm() / truth.norm(),
            after_scale: (&phi * scale - truth).norm() / truth.norm(),
            mtf: None,
        };
        Ok(Some((wrong, misplacement)))
    }
}

impl Division for ToleranceTasks {
    type Ground = Bench;
    type Part = Placed;
    type Finding = Tolerance;
    type Error = ModelError;

    fn tasks(&self) -> usize {
        1 + Misplaced::ALL.len() * SIZES.len()
    }

    fn ground(&self, _: Control<'_>) -> Result<Option<Bench>, ModelError> {
        let truth = converged(&self.scene, Kernel::Physical, Extent::FULL)?.phi;
        let photograph = |seed| {
            let mut normal = normal(seed);
            let stderr = truth.map(|x| x * self.noise);
            (truth.zip_map(&stderr, |x, s| x + s * normal()[0]), stderr)
        };
        let photographs = (0..DRAWS).map(photograph).collect();
        Ok(Some(Bench { truth, photographs }))
    }

    fn task(
        &self,
        bench: &Bench,
        index: usize,
        _: Control<'_>,
    ) -> Result<Option<Placed>, ModelError> {
        let Some(at) = index.checked_sub(1) else {
            return Ok(Some(Placed::Right(self.mtf(bench, &self.scene)?)));
        };
        let what = Misplaced::ALL[at / SIZES.len()];
        let size = SIZES[at % SIZES.len()] * inch(what, &self.scene).0;
        let found = match self.misplaced(bench, what, size)? {
            Some((wrong, found)) => Some(Misplacement {
                mtf: self.mtf(bench, &wrong)?,
                ..found
            }),
            None => None,
        };
        Ok(Some(Placed::Wrong(found)))
    }

    fn fits(&self, _: &Bench, index: usize, part: &Placed) -> bool {
        matches!(part, Placed::Right(_)) == (index == 0)
    }

    fn finish(&self, _: &Bench, parts: Vec<Placed>) -> Result<Tolerance, ModelError> {
        let mut right = None;
        let mut placed = Vec::with_capacity(parts.len());
        for part in parts {
            match part {
                Placed::Right(mtf) => right = mtf,
                Placed::Wrong(found) => placed.push(found),
            }
        }
        let of = |(what, own): (&Misplaced, &[Option<Misplacement>])| {
            let rows: Vec<Misplacement> = own.iter().flatten().copied().collect();
            (!rows.is_empty()).then(|| Sensitivity {
                name: what.name().to_owned(),
                unit: inch(*what, &self.scene).1.to_owned(),
                lost_at: lost_at(right, &rows),
                rows,
            })
        };
        let things = Misplaced::ALL.iter().zip(placed.chunks(SIZES.len()));
        Ok(Tolerance {
            scene: self.scene.name.clone(),
            scene_hash: self.scene.hash.clone(),
            noise: self.noise,
            mtf: right,
            parameters: things.filter_map(of).collect(),
        })
    }
}

/// What one of [`SIZES`] is, and in which unit: a degree, or an inch in the scene's unit.
fn inch(what: Misplaced, scene: &Scene) -> (f64, &'static str) {
    match what {
        Misplaced::HingeAngle => (1.0, "deg"),
        _ => (scene.unit.per_inch(), scene.unit.symbol()),
    }
}

/// Below this an MTF shows no pattern.
const PATTERN: f64 = 0.5;

/// Where the MTF first falls through half of its undisturbed value, interpolated in log size.
fn lost_at(right: Option<f64>, rows: &[Misplacement]) -> Option<f64> {
    let right = right.filter(|m| *m >= PATTERN)?;
    let limit = PATTERN * right;
    let mut before = (rows.first()?.size * 0.1, right);
    for row in rows {
        let mtf = row.mtf?;
        if mtf < limit {
            let t = (before.1 - limit) / (before.1 - mtf);
            return Some(libm::exp(
                libm::log(before.0) + t * libm::log(row.size / before.0),
            ));
        }
        before = (row.size, mtf);
    }
    None
}

#[cfg(test)]
mod tests {
    use super::misplaced::hinge;
    use super::*;
    use crate::study::task::tests::{divides, small};

    #[test]
    fn it_divides() {
        let found = divides(&ToleranceTasks::new(&small("bench"), 0.01));
        assert_eq!(found.parameters.len(), Misplaced::ALL.len());
    }

    /// On the bench the planes meet at y = 15.5, z = 0, along x.
    #[test]
    fn the_hinge_of_the_bench_is_where_it_is() {
        let (point, axis) = hinge(&Scene::load("bench").unwrap()).unwrap();
        assert!((point.y - 15.5).abs() < 1e-12 && point.z.abs() < 1e-12);
        assert!((axis.x.abs() - 1.0).abs() < 1e-12);
    }

    /// Every misplacement changes Φcam in proportion to its size where it is small.
    #[test]
    fn small_misplacements_act_in_proportion() {
        let scene = Scene::load("bench").unwrap();
        let truth = converged(&scene, Kernel::Physical, Extent::FULL)
            .unwrap()
            .phi;
        for what in Misplaced::ALL {
            let change = |size: f64| {
                let wrong = what.apply(&scene, size).unwrap().unwrap();
                let phi = converged(&wrong, Kernel::Physical, Extent::FULL)
                    .unwrap()
                    .phi;
                (phi - &truth).norm() / truth.norm()
            };
            let (small, twice) = (change(1e-3), change(2e-3));
            assert!(small > 1e-7, "{what:?}: {small:e}");
            assert!(
                (twice / small - 2.0).abs() < 0.01,
                "{what:?}: {small:e}, {twice:e}"
            );
        }
    }

    #[test]
    fn the_limit_is_interpolated_in_log_size() {
        let row = |size, mtf| Misplacement {
            size,
            change: 0.0,
            after_scale: 0.0,
            mtf: Some(mtf),
        };
        let rows = [row(0.01, 1.0), row(0.1, 0.75), row(1.0, 0.25)];
        assert!((lost_at(Some(1.0), &rows).unwrap() / 0.1f64.sqrt() - 1.0).abs() < 1e-12);
        assert_eq!(lost_at(Some(1.0), &rows[..2]), None);
        assert_eq!(lost_at(Some(0.3), &rows), None);
    }
}
