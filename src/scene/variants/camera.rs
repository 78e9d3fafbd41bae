//! Scenes whose camera or view is another.

use glam::DAffine3;

use crate::geometry::DVec3;
use crate::scene::Scene;

impl Scene {
    /// The same scene with the camera's view moved by (dx, dy) in its plane.
    pub fn with_shifted_view(&self, [dx, dy]: [f64; 2]) -> Self {
        let mut scene = self.clone();
        let n = self.camera.view.normal();
        let dz = -(n.x * dx + n.y * dy) / n.z;
        let motion = DAffine3::from_translation(DVec3::new(dx, dy, dz));
        if let Some(view) = self.camera.view.moved(&motion) {
            scene.camera.view = view;
        }
        scene
    }

    /// The same scene with the camera's view scaled about its middle.
    pub fn with_scaled_view(&self, factor: f64) -> Self {
        let mut scene = self.clone();
        let middle = self.camera.view.at([0.5; 2]).position;
        let scaled = DAffine3::from_translation(middle)
            * DAffine3::from_scale(DVec3::splat(factor))
            * DAffine3::from_translation(-middle);
        if let Some(view) = self.camera.view.moved(&scaled) {
            scene.camera.view = view;
        }
        scene
    }

    /// The same scene with the pinhole moved by `by`; the view stays.
    pub fn with_moved_camera(&self, by: DVec3) -> Self {
        let mut scene = self.clone();
        scene.camera.position += by;
        scene
    }
}
