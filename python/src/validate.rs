//! Traced or measured against modelled.

use std::sync::Arc;

use numpy::PyArray2;
use phicam::jobs::need;
use phicam::lab::finding::Describe;
use phicam::lab::{
    Against, Errors, Measured, OtherLight, Test, polynomials, validate as validated,
};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::{array, matrix, maybe};
use crate::errors::{Raise, named};
use crate::findings::found;
use crate::model::{integration, kernel, occlusion};
use crate::scene::Scene;
use crate::work::{fits, run};

/// How errors hang together, by its name.
pub fn errors(name: &str) -> PyResult<Errors> {
    named(name, "errors", Errors::ALL, Errors::name)
}

/// Whether errors that all spots of a pixel have in common, a part `common` of the variance, matter.
#[pyfunction]
pub fn shares_by_pixel(common: f64, spots: usize) -> bool {
    Errors::of_common(common, spots) != Errors::Independent
}

/// What was found, z of every entry, the model.
type Verdict<'py> = (
    Bound<'py, PyDict>,
    Bound<'py, PyArray2<f64>>,
    Bound<'py, PyArray2<f64>>,
);

/// The verdict on Φcam.
#[pyfunction]
#[pyo3(signature = (scene, phi, stderr, left_out, *, kernel_name, integration_name, considered,
                    significance, replicates, errors_name, free_scale, frame_polynomial,
                    threads))]
#[expect(
    clippy::too_many_arguments,
    reason = "one for each keyword of Python's function"
)]
pub fn validate<'py>(
    py: Python<'py>,
    scene: &Scene,
    phi: &Bound<'py, PyAny>,
    stderr: &Bound<'py, PyAny>,
    left_out: Option<&Bound<'py, PyAny>>,
    kernel_name: &str,
    integration_name: &str,
    considered: bool,
    significance: f64,
    replicates: Option<u32>,
    errors_name: &str,
    free_scale: bool,
    frame_polynomial: Option<usize>,
    threads: Option<usize>,
) -> PyResult<Verdict<'py>> {
    let against = Against {
        kernel: kernel(kernel_name)?,
        integration: integration(integration_name)?,
        occlusion: occlusion(considered),
    };
    let test = Test {
        significance,
        replicates: replicates.unwrap_or(u32::MAX),
        errors: errors(errors_name)?,
    };
    fits(py, &scene.inner, need::verdict)?;
    let phi = matrix(phi, "phi")?;
    let stderr = crate::arrays::errors(Some(stderr), "stderr")?.unwrap_or_default();
    let left_out = maybe(left_out, "left_out")?;
    let scene = Arc::clone(&scene.inner);
    let verdict = run(py, threads, None, move |_| {
        let size = [scene.camera.columns, scene.camera.rows];
        let patterns = frame_polynomial.map(|degree| polynomials(size, degree));
        let measured = Measured {
            beside: OtherLight {
                patterns: patterns.as_ref(),
                is_scale_free: free_scale,
            },
            ..Measured::new(&phi, &stderr, left_out.as_ref())
        };
        validated(&scene, measured, against, test)
    })?;
    let verdict = verdict.raise()?;
    let json = serde_json::to_string(&verdict.agreement).raise()?;
    let words = found(py, &verdict.agreement.describe(), &json)?;
    Ok((words, array(py, verdict.z)?, array(py, verdict.model)?))
}
