//! The light of each element at assumed values of the unknowns, and its derivatives.
//!
//! The unknowns are geometric parameters, then a gain of each frame where gains are unknown: frame
//! l is (1 + g_l) times what the scene sends.

use crate::lab::error::LabError;
use crate::matrix::Matrix;
use crate::model::{
    Differential, Effort, Fineness, Kernel, MatrixModel, Occlusion, Swept, Terms, TermsRate,
    is_obstructed,
};
use crate::scene::{Parameter, Scene, Velocity};

/// Step of a central difference where something stands in the way: part of the distance between the
/// middles of view and hidden surface; of angles and percents; and of percents by which spots and
/// walls spread light, which change it by much less.
const OF_DISTANCE: f64 = 1e-3;
const OF_TURN: f64 = 0.05;
const OF_SPREAD: f64 = 1.0;
/// Halvings of that step where the scene ends within it on both sides.
const HALVINGS: u32 = 10;

/// Change of the light by the last halving of elements, in noises of the photographs, with which
/// the cells are fine enough before the last stage: what is left is a half to a fourth of it.
const OF_NOISE: f64 = 0.2;

/// A scene with its unknowns.
#[derive(Clone, Copy, Debug)]
pub(super) struct Geometry<'a> {
    pub scene: &'a Scene,
    pub parameters: &'a [Parameter],
    pub elements: Option<[usize; 2]>,
    /// Past what stands in the way there is one finer than the first.
    pub fineness: Fineness,
    pub occlusion: Occlusion,
    /// Frames whose gain is unknown: none or all.
    pub gains: usize,
}

/// How the terms change with a parameter.
enum Rate {
    Exact(TermsRate),
    /// Of what hides light and moves alone.
    Swept(Terms),
    Difference {
        more: Terms,
        less: Terms,
        over: f64,
    },
}

/// The light of each element at some values of the unknowns.
pub(super) struct Light {
    terms: Terms,
    gains: Vec<f64>,
    elements: usize,
    rates: Vec<Rate>,
    /// What is taken out of every frame, pixels × elements.
    mean: Option<Matrix>,
}

/// Distance between the middles of the view and of the first hidden surface.
pub(super) fn distance(scene: &Scene) -> f64 {
    let view = scene.camera.view.at([0.5; 2]).position;
    let hidden = scene.hidden().next();
    hidden.map_or(1.0, |(_, s)| {
        (s.shape.at([0.5; 2]).position - view).length()
    })
}

impl Geometry<'_> {
    /// Number of unknowns.
    pub(super) fn unknowns(&self) -> usize {
        self.parameters.len() + self.gains
    }

    /// The scene with its parameters at `values`.
    pub(super) fn scene_at(&self, values: &[f64]) -> Result<Scene, LabError> {
        let own = &values[..self.parameters.len()];
        Ok(self.scene.displaced(self.parameters, own)?)
    }

    /// Whether light is integrated past something in the way, by rules of its own.
    pub(super) fn is_obstructed(&self) -> bool {
        self.occlusion == Occlusion::Considered && is_obstructed(self.scene)
    }

    /// The light of `scene` past what stands in the way, with its rates by these velocities, as
    /// fine as is asked for.
    fn past(
        &self,
        scene: &Scene,
        velocities: &[Velocity],
        effort: Effort,
    ) -> Result<Swept, LabError> {
        if let Some(swept) = Swept::new(scene, self.elements, velocities, effort)? {
            return Ok(swept);
        }
        // What stood in the way does no more.
        let model = MatrixModel::with(scene, Kernel::Physical, self.elements, Occlusion::Ignored)?;
        let elements = model.albedo.len();
        Ok(Swept {
            terms: Terms {
                element: (0..elements).collect(),
                camera: model.camera_side,
                laser: model.laser_side,
            },
            elements,
            rates: velocities.iter().map(|_| None).collect(),
        })
    }

    /// The light at `values` for photographs of this relative noise, with its derivatives where
    /// `rates` says so.
    pub(super) fn light(&self, values: &[f64], noise: f64, rates: bool) -> Result<Light, LabError> {
        let (own, gains) = values.split_at(self.parameters.len());
        let scene = self.scene_at(values)?;
        let parameters = if rates { 0..own.len() } else { 0..0 };
        let velocity = |k| self.scene.velocity(self.parameters, own, k);
        let (terms, elements, rates) = if self.is_obstructed() {
            let velocities: Vec<Velocity> = parameters.map(velocity).collect();
            let effort = Effort::coarse(OF_NOISE * noise);
            let swept = self.past(&scene, &velocities, effort)?;
            let rate = |(k, own_rate): (usize, Option<Terms>)| match own_rate {
                Some(rate) => Ok(Rate::Swept(rate)),
                None => self.difference(own, effort, k),
            };
            let rates = swept.rates.into_iter().enumerate().map(rate);
            let rates = rates.collect::<Result<_, LabError>>()?;
            let terms = match self.fineness {
                Fineness::Centres | Fineness::Areas(..=1) => swept.terms,
                Fineness::Areas(_) => self.past(&scene, &[], Effort::FINEST)?.terms,
            };
            (terms, swept.elements, rates)
        } else {
            let model = Differential::new(&scene, self.elements, self.fineness)?;
            let rates = parameters.map(|k| Rate::Exact(model.rate(&velocity(k))));
            (model.terms(), model.elements(), rates.collect())
        };
        Ok(Light {
            terms,
            gains: gains.to_vec(),
            elements,
            rates,
            mean: None,
        })
    }

    /// The central difference by parameter `k` about the values `own`; where the scene ends on one
    /// side the other one's, by a smaller step where it does on both, and 0 where nothing may move.
    fn difference(&self, own: &[f64], effort: Effort, k: usize) -> Result<Rate, LabError> {
        let p = &self.parameters[k];
        let step = if p.is_of_spread() {
            OF_SPREAD
        } else if p.is_angle() || p.is_percent() {
            OF_TURN
        } else {
            OF_DISTANCE * distance(self.scene)
        };
        let moved = |by: f64| {
            let mut values = own.to_vec();
            values[k] += by;
            values
        };
        let open = |by: f64| {
            if self.refused(&moved(by)).is_some() {
                0.0
            } else {
                by
            }
        };
        let mut shares = (0..HALVINGS).map(|halving| step * 0.5f64.powi(halving.cast_signed()));
        let ends =
            shares.find_map(|by| Some([open(by), open(-by)]).filter(|ends| *ends != [0.0; 2]));
        let [more, less] = ends.unwrap_or_default();
        let at = |by: f64| -> Result<Terms, LabError> {
            let scene = self.scene_at(&moved(by))?;
            Ok(self.past(&scene, &[], effort)?.terms)
        };
        Ok(Rate::Difference {
            more: at(more)?,
            less: at(less)?,
            over: ends.map_or(step, |_| more - less),
        })
    }
}

impl Light {
    /// Number of elements.
    pub(super) fn elements(&self) -> usize {
        self.elements
    }

    fn gain(&self, l: usize) -> f64 {
        1.0 + self.gains.get(l).copied().unwrap_or(0.0)
    }

    /// The same less its means over the frames by these weights, pixels × frames.
    pub(super) fn less_means(self, shares: &Matrix) -> Self {
        let gains = |l: usize| self.gain(l);
        let shares = Matrix::from_fn(shares.nrows(), shares.ncols(), |p, l| {
            shares[(p, l)] * gains(l)
        });
        Self {
            mean: Some(self.terms.mean(&shares, self.elements)),
            ..self
        }
    }

    /// What frame l shows of each element at albedo 1, pixels × elements, W.
    pub(super) fn frame(&self, l: usize) -> Matrix {
        let own = self.terms.frame(l, self.elements) * self.gain(l);
        match &self.mean {
            Some(mean) => own - mean,
            None => own,
        }
    }

    /// ∂ of that by unknown k, means not taken out; none where it is 0.
    pub(super) fn frame_rate(&self, l: usize, k: usize) -> Option<Matrix> {
        let n = self.elements;
        match self.rates.get(k) {
            None => (k - self.rates.len() == l).then(|| self.terms.frame(l, n)),
            Some(Rate::Exact(rate)) => {
                let still = |laser: &Matrix| laser.column(l).iter().all(|x| *x == 0.0);
                if rate.camera.is_none() && rate.laser.as_ref().is_none_or(still) {
                    return None;
                }
                Some(self.terms.frame_rate(rate, l, n) * self.gain(l))
            }
            Some(Rate::Swept(rate)) => Some(rate.frame(l, n) * self.gain(l)),
            Some(Rate::Difference { more, less, over }) => {
                Some((more.frame(l, n) - less.frame(l, n)) * (self.gain(l) / over))
            }
        }
    }
}
