//! The sweep in tasks: first one for each arrangement without noise, then one for each bench under noise.

use serde::{Deserialize, Serialize};

use super::noisy::{self, Compared};
use super::summary::{coefficients, summary};
use super::sweep::{Arrangement, Site};
use super::{
    Configuration, Indicator, IndicatorError, IndicatorPlan, NoisyPoint, configurations, model,
};
use crate::model::ModelError;
use crate::scene::Scene;
use crate::study::task::Division;
use crate::transport::Control;

/// [`super::indicator`] in tasks.
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
pub enum Part {
    /// Every board on one arrangement.
    Swept(Vec<Configuration>),
    /// Every method at every noise on one bench.
    Noisy(Vec<Compared>),
}

impl IndicatorTasks {
    /// The study of a scene.
    ///
    /// # Errors
    /// [`IndicatorError`] if nothing is hidden, there is no object, or no place for the spots.
    pub fn new(scene: &Scene, plan: IndicatorPlan) -> Result<Self, IndicatorError> {
        if scene.hidden().next().is_none() {
            return Err(ModelError::NothingHidden.into());
        }
        let divides = |e: &usize| plan.boards.iter().any(|b| e.is_multiple_of(*b));
        if !plan.elements.iter().any(divides) {
            return Err(IndicatorError::NoObject);
        }
        let widest = plan.half_widths.iter().copied().fold(0.0, f64::max);
        // Two inches for the stagger and to spare.
        let reach = (widest + 2.0) * scene.unit.per_inch();
        let site = Site::new(scene, reach)?.ok_or(IndicatorError::NoCentre)?;
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
    fn noisy(&self, (k, board): (usize, usize)) -> Result<Vec<Compared>, IndicatorError> {
        let found = model(&self.site, &self.arrangements[k], board)?;
        Ok(found.map_or_else(Vec::new, |model| noisy::compared(&model, &self.plan)))
    }
}

/// Checks a side that divide the elements.
fn boards(arrangement: &Arrangement, plan: &IndicatorPlan) -> impl Iterator<Item = usize> {
    let elements = arrangement.elements;
    let boards = plan.boards.iter().copied();
    boards.filter(move |b| elements.is_multiple_of(*b))
}

impl Division for IndicatorTasks {
    type Ground = ();
    type Part = Part;
    type Finding = Indicator;
    type Error = IndicatorError;

    fn tasks(&self) -> usize {
        self.arrangements.len() + self.chosen.len()
    }

    fn ground(&self, _: Control<'_>) -> Result<Option<()>, IndicatorError> {
        Ok(Some(()))
    }

    fn task(&self, (): &(), index: usize, _: Control<'_>) -> Result<Option<Part>, IndicatorError> {
        Ok(Some(match self.arrangements.get(index) {
            Some(own) => Part::Swept(configurations(&self.site, own, &self.plan.boards)?),
            None => Part::Noisy(self.noisy(self.chosen[index - self.arrangements.len()])?),
        }))
    }

    fn fits(&self, (): &(), index: usize, part: &Part) -> bool {
        let points = self.plan.methods.len() * self.plan.noise.len();
        match (part, self.arrangements.get(index)) {
            (Part::Swept(found), Some(own)) => {
                let mut boards = boards(own, &self.plan);
                found.iter().all(|f| boards.any(|b| b == f.board))
            }
            (Part::Noisy(found), None) => {
                let drawn = |c: &Compared| match c {
                    Compared::Measured(c) => c.measured.draws as u64 == self.plan.seeds,
                    _ => true,
                };
                [0, points].contains(&found.len()) && found.iter().all(drawn)
            }
            _ => false,
        }
    }

    fn finish(&self, (): &(), parts: Vec<Part>) -> Result<Indicator, IndicatorError> {
        let (mut configured, mut noisy) = (Vec::new(), Vec::new());
        for (k, part) in parts.into_iter().enumerate() {
            match part {
                Part::Swept(found) => configured.extend(found.into_iter().map(|f| (k, f))),
                Part::Noisy(found) => noisy.push(found),
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
            // Where a recovery had no modulation its bench has dropped out, and others are the chosen ones.
            let compared = match expected.next() {
                Some((own, compared)) if *own == bench => compared,
                _ => self.noisy(bench)?,
            };
            let pairs = noisy::pairs(&self.plan).into_iter().zip(compared);
            points.extend(pairs.map(|((method, noise), compared)| NoisyPoint {
                configuration: i,
                method: method.name().to_owned(),
                noise,
                outcome: compared.into(),
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
