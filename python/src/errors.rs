//! Errors of the crate as exceptions of Python.

use std::error::Error;
use std::fmt::Write as _;

use phicam::folder::FolderError;
use phicam::scene::SceneError;
use phicam::store::{LockError, ReadError, StoreError};
use phicam::transport::Stopped;
use pyo3::PyErr;

mod python {
    pyo3::import_exception!(phicam.errors, Error);
    pyo3::import_exception!(phicam.errors, FileError);
    pyo3::import_exception!(phicam.errors, InputError);
    pyo3::import_exception!(phicam.errors, InternalError);
    pyo3::import_exception!(phicam.errors, SceneError);
    pyo3::import_exception!(phicam.errors, Stopped);
}

/// An input that has no meaning, by cause and cure.
pub fn input(cause: impl AsRef<str>, cure: &str) -> PyErr {
    python::InputError::new_err(format!("{}\n  cure: {cure}", cause.as_ref()))
}

/// The one of `all` that has this name.
pub fn named<T: Copy, const N: usize>(
    given: &str,
    what: &str,
    all: [T; N],
    name: fn(T) -> &'static str,
) -> Result<T, PyErr> {
    let found = all.into_iter().find(|one| name(*one) == given);
    found.ok_or_else(|| {
        let cure = format!("use one of {}", all.map(name).join(", "));
        input(format!("no {what} `{given}`"), &cure)
    })
}

/// A fault of phicam itself.
pub fn internal(what: &str) -> PyErr {
    python::InternalError::new_err(format!(
        "{what}\n  cure: report it with the call that led to it"
    ))
}

/// The error of any floor of the crate, whose message names cause and cure.
pub fn raised(error: &(dyn Error + 'static)) -> PyErr {
    let mut message = error.to_string();
    let (mut file, mut stopped) = (is_of_a_file(error), error.is::<Stopped>());
    let mut source = error.source();
    while let Some(inner) = source {
        let text = inner.to_string();
        stopped |= inner.is::<Stopped>();
        if !stopped && !message.contains(&text) {
            let _ = write!(message, ": {text}");
        }
        file |= is_of_a_file(inner);
        source = inner.source();
    }
    if stopped {
        python::Stopped::new_err(message)
    } else if error.is::<SceneError>() {
        python::SceneError::new_err(message)
    } else if file {
        python::FileError::new_err(message)
    } else {
        python::InputError::new_err(message)
    }
}

fn is_of_a_file(error: &(dyn Error + 'static)) -> bool {
    let folder = error.downcast_ref::<FolderError>();
    folder.is_some_and(|e| !matches!(e, FolderError::Scene(_)))
        || error.is::<ReadError>()
        || error.is::<StoreError>()
        || error.is::<LockError>()
        || error.is::<std::io::Error>()
}

/// Results of the crate as results for Python.
pub trait Raise<T> {
    /// The value, or the exception.
    fn raise(self) -> Result<T, PyErr>;
}

impl<T, E: Error + 'static> Raise<T> for Result<T, E> {
    fn raise(self) -> Result<T, PyErr> {
        self.map_err(|error| raised(&error))
    }
}
