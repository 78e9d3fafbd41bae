//! The tasks of the study: an occluder and a number of spots each.

use super::found::{LEVELS, Misplaced, Occluders, Row, SEARCHED};
use super::kinds::{Kind, Place};
use super::search::search;
use crate::lab::ensemble::Photographs;
use crate::lab::error::LabError;
use crate::lab::fit::{Certainty, Residuals};
use crate::lab::problem::problem;
use crate::lab::study::{Sharing, Study};
use crate::matrix::Matrix;
use crate::metrics::mtf_raw;
use crate::model::{Kernel, MatrixModel, ModelError};
use crate::recovery::{Method, Options, determined, picard_joint, recover};
use crate::scene::Scene;
use crate::transport::Control;

/// Kinds of noise: how the standard error goes with the light of an entry.
pub(super) const NOISES: &[(&str, &str)] = &[
    ("relative", "A share of each entry"),
    (
        "shot",
        "The same share of the brightest entry, of others by the root of their light",
    ),
    ("read", "The same for all entries, a share of the brightest"),
];

/// Contrast at which a board counts as resolved.
const RESOLVED: f64 = 0.9;
/// Decades of noise, from 1 down, in which its limit is looked for, and halvings.
const DECADES: f64 = 10.0;
const HALVINGS: usize = 8;
/// Standard deviation of the prior, about ½.
const BEFORE: f64 = 0.5;

/// What is studied.
#[derive(Clone, Debug)]
pub(super) struct Plan {
    pub kinds: Vec<Kind>,
    pub spots: Vec<usize>,
    /// Index in [`NOISES`].
    pub noise: usize,
    pub level: f64,
    pub start: Place,
    pub search: usize,
    pub boards: Vec<usize>,
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
        plan.spots.iter_mut().for_each(|n| *n = (*n).min(all));
        plan.spots.dedup();
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

    /// Standard errors of photographs `phi` at noise `level`.
    fn stderr(&self, phi: &Matrix, level: f64) -> Matrix {
        let top = phi.amax();
        let of = |x: f64| match NOISES[self.plan.noise].0 {
            "relative" => x,
            "shot" => (x * top).sqrt(),
            _ => top,
        };
        // Entries without light have the noise of a ten-thousandth of the brightest.
        phi.map(|x| level * of(x.abs()).max(1e-4 * top))
    }

    /// Share of the prior variance that photographs of a surface of mean ½ leave.
    fn risk(&self, model: &MatrixModel, level: f64) -> Result<f64, LabError> {
        let grey = model.phi_of(&vec![BEFORE; model.albedo.len()]);
        let stderr = self.stderr(&grey, level);
        let shares = determined(&problem(model, &grey, Some(&stderr))?)?;
        Ok(1.0 - shares.rank / model.albedo.len() as f64)
    }

    /// MTF of the recovered board and P of its fit, from one draw of the photographs `exact`.
    fn recovered(
        &self,
        model: &MatrixModel,
        board: &[f64],
        exact: &Matrix,
        level: f64,
        seed: u64,
    ) -> Result<(Option<f64>, Option<f64>), LabError> {
        let Photographs { phi, stderr } =
            Photographs::drawn(exact, self.stderr(exact, level), seed);
        let problem = problem(model, &phi, Some(&stderr))?;
        let found = recover(Method::Joint, &problem, &Options::default())?;
        let mut residuals = Residuals::default();
        residuals.add(
            &phi,
            &found.photographs(&problem),
            &stderr,
            Certainty::STATED,
        );
        let fit = residuals.fit(found.freedom_used(), Certainty::STATED.errors);
        Ok((
            mtf_raw(found.reflectance.as_slice(), board),
            fit.map(|f| f.p),
        ))
    }

    /// The most noise at which the board's mean MTF over the draws is 0.9; none below 1e-10.
    fn limit(
        &self,
        model: &MatrixModel,
        board: &[f64],
        control: Control<'_>,
    ) -> Result<Option<f64>, LabError> {
        let exact = model.phi_of(board);
        let resolved = |decades: f64| -> Result<bool, LabError> {
            let mut sum = 0.0;
            for draw in 0..self.plan.draws {
                control.check()?;
                let level = libm::pow(10.0, -decades);
                let seed = self.plan.seed.wrapping_add(draw);
                sum += self
                    .recovered(model, board, &exact, level, seed)?
                    .0
                    .unwrap_or(0.0);
            }
            Ok(sum >= RESOLVED * self.plan.draws as f64)
        };
        if resolved(0.0)? {
            return Ok(Some(1.0));
        }
        let [mut lost, mut kept] = [0.0, DECADES];
        if !resolved(kept)? {
            return Ok(None);
        }
        for _ in 0..HALVINGS {
            let middle = 0.5 * (lost + kept);
            if resolved(middle)? {
                kept = middle;
            } else {
                lost = middle;
            }
        }
        Ok(Some(libm::pow(10.0, -kept)))
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

    fn name(&self) -> &'static str {
        "occluder"
    }

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
            let scene = kind.in_scene(&rough, place)?;
            self.risk(&self.model(&scene)?, plan.level)
        };
        let tries = if kind == Kind::None { 0 } else { plan.search };
        let (place, tries) = search(plan.start, tries, merit)?;
        let whole = thinned(&self.scene, spots, usize::MAX);
        let at = |place: &Place| self.model(&kind.in_scene(&whole, place)?);
        let model = at(&place)?;
        let grey = model.phi_of(&vec![BEFORE; model.albedo.len()]);
        let stderr = self.stderr(&grey, 1.0);
        let sigma =
            picard_joint(&problem(&model, &grey, Some(&stderr))?, &Options::default())?.sigma;
        let above = |level: f64| sigma.iter().filter(|s| **s * BEFORE > level).count();
        let boards: Vec<Vec<f64>> = plan
            .boards
            .iter()
            .map(|b| board(&self.scene, &model, *b))
            .collect();
        let limits = boards.iter().map(|b| self.limit(&model, b, control));
        let limits = limits.collect::<Result<_, LabError>>()?;
        let shifts: &[f64] = if kind == Kind::None {
            &[]
        } else {
            &plan.misplaced
        };
        let wrong = |by: &f64| -> Result<Misplaced, LabError> {
            control.check()?;
            let mut there = place;
            there.offset[0] += by;
            let (mtf, p) = match boards.first() {
                Some(b) => {
                    let exact = model.phi_of(b);
                    self.recovered(&at(&there)?, b, &exact, plan.level, plan.seed)?
                }
                None => (None, None),
            };
            Ok(Misplaced { by: *by, mtf, p })
        };
        Ok(Row {
            kind,
            spots,
            tries,
            directions: LEVELS.iter().map(|l| above(*l)).collect(),
            risk: self.risk(&model, plan.level)?,
            limits,
            misplaced: shifts.iter().map(wrong).collect::<Result<_, LabError>>()?,
            place,
        })
    }

    fn fits(&self, (): &(), index: usize, row: &Row) -> bool {
        row.kind == self.plan.kinds[index % self.plan.kinds.len()]
            && row.limits.len() == self.plan.boards.len()
    }

    fn finish(&self, (): &(), rows: Vec<Row>) -> Result<Occluders, LabError> {
        let elements = self.plan.elements.map_or_else(
            || {
                self.scene
                    .hidden()
                    .map(|(_, s)| s.elements[0] * s.elements[1])
                    .sum()
            },
            |n| n * n * self.scene.hidden().count(),
        );
        Ok(Occluders {
            scene: self.scene.name.clone(),
            scene_hash: self.scene.hash.clone(),
            pixels: self.scene.camera.pixels(),
            elements,
            noise: NOISES[self.plan.noise].0.to_owned(),
            level: self.plan.level,
            boards: self.plan.boards.clone(),
            draws: self.plan.draws,
            rows,
        })
    }
}

/// A board of `checks` a side by the elements of the model.
fn board(scene: &Scene, model: &MatrixModel, checks: usize) -> Vec<f64> {
    let scene = scene.with_checkerboard(checks);
    let each = scene.hidden().zip(&model.grids);
    each.flat_map(|((_, surface), grid)| surface.divided(grid.count))
        .map(|element| element.albedo)
        .collect()
}
