//! What a sensor makes of Φcam.

use std::sync::Arc;

use phicam::jobs::need;
use phicam::lab::describe_exposure;
use phicam::matrix::Matrix;
use phicam::scene::SensorModel;
use phicam::sensor::{
    Exposure, Light, Range, Sensor, SensorError, Stated, Summary, builtin_summary, glare,
};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::{array, matrix};
use crate::errors::{Raise, input};
use crate::findings::found;
use crate::scene::Scene;
use crate::work::{fits, run};

/// Matrices of Φcam's size that are held at once, beside one for each exposure.
const EXPOSING: f64 = 12.0;

/// The built-in sensors, each with what it is.
#[pyfunction]
pub fn sensors() -> Vec<(&'static str, &'static str)> {
    let each = SensorModel::ALL.iter();
    each.map(|m| (m.name(), builtin_summary(*m))).collect()
}

/// The photographs of `phi` by the sensor of the scene.
#[pyfunction]
#[pyo3(signature = (scene, phi, render_error, *, blocks, seed, by_counts, threads))]
#[expect(
    clippy::too_many_arguments,
    reason = "one for each keyword of Python's function"
)]
pub fn expose<'py>(
    py: Python<'py>,
    scene: &Scene,
    phi: &Bound<'py, PyAny>,
    render_error: &Bound<'py, PyAny>,
    blocks: u32,
    seed: u64,
    by_counts: bool,
    threads: Option<usize>,
) -> PyResult<Bound<'py, PyDict>> {
    let Some(settings) = scene.inner.sensor.clone() else {
        let cause = format!("scene `{}` has no [sensor] table", scene.inner.name);
        return Err(input(cause, "name a built-in sensor: sensor=\"ideal\""));
    };
    let exposures = settings.brackets.as_ref().map_or(1, Vec::len);
    let matrices = EXPOSING + exposures as f64;
    fits(py, &scene.inner, move |scene| {
        need::photographs(scene, matrices)
    })?;
    let (phi, render_error) = (matrix(phi, "phi")?, matrix(render_error, "stderr")?);
    if phi.max() <= 0.0 {
        let cure = "render a scene whose light reaches the camera";
        return Err(input("phi is dark in every pixel", cure));
    }
    let scene = Arc::clone(&scene.inner);
    let done = run(py, threads, None, move |_| -> Result<_, SensorError> {
        let sensor = Sensor::from_settings(&settings)?;
        let exposure = Exposure::from_settings(&settings)?;
        let scattered = match settings.glare {
            Some(g) => glare(&scene, g),
            None => Matrix::zeros(phi.nrows(), phi.ncols()),
        };
        let light = Light::new(&phi, scene.laser.wavelength)?
            .with_glare(&scattered)?
            .with_render_error(&render_error, blocks)?
            .with_ambient(settings.ambient.unwrap_or(0.0))?;
        let stated = if by_counts {
            Stated::Counts(sensor.photon_transfer(seed))
        } else {
            Stated::Oracle
        };
        let exposed = sensor.expose(&light, &exposure, stated, seed)?;
        let summary = Summary::new(&sensor, &light, &exposure, &exposed);
        Ok((exposed, summary, exposure.times().to_vec()))
    })?;
    let (exposed, summary, times) = done.raise()?;
    let json = serde_json::to_string(&summary).raise()?;
    let dict = found(py, &describe_exposure(&summary, &times), &json)?;
    let code = |range: &Range| match range {
        Range::Within => 0.0,
        Range::Near => 0.5,
        Range::Saturated => 1.0,
        Range::Floored => -1.0,
    };
    let (rows, columns) = exposed.flux.shape();
    let codes = exposed.range.iter().map(code).collect();
    dict.set_item(
        "clipped",
        array(py, Matrix::from_vec(rows, columns, codes))?,
    )?;
    dict.set_item("flux", array(py, exposed.flux)?)?;
    dict.set_item("stderr", array(py, exposed.stderr)?)?;
    let counts: PyResult<Vec<_>> = exposed.counts.into_iter().map(|m| array(py, m)).collect();
    dict.set_item("counts", counts?)?;
    dict.set_item("times", times)?;
    Ok(dict)
}
