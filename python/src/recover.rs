//! The hidden reflectance.

use std::sync::Arc;

use numpy::PyArray2;
use phicam::lab::{Noise, RecoveredObject, by_trust, describe_recovery, recover_objects};
use phicam::matrix::Matrix;
use phicam::num::linalg::Tolerance;
use phicam::recovery::{Method, Options, Rule, Setting, Uncertainty, WeightRule};
use phicam::report::finding_text;
use phicam::store::memory;
use phicam::transport::Control;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::{array, errors, matrix, maybe, vector};
use crate::beside::Given;
use crate::errors::{Raise, input, named};
use crate::model::Model;
use crate::validate::{Known, certainty};
use crate::work::run;

/// Copies of all matrices that are held at once.
const HELD: f64 = 6.0;

/// The methods.
#[pyfunction]
pub fn methods() -> Vec<&'static str> {
    Method::names().to_vec()
}

/// Standard errors of photographs with `noise` relative to each entry.
#[pyfunction]
#[pyo3(signature = (phi, noise, left_out))]
pub fn relative_errors<'py>(
    phi: &Bound<'py, PyAny>,
    noise: f64,
    left_out: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let (flux, flags) = (matrix(phi, "phi")?, maybe(left_out, "left_out")?);
    let found = phicam::matrix::relative_errors(&flux, noise, flags.as_ref());
    let (stderr, _) = found.raise()?;
    array(phi.py(), stderr)
}

/// A setting by its keyword.
fn setting(name: &str) -> PyResult<Setting> {
    let found = Setting::ALL
        .into_iter()
        .find(|s| s.name().replace('-', "_") == name);
    found.ok_or_else(|| input(format!("no setting `{name}`"), "see help(phicam.recover)"))
}

/// The methods that do something with a setting.
#[pyfunction]
pub fn setting_methods(name: &str) -> PyResult<Vec<&'static str>> {
    Ok(setting(name)?.methods().iter().map(|m| m.name()).collect())
}

/// Which numbers a setting can be, in words.
#[pyfunction]
pub fn setting_range(name: &str) -> PyResult<&'static str> {
    Ok(setting(name)?.range().unwrap_or_default())
}

/// Whether a setting can have this value.
#[pyfunction]
pub fn setting_allows(name: &str, value: f64) -> PyResult<bool> {
    Ok(setting(name)?.allows(value))
}

/// How to recover, as keywords.
#[derive(FromPyObject)]
pub struct Settings {
    #[pyo3(item)]
    rank: Option<usize>,
    #[pyo3(item)]
    damping: Option<f64>,
    #[pyo3(item)]
    rule: Option<String>,
    #[pyo3(item)]
    tolerance: Option<f64>,
    #[pyo3(item)]
    tv: Option<f64>,
    #[pyo3(item)]
    levels: Option<(f64, f64)>,
    #[pyo3(item)]
    weighting: Option<String>,
    #[pyo3(item)]
    bands: Option<f64>,
    #[pyo3(item)]
    error_field: bool,
}

impl Settings {
    fn options(&self, elements: usize, frame: Option<[usize; 2]>) -> PyResult<Options> {
        let rule = self.rule.as_deref();
        let rule = rule.map(|name| named(name, "rule", Rule::ALL, Rule::name));
        let weighting = self.weighting.as_deref();
        let weighting =
            weighting.map(|name| named(name, "weighting", WeightRule::ALL, WeightRule::name));
        let usual = Options::default();
        Ok(Options {
            rank: self.rank,
            damping: self.damping,
            rule: rule.transpose()?.unwrap_or_default(),
            tolerance: self.tolerance.map_or(usual.tolerance, Tolerance::Relative),
            total_variation: self.tv,
            levels: self.levels.map(Into::into),
            bands: self.bands,
            weighting: weighting.transpose()?.unwrap_or_default(),
            frame,
            error_field: self.error_field,
            uncertainty: Uncertainty::of(elements),
            ..usual
        })
    }
}

/// Recovers by each of the methods; without `is_grid` nothing says how the elements lie; `trusted`
/// orders what was found by how far it can be trusted.
#[pyfunction]
#[pyo3(signature = (model, phi, stderr, *, methods, is_grid, settings, beside, known,
                    trusted, threads))]
#[expect(
    clippy::too_many_arguments,
    reason = "one for each keyword of Python's function"
)]
pub fn recover<'py>(
    py: Python<'py>,
    model: &Model,
    phi: &Bound<'py, PyAny>,
    stderr: Option<&Bound<'py, PyAny>>,
    methods: Option<Vec<String>>,
    is_grid: bool,
    settings: Settings,
    beside: Given<'py>,
    known: Known,
    trusted: bool,
    threads: Option<usize>,
) -> PyResult<(Vec<Bound<'py, PyDict>>, Vec<(String, String)>)> {
    let own = Arc::clone(&model.inner);
    let elements = own.albedo.len();
    let named: Result<Vec<Method>, _> = methods.iter().flatten().map(|m| m.parse()).collect();
    let named = named.raise()?;
    let alone = |method: &Method| is_grid || !method.compares_neighbours();
    let methods = match methods {
        None => Method::tried(elements).into_iter().filter(alone).collect(),
        Some(_) => named,
    };
    if let Some(method) = methods.iter().find(|method| !alone(method)) {
        let cause = format!("{method} compares neighbours, and nothing says how the elements lie");
        return Err(input(cause, "give elements=(nu, nv)"));
    }
    let options = settings.options(elements, beside.frame())?;
    let (rows, columns) = (own.camera_side.nrows(), own.laser_side.ncols());
    let entries = (rows * columns + elements * (rows + columns)) as f64;
    let refuse = move |_: Control<'_>| memory::refuse("these matrices", HELD * 8.0 * entries, &[]);
    run(py, None, None, refuse)?.raise()?;
    let (phi, stderr) = (matrix(phi, "phi")?, errors(stderr, "stderr")?);
    let beside = beside.read()?;
    let certainty = certainty(known)?;
    let attempts = run(py, threads, None, move |control| {
        let noise = stderr.as_ref().map_or(Noise::Unknown, |stderr| {
            Noise::StandardError(stderr, certainty)
        });
        let nuisance = beside.nuisance();
        recover_objects(&own, &phi, noise, nuisance, &methods, &options, control)
    })?;
    let alone = attempts.len() == 1;
    let (mut objects, mut failed) = (Vec::new(), Vec::new());
    for attempt in attempts {
        match attempt.outcome {
            Ok(found) => objects.extend(found),
            Err(error) if alone => return Err(crate::errors::raised(&error)),
            Err(error) => failed.push((attempt.method.name().to_owned(), error.to_string())),
        }
    }
    if trusted {
        by_trust(&mut objects);
    }
    let objects: PyResult<Vec<_>> = objects.into_iter().map(|object| dict(py, object)).collect();
    Ok((objects?, failed))
}

/// What was found of a surface: its arrays, and all else as JSON.
fn dict(py: Python<'_>, mut object: RecoveredObject) -> PyResult<Bound<'_, PyDict>> {
    let found = PyDict::new(py);
    let text = finding_text(&describe_recovery(std::slice::from_ref(&object)));
    found.set_item("text", text)?;
    let whole = |m: Option<Matrix>| m.map(|m| array(py, m)).transpose();
    found.set_item("covariance", whole(object.covariance.take())?)?;
    found.set_item("resolution", whole(object.resolution.take())?)?;
    found.set_item("json", serde_json::to_string(&object).raise()?)?;
    let numbers = |values: Option<Vec<f64>>| values.map(|values| vector(py, values));
    let (lower, upper) = object.bands.map(|b| (b.lower, b.upper)).unzip();
    let (alike, alike_stderr) = object.alike.map(|[mean, error]| (mean, error)).unzip();
    for (name, values) in [
        ("reflectance", Some(object.reflectance)),
        ("truth", object.truth),
        ("stderr", object.standard_error),
        ("bias", object.bias),
        ("light", object.light),
        ("alike", alike),
        ("alike_stderr", alike_stderr),
        ("determined", object.determined_share),
        ("lower", lower),
        ("upper", upper),
    ] {
        found.set_item(name, numbers(values))?;
    }
    Ok(found)
}
