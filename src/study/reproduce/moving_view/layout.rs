//! Where the camera looks while the spot moves.

use super::super::ReproduceError;
use crate::scene::Scene;

/// A camera's view of one size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum View {
    /// It stays.
    Fixed,
    /// It moves with the spot; its centre is off the spot by this much along x and y.
    Moving {
        name: &'static str,
        offset: [f64; 2],
    },
}

/// The fixed view, and the moving one at four places beside the spot or on it, in. Half the view's width is 1.625 in., so that at 2 in. the spot is as far from the
/// view's edge (0.375 in.) as the nearest of the bench's spots is from its view.
pub(super) const VIEWS: [View; 5] = [
    View::Fixed,
    View::Moving {
        name: "2 in. left of the spot",
        offset: [-2.0, 0.0],
    },
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
];

/// The view that is traced beside the fixed one: its lines of sight pass nothing, and the spot is not in it.
pub(super) const TRACED: View = VIEWS[1];

impl View {
    pub(super) fn name(self) -> String {
        match self {
            Self::Fixed => "fixed".to_owned(),
            Self::Moving { name, .. } => format!("moving, {name}"),
        }
    }

    /// `scene` as the camera sees it while spot `spot` is lit; all spots stay in their places.
    pub(super) fn at(self, scene: &Scene, spot: usize) -> Scene {
        let Self::Moving {
            offset: [dx, dy], ..
        } = self
        else {
            return scene.clone();
        };
        let lit = scene.laser.spots[spot].target.position;
        let centre = scene.camera.view.at([0.5, 0.5]).position;
        scene.with_shifted_view([lit.x + dx - centre.x, lit.y + dy - centre.y])
    }

    /// The same with that spot alone: one photograph.
    pub(super) fn photograph(self, scene: &Scene, spot: usize) -> Result<Scene, ReproduceError> {
        let lit = scene.laser.spots[spot].target.position;
        Ok(self.at(scene, spot).with_spots_at(&[[lit.x, lit.y]])?)
    }
}

/// Both scenes are given a wall that reaches further by this much, in., so that every moving view lies on it.
const MARGIN: f64 = 4.0;

/// The scene `name` with `pixels` × `pixels` pixels and a wall large enough for every view.
pub(super) fn scene(name: &str, pixels: usize) -> Result<Scene, ReproduceError> {
    let mut scene = Scene::load(name)?.with_extended_relay(MARGIN)?;
    [scene.camera.columns, scene.camera.rows] = [pixels; 2];
    Ok(scene)
}
