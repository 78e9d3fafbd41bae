//! Where things are, by the photographs.

use std::sync::Arc;

use phicam::jobs::need;
use phicam::lab::finding::Describe;
use phicam::lab::{
    CalibrationPlan, Certainty, Free, LOCATABLE, LocatedPlan, Photographs, fewer, polynomials,
};
use phicam::matrix::Matrix;
use phicam::scene;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::{errors, matrix, maybe};
use crate::errors::{Raise, input};
use crate::findings::found;
use crate::model::{integration, occlusion};
use crate::scene::Scene;
use crate::validate::{Known, certainty};
use crate::work::{fits, run};

/// What may be looked for, each with what it is.
#[pyfunction]
pub fn locatable() -> Vec<(&'static str, &'static str)> {
    LOCATABLE.to_vec()
}

/// Photographs of unknown reflectances.
fn read(
    scene: &scene::Scene,
    phi: &Bound<'_, PyAny>,
    stderr: Option<&Bound<'_, PyAny>>,
    left_out: Option<&Bound<'_, PyAny>>,
    (degree, certainty): (Option<u8>, Certainty),
) -> PyResult<Photographs> {
    let size = [scene.camera.columns, scene.camera.rows];
    let read = Photographs {
        phi: matrix(phi, "phi")?,
        stderr: errors(stderr, "stderr")?,
        certainty,
        left_out: maybe(left_out, "left_out")?,
        patterns: degree.map(|degree| polynomials(size, usize::from(degree))),
    };
    let expected = (scene.camera.pixels(), scene.laser.spots.len());
    let given = [
        Some(&read.phi),
        read.stderr.as_ref(),
        read.left_out.as_ref(),
    ];
    let shapes = given.map(|m| m.map_or(expected, Matrix::shape));
    if let Some((rows, columns)) = shapes.into_iter().find(|shape| *shape != expected) {
        let cause = format!(
            "an array is {rows} × {columns}, but the scene has {} pixels and {} spots",
            expected.0, expected.1
        );
        return Err(input(cause, "give arrays of pixels × spots"));
    }
    Ok(read)
}

/// The elements that are asked for, else fewer where the scene has many.
fn thinned(asked: Option<(usize, usize)>, scene: &scene::Scene) -> Option<[usize; 2]> {
    let fewer = || fewer(scene).map(|(fewer, _)| fewer);
    asked.map(Into::into).or_else(fewer)
}

/// The geometry, estimated; the text of the calibrated scene beside it.
#[pyfunction]
#[pyo3(signature = (scene, phi, stderr, left_out, *, free, frame_gain, free_scale, error_field, background, known, elements,
                    considered, integration_name, frame_polynomial, starts, spread, seed, threads, progress))]
#[expect(
    clippy::too_many_arguments,
    reason = "one for each keyword of Python's function"
)]
pub fn calibrate<'py>(
    py: Python<'py>,
    scene: &Scene,
    phi: &Bound<'py, PyAny>,
    stderr: Option<&Bound<'py, PyAny>>,
    left_out: Option<&Bound<'py, PyAny>>,
    free: Vec<(String, Option<f64>)>,
    frame_gain: Option<f64>,
    free_scale: bool,
    error_field: bool,
    background: bool,
    known: Known,
    elements: Option<(usize, usize)>,
    considered: bool,
    integration_name: &str,
    frame_polynomial: Option<u8>,
    starts: usize,
    spread: f64,
    seed: u64,
    threads: Option<usize>,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<(Bound<'py, PyDict>, bool, Scene)> {
    let plan = CalibrationPlan {
        free: free
            .into_iter()
            .map(|(name, sigma)| Free { name, sigma })
            .collect(),
        frame_gain,
        is_scale_free: free_scale,
        error_field,
        background,
        elements: thinned(elements, &scene.inner),
        occlusion: occlusion(considered),
        integration: integration(integration_name)?,
        starts,
        spread,
        seed,
    };
    let elements = plan.elements;
    fits(py, &scene.inner, move |scene| {
        need::calibrate(scene, elements)
    })?;
    let known = certainty(known)?;
    let beside = (frame_polynomial, known);
    let photographs = read(&scene.inner, phi, stderr, left_out, beside)?;
    let own = Arc::clone(&scene.inner);
    let done = run(py, threads, progress, move |control| {
        let found = plan.calibrate(&own, &photographs.unexplained(), control)?;
        let calibrated = own.remade(&found.toml)?;
        Ok::<_, phicam::lab::LabError>((found, calibrated))
    })?;
    let (calibration, calibrated) = done.raise()?;
    let json = serde_json::to_string(&calibration).raise()?;
    let words = found(py, &calibration.describe(), &json)?;
    Ok((words, calibration.is_found(), Scene::from(calibrated)))
}

/// Where something is, by the likeliest of some sizes.
#[pyfunction]
#[pyo3(signature = (scene, phi, stderr, left_out, *, known, what, range, steps, elements, considered, integration_name,
                    frame_polynomial, background, orders, seed, threads, progress))]
#[expect(
    clippy::too_many_arguments,
    reason = "one for each keyword of Python's function"
)]
pub fn locate<'py>(
    py: Python<'py>,
    scene: &Scene,
    phi: &Bound<'py, PyAny>,
    stderr: Option<&Bound<'py, PyAny>>,
    left_out: Option<&Bound<'py, PyAny>>,
    known: Known,
    what: &str,
    range: (f64, f64),
    steps: usize,
    elements: Option<(usize, usize)>,
    considered: bool,
    integration_name: &str,
    frame_polynomial: Option<u8>,
    background: bool,
    orders: u64,
    seed: u64,
    threads: Option<usize>,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<(Bound<'py, PyDict>, bool)> {
    let Some((what, _)) = LOCATABLE.iter().find(|(name, _)| *name == what) else {
        let names: Vec<&str> = LOCATABLE.iter().map(|(name, _)| *name).collect();
        let cure = format!("use one of {}", names.join(", "));
        return Err(input(format!("nothing is called `{what}`"), &cure));
    };
    let plan = LocatedPlan {
        what,
        range: range.into(),
        steps,
        elements: thinned(elements, &scene.inner),
        occlusion: occlusion(considered),
        integration: integration(integration_name)?,
        background,
        orders,
        seed,
    };
    let elements = plan.elements;
    fits(py, &scene.inner, move |scene| need::locate(scene, elements))?;
    let known = certainty(known)?;
    let beside = (frame_polynomial, known);
    let photographs = read(&scene.inner, phi, stderr, left_out, beside)?;
    let own = Arc::clone(&scene.inner);
    let done = run(py, threads, progress, move |control| {
        plan.locate(&own, &photographs.unexplained(), control)
    })?;
    let located = done.raise()?;
    let json = serde_json::to_string(&located).raise()?;
    Ok((found(py, &located.describe(), &json)?, located.is_found()))
}
