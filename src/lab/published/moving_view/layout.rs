//! Where the camera looks while the spot moves.

use super::super::sheet;
use crate::geometry::{DVec3, Parallelogram};
use crate::lab::LabError;
use crate::scene::Scene;

/// Pixels of the camera and elements of the board, a side.
pub(super) const PIXELS: usize = 8;
pub(super) const ELEMENTS: usize = 8;
/// Checks a side.
pub(super) const BOARDS: [usize; 2] = [2, 4];
/// Scenes and the half-widths of their squares of spots, in.; the first is traced too.
pub(super) const HALF_WIDTHS: [(&str, f64); 2] = [("bench", 3.0), ("thesis", 6.0)];
/// A board is kept where the raw MTF is at least this.
pub(super) const KEPT: f64 = 0.9;

/// The board of `checks` a side on the elements.
pub(super) fn board(checks: usize) -> Vec<f64> {
    sheet::board(ELEMENTS, checks)
}

/// A camera's view of one size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum View {
    /// It stays.
    Fixed,
    /// It stays, and covers all that the traced moving view comes to see: it tells what coverage
    /// does without motion.
    Wide,
    /// It moves with the spot; its centre is off the spot by this much along x and y.
    Moving {
        name: &'static str,
        offset: [f64; 2],
    },
}

/// Where the traced moving view has its centre off the spot, in.
const LEFT: [f64; 2] = [-2.0, 0.0];

/// The view that is traced beside the fixed one: its lines of sight pass nothing, and the spot is
/// not in it.
pub(super) const TRACED: View = View::Moving {
    name: "2 in. left of the spot",
    offset: LEFT,
};

/// The fixed view, the moving one at four places beside the spot or on it, and the wide one. Half
/// the view's width is 1.625 in., so that at 2 in. the spot is as far from the view's edge (0.375
/// in.) as the nearest of the bench's spots is from its view.
pub(super) const VIEWS: [View; 6] = [
    View::Fixed,
    TRACED,
    View::Moving {
        name: "2 in. above the spot",
        offset: [0.0, 2.0],
    },
    View::Moving {
        name: "2 in. below the spot",
        offset: [0.0, -2.0],
    },
    View::Moving {
        name: "centred on the spot",
        offset: [0.0, 0.0],
    },
    View::Wide,
];

impl View {
    pub(super) fn name(self) -> String {
        match self {
            Self::Fixed => "fixed".to_owned(),
            Self::Wide => "fixed, over all that the view left of the spot covers".to_owned(),
            Self::Moving { name, .. } => format!("moving, {name}"),
        }
    }

    /// Whether it moves.
    pub(super) fn moves(self) -> bool {
        matches!(self, Self::Moving { .. })
    }

    /// `scene` as the camera sees it while spot `spot` is lit; all spots stay in their places.
    pub(super) fn at(self, scene: &Scene, spot: usize) -> Scene {
        let centre = scene.camera.view.at([0.5, 0.5]).position;
        match self {
            Self::Fixed => scene.clone(),
            Self::Wide => wide(scene),
            Self::Moving {
                offset: [dx, dy], ..
            } => {
                let lit = scene.laser.spots[spot].target.position;
                scene.with_shifted_view([lit.x + dx - centre.x, lit.y + dy - centre.y])
            }
        }
    }

    /// The same with that spot alone: one photograph.
    pub(super) fn photograph(self, scene: &Scene, spot: usize) -> Result<Scene, LabError> {
        let lit = scene.laser.spots[spot].target.position;
        Ok(self.at(scene, spot).with_spots_at(&[[lit.x, lit.y]])?)
    }
}

/// The view grown to the rectangle of the view left of the spot at every spot.
fn wide(scene: &Scene) -> Scene {
    let moving = |spot| TRACED.at(scene, spot).camera.view;
    let mut scene_wide = scene.clone();
    let corners = (0..scene.laser.spots.len()).flat_map(|spot| moving(spot).corners());
    let (low, high) = corners.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), c| {
        (low.min(c), high.max(c))
    });
    let span = high - low;
    let [u, v] = [DVec3::new(span.x, 0.0, 0.0), DVec3::new(0.0, span.y, 0.0)];
    if let Some(view) = Parallelogram::new(low, u, v) {
        scene_wide.camera.view = view;
    }
    scene_wide
}

/// Both scenes are given a wall that reaches further by this much, in., so that every moving view
/// lies on it.
const MARGIN: f64 = 4.0;

/// The scene `name` with `pixels` × `pixels` pixels and a wall large enough for every view.
pub(super) fn scene(name: &str, pixels: usize) -> Result<Scene, LabError> {
    let mut scene = Scene::load(name)?.with_extended_relay(MARGIN)?;
    [scene.camera.columns, scene.camera.rows] = [pixels; 2];
    Ok(scene)
}
