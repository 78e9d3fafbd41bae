//! The tasks of the study: an occluder and a number of spots each.

use super::found::{Misplaced, Occluders, Row, SEARCHED};
use super::kinds::{Cells, Kind, Place};
use super::photographed::Camera;
use super::search::search;
use crate::lab::ensemble::Photographs;
use crate::lab::error::LabError;
use crate::lab::studies::grey::Grey;
use crate::lab::studies::limit::Limit;
use crate::lab::studies::subject::{Subject, recovered};
use crate::lab::study::{Sharing, Study};
use crate::lab::uncertainty::noise_law::NoiseLaw;
use crate::model::{Kernel, MatrixModel, ModelError};
use crate::scene::Scene;
use crate::transport::Control;

/// What is studied.
#[derive(Clone, Debug)]
pub(super) struct Plan {
    pub kinds: Vec<Kind>,
    pub spots: Vec<usize>,
    pub noise: NoiseLaw,
    pub level: f64,
    pub start: Place,
    pub search: usize,
    pub subjects: Vec<Subject>,
    /// The random mask.
    pub mask: Cells,
    pub camera: Camera,
    pub draws: u64,
    pub misplaced: Vec<f64>,
    pub elements: Option<usize>,
    pub seed: u64,
}

/// The study of a scene.
#[derive(Debug)]
pub(super) struct OccluderTasks {
    scene: Scene,
    plan: Plan,
}

impl OccluderTasks {
    /// # Errors
    /// [`ModelError::NothingHidden`].
    pub(super) fn new(scene: &Scene, mut plan: Plan) -> Result<Self, LabError> {
        let all = scene.laser.spots.len();
        if plan.spots.is_empty() {
            plan.spots.push(all);
        }
        if scene.hidden().next().is_none() {
            return Err(ModelError::NothingHidden.into());
        }
        Ok(Self {
            scene: scene.clone(),
            plan,
        })
    }

    fn model(&self, scene: &Scene) -> Result<MatrixModel, LabError> {
        let elements = self.plan.elements.map(|n| [n; 2]);
        Ok(MatrixModel::new(scene, Kernel::Physical, elements)?)
    }

    /// The model by elements that show `subject`.
    fn showing(&self, scene: &Scene, subject: Subject) -> Result<MatrixModel, LabError> {
        let elements = Some(subject.elements(self.elements()));
        Ok(MatrixModel::new(scene, Kernel::Physical, elements)?)
    }

    /// Elements a side of the first hidden surface.
    fn elements(&self) -> [usize; 2] {
        let own = self.scene.hidden().next().map(|(_, s)| s.elements);
        self.plan
            .elements
            .map_or(own.unwrap_or_default(), |n| [n; 2])
    }
}

/// `n` of the scene's spots, evenly among them, and at most so many pixels a side.
fn thinned(scene: &Scene, n: usize, side: usize) -> Scene {
    let mut few = scene.clone();
    let all = scene.laser.spots.len();
    few.laser.spots = (0..n).map(|k| scene.laser.spots[k * all / n]).collect();
    few.camera.columns = few.camera.columns.min(side);
    few.camera.rows = few.camera.rows.min(side);
    few
}

impl Study for OccluderTasks {
    type Context = ();
    type Output = Row;
    type Result = Occluders;
    type Error = LabError;

    fn tasks(&self) -> usize {
        self.plan.kinds.len() * self.plan.spots.len()
    }

    fn sharing(&self) -> Sharing {
        Sharing::InTurn
    }

    fn context(&self, _: Control<'_>) -> Result<(), LabError> {
        Ok(())
    }

    fn task(&self, (): &(), index: usize, control: Control<'_>) -> Result<Row, LabError> {
        let plan = &self.plan;
        let kind = plan.kinds[index % plan.kinds.len()];
        let spots = plan.spots[index / plan.kinds.len()];
        let rough = thinned(&self.scene, spots.min(SEARCHED[1]), SEARCHED[0]);
        let merit = |place: &Place| -> Result<f64, LabError> {
            control.check()?;
            let scene = kind.in_scene(&rough, place, &plan.mask)?;
            Grey::new(&self.model(&scene)?, plan.noise).risk(plan.level)
        };
        let tries = if kind == Kind::None { 0 } else { plan.search };
        let (place, tries) = search(plan.start, tries, merit)?;
        let whole = thinned(&self.scene, spots, usize::MAX);
        let at = |place: &Place| kind.in_scene(&whole, place, &plan.mask);
        let scene = at(&place)?;
        let own = self.model(&scene)?;
        let grey = Grey::new(&own, plan.noise);
        let (directions, risk) = (grey.directions()?, grey.risk(plan.level)?);
        let limit = Limit {
            noise: plan.noise,
            draws: plan.draws,
            seed: plan.seed,
        };
        let (mut limits, mut seen) = (Vec::new(), Vec::new());
        let shown = plan.subjects.iter().map(|s| self.showing(&scene, *s));
        let shown: Vec<MatrixModel> = shown.collect::<Result<_, _>>()?;
        for (subject, model) in plan.subjects.iter().zip(&shown) {
            limits.push(limit.of(&self.scene, model, *subject, control)?);
            if plan.camera.samples > 0 {
                let scene = subject.in_scene(&scene);
                seen.push(plan.camera.photograph(&scene, model, *subject, control)?);
            }
        }
        let shifts: &[f64] = if kind == Kind::None {
            &[]
        } else {
            &plan.misplaced
        };
        let misplaced = |by: &f64| -> Result<Misplaced, LabError> {
            control.check()?;
            let mut there = place;
            there.offset[0] += by;
            let (subject, right) = (plan.subjects[0], &shown[0]);
            let wrong = self.showing(&at(&there)?, subject)?;
            let truth = subject.albedo(&self.scene, right);
            let exact = right.phi_of(&truth);
            let stderr = self.plan.noise.stderrs(&exact, plan.level);
            let photographs = Photographs::drawn(&exact, stderr, plan.seed);
            let recovery = recovered(&wrong, subject, &truth, &photographs, control)?;
            Ok(Misplaced { by: *by, recovery })
        };
        Ok(Row {
            kind,
            spots,
            tries,
            directions,
            risk,
            limits,
            seen,
            misplaced: shifts
                .iter()
                .map(misplaced)
                .collect::<Result<_, LabError>>()?,
            place,
        })
    }

    fn fits(&self, (): &(), index: usize, row: &Row) -> bool {
        row.kind == self.plan.kinds[index % self.plan.kinds.len()]
            && row.limits.len() == self.plan.subjects.len()
    }

    fn finish(&self, (): &(), rows: Vec<Row>) -> Result<Occluders, LabError> {
        let [nu, nv] = self.elements();
        Ok(Occluders {
            scene: self.scene.name.clone(),
            scene_hash: self.scene.hash.clone(),
            pixels: self.scene.camera.pixels(),
            elements: nu * nv,
            noise: self.plan.noise.name().to_owned(),
            level: self.plan.level,
            subjects: self.plan.subjects.clone(),
            sensor: self.plan.camera.sensor.name(),
            draws: self.plan.draws,
            rows,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lab::studies::occluder::kinds;
    use crate::lab::study::tests::small;
    use crate::scene::SensorModel;

    /// Behind a plate that hides the whole view nothing is known but what was known before, R = 1,
    /// and no noise is low enough; past a small one something is.
    #[test]
    fn darkness_tells_nothing() {
        let row = |size: f64| {
            // Two checks do not divide five elements; a plate hardly misplaced is the right one.
            let plan = Plan {
                kinds: vec![Kind::Plate],
                spots: Vec::new(),
                noise: NoiseLaw::Relative,
                level: 0.01,
                start: Place {
                    height: 0.36,
                    offset: [0.0; 2],
                    size,
                },
                search: 0,
                subjects: vec![Subject::Board(2)],
                mask: kinds::random(6, 1),
                camera: Camera {
                    sensor: SensorModel::MachineVision,
                    exposure: 0.1,
                    frames: 1,
                    samples: 1024,
                    seed: 1,
                },
                draws: 1,
                misplaced: vec![1e-9],
                elements: Some(5),
                seed: 1,
            };
            let study = OccluderTasks::new(&small("thesis"), plan).unwrap();
            study.task(&(), 0, Control::none()).unwrap()
        };
        let (hidden, seen) = (row(100.0), row(1.0));
        assert_eq!((hidden.directions, hidden.risk), (vec![0; 4], 1.0));
        assert_eq!(hidden.limits, [None]);
        assert_eq!(hidden.seen[0].recovery.likeness, None);
        assert_eq!(hidden.misplaced[0].recovery.likeness, None);
        assert!(seen.directions[3] > 0 && seen.risk < 1.0 && seen.limits[0].is_some());
        assert!(seen.seen[0].recovery.likeness.is_some());
        assert!(seen.misplaced[0].recovery.is_resolved(), "{seen:?}");
    }
}
