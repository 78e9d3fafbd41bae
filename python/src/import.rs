//! Photographs of a real camera.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use phicam::photographs::set::{ChannelName, Set};
use phicam::photographs::{Imported, import, scene_of};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::{array, maybe_array};
use crate::errors::{Raise, input};
use crate::scene::Scene;
use crate::work::run;

/// Φcam of the photographs that `text`, a list in TOML, names in `folder`; `channel` of those in
/// colour.
#[pyfunction]
#[pyo3(signature = (scene, text, folder, channel, *, threads))]
pub fn import_photographs<'py>(
    py: Python<'py>,
    scene: &Scene,
    text: String,
    folder: PathBuf,
    channel: Option<&str>,
    threads: Option<usize>,
) -> PyResult<(Bound<'py, PyDict>, Scene)> {
    let channel = channel.map(channel_of).transpose()?;
    let own = Arc::clone(&scene.inner);
    let done = run(py, threads, None, move |_| {
        let set = Set::parse("the list", &text)?.checked()?;
        let folder: &Path = &folder;
        let scene = scene_of(&set, (*own).clone(), folder)?;
        let channel = channel.or(set.channel);
        let imported = import(&set, &scene, folder, channel)?;
        Ok::<_, phicam::photographs::PhotographError>((imported, scene))
    })?;
    let (imported, scene) = done.raise()?;
    let Imported {
        phi,
        stderr,
        left_out,
        account,
        ..
    } = imported;
    let found = PyDict::new(py);
    found.set_item("json", serde_json::to_string(&account).raise()?)?;
    found.set_item("flux", array(py, phi)?)?;
    found.set_item("stderr", maybe_array(py, stderr)?)?;
    found.set_item("left_out", array(py, left_out)?)?;
    Ok((found, Scene::from(scene)))
}

fn channel_of(name: &str) -> PyResult<ChannelName> {
    match name {
        "red" => Ok(ChannelName::Red),
        "green" => Ok(ChannelName::Green),
        "blue" => Ok(ChannelName::Blue),
        "mean" => Ok(ChannelName::Mean),
        _ => Err(input(
            format!("no channel `{name}`"),
            "use red, green, blue or mean",
        )),
    }
}

/// The scene that a list names; empty where it names none.
#[pyfunction]
pub fn scene_named(text: &str) -> PyResult<String> {
    Ok(Set::parse("the list", text).raise()?.scene)
}
