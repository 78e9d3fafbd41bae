//! Scenes that differ from a given one in a single respect, for studies. Their hash and text remain the original's.

use super::laser;
use super::parse;
use super::{Role, Scene, SceneError, Texture};

impl Scene {
    /// The same scene with every spot moved by (dx, dy) on the wall.
    ///
    /// # Errors
    /// [`SceneError`] if a spot leaves the wall.
    pub fn with_shifted_spots(&self, [dx, dy]: [f64; 2]) -> Result<Self, SceneError> {
        let places: Vec<[f64; 2]> = self
            .laser
            .spots
            .iter()
            .map(|s| [s.target.position.x + dx, s.target.position.y + dy])
            .collect();
        let spots = laser::place(&places, self.laser.position, &self.surfaces)
            .map_err(|fault| parse::locate(&self.name, &self.text, fault))?;
        let mut scene = self.clone();
        scene.laser.spots = spots;
        Ok(scene)
    }

    /// The same scene with paths of up to `surfaces` surfaces.
    pub fn with_max_bounces(&self, surfaces: u32) -> Self {
        Self {
            max_bounces: surfaces,
            ..self.clone()
        }
    }

    /// The same scene with occluders that only block: their albedo is 0.
    pub fn with_black_occluders(&self) -> Self {
        let mut scene = self.clone();
        for surface in &mut scene.surfaces {
            if surface.role == Role::Occluder {
                surface.albedo = Texture::Constant(0.0);
            }
        }
        scene
    }

    /// The same scene with each hidden surface's albedo replaced by its mean over the area.
    pub fn with_mean_albedo(&self) -> Self {
        let mut scene = self.clone();
        for surface in &mut scene.surfaces {
            if surface.role == Role::Hidden {
                let cells: usize = surface.albedo.smooth_cells().iter().product();
                let sum: f64 = (0..cells).map(|c| surface.albedo.cell_mean(c)).sum();
                surface.albedo = Texture::Constant(sum / cells as f64);
            }
        }
        scene
    }
}
