//! Folders that the user lets scenes read.

use std::path::PathBuf;
use std::sync::OnceLock;

use crate::scene::{Scene, SceneError};

static ALSO: OnceLock<Vec<PathBuf>> = OnceLock::new();

/// Lets scenes read meshes, pictures and materials in these folders too; said once, before anything is read.
pub(super) fn also_read(folders: &[PathBuf]) {
    let _ = ALSO.set(folders.to_vec());
}

/// A built-in scene by name, or a scene file by path.
pub(super) fn load(name_or_path: &str) -> Result<Scene, SceneError> {
    Scene::load_with(name_or_path, ALSO.get().map_or(&[], Vec::as_slice))
}
