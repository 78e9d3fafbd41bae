//! Run folders.

use std::path::PathBuf;
use std::sync::Arc;

use phicam::folder;
use phicam::transport::Traced;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::{array, matrix, maybe_array};
use crate::errors::Raise;
use crate::render::plan;
use crate::scene::Scene;
use crate::work::run;

/// Writes a run as the commands do.
#[pyfunction]
#[pyo3(signature = (folder, scene, flux, stderr, tails, bounces, *, estimator, sampler, seed, samples, seconds, threads))]
#[expect(clippy::too_many_arguments, reason = "one for each part of a run")]
pub fn write_run(
    py: Python<'_>,
    folder: PathBuf,
    scene: &Scene,
    flux: &Bound<'_, PyAny>,
    stderr: &Bound<'_, PyAny>,
    tails: &Bound<'_, PyAny>,
    bounces: Vec<Bound<'_, PyAny>>,
    estimator: &str,
    sampler: &str,
    seed: u64,
    samples: u64,
    seconds: f64,
    threads: usize,
) -> PyResult<()> {
    let plan = plan(estimator, sampler, seed, samples)?;
    let bounces: PyResult<Vec<_>> = bounces.iter().map(|m| matrix(m, "by_bounces")).collect();
    let traced = Traced {
        bounces: bounces?,
        flux: matrix(flux, "flux")?,
        stderr: matrix(stderr, "stderr")?,
        tails: matrix(tails, "tails")?,
    };
    let scene = Arc::clone(&scene.inner);
    let written = run(py, None, None, move |_| {
        folder::write_run(&folder, &scene, &plan, &traced, (seconds, threads))
    })?;
    written.raise()
}

/// Reads a run back.
#[pyfunction]
pub fn read_run(
    py: Python<'_>,
    folder: PathBuf,
    also: Vec<PathBuf>,
) -> PyResult<(Scene, Bound<'_, PyDict>)> {
    let read = run(py, None, None, move |_| folder::read_run(&folder, &also))?;
    let folder::Run {
        scene,
        record,
        flux,
        stderr,
        left_out,
        bounces,
    } = read.raise()?;
    let found = PyDict::new(py);
    found.set_item("flux", array(py, flux)?)?;
    found.set_item("stderr", maybe_array(py, stderr)?)?;
    found.set_item("left_out", maybe_array(py, left_out)?)?;
    let bounces = bounces.map(|parts| parts.into_iter().map(|m| array(py, m)).collect());
    let bounces: Option<PyResult<Vec<_>>> = bounces;
    found.set_item("bounces", bounces.transpose()?)?;
    found.set_item("record", record.json().raise()?)?;
    Ok((Scene::from(scene), found))
}
