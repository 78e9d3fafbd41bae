//! What does a key of the scene do for the picture?
//!
//! One key takes one value after the other, everything else stays as it is. For each value the
//! matrix model of that scene tells how bright the photographs are, how many directions of the
//! picture are above a noise, and what share of the prior variance is left
//! ([`Grey`](super::grey::Grey)).

use serde::{Deserialize, Serialize};

use super::error::LabError;
use super::finding::{
    Axis, Cell, Column, Curve, Describe, Figure, Finding, Mark, Plot, Spacing, Table,
};
use super::grey::{self, Grey, LEVELS};
use super::noise_law::NoiseLaw;
use super::options::{Opt, OptionError};
use super::registered::{Registered, prepared};
use super::study::{Sharing, Study};
use crate::model::{Kernel, MatrixModel};
use crate::num::digits::figure;
use crate::num::named::Named;
use crate::scene::{Scene, quoted};
use crate::transport::Control;

/// `phicam study sweep`.
pub(super) const STUDY: Registered = Registered {
    name: "sweep",
    about: "What one key of the scene does for the picture, value by value: table, JSON, CSV, figure",
    scene: Some("bench"),
    files: "sweep.csv, sweep.svg",
    options: &[
        Opt::text(
            "key",
            "The key, as in -D, e.g. camera.position.2 or surface.wall.material.lambertian",
        )
        .or("laser.spots.half_width"),
        Opt::text(
            "values",
            "Its values, separated by commas: numbers, with units or without, or words; at least two",
        )
        .list()
        .or("1,1.5,2,2.5,3"),
        Opt::number("noise", "Noise at which the risk is computed, relative to the law's own size")
            .or("0.01")
            .rule(
                |x| x > 0.0 && x <= 1.0,
                "has no meaning here",
                "use a number above 0 and not above 1, e.g. 0.01",
            ),
        Opt::choice("law", "How the noise goes with the light", NoiseLaw::NAMES).or("relative"),
        Opt::whole("elements", "Elements a side, in place of the scene's").within(1, 1024),
    ],
    prepare: |scene, values| {
        let key: String = values.one("key")?;
        let steps: Vec<String> = values.list("values")?;
        if steps.len() < 2 {
            let cause = format!("one value of {key} is no sweep");
            return Err(OptionError::new(cause, "list at least two, as --values 1,2,3").into());
        }
        let with = |value: &String| scene.with(&[(&key, &quoted(value))]);
        let scenes = steps.iter().map(with).collect::<Result<_, _>>()?;
        Ok(prepared(SweepTasks {
            scene: scene.clone(),
            key,
            values: steps,
            scenes,
            noise: values.one("law")?,
            level: values.one("noise")?,
            elements: values.maybe("elements")?.map(|n| [n; 2]),
        }))
    },
};

/// The study of a scene. A task is one value.
#[derive(Debug)]
pub(super) struct SweepTasks {
    scene: Scene,
    key: String,
    values: Vec<String>,
    /// One a value.
    scenes: Vec<Scene>,
    noise: NoiseLaw,
    level: f64,
    elements: Option<[usize; 2]>,
}

/// The scene with one of the values.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct SweepStep {
    pub value: String,
    /// Hash of the scene with it.
    pub scene_hash: String,
    /// Pixels, spots, and elements of the hidden surfaces.
    pub pixels: usize,
    pub spots: usize,
    pub elements: usize,
    /// Flux of the brightest entry and mean over all, of the scene's own picture, W.
    pub brightest: f64,
    pub mean: f64,
    /// Directions above a noise of 10 %, 1 %, 0.1 %, 0.01 %.
    pub directions: Vec<usize>,
    /// Share of the prior variance that is left.
    pub risk: f64,
}

/// What the key does.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Sweep {
    /// Name of the scene.
    pub scene: String,
    /// Its hash, with the key as it is.
    pub scene_hash: String,
    /// The key.
    pub key: String,
    /// How the noise goes with the light.
    pub law: &'static str,
    /// Noise at which the risk is computed.
    pub noise: f64,
    /// In the order of the values.
    pub steps: Vec<SweepStep>,
}

impl Study for SweepTasks {
    type Context = ();
    type Output = SweepStep;
    type Result = Sweep;
    type Error = LabError;

    fn tasks(&self) -> usize {
        self.values.len()
    }

    fn sharing(&self) -> Sharing {
        Sharing::InTurn
    }

    fn context(&self, _: Control<'_>) -> Result<(), LabError> {
        Ok(())
    }

    fn task(&self, (): &(), index: usize, _: Control<'_>) -> Result<SweepStep, LabError> {
        let scene = &self.scenes[index];
        let model = MatrixModel::new(scene, Kernel::Physical, self.elements)?;
        let phi = model.phi();
        let grey = Grey::new(&model, self.noise);
        Ok(SweepStep {
            value: self.values[index].clone(),
            scene_hash: scene.hash.clone(),
            pixels: phi.nrows(),
            spots: phi.ncols(),
            elements: model.albedo.len(),
            brightest: phi.max(),
            mean: phi.mean(),
            directions: grey.directions()?,
            risk: grey.risk(self.level)?,
        })
    }

    fn fits(&self, (): &(), index: usize, step: &SweepStep) -> bool {
        step.value == self.values[index] && step.directions.len() == LEVELS.len()
    }

    fn finish(&self, (): &(), steps: Vec<SweepStep>) -> Result<Sweep, LabError> {
        Ok(Sweep {
            scene: self.scene.name.clone(),
            scene_hash: self.scene.hash.clone(),
            key: self.key.clone(),
            law: self.noise.name(),
            noise: self.level,
            steps,
        })
    }
}

impl Sweep {
    /// Where most is known of the picture, and where least.
    fn sentence(&self) -> String {
        let by_risk = |a: &&SweepStep, b: &&SweepStep| a.risk.total_cmp(&b.risk);
        let ends = [
            self.steps.iter().min_by(by_risk),
            self.steps.iter().max_by(by_risk),
        ];
        let [Some(best), Some(worst)] = ends else {
            return "No value was studied.".to_owned();
        };
        let left = |step: &SweepStep| figure(100.0 * step.risk, 2);
        format!(
            "At a {} noise of {} the photographs leave least of the prior variance, {} %, with {} = \
             {}, and most, {} %, with {}.",
            self.law,
            figure(self.noise, 1),
            left(best),
            self.key,
            best.value,
            left(worst),
            worst.value
        )
    }

    fn table(&self) -> Table {
        let mut columns = vec![
            Column::text(&self.key, "value"),
            Column::text("pixels", "pixels"),
            Column::text("spots", "spots"),
            Column::text("elements", "elements"),
            Column::number("brightest", "brightest", "W", 3),
            Column::number("mean", "mean", "W", 3),
        ];
        columns.extend(grey::columns());
        let row = |s: &SweepStep| {
            let mut row: Vec<Cell> = vec![
                Cell::Text(s.value.clone()),
                s.pixels.into(),
                s.spots.into(),
                s.elements.into(),
                s.brightest.into(),
                s.mean.into(),
            ];
            row.extend(s.directions.iter().map(|n| Cell::from(*n)));
            row.push(s.risk.into());
            row
        };
        Table {
            caption: format!(
                "Entries of Φcam, directions of the picture above a {} noise, and the share of the \
                 prior variance that is left at {}",
                self.law,
                figure(self.noise, 1)
            ),
            file: Some("sweep.csv".to_owned()),
            columns,
            rows: self.steps.iter().map(row).collect(),
            ..Table::default()
        }
    }

    /// Directions and risk over the values: at their places where all are numbers, else one beside
    /// the other.
    fn figure(&self, title: &str) -> Figure {
        let numbers: Option<Vec<f64>> = self.steps.iter().map(|s| s.value.parse().ok()).collect();
        let across = match &numbers {
            Some(x) => Axis::linear(&self.key, [x[0]; 2]),
            None => Axis {
                title: self.key.clone(),
                spacing: Spacing::Categories(self.steps.iter().map(|s| s.value.clone()).collect()),
            },
        };
        let x = |k: usize| numbers.as_ref().map_or(k as f64, |x| x[k]);
        let curve = |name: String, y: &dyn Fn(&SweepStep) -> f64| {
            let points = self.steps.iter().enumerate();
            let points = points.map(|(k, s)| [x(k), y(s)]).collect();
            let mark = if numbers.is_some() {
                Mark::Line
            } else {
                Mark::Points
            };
            Curve::new(name, mark, points)
        };
        let directions = LEVELS.iter().enumerate().map(|(k, level)| {
            let name = format!("above {} %", figure(100.0 * level, 1));
            curve(name, &|s| s.directions[k] as f64)
        });
        let risk = curve(format!("risk at {}", figure(self.noise, 1)), &|s| s.risk);
        let upwards = Axis::linear("directions of the picture", [0.0, 1.0]);
        let left = Axis::linear("share of the prior variance left", [0.0, 1.0]);
        let plots = vec![
            Plot::new("", [across.clone(), upwards], directions.collect()),
            Plot::new("", [across, left], vec![risk]),
        ];
        Figure::new("sweep.svg", title, plots)
    }
}

impl Describe for Sweep {
    fn describe(&self) -> Finding {
        let title = format!("{} of {}", self.key, self.scene);
        Finding {
            sentence: self.sentence(),
            notes: vec![
                "Photographs are those of the matrix model: light of three bounces, with pixels, \
                 elements and spots taken at their centres where nothing stands in the way. Its \
                 noise is relative to the light: exposures are not compared, brightness is in \
                 `brightest` and `mean`."
                    .to_owned(),
                "Nothing is known of the picture beforehand but that reflectances lie about ½ with \
                 a standard deviation of ½. The geometry is taken as known exactly \
                 (`phicam study tolerance` asks what of it must be known how well)."
                    .to_owned(),
            ],
            tables: vec![self.table()],
            figures: vec![self.figure(&title)],
            title,
            ..Finding::default()
        }
    }
}
