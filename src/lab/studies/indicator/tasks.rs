//! The sweep in tasks: first one for each arrangement without noise, then one for each bench under
//! noise.

use serde::{Deserialize, Serialize};

use super::configuration::{Configuration, configurations, model};
use super::noisy::{self, NoisyOutcome, NoisyPoint};
use super::plan::IndicatorPlan;
use super::study::Indicator;
use super::summary::{coefficients, summary};
use super::sweep::{Arrangement, Layout, Site};
use crate::lab::LabError;
use crate::lab::options::Opt;
use crate::lab::studies::registered::{Registered, prepared};
use crate::lab::study::Study;
use crate::model::{Kernel, ModelError};
use crate::scene::Scene;
use crate::transport::Control;

/// No point of the wall lies opposite the hidden surface.
const NO_CENTRE: LabError = LabError::Unsuited(
    "the normal of the hidden surface meets no wall, so there is no centre for the spots to lie around (turn the surface towards the wall)",
);

/// What predicts how well the published inversion works: without noise on every bench, under noise
/// on every N-th.
pub struct IndicatorTasks {
    name: String,
    hash: String,
    plan: IndicatorPlan,
    site: Site,
    arrangements: Vec<Arrangement>,
    /// Arrangements (by number) and checks a side of the benches that are taken under noise.
    chosen: Vec<(usize, usize)>,
}

/// What a task gives.
#[derive(Debug, Serialize, Deserialize)]
pub enum Output {
    /// Every board on one arrangement.
    Swept(Vec<Configuration>),
    /// Every method at every noise on one bench.
    Noisy(Vec<NoisyOutcome>),
}

/// `phicam study indicator`.
pub(in crate::lab) const STUDY: Registered = Registered {
    name: "indicator",
    about: "What predicts the modulation of the published inversion: table, JSON, CSV, figure",
    scene: Some("thesis"),
    files: "indicator.csv, indicator-noise.csv, indicator.svg",
    options: &[
        Opt::whole("spots", "Numbers of spots, separated by commas")
            .or("8,24,60,120,240,400")
            .list()
            .within(1, 10_000),
        Opt::number(
            "half-widths",
            "Half-widths or radii in inches, separated by commas; the scene's wall is extended to hold every spot",
        )
        .or("1,2,3,4.5,6,8,10,14")
        .list()
        .rule(
            |x| x > 0.0 && x <= 1000.0,
            "is not a size of a layout",
            "use inches above 0 and up to 1000",
        ),
        Opt::whole("elements", "Elements a side, separated by commas")
            .or("4,6,8")
            .list()
            .within(1, 1024),
        Opt::whole(
            "boards",
            "Checks a side of the objects, separated by commas; with each number of elements those that divide it",
        )
        .or("2,4,8")
        .list()
        .within(2, 1024),
        Opt::methods(
            "Methods compared under noise, separated by commas; those that state their covariance are predicted",
            "pinv,tsvd,tikhonov,joint-unbounded",
        ),
        Opt::relative_noise("Relative noise of each entry, separated by commas")
            .or("1e-10,1e-8,1e-6,1e-4,1e-2"),
        Opt {
            value: Some("N"),
            ..Opt::whole("every", "Under noise every N-th configuration only")
                .or("61")
                .within(1, u64::MAX)
        },
        Opt::whole("seeds", "Draws of the noise").or("50").within(2, 100_000),
        Opt::seed("First seed"),
    ],
    prepare: |scene, values| {
        let plan = IndicatorPlan {
            layouts: Layout::ALL.to_vec(),
            spots: values.list("spots")?,
            half_widths: values.list("half-widths")?,
            elements: values.sides("elements")?,
            boards: values.sides("boards")?,
            kernels: vec![Kernel::Physical, Kernel::Published],
            methods: values.methods()?,
            noise: values.list("noise")?,
            every: values.one("every")?,
            seeds: values.one("seeds")?,
            first_seed: values.one("seed")?,
        };
        Ok(prepared(IndicatorTasks::new(scene, plan)?))
    },
};

impl IndicatorTasks {
    /// The study of a scene.
    ///
    /// # Errors
    /// [`LabError`] if nothing is hidden, there is no object, or no place for the spots.
    pub fn new(scene: &Scene, plan: IndicatorPlan) -> Result<Self, LabError> {
        if scene.hidden().next().is_none() {
            return Err(ModelError::NothingHidden.into());
        }
        let divides = |e: &usize| plan.boards.iter().any(|b| e.is_multiple_of(*b));
        if !plan.elements.iter().any(divides) {
            return Err(LabError::NO_OBJECT);
        }
        let widest = plan.half_widths.iter().copied().fold(0.0, f64::max);
        // Two inches for the stagger and to spare.
        let reach = (widest + 2.0) * scene.unit.per_inch();
        let site = Site::new(scene, reach)?.ok_or(NO_CENTRE)?;
        let arrangements = plan.arrangements();
        let mut benches = Vec::new();
        for (k, arrangement) in arrangements.iter().enumerate() {
            if site.arranged(arrangement)?.is_some() {
                benches.extend(boards(arrangement, &plan).map(|board| (k, board)));
            }
        }
        Ok(Self {
            name: scene.name.clone(),
            hash: scene.hash.clone(),
            chosen: benches.into_iter().step_by(plan.every.max(1)).collect(),
            plan,
            site,
            arrangements,
        })
    }

    /// The bench of an arrangement and a board, under noise.
    fn noisy(
        &self,
        (k, board): (usize, usize),
        control: Control<'_>,
    ) -> Result<Vec<NoisyOutcome>, LabError> {
        match model(&self.site, &self.arrangements[k], board)? {
            Some(model) => noisy::compared(&model, &self.plan, control),
            None => Ok(Vec::new()),
        }
    }
}

/// Checks a side that divide the elements.
fn boards(arrangement: &Arrangement, plan: &IndicatorPlan) -> impl Iterator<Item = usize> {
    let elements = arrangement.elements;
    let boards = plan.boards.iter().copied();
    boards.filter(move |b| elements.is_multiple_of(*b))
}

impl Study for IndicatorTasks {
    type Context = ();
    type Output = Output;
    type Result = Indicator;
    type Error = LabError;

    fn tasks(&self) -> usize {
        self.arrangements.len() + self.chosen.len()
    }

    fn context(&self, _: Control<'_>) -> Result<(), LabError> {
        Ok(())
    }

    fn task(&self, (): &(), index: usize, control: Control<'_>) -> Result<Output, LabError> {
        Ok(match self.arrangements.get(index) {
            Some(own) => {
                Output::Swept(configurations(&self.site, own, &self.plan.boards, control)?)
            }
            None => {
                let bench = self.chosen[index - self.arrangements.len()];
                Output::Noisy(self.noisy(bench, control)?)
            }
        })
    }

    fn fits(&self, (): &(), index: usize, part: &Output) -> bool {
        let points = self.plan.methods.len() * self.plan.noise.len();
        match (part, self.arrangements.get(index)) {
            (Output::Swept(found), Some(own)) => {
                let mut boards = boards(own, &self.plan);
                found.iter().all(|f| boards.any(|b| b == f.board))
            }
            (Output::Noisy(found), None) => {
                let drawn = |c: &NoisyOutcome| match c {
                    NoisyOutcome::Compared(c) => c.measured.draws as u64 == self.plan.seeds,
                    _ => true,
                };
                [0, points].contains(&found.len()) && found.iter().all(drawn)
            }
            _ => false,
        }
    }

    fn finish(&self, (): &(), parts: Vec<Output>) -> Result<Indicator, LabError> {
        let (mut configured, mut noisy) = (Vec::new(), Vec::new());
        for (k, part) in parts.into_iter().enumerate() {
            match part {
                Output::Swept(found) => configured.extend(found.into_iter().map(|f| (k, f))),
                Output::Noisy(found) => noisy.push(found),
            }
        }
        let mut expected = self.chosen.iter().zip(noisy);
        let mut points = Vec::new();
        for (i, (k, found)) in configured
            .iter()
            .enumerate()
            .step_by(self.plan.every.max(1))
        {
            let bench = (*k, found.board);
            // Where a recovery had no modulation its bench has dropped out, and others are the
            // chosen ones.
            let compared = match expected.next() {
                Some((own, compared)) if *own == bench => compared,
                _ => self.noisy(bench, Control::none())?,
            };
            let pairs = noisy::pairs(&self.plan).into_iter().zip(compared);
            points.extend(pairs.map(|((method, noise), compared)| NoisyPoint {
                configuration: i,
                method: method.name().to_owned(),
                noise,
                outcome: compared,
            }));
        }
        let configurations: Vec<Configuration> = configured.into_iter().map(|c| c.1).collect();
        let identity = configurations
            .iter()
            .map(|c| (c.projected - c.mtf).abs())
            .fold(0.0, f64::max);
        let mtf: Vec<f64> = configurations.iter().map(|c| c.mtf).collect();
        let everything: Vec<&Configuration> = configurations.iter().collect();
        let noisy = self.plan.methods.iter();
        Ok(Indicator {
            scene: self.name.clone(),
            scene_hash: self.hash.clone(),
            seeds: self.plan.seeds,
            first_seed: self.plan.first_seed,
            identity,
            coefficients: coefficients(&everything, &mtf),
            noisy: noisy
                .map(|m| summary(*m, &points, &configurations))
                .collect(),
            points,
            configurations,
        })
    }
}
