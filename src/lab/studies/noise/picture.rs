//! What is photographed.

use std::fmt;

use serde::{Serialize, Serializer};

use crate::scene::{Scene, Texture};

/// What the hidden surfaces are painted with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Picture {
    /// As the scene says; of each element the mean.
    Own,
    /// A board of so many checks a side, of albedo 0 and 1.
    Board(usize),
}

impl Picture {
    /// The scene with its hidden surfaces painted so.
    pub(super) fn on(self, scene: &Scene) -> Scene {
        match self {
            Self::Own => scene.clone(),
            Self::Board(checks) => scene.with_checkerboard(checks),
        }
    }

    /// What the scene's hidden surfaces are painted with; none where there are none.
    pub(super) fn of(scene: &Scene) -> Option<Self> {
        let hidden = |scene: &Scene| scene.hidden().map(|h| h.1.albedo.clone()).collect();
        let own: Vec<Texture> = hidden(scene);
        match own.first()? {
            Texture::Cells(cells) => {
                let checks = cells.count[0];
                let board: Vec<Texture> = hidden(&scene.with_checkerboard(checks));
                Some(if board == own {
                    Self::Board(checks)
                } else {
                    Self::Own
                })
            }
            _ => Some(Self::Own),
        }
    }
}

/// As files have it: `own`, or the checks a side.
impl fmt::Display for Picture {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Own => f.pad("own"),
            Self::Board(checks) => checks.fmt(f),
        }
    }
}

/// The checks a side, or `"own"`.
impl Serialize for Picture {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Own => serializer.serialize_str("own"),
            Self::Board(checks) => serializer.serialize_u64(*checks as u64),
        }
    }
}
