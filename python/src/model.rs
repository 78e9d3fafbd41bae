//! The matrix model.

use std::sync::Arc;

use numpy::PyArray2;
use phicam::jobs::need;
use phicam::lab::{Integration, inverted};
use phicam::model::{
    Differential, Effort, Extent, Fineness, Kernel, MatrixModel, ModelError, Occlusion, converged,
};
use phicam::scene::{self, Parameter};
use pyo3::prelude::*;

use crate::arrays::{array, matrix, points};
use crate::errors::{Raise, input, named};
use crate::scene::Scene;
use crate::work::{fits, knows_its_light, run};

/// The kernel of that name.
pub fn kernel(name: &str) -> PyResult<Kernel> {
    let all = [Kernel::Physical, Kernel::Published];
    named(name, "kernel", all, Kernel::name)
}

/// The integration of that name.
pub fn integration(name: &str) -> PyResult<Integration> {
    let all = [Integration::Centres, Integration::Quadrature];
    named(name, "integration", all, Integration::name)
}

/// Whether things in the way are considered.
pub fn occlusion(considered: bool) -> Occlusion {
    if considered {
        Occlusion::Considered
    } else {
        Occlusion::Ignored
    }
}

/// G12, G23 and the two sides of Φcam.
#[pyclass(frozen, module = "phicam._native")]
pub struct Model {
    pub inner: Arc<MatrixModel>,
    /// Its scene and what stands in the way of it; none of matrices from elsewhere.
    scene: Option<(Arc<scene::Scene>, Occlusion)>,
}

#[pymethods]
impl Model {
    #[staticmethod]
    fn of_scene(
        py: Python<'_>,
        scene: &Scene,
        kernel_name: &str,
        elements: Option<(usize, usize)>,
        considered: bool,
        integration_name: &str,
    ) -> PyResult<Self> {
        let (kernel, integration) = (kernel(kernel_name)?, integration(integration_name)?);
        let (own, occlusion) = (Arc::clone(&scene.inner), occlusion(considered));
        let elements = elements.map(Into::into);
        fits(py, &own, move |scene| need::model(scene, elements, false))?;
        let made = run(py, None, None, move |_| {
            inverted(
                &own,
                kernel,
                elements,
                occlusion,
                (integration, Effort::FINEST),
            )
        })?;
        Ok(Self {
            inner: Arc::new(made.raise()?),
            scene: Some((Arc::clone(&scene.inner), occlusion)),
        })
    }

    #[staticmethod]
    fn of_sides(
        camera_side: &Bound<'_, PyAny>,
        laser_side: &Bound<'_, PyAny>,
        elements: (usize, usize),
    ) -> PyResult<Self> {
        let camera = matrix(camera_side, "camera_side")?;
        let laser = matrix(laser_side, "laser_side")?;
        let made = MatrixModel::of_sides(camera, laser, elements.into()).raise()?;
        Ok(Self {
            inner: Arc::new(made),
            scene: None,
        })
    }

    #[getter]
    fn g12<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        array(py, self.inner.g12.clone())
    }

    #[getter]
    fn g23<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        array(py, self.inner.g23.clone())
    }

    #[getter]
    fn camera_side<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        array(py, self.inner.camera_side.clone())
    }

    #[getter]
    fn laser_side<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        array(py, self.inner.laser_side.clone())
    }

    #[getter]
    fn albedo(&self) -> Vec<f64> {
        self.inner.albedo.clone()
    }

    /// The same where the scene knows it.
    fn own_albedo(&self) -> PyResult<Vec<f64>> {
        let (scene, _) = self.own_scene()?;
        knows_its_light(&scene)?;
        Ok(self.inner.albedo.clone())
    }

    /// Middles of the elements, elements × 3; empty of matrices from elsewhere.
    #[getter]
    fn places<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        points(py, &self.inner.places)
    }

    /// Of each surface: its name and its elements along u and v.
    #[getter]
    fn grids(&self) -> Vec<(String, (usize, usize))> {
        let grids = self.inner.grids.iter();
        grids.map(|g| (g.surface.clone(), g.count.into())).collect()
    }

    /// Pixels, elements, spots.
    #[getter]
    fn shape(&self) -> (usize, usize, usize) {
        let elements = self.inner.albedo.len();
        let (pixels, spots) = (
            self.inner.camera_side.nrows(),
            self.inner.laser_side.ncols(),
        );
        (pixels, elements, spots)
    }

    /// Φcam of these reflectances.
    fn phi<'py>(&self, py: Python<'py>, albedo: Vec<f64>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let (given, wanted) = (albedo.len(), self.inner.albedo.len());
        if given != wanted || albedo.iter().any(|x| !x.is_finite()) {
            let cause = format!("rho has {given} numbers, and the model {wanted} elements");
            return Err(input(cause, "give one finite reflectance for each element"));
        }
        let model = Arc::clone(&self.inner);
        array(py, run(py, None, None, move |_| model.phi_of(&albedo))?)
    }

    /// Φcam integrated until it no longer changes, and a bound of what is left of each entry.
    #[expect(clippy::type_complexity, reason = "a pair of arrays")]
    fn converged<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<f64>>)> {
        let (scene, occlusion) = self.own_scene()?;
        knows_its_light(&scene)?;
        fits(py, &scene, |scene| need::model(scene, None, true))?;
        let kernel = self.inner.kernel;
        let found = run(py, None, None, move |_| {
            let extent = Extent {
                occlusion,
                ..Extent::FULL
            };
            converged(&scene, kernel, extent)
        })?;
        let found = found.raise()?;
        Ok((array(py, found.phi)?, array(py, found.bound)?))
    }

    /// ∂Φcam/∂θ of each parameter that `name` names, by centres, at `albedo`.
    fn derivatives<'py>(
        &self,
        py: Python<'py>,
        name: String,
        albedo: Vec<f64>,
    ) -> PyResult<Vec<(String, Bound<'py, PyArray2<f64>>)>> {
        let (scene, _) = self.own_scene()?;
        let grid = match &self.inner.grids[..] {
            [grid] => Some(grid.count),
            _ => None,
        };
        let found = run(py, None, None, move |_| -> Result<_, Wrong> {
            let parameters = Parameter::named(&scene, &name)?;
            let at = Differential::new(&scene, grid, Fineness::Centres)?;
            let (terms, zeros) = (at.terms(), vec![0.0; parameters.len()]);
            let elements = at.elements();
            let mut rates = Vec::new();
            for (k, parameter) in parameters.iter().enumerate() {
                let rate = at.rate(&scene.velocity(&parameters, &zeros, k));
                let columns: Vec<_> = (0..scene.laser.spots.len())
                    .map(|l| {
                        let slope = terms.frame_rate(&rate, l, elements);
                        let light = slope.column_iter().zip(&albedo);
                        let mut sum = vec![0.0; slope.nrows()];
                        for (column, rho) in light {
                            for (total, entry) in sum.iter_mut().zip(&column) {
                                *total += rho * entry;
                            }
                        }
                        sum
                    })
                    .collect();
                let (pixels, spots) = (scene.camera.pixels(), columns.len());
                let flat = columns.into_iter().flatten().collect();
                let matrix = phicam::matrix::Matrix::from_vec(pixels, spots, flat);
                rates.push((parameter.name.clone(), matrix));
            }
            Ok(rates)
        })?;
        let found = found.raise()?.into_iter();
        found.map(|(name, m)| Ok((name, array(py, m)?))).collect()
    }
}

impl Model {
    fn own_scene(&self) -> PyResult<(Arc<scene::Scene>, Occlusion)> {
        let cause = "this model is of matrices, and has no scene";
        let cure = "make it of a scene: phicam.model(scene)";
        self.scene.clone().ok_or_else(|| input(cause, cure))
    }
}

/// Why there are no derivatives.
#[derive(Debug)]
enum Wrong {
    Scene(scene::SceneError),
    Model(ModelError),
}

impl std::fmt::Display for Wrong {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Scene(error) => error.fmt(f),
            Self::Model(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for Wrong {}

impl From<scene::SceneError> for Wrong {
    fn from(error: scene::SceneError) -> Self {
        Self::Scene(error)
    }
}

impl From<ModelError> for Wrong {
    fn from(error: ModelError) -> Self {
        Self::Model(error)
    }
}
