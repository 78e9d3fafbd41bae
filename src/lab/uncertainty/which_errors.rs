//! Which kind of errors photographs are likelier with, in words.

use crate::num::digits::figure;

/// ln of a ratio of likelihoods above which errors that neighbours share are taken; three numbers
/// more fit noise by e^1.5 better.
const DECISIVE: f64 = 6.0;

/// By ln of how much likelier they are with errors that neighbours share than with noise of single
/// pixels alone.
pub(in crate::lab) fn which_errors(likelier: f64) -> String {
    if likelier > DECISIVE {
        format!(
            "with these errors the photographs are e^{} times likelier than with noise of single pixels alone",
            figure(likelier, 3)
        )
    } else {
        format!(
            "noise of single pixels alone explains the photographs as well (these errors are e^{} times \
             likelier): leave out --error-field",
            figure(likelier, 2)
        )
    }
}
