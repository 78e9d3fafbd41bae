//! Studies, by their names.

use std::sync::Arc;

use phicam::jobs::need;
use phicam::lab::options::{Kind, Values};
use phicam::lab::{Found, STUDIES, StudyError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::errors::{input, raised};
use crate::findings::found;
use crate::scene::Scene;
use crate::work::{fits, knows_its_light, run};

/// An option: name, help, kind, default, whether it takes several.
type Described = (
    &'static str,
    String,
    &'static str,
    Option<&'static str>,
    bool,
);

/// Every study: name, what it asks, the scene that it studies unless one is given, its options.
#[pyfunction]
pub fn studies() -> Vec<(
    &'static str,
    &'static str,
    Option<&'static str>,
    Vec<Described>,
)> {
    let each = STUDIES.iter();
    each.map(|study| {
        let options = study.options.iter().map(|option| {
            let (kind, names) = match &option.kind {
                Kind::Whole(_) => ("int", String::new()),
                Kind::Number => ("float", String::new()),
                Kind::Text => ("str", String::new()),
                Kind::Name(names) => {
                    let names: Vec<&str> = names.iter().map(|(name, _)| *name).collect();
                    ("name", format!(": {}", names.join(", ")))
                }
            };
            let help = format!("{}{names}", option.help);
            (option.name, help, kind, option.default, option.list)
        });
        (study.name, study.about, study.scene, options.collect())
    })
    .collect()
}

/// Runs a study; `progress` is called with what is done of the work, which is returned too.
#[pyfunction]
#[pyo3(signature = (name, scene, options, *, threads, progress))]
pub fn study<'py>(
    py: Python<'py>,
    name: &str,
    scene: &Scene,
    options: Vec<(String, Vec<String>)>,
    threads: Option<usize>,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<(Bound<'py, PyDict>, bool)> {
    let Some(registered) = STUDIES.iter().find(|s| s.name == name) else {
        let names: Vec<&str> = STUDIES.iter().map(|s| s.name).collect();
        let cure = format!("use one of {}", names.join(", "));
        return Err(input(format!("there is no study `{name}`"), &cure));
    };
    if let Some((_, surface)) = scene.inner.shining() {
        let cause = format!(
            "studies need a scene with a laser, and here `{}` shines",
            surface.name
        );
        return Err(input(cause, "use validate and recover for this scene"));
    }
    knows_its_light(&scene.inner)?;
    fits(py, &scene.inner, need::study)?;
    let mut values = Values::defaults(registered.options);
    for (option, given) in options {
        values = values.with(&option, given).map_err(|e| raised(&e))?;
    }
    let prepare = registered.prepare;
    let scene = Arc::clone(&scene.inner);
    let report = |of: u64| -> PyResult<()> {
        progress.map_or(Ok(()), |call| call.call_method1("of", (of,)).map(|_| ()))
    };
    let ready = run(py, threads, None, move |_| prepare(&scene, &values))?;
    let ready = ready.map_err(boxed)?;
    report(ready.work().units())?;
    let done = run(
        py,
        threads,
        progress,
        move |control| -> Result<Found, StudyError> {
            let outputs = ready.outputs(0..ready.tasks(), control)?;
            ready.merge(&outputs, control)
        },
    )?;
    let done = done.map_err(boxed)?;
    Ok((found(py, &done.finding, &done.json)?, done.agrees))
}

fn boxed(error: StudyError) -> PyErr {
    raised(&*error)
}
