//! The crate phicam as a Python module: arrays in, arrays out. What Python's users see is written
//! in `phicam/*.py`; here is what those files call.
//!
//! Every computation runs on a thread pool of its own with the interpreter unlocked
//! ([`work::run`]), so that Ctrl-C ends it, and that a forked process does not wait for threads
//! that it has not.

mod arrays;
mod beside;
mod calibrate;
mod errors;
mod expose;
mod findings;
mod folder;
mod import;
mod model;
mod published;
mod recover;
mod render;
mod scene;
mod study;
mod target;
mod validate;
mod work;

use pyo3::pymodule;

#[pymodule]
mod _native {
    #[pymodule_export]
    use crate::calibrate::{calibrate, locatable, locate};
    #[pymodule_export]
    use crate::expose::{expose, sensors};
    #[pymodule_export]
    use crate::findings::gallery_svg;
    #[pymodule_export]
    use crate::folder::{read_run, write_run};
    #[pymodule_export]
    use crate::import::{import_photographs, scene_named};
    #[pymodule_export]
    use crate::model::Model;
    #[pymodule_export]
    use crate::published::{again, published};
    #[pymodule_export]
    use crate::recover::{
        methods, recover, relative_errors, setting_allows, setting_methods, setting_range,
    };
    #[pymodule_export]
    use crate::render::aimed;
    #[pymodule_export]
    use crate::render::render;
    #[pymodule_export]
    use crate::scene::{Scene, builtins};
    #[pymodule_export]
    use crate::study::{studies, study};
    #[pymodule_export]
    use crate::target::{target, targets};
    #[pymodule_export]
    use crate::validate::{shares_by_pixel, validate};

    #[pymodule_init]
    fn init(module: &pyo3::Bound<'_, pyo3::types::PyModule>) -> pyo3::PyResult<()> {
        use pyo3::types::PyModuleMethods;
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
