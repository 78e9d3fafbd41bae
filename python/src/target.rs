//! The built-in target pictures.

use phicam::num::named::Named;
use phicam::scene::target::{MOST_SIDE, Target};
use pyo3::prelude::*;

use crate::errors::input;

/// Each target's name and what it shows.
#[pyfunction]
pub fn targets() -> Vec<(&'static str, &'static str)> {
    Target::ALL.map(|t| (t.name(), t.summary())).to_vec()
}

/// Reflectances row by row from the top, with columns and rows.
#[pyfunction]
pub fn target(name: &str, size: Option<(usize, usize)>) -> PyResult<(Vec<f64>, (usize, usize))> {
    let Some(found) = Target::by_name(name) else {
        let names = Target::ALL.map(Target::name).join(", ");
        return Err(input(
            format!("there is no target {name:?}"),
            &format!("use one of {names}"),
        ));
    };
    let size = size.map_or(found.usual_size(), |(columns, rows)| [columns, rows]);
    let Some(picture) = found.picture(size) else {
        let cause = format!("a target of {} × {} pixels", size[0], size[1]);
        return Err(input(cause, &format!("use 1 to {MOST_SIDE} a side")));
    };
    Ok((picture.values, (size[0], size[1])))
}
