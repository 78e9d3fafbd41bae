//! The tasks of the study: the search for the best layout, and each layout that it is compared
//! with.

use serde::{Deserialize, Serialize};

use super::design::left;
use super::exchange::rounded;
use super::found::{Layouts, Optimum, Row};
use super::photographs::{GREY, Photographs};
use super::places::Places;
use super::plan::Plan;
use super::search::searched;
use crate::geometry::Shape;
use crate::lab::error::LabError;
use crate::lab::studies::foot_on_wall::foot_on_wall;
use crate::lab::studies::limit::Limit;
use crate::lab::studies::subject::Subject;
use crate::lab::study::Study;
use crate::model::{Kernel, MatrixModel};
use crate::scene::{Scene, spots};
use crate::transport::Control;

/// Half-widths of the published squares, in., and whether their sides are staggered by −1, 1, 0 in.
const PUBLISHED: [(f64, bool); 4] = [(3.0, false), (3.0, true), (6.0, false), (6.0, true)];

/// The study of a scene.
#[derive(Debug)]
pub(super) struct LayoutTasks {
    scene: Scene,
    plan: Plan,
}

/// What all layouts share.
#[derive(Debug)]
pub(super) struct Context {
    pub(super) photographs: Photographs,
    places: Places,
}

/// What a task finds: rows of layouts, and what of the search the first task made.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Output {
    rows: Vec<Row>,
    optimum: Option<Optimum>,
}

impl LayoutTasks {
    /// # Errors
    /// [`LabError::Unsuited`] where not so many spots fit on the wall.
    pub(super) fn new(scene: &Scene, plan: Plan) -> Result<Self, LabError> {
        let scene = scene.clone();
        let places = Places::new(&scene, plan.margin, plan.apart);
        let all = places.grid(plan.candidates);
        let _ = rounded(&vec![1.0; all.len()], &all, &places, plan.count)?;
        Ok(Self { scene, plan })
    }

    fn elements(&self) -> Option<[usize; 2]> {
        self.plan.elements.map(|n| [n; 2])
    }

    /// The layout of spots at `places` in `scene`, which may have another view.
    fn row(
        &self,
        context: &Context,
        name: &str,
        scene: &Scene,
        places: &[[f64; 2]],
        control: Control<'_>,
    ) -> Result<Row, LabError> {
        let mut photographs = context.photographs.clone();
        photographs.scene = scene.clone();
        let triangles = photographs.triangles(places, control)?;
        let lit: Vec<[f64; 2]> = places
            .iter()
            .zip(&triangles)
            .filter_map(|(place, r)| r.as_ref().map(|_| *place))
            .collect();
        if lit.is_empty() {
            return Err(LabError::DARK);
        }
        let left = left(
            triangles.into_iter().flatten().collect(),
            &photographs.factor,
        )?;
        let scene = scene.with_spots_at(&lit)?;
        let own = scene.hidden().next().map(|(_, s)| s.elements);
        let own = self.elements().or(own).unwrap_or_default();
        let limit = Limit {
            noise: self.plan.noise,
            draws: self.plan.draws,
            seed: self.plan.seed,
        };
        let limits = self.plan.boards.iter().map(|n| {
            let board = Subject::Board(*n);
            let model = MatrixModel::new(&scene, Kernel::Physical, Some(board.elements(own)))?;
            limit.of(&scene, &model, board, control)
        });
        Ok(Row {
            name: name.to_owned(),
            spots: lit.len(),
            risk: left.risk,
            directions: left.directions,
            limits: limits.collect::<Result<_, LabError>>()?,
        })
    }

    /// The first task: the best layout, and the same with the whole wall in view.
    fn search(&self, context: &Context, control: Control<'_>) -> Result<Output, LabError> {
        let optimum = searched(&self.plan, &context.photographs, &context.places, control)?;
        let own = self.row(context, "optimised", &self.scene, &optimum.layout, control)?;
        let mut rows = vec![own];
        if self.plan.wall_in_view
            && let Some(scene) = with_wall_in_view(&self.scene)
        {
            let name = "optimised, whole wall in view";
            rows.push(self.row(context, name, &scene, &optimum.layout, control)?);
        }
        let optimum = Some(optimum);
        Ok(Output { rows, optimum })
    }

    /// The other layouts: that of the scene, and the published squares around the foot of the
    /// hidden surface, as far as they are on the wall.
    fn other(
        &self,
        context: &Context,
        index: usize,
        control: Control<'_>,
    ) -> Result<Output, LabError> {
        let (name, places) = match index.checked_sub(1) {
            None => {
                let place = |s: &crate::scene::Spot| [s.target.position.x, s.target.position.y];
                let own = self.scene.laser.spots.iter().map(place).collect();
                ("the scene's own".to_owned(), own)
            }
            Some(k) => {
                let (half, staggered) = PUBLISHED[k];
                let inch = self.scene.unit.per_inch();
                let side = (self.plan.count / 4).max(2) as u32;
                let stagger: &[f64] = if staggered { &[-inch, inch, 0.0] } else { &[] };
                let square = |centre| spots::square(centre, half * inch, side, stagger);
                let word = if staggered {
                    "staggered square"
                } else {
                    "square"
                };
                let places = foot_on_wall(&self.scene).map(square).unwrap_or_default();
                (format!("{word} of {half} in."), places)
            }
        };
        let on_the_wall = !places.is_empty() && self.scene.with_spots_at(&places).is_ok();
        let rows = if on_the_wall {
            vec![self.row(context, &name, &self.scene, &places, control)?]
        } else {
            Vec::new()
        };
        Ok(Output {
            rows,
            optimum: None,
        })
    }
}

/// The scene with a camera of as many pixels that sees the whole of its first flat wall.
fn with_wall_in_view(scene: &Scene) -> Option<Scene> {
    let mut scene = scene.clone();
    let wall = scene.relays().find_map(|(_, wall)| match &wall.shape {
        Shape::Parallelogram(p) => Some(*p),
        _ => None,
    })?;
    scene.camera.view = wall;
    Some(scene)
}

impl Study for LayoutTasks {
    type Context = Context;
    type Output = Output;
    type Result = Layouts;
    type Error = LabError;

    fn tasks(&self) -> usize {
        2 + PUBLISHED.len()
    }

    fn context(&self, _: Control<'_>) -> Result<Context, LabError> {
        let plan = &self.plan;
        let model = MatrixModel::new(&self.scene, Kernel::Physical, self.elements())?;
        let photographs = Photographs {
            scene: self.scene.clone(),
            elements: self.elements(),
            noise: plan.noise,
            level: plan.level,
            top: model.phi_of(&vec![GREY; model.albedo.len()]).amax(),
            factor: plan.prior.factor(&model)?,
            unsure: plan.unsure.clone(),
        };
        Ok(Context {
            photographs,
            places: Places::new(&self.scene, plan.margin, plan.apart),
        })
    }

    fn task(
        &self,
        context: &Context,
        index: usize,
        control: Control<'_>,
    ) -> Result<Output, LabError> {
        match index.checked_sub(1) {
            None => self.search(context, control),
            Some(other) => self.other(context, other, control),
        }
    }

    fn fits(&self, _: &Context, index: usize, output: &Output) -> bool {
        let whole = |row: &Row| row.limits.len() == self.plan.boards.len();
        let alike = |o: &Optimum| o.weights.len() == o.candidates.len();
        let layout = output.optimum.as_ref().filter(|o| alike(o));
        let layout = layout.map(|o| o.layout.len());
        output.rows.iter().all(whole) && layout == (index == 0).then_some(self.plan.count)
    }

    fn finish(&self, context: &Context, outputs: Vec<Output>) -> Result<Layouts, LabError> {
        let mut rows = Vec::new();
        let mut found = None;
        for output in outputs {
            // The layouts to compare with come first.
            if output.optimum.is_some() {
                found = output.optimum.map(|optimum| (optimum, output.rows));
            } else {
                rows.extend(output.rows);
            }
        }
        let Some((optimum, best)) = found else {
            return Err(LabError::DARK);
        };
        rows.extend(best);
        let scene = &self.scene;
        let corners = |p: [glam::DVec3; 4]| p.map(|c| [c.x, c.y]).to_vec();
        let walls = scene.relays().filter_map(|(_, wall)| match &wall.shape {
            Shape::Parallelogram(p) => Some(corners(p.corners())),
            _ => None,
        });
        Ok(Layouts {
            scene: scene.name.clone(),
            scene_hash: scene.hash.clone(),
            unit: scene.unit.symbol(),
            pixels: [scene.camera.columns, scene.camera.rows],
            elements: context.photographs.factor.nrows(),
            noise: self.plan.noise.name(),
            level: self.plan.level,
            prior: self.plan.prior.told(scene.unit.symbol()),
            unsure: self.plan.unsure.len(),
            boards: self.plan.boards.clone(),
            draws: self.plan.draws,
            walls: walls.collect(),
            view: corners(scene.camera.view.corners()),
            text: scene.with_listed_spots(&optimum.layout)?.text,
            rows,
            optimum,
        })
    }
}
