//! Traced or measured against modelled.

use std::sync::Arc;

use numpy::PyArray2;
use phicam::jobs::need;
use phicam::lab::finding::Describe;
use phicam::lab::{Against, Certainty, Errors, Measured, Test, validate as validated};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::{array, matrix};
use crate::beside::Given;
use crate::errors::{Raise, named};
use crate::findings::found;
use crate::model::{integration, kernel, occlusion};
use crate::scene::Scene;
use crate::work::{fits, knows_its_light, run};

/// How errors hang together, by its name; from how many replicates they were estimated; the variance
/// of the entries' variances over their squares that all share.
pub type Known = (String, Option<u32>, f64);

/// What is known of errors.
pub fn certainty((errors, replicates, unknown): Known) -> PyResult<Certainty> {
    let errors = named(&errors, "errors", Errors::ALL, Errors::name)?;
    Ok(Certainty {
        unknown,
        ..Certainty::new(errors, replicates)
    })
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
#[pyo3(signature = (scene, phi, stderr, *, kernel_name, integration_name, considered,
                    significance, known, paths, beside, threads))]
#[expect(
    clippy::too_many_arguments,
    reason = "one for each keyword of Python's function"
)]
pub fn validate<'py>(
    py: Python<'py>,
    scene: &Scene,
    phi: &Bound<'py, PyAny>,
    stderr: &Bound<'py, PyAny>,
    kernel_name: &str,
    integration_name: &str,
    considered: bool,
    significance: f64,
    known: Known,
    paths: Option<u64>,
    beside: Given<'py>,
    threads: Option<usize>,
) -> PyResult<Verdict<'py>> {
    let against = Against {
        kernel: kernel(kernel_name)?,
        integration: integration(integration_name)?,
        occlusion: occlusion(considered),
    };
    let test = Test {
        significance,
        known: Certainty {
            paths,
            ..certainty(known)?
        },
    };
    knows_its_light(&scene.inner)?;
    fits(py, &scene.inner, need::verdict)?;
    let phi = matrix(phi, "phi")?;
    let stderr = crate::arrays::errors(Some(stderr), "stderr")?.unwrap_or_default();
    let beside = beside.read()?;
    let scene = Arc::clone(&scene.inner);
    let verdict = run(py, threads, None, move |_| {
        let measured = Measured {
            phi: &phi,
            stderr: &stderr,
            beside: beside.nuisance(),
        };
        validated(&scene, measured, against, test)
    })?;
    let verdict = verdict.raise()?;
    let json = serde_json::to_string(&verdict.agreement).raise()?;
    let words = found(py, &verdict.agreement.describe(), &json)?;
    Ok((words, array(py, verdict.z)?, array(py, verdict.model)?))
}
