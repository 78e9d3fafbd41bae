//! Meshes that phicam makes itself.

use serde::{Deserialize, Serialize};

use super::{Triangles, bust, cube, rectangle, sphere};

/// A mesh that phicam makes itself.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub enum Generator {
    /// Head and shoulders, 1 high.
    Bust,
    /// The sphere of radius 1.
    Sphere,
    /// The unit square.
    Rectangle,
    /// The unit cube, which has 12 triangles.
    Box,
}

impl Generator {
    /// The mesh, of at least `faces` triangles where it can be finer or coarser.
    pub fn triangles(self, faces: usize) -> Triangles {
        match self {
            Self::Bust => bust(faces),
            Self::Sphere => sphere(faces),
            Self::Rectangle => {
                let side = (0.5 * faces as f64).sqrt().ceil() as u32;
                rectangle(side, side)
            }
            Self::Box => cube(),
        }
    }
}
