//! Scenes.

use std::path::PathBuf;
use std::sync::Arc;

use numpy::{PyArray1, PyArray2};
use phicam::lab;
use phicam::model::{Kernel, MatrixModel, Occlusion};
use phicam::report;
use phicam::scene::{self, Parameter};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::arrays::{points, vector};
use crate::errors::{Raise, input, raised};
use crate::work::run;

/// A scene, checked.
#[pyclass(frozen, module = "phicam._native")]
pub struct Scene {
    pub inner: Arc<scene::Scene>,
}

impl From<scene::Scene> for Scene {
    fn from(scene: scene::Scene) -> Self {
        let inner = Arc::new(scene);
        Self { inner }
    }
}

/// Names of the built-in scenes, each with what it is.
#[pyfunction]
pub fn builtins() -> Vec<(String, String)> {
    let each = scene::builtins().iter();
    each.map(|b| (b.name.to_owned(), b.summary.to_owned()))
        .collect()
}

#[pymethods]
impl Scene {
    /// A built-in scene, or a file's; it may read files in the folders `also` too.
    #[staticmethod]
    fn load(py: Python<'_>, name: String, also: Vec<PathBuf>) -> PyResult<Self> {
        let found = run(py, Some(1), None, move |_| {
            scene::Scene::load_with(&name, &also)
        })?;
        found.raise().map(Self::from)
    }

    /// A scene that is text alone.
    #[staticmethod]
    fn parse(py: Python<'_>, text: String) -> PyResult<Self> {
        let read = move |_: phicam::transport::Control<'_>| scene::Scene::from_toml("scene", &text);
        run(py, Some(1), None, read)?.raise().map(Self::from)
    }

    /// The same with other values of some keys, as TOML.
    fn with_values(&self, py: Python<'_>, changes: Vec<(String, String)>) -> PyResult<Self> {
        let scene = Arc::clone(&self.inner);
        let made = run(py, Some(1), None, move |_| {
            let changes: Vec<(&str, &str)> = changes
                .iter()
                .map(|(key, value)| (key.as_str(), value.as_str()))
                .collect();
            scene.with(&changes)
        })?;
        made.raise().map(Self::from)
    }

    /// The file of the same scene with its geometry displaced.
    fn displaced(&self, py: Python<'_>, values: Vec<(String, f64)>) -> PyResult<Self> {
        let scene = Arc::clone(&self.inner);
        let made = run(py, Some(1), None, move |_| {
            let (mut parameters, mut sizes) = (Vec::new(), Vec::new());
            for (name, value) in &values {
                let named = Parameter::named(&scene, name)?;
                sizes.extend(std::iter::repeat_n(*value, named.len()));
                parameters.extend(named);
            }
            let file = scene.displaced_file(&parameters, &sizes)?;
            scene.remade(&file.toml()?)
        })?;
        made.raise().map(Self::from)
    }

    #[getter]
    fn name(&self) -> &str {
        &self.inner.name
    }

    #[getter]
    fn unit(&self) -> &str {
        self.inner.unit.symbol()
    }

    #[getter]
    fn hash(&self) -> &str {
        &self.inner.hash
    }

    #[getter]
    fn text(&self) -> &str {
        &self.inner.text
    }

    #[getter]
    fn max_bounces(&self) -> u32 {
        self.inner.max_bounces
    }

    /// Columns and rows.
    #[getter]
    fn pixels(&self) -> (usize, usize) {
        (self.inner.camera.columns, self.inner.camera.rows)
    }

    #[getter]
    fn power(&self) -> f64 {
        self.inner.laser.power
    }

    #[getter]
    fn wavelength(&self) -> f64 {
        self.inner.laser.wavelength
    }

    /// Spots × 3.
    #[getter]
    fn spots<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let spots = self.inner.laser.spots.iter();
        let places: Vec<[f64; 3]> = spots.map(|s| s.target.position.to_array()).collect();
        points(py, &places)
    }

    /// Middles of the pixels' footprints on the view, pixels × 3.
    #[getter]
    fn footprints<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let camera = &self.inner.camera;
        let each = (0..camera.pixels()).map(|p| camera.footprint(p).at([0.5; 2]).to_array());
        points(py, &each.collect::<Vec<_>>())
    }

    /// Of each hidden surface: its name, elements along u and v, and whether its albedo is known.
    #[getter]
    fn hidden(&self) -> Vec<(String, (usize, usize), bool)> {
        let each = self.inner.hidden();
        each.map(|(_, s)| (s.name.clone(), s.elements.into(), s.is_known))
            .collect()
    }

    /// Albedos of all elements.
    fn truth<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        if let Some(names) = self.inner.unknown() {
            let cause = format!("the albedo of {names} is unknown");
            return Err(input(cause, "give it one in the scene"));
        }
        let scene = Arc::clone(&self.inner);
        let model = run(py, None, None, move |_| {
            MatrixModel::without_photographs(&scene, Kernel::Physical, None, Occlusion::Ignored)
        })?;
        Ok(vector(py, model.raise()?.albedo))
    }

    /// What is suspicious though not wrong.
    fn warnings(&self, py: Python<'_>) -> PyResult<Vec<String>> {
        let scene = Arc::clone(&self.inner);
        let found = run(py, None, None, move |_| scene.warnings())?;
        Ok(found.iter().map(ToString::to_string).collect())
    }

    /// The names of what may be displaced, with their units, below each of `names`.
    fn parameters(&self, names: Vec<String>) -> PyResult<Vec<(String, String)>> {
        let mut found = Vec::new();
        for name in names {
            let named = Parameter::named(&self.inner, &name).raise()?;
            found.extend(named.into_iter().map(|p| (p.name, p.unit)));
        }
        Ok(found)
    }

    /// The files that it names: name of the copy in the folder `files` beside a scene, and bytes.
    fn files<'py>(&self, py: Python<'py>) -> PyResult<Vec<(String, Bound<'py, PyBytes>)>> {
        let read = |file: &scene::Referenced| {
            let bytes = file.again().map_err(|(cause, cure)| input(cause, cure))?;
            Ok((file.copy_name(), PyBytes::new(py, &bytes)))
        };
        self.inner.files.iter().map(read).collect()
    }

    /// What it is uncertain of: names of parameters with standard deviations.
    #[getter]
    fn uncertainty(&self) -> Vec<(String, f64)> {
        self.inner.uncertainty.clone()
    }

    /// Its [sensor] table as JSON: null where it has none.
    #[getter]
    fn sensor(&self) -> PyResult<String> {
        serde_json::to_string(&self.inner.sensor).raise()
    }

    /// The bench, drawn to scale.
    fn svg(&self) -> String {
        report::bench_svg(&self.inner)
    }

    /// A picture of it in ordinary light, rows × 3 columns, from the top.
    fn preview<'py>(
        &self,
        py: Python<'py>,
        size: (usize, usize),
        samples: u32,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let scene = Arc::clone(&self.inner);
        let made = run(py, None, None, move |control| {
            let size = [size.0, size.1];
            let viewpoint = lab::auto_viewpoint(&scene, size, &lab::ViewOptions::default())?;
            let plan = lab::PreviewPlan {
                viewpoint,
                size,
                samples,
                overlay: true,
            };
            lab::preview(&scene, &plan, control)
        })?;
        let colours = made.map_err(|e| raised(&e))?.colours;
        let colours: Vec<[f64; 3]> = colours.into_iter().map(Into::into).collect();
        points(py, &colours)
    }

    /// The program that renders it with Mitsuba 3.
    fn mitsuba_script(&self) -> PyResult<String> {
        report::mitsuba_script(&self.inner).raise()
    }
}
