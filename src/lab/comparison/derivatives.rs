//! What may be off in a scene, and what each deviation does to the model: derivatives by central
//! differences of the quadrature; past flat figures in closed form.

use std::sync::OnceLock;

use super::misplaced::{ALL, Misplaced, Size};
use super::over_view::over_view;
use super::score::Parameter;
use super::shaded::{Shaded, albedo_of};
use crate::geometry::DVec3;
use crate::matrix::Matrix;
use crate::model::{Kernel, Nodes, integrated};
use crate::scene::Scene;

/// The scale of all light, light beside it, the albedos, and everything that the tolerance study
/// misplaces.
pub(in crate::lab) struct SceneDerivatives<'a> {
    scene: &'a Scene,
    kernel: Kernel,
    nodes: Nodes,
    /// Modelled Φcam, W, and what of it is visible: 1 where nothing is known to stand in the way.
    phi: &'a Matrix,
    visible: Option<&'a Matrix>,
    step: f64,
    kinds: Vec<Kind>,
    shaded: Shaded,
    /// What `nodes` give of the scene as it is, with nothing in the way.
    here: OnceLock<Option<Matrix>>,
    /// By index as for [`Self::of`].
    pub(in crate::lab) parameters: Vec<Parameter>,
}

/// How a derivative is taken.
#[derive(Clone, Copy)]
enum Kind {
    /// Φ itself.
    Scale,
    /// The same light in every entry: dark current, stray light.
    Offset,
    /// Light, or a share of it, of a pattern of [`over_view`].
    OverView(usize),
    /// The albedo of a surface.
    Albedo(usize),
    Misplaced(&'static Misplaced),
    /// A shift of what stands in the way.
    Shift,
}

/// Relative change of an albedo, or of the view's size, percent.
const PERCENT: f64 = 0.1;
/// Step of a length over the shortest distance between wall and hidden surfaces, and at most over
/// that between their middles: the rest of a central difference is of its square, 1e-4.
const OF_NEAREST: f64 = 0.01;
const OF_MIDDLE: f64 = 1e-3;
/// Scale and offset of the light of one spot: its laser, its exposure, the dark level then.
const OF_ONE: [&str; 2] = [
    "one photograph alone, scale",
    "one photograph alone, offset",
];
/// Patterns over the view, of what: light that all frames share, in percent of its mean, and a
/// falloff, in percent of the light, both at the ends of the view.
const OVER_VIEW: [(usize, &str, &str); 5] = [
    (1, "slope of all entries, x", "% of the mean"),
    (2, "slope of all entries, y", "% of the mean"),
    (3, "falloff over the view, x", "%"),
    (4, "falloff over the view, y", "%"),
    (5, "falloff to the corners of the view", "%"),
];
/// 1 − cos² of the angle between two derivatives below which no light tells them apart.
const PARALLEL: f64 = 1e-6;

impl<'a> SceneDerivatives<'a> {
    /// Those of the model of `scene`, which is `phi`; albedos that act on every entry alike are
    /// counted to the scale. `visible` is the share of each entry that is not hidden: derivatives
    /// then are [`Shaded`]; where that knows none, those of the model without occlusion times this
    /// share, as if shadows stayed where they are.
    pub(in crate::lab) fn new(
        scene: &'a Scene,
        kernel: Kernel,
        nodes: Nodes,
        phi: &'a Matrix,
        visible: Option<&'a Matrix>,
    ) -> Self {
        let power = if scene.laser.is_shining() {
            "exitance"
        } else {
            "laser power"
        };
        let several = scene.laser.spots.len() > 1;
        let scale = Parameter {
            name: "overall scale".to_owned(),
            unit: "%".to_owned(),
            reach: None,
            same: vec![(power.to_owned(), 1.0), ("aperture".to_owned(), 1.0)],
            each_spot: several.then(|| OF_ONE[0].to_owned()),
        };
        let mut found = Self {
            scene,
            kernel,
            nodes,
            phi,
            visible,
            step: step(scene),
            kinds: vec![Kind::Scale],
            shaded: match (visible, kernel) {
                (Some(_), Kernel::Physical) => Shaded::new(scene).unwrap_or_default(),
                _ => Shaded::default(),
            },
            here: OnceLock::new(),
            parameters: vec![scale],
        };
        let offset = "offset of all entries".to_owned();
        let each = several.then_some(OF_ONE[1]);
        found.add(Kind::Offset, offset, "% of the mean", each);
        let [columns, rows] = [scene.camera.columns, scene.camera.rows];
        for (pattern, name, unit) in OVER_VIEW {
            // Of fewer pixels it is none, or the scale.
            let varies = match pattern {
                1 | 3 => columns > 1,
                2 | 4 => rows > 1,
                _ => columns.max(rows) > 2,
            };
            if varies {
                found.add(Kind::OverView(pattern), name.to_owned(), unit, None);
            }
        }
        let reflecting = scene.relays().chain(scene.hidden());
        for (index, surface) in reflecting.filter(|(_, s)| s.is_lambertian()) {
            let name = albedo_of(&surface.name);
            let kind = Kind::Albedo(index);
            match found.by(kind, &name).and_then(|d| factor(&d, phi)) {
                Some(factor) => found.parameters[0].same.push((name, 1.0 / factor)),
                None => found.add(kind, name, "%", None),
            }
        }
        let tried = |what: &&Misplaced| what.size != Size::Random && what.is_in(scene);
        for what in ALL.iter().filter(tried) {
            let each = what.each_spot.filter(|_| several);
            let unit = what.size.unit(scene);
            found.add(Kind::Misplaced(what), what.name.to_owned(), unit, each);
        }
        for shift in found.shaded.shifts.clone() {
            found.add(Kind::Shift, shift.name, &shift.unit, None);
        }
        found
    }

    fn add(&mut self, kind: Kind, name: String, unit: &str, each_spot: Option<&str>) {
        let reach = match (kind, unit) {
            (Kind::Albedo(_) | Kind::Offset | Kind::OverView(_), _) => None,
            (_, "deg") => Some(90.0),
            (_, "%") => Some(100.0),
            _ => Some(nearest_and_middle(self.scene)[1]),
        };
        self.kinds.push(kind);
        self.parameters.push(Parameter {
            name,
            unit: unit.to_owned(),
            reach,
            same: Vec::new(),
            each_spot: each_spot.map(str::to_owned),
        });
    }

    /// ∂Φ/∂θ, W per unit.
    pub(in crate::lab) fn of(&self, index: usize) -> Option<Matrix> {
        self.by(self.kinds[index], &self.parameters[index].name)
    }

    /// Whether shadows are taken to stay where they are.
    pub(super) fn are_shadows_still(&self) -> bool {
        self.visible.is_some() && !self.shaded.is_known()
    }

    fn by(&self, kind: Kind, name: &str) -> Option<Matrix> {
        match self.shaded.rates.get(name) {
            Some(rate) => Some(rate.clone()),
            None => self.difference(kind),
        }
    }

    /// Φ(θ) − Φ(0) and ∂Φ/∂θ at θ, W and W per unit. None past shadows that move, and where the
    /// scene allows no such deviation.
    pub(super) fn moved(&self, index: usize, size: f64) -> Option<[Matrix; 2]> {
        let kind = self.kinds[index];
        if let Some(slope) = self.straight(kind) {
            return Some([&slope * size, slope]);
        }
        if self.shaded.is_known() {
            return None;
        }
        let here = self.here.get_or_init(|| self.integrated(self.scene));
        let change = self.deviating(kind, size)? - here.as_ref()?;
        Some([change, self.slope(kind, size)?].map(|free| self.seen(free)))
    }

    fn difference(&self, kind: Kind) -> Option<Matrix> {
        match kind {
            Kind::Scale | Kind::Offset | Kind::OverView(_) => self.straight(kind),
            // What it does to shadows is not known.
            Kind::Misplaced(_) if self.shaded.is_known() => None,
            _ => Some(self.seen(self.slope(kind, 0.0)?)),
        }
    }

    /// ∂Φ/∂θ of what no geometry changes; none of others.
    fn straight(&self, kind: Kind) -> Option<Matrix> {
        let (rows, columns) = self.phi.shape();
        match kind {
            Kind::Scale => Some(self.phi * 0.01),
            Kind::Offset => Some(Matrix::from_element(rows, columns, 0.01 * self.phi.mean())),
            Kind::OverView(pattern) => Some(self.over_view(pattern)),
            Kind::Albedo(_) | Kind::Misplaced(_) | Kind::Shift => None,
        }
    }

    /// Of a pattern over the view, at its ends: a hundredth of the mean, or of the light, which
    /// falls towards the corners, where x² + y² is 2.
    fn over_view(&self, pattern: usize) -> Matrix {
        let (rows, columns) = self.phi.shape();
        let size = match pattern {
            1 | 2 => 0.01 * self.phi.mean(),
            3 | 4 => 0.01,
            _ => -0.005,
        };
        let mut found = Matrix::zeros(rows, columns);
        for l in 0..columns {
            let light = self.phi.columns(l, 1).into_owned();
            let own = over_view(&light, self.scene.camera.columns);
            found.set_column(l, &(own.column(pattern) * size));
        }
        found
    }

    /// What is visible of light with nothing in the way.
    fn seen(&self, free: Matrix) -> Matrix {
        match self.visible {
            None => free,
            Some(share) => free.component_mul(share),
        }
    }

    fn integrated(&self, scene: &Scene) -> Option<Matrix> {
        integrated(scene, self.kernel, self.nodes).ok()
    }

    /// Φ of a scene that deviates by so much, with nothing in the way.
    fn deviating(&self, kind: Kind, size: f64) -> Option<Matrix> {
        match kind {
            Kind::Albedo(_) if size <= -100.0 => None,
            Kind::Albedo(index) => {
                let factor = 1.0 + 0.01 * size;
                self.integrated(&self.scene.with_scaled_albedo(index, factor))
            }
            Kind::Misplaced(_) if size == 0.0 => self.integrated(self.scene),
            Kind::Misplaced(what) => self.integrated(&what.apply(self.scene, size)?),
            Kind::Scale | Kind::Offset | Kind::OverView(_) | Kind::Shift => None,
        }
    }

    /// ∂Φ/∂θ at a deviation, with nothing in the way.
    fn slope(&self, kind: Kind, size: f64) -> Option<Matrix> {
        let step = match kind {
            Kind::Misplaced(what) => match what.size {
                Size::Percent => PERCENT,
                Size::Angle => (self.step / lever(self.scene)).to_degrees(),
                Size::Length | Size::Random | Size::Positive => self.step,
            },
            Kind::Scale | Kind::Offset | Kind::OverView(_) | Kind::Albedo(_) | Kind::Shift => {
                PERCENT
            }
        };
        let at = |steps: f64| self.deviating(kind, size + steps * step);
        let is_positive = matches!(kind, Kind::Misplaced(what) if what.size == Size::Positive);
        match (at(1.0), at(-1.0)) {
            (Some(one), _) if is_positive => Some((at(2.0)? - one) / step),
            (Some(more), Some(less)) => Some((more - less) / (2.0 * step)),
            // At the edge of what the scene allows, from one side.
            (Some(more), None) => Some((more - at(0.0)?) / step),
            (None, Some(less)) => Some((at(0.0)? - less) / step),
            (None, None) => None,
        }
    }
}

/// How many times `phi`/100 a derivative is, if it is that.
fn factor(d: &Matrix, phi: &Matrix) -> Option<f64> {
    let (dot, own, square) = (d.dot(phi), d.norm_squared(), phi.norm_squared());
    let parallel = own > 0.0 && square > 0.0 && 1.0 - dot * dot / (own * square) < PARALLEL;
    parallel.then(|| 100.0 * dot / square)
}

/// Step of a length.
fn step(scene: &Scene) -> f64 {
    let [nearest, middle] = nearest_and_middle(scene);
    let fine = 1e-6 * middle;
    (OF_NEAREST * nearest).clamp(fine, OF_MIDDLE * middle)
}

/// The shortest distance between what is lit or seen of the walls and the hidden surfaces, and that
/// to their middles.
fn nearest_and_middle(scene: &Scene) -> [f64; 2] {
    let spots = scene.laser.beams().iter().map(|s| s.target.position);
    let view = scene.camera.view.corners();
    let mut nearest = f64::INFINITY;
    let mut middle = f64::INFINITY;
    for wall in spots.chain(view) {
        for (_, surface) in scene.hidden() {
            let apart = |at: DVec3| (wall - at).length();
            nearest = nearest.min(apart(surface.shape.at_position(wall).position));
            middle = middle.min(apart(surface.shape.at([0.5; 2]).position));
        }
    }
    [nearest, middle]
}

/// Distance of the hidden surface's middle from the hinge; from its rim where there is none.
fn lever(scene: &Scene) -> f64 {
    let Some((_, surface)) = scene.hidden().next() else {
        return 1.0;
    };
    let middle = surface.shape.at([0.5; 2]).position;
    match scene.hinge() {
        Some((point, axis)) => (middle - point).cross(axis).length(),
        None => 0.5 * surface.shape.area().sqrt(),
    }
}

#[cfg(test)]
mod tests;
