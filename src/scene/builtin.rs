//! The scenes that are compiled in, and reading of the others.

use std::path::Path;

use super::error::SceneError;
use crate::store;

/// A scene file larger than this is not one.
const LARGEST_FILE: u64 = 64 << 20;

/// A built-in scene.
#[derive(Clone, Copy, Debug)]
pub struct Builtin {
    /// Its name.
    pub name: &'static str,
    /// What it is, in one line.
    pub summary: &'static str,
    /// The text of its scene file.
    pub text: &'static str,
}

macro_rules! scenes {
    ($($name:literal: $summary:literal,)*) => {
        &[$(Builtin {
            name: $name,
            summary: $summary,
            text: include_str!(concat!("../../scenes/", $name, ".toml")),
        }),*]
    };
}

/// All built-in scenes.
pub fn builtins() -> &'static [Builtin] {
    scenes! {
        "bench": "the bench: 2 × 2 board, 120 staggered spots, half-width 3 in.",
        "thesis": "as published: 8 × 8 board, 120 staggered spots, half-width 6 in., wall extended",
        "experiment": "the laboratory experiment: 252 spots 1 in. around the view, 64 × 64 pixels",
        "dual": "a projector–camera pair for dual photography: 16 × 16 spots beside 16 × 16 pixels",
        "card": "a playing card face down over a table, 47 × 31 elements; laser and camera peek under it",
        "satin": "the bench with a wall in satin paint: its BRDF enters the model",
        "shelf": "the bench with a shelf between wall and object",
        "periscope": "a plate between object and wall: the edge of its shadow is a lens",
        "screen": "a monitor that faces a wall, a plate between: one photograph without a laser",
        "mask": "the same with a half-open mask: its shadow is another for each element",
        "masked-card": "a playing card of 47 × 31 cells past a half-open mask of 16 × 16",
        "corner": "a letter chart around a corner: the relay wall is seen past another wall",
        "room": "a furnished room with a bust of a million triangles in it",
        "furnace": "an integrating sphere, whose flux at every bounce count is known in closed form",
    }
}

/// Reads a scene file.
pub(super) fn read(path: &str) -> Result<String, SceneError> {
    let names = builtins().iter().map(|b| b.name);
    let error = |cause: String, cure: String| SceneError {
        source: path.to_owned(),
        place: None,
        cause,
        cure,
    };
    let known = names.clone().collect::<Vec<_>>().join(", ");
    let cure = || format!("give the path of a TOML scene file, or a built-in scene: {known}");
    let bytes = store::read(Path::new(path), LARGEST_FILE).map_err(|e| {
        let cure = meant(path, e.is_missing()).unwrap_or_else(|| {
            if e.is_denied() {
                "allow to read it".to_owned()
            } else {
                cure()
            }
        });
        error(format!("cannot read this scene: {}", e.fault), cure)
    })?;
    String::from_utf8(bytes).map_err(|_| error("the file is not UTF-8 text".into(), cure()))
}

/// What somebody meant who called `path` a scene; `None` if nothing is near.
fn meant(path: &str, is_missing: bool) -> Option<String> {
    let scene_of_run = Path::new(path).join("scene.toml");
    if scene_of_run.is_file() {
        let scene_of_run = scene_of_run.display();
        return Some(format!("that is a folder; its scene is `{scene_of_run}`"));
    }
    if !is_missing {
        return None;
    }
    let with_ending = format!("{path}.toml");
    if Path::new(&with_ending).is_file() {
        return Some(format!("did you mean the file `{with_ending}`?"));
    }
    let name = path.strip_suffix(".toml").unwrap_or(path);
    let near = |b: &&Builtin| strsim::damerau_levenshtein(b.name, name) <= 2;
    let near = builtins()
        .iter()
        .filter(|b| b.name.len() >= name.len() / 2)
        .find(near)?;
    Some(format!("did you mean the built-in scene `{}`?", near.name))
}
