//! Statistics of agreement: tail probabilities and the test of a whole family. The one door to
//! crate `statrs`.

mod binomial;
mod chi_square;
mod correlation;
mod family;
mod fisher;
mod gamma;
mod median;
mod normal;
mod student;

pub use binomial::binomial_interval;
pub(super) use chi_square::excess;
pub use chi_square::{chi_square_quantile, chi_square_sf};
pub use correlation::correlation_two_sided;
pub use family::{sidak_p, sidak_threshold, squares_or_largest};
pub use fisher::fisher_sf;
pub use gamma::{freedom_of_log_variance, pentagamma, trigamma};
pub use median::median;
pub use normal::{normal_two_sided, unskewed};
pub use student::{student_threshold, student_to_normal};
