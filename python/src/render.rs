//! Φcam, traced.

use std::sync::Arc;
use std::time::Instant;

use numpy::PyArray2;
use phicam::jobs::need;
use phicam::lab;
use phicam::transport::{Plan, Traced, render as traced_render};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::array;
use crate::errors::{Raise, input};
use crate::scene::Scene;
use crate::work::{fits, knows_its_light, run};

/// The plan of these settings.
pub fn plan(estimator: &str, sampler: &str, seed: u64, samples: u64) -> PyResult<Plan> {
    let refused = |e: String| input(e, "see the function's documentation");
    let (estimator, sampling) = (
        estimator.parse().map_err(refused)?,
        sampler.parse().map_err(refused)?,
    );
    Plan::new(estimator, sampling, seed, samples).raise()
}

/// Estimator and samples of a render that is told neither.
#[pyfunction]
#[pyo3(signature = (scene, *, sampler, seed))]
pub fn aimed(
    py: Python<'_>,
    scene: &Scene,
    sampler: &str,
    seed: u64,
) -> PyResult<(&'static str, u64)> {
    let refused = |e: String| input(e, "see the function's documentation");
    let sampling = sampler.parse().map_err(refused)?;
    let scene = Arc::clone(&scene.inner);
    let found = run(py, None, None, move |control| {
        lab::aimed(&scene, sampling, seed, control)
    })?;
    let (plan, _) = found.map_err(|e| input(e.to_string(), "give estimator and samples"))?;
    Ok((plan.estimator.name(), plan.budget.samples()))
}

/// Traces the spots `first..last`; `progress` is called with the paths that are done.
#[pyfunction]
#[pyo3(signature = (scene, *, estimator, sampler, seed, samples, spots, threads, progress))]
#[expect(
    clippy::too_many_arguments,
    reason = "one for each keyword of Python's function"
)]
pub fn render<'py>(
    py: Python<'py>,
    scene: &Scene,
    estimator: &str,
    sampler: &str,
    seed: u64,
    samples: u64,
    spots: (usize, usize),
    threads: Option<usize>,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    knows_its_light(&scene.inner)?;
    let plan = plan(estimator, sampler, seed, samples)?;
    fits(py, &scene.inner, move |scene| need::render(scene, &plan))?;
    let scene = Arc::clone(&scene.inner);
    let (traced, seconds) = run(py, threads, progress, move |control| {
        let begun = Instant::now();
        let traced = traced_render(&scene, &plan, spots.0..spots.1, control);
        (traced, begun.elapsed().as_secs_f64())
    })?;
    let Traced {
        bounces,
        flux,
        stderr,
        tails,
    } = traced.raise()?;
    let bounces: PyResult<Vec<Bound<'py, PyArray2<f64>>>> =
        bounces.into_iter().map(|m| array(py, m)).collect();
    let found = PyDict::new(py);
    found.set_item("flux", array(py, flux)?)?;
    found.set_item("stderr", array(py, stderr)?)?;
    found.set_item("tails", array(py, tails)?)?;
    found.set_item("bounces", bounces?)?;
    found.set_item("seconds", seconds)?;
    found.set_item("samples", plan.budget.samples())?;
    found.set_item("blocks", plan.budget.blocks)?;
    Ok(found)
}
