//! What is found, as text: JSON for values, SVG for figures.

use phicam::lab::finding::{Finding, Gallery, Picture, Shades};
use phicam::report::{finding_files, finding_text};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::errors::Raise;

/// A finding: `finding` and `text`, its files and figures by name; with `json`, the result itself.
pub fn found<'py>(py: Python<'py>, finding: &Finding, json: &str) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("json", json)?;
    dict.set_item("finding", serde_json::to_string(finding).raise()?)?;
    dict.set_item("text", finding_text(finding))?;
    dict.set_item("files", finding_files(finding))?;
    let galleries = finding.galleries.iter();
    let drawn: PyResult<Vec<String>> = galleries.map(drawn).collect();
    dict.set_item("galleries", drawn?)?;
    Ok(dict)
}

fn drawn(gallery: &Gallery) -> PyResult<String> {
    phicam::report::gallery_svg(gallery).raise()
}

/// A picture: its title, columns and rows, values, what its axes are, and its width.
type Given = (String, (usize, usize), Vec<f64>, (String, String), f64);

/// Pictures side by side on one scale, as SVG.
#[pyfunction]
pub fn gallery_svg(
    title: String,
    unit: String,
    is_reflectance: bool,
    pictures: Vec<Given>,
) -> PyResult<String> {
    let picture = |(title, size, values, axes, width): Given| Picture {
        title,
        size: size.into(),
        values,
        axes: axes.into(),
        width,
    };
    let shades = if is_reflectance {
        Shades::Reflectance
    } else {
        Shades::Values
    };
    drawn(&Gallery {
        title,
        shades,
        unit,
        pictures: pictures.into_iter().map(picture).collect(),
    })
}
