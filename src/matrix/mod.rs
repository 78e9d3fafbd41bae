//! Floor 3: the pixels × spots matrix and its file format.
//!
//! One photograph per laser spot, each photograph a column: the stack of them is the
//! light-transport matrix Φcam that the whole laboratory is about.
//!
//! * [`Matrix`]: the type every floor above uses.
//! * [`npy`]: its `.npy` file, as NumPy writes and reads it.
//! * [`expected`]: what is expected of entries whose noise goes with their size.
//! * [`Array`]: photographs of any number of dimensions, from `.npy` or a MATLAB file ([`mat`]).

mod array;
mod expected;
pub mod mat;
pub mod npy;

pub use array::{Array, ArrayError, MOST_ENTRIES};
pub use expected::{TOO_DARK, expected, relative_errors};

/// A dense matrix of f64, stored by columns. As Φcam it has one row a camera pixel (row = column +
/// row·columns of the pixel grid), one column a laser spot, and entries in W; G12, G23 and the
/// standard errors of Φcam have the same type.
pub type Matrix = nalgebra::DMatrix<f64>;
