//! Arrays of NumPy ↔ matrices of the crate.

use numpy::ndarray::{ArrayView2, Axis};
use numpy::npyffi::NPY_ORDER;
use numpy::{PyArray, PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2};
use phicam::matrix::Matrix;
use pyo3::prelude::*;

use crate::errors::input;

/// A matrix from an array of float64 or float32 in any layout: the one copy that is made of it.
/// `name` is what errors call it.
pub fn matrix(array: &Bound<'_, PyAny>, name: &str) -> PyResult<Matrix> {
    if let Ok(array) = array.extract::<PyReadonlyArray2<'_, f64>>() {
        return copied(&array.as_array(), name, |x| x);
    }
    if let Ok(array) = array.extract::<PyReadonlyArray2<'_, f32>>() {
        return copied(&array.as_array(), name, f64::from);
    }
    let cause = format!("{name} is no array of two dimensions of float64 or float32");
    Err(input(cause, "give one: numpy.asarray(…, dtype=float)"))
}

/// The same where it may be None.
pub fn maybe(array: Option<&Bound<'_, PyAny>>, name: &str) -> PyResult<Option<Matrix>> {
    array.map(|array| matrix(array, name)).transpose()
}

/// Standard errors: as [`maybe`], and none negative.
pub fn errors(array: Option<&Bound<'_, PyAny>>, name: &str) -> PyResult<Option<Matrix>> {
    let Some(found) = maybe(array, name)? else {
        return Ok(None);
    };
    match found.iter().position(|x| *x < 0.0) {
        None => Ok(Some(found)),
        Some(at) => {
            let (row, column) = (at % found.nrows(), at / found.nrows());
            let cause = format!(
                "{name} has the negative standard error {} at [{row}, {column}]",
                found[at]
            );
            Err(input(cause, "give standard errors, 0 or more"))
        }
    }
}

fn copied<T: Copy>(
    view: &ArrayView2<'_, T>,
    name: &str,
    of: impl Fn(T) -> f64,
) -> PyResult<Matrix> {
    let (rows, columns) = view.dim();
    let mut values = Vec::with_capacity(rows * columns);
    // Column by column, as the matrix lies.
    for column in view.axis_iter(Axis(1)) {
        values.extend(column.iter().map(|x| of(*x)));
    }
    match values.iter().position(|x| !x.is_finite()) {
        None => Ok(Matrix::from_vec(rows, columns, values)),
        Some(at) => {
            let (row, column) = (at % rows, at / rows);
            let cause = format!("{name} has {} at [{row}, {column}]", values[at]);
            Err(input(
                cause,
                "give finite numbers, and leave out entries that do not count by `left_out`",
            ))
        }
    }
}

/// The matrix as an array that Python owns, without a copy; in Fortran's order.
pub fn array<'py>(py: Python<'py>, matrix: Matrix) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let shape = [matrix.nrows(), matrix.ncols()];
    let values: Vec<f64> = matrix.data.into();
    PyArray1::from_vec(py, values).reshape_with_order(shape, NPY_ORDER::NPY_FORTRANORDER)
}

/// The same of one that may not be there.
pub fn maybe_array<'py>(
    py: Python<'py>,
    matrix: Option<Matrix>,
) -> PyResult<Option<Bound<'py, PyArray2<f64>>>> {
    matrix.map(|matrix| array(py, matrix)).transpose()
}

/// Points of space, n × 3.
pub fn points<'py>(py: Python<'py>, points: &[[f64; 3]]) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let flat: Vec<f64> = points.iter().flatten().copied().collect();
    PyArray1::from_vec(py, flat).reshape([points.len(), 3])
}

/// Numbers.
pub fn vector(py: Python<'_>, values: Vec<f64>) -> Bound<'_, PyArray1<f64>> {
    PyArray::from_vec(py, values)
}
