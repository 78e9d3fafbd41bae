//! Progress bars on standard error.

use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use super::output::Talk;

/// A bar that counts `total` paths; silent with `--quiet` or where standard error is no terminal.
pub(super) fn paths(talk: Talk, what: &str, total: u64) -> ProgressBar {
    let target = if talk.quiet {
        ProgressDrawTarget::hidden()
    } else {
        ProgressDrawTarget::stderr()
    };
    let bar = ProgressBar::with_draw_target(Some(total), target);
    let template = "{msg} {wide_bar} {percent:>3} %  {eta} left, {si} paths/s";
    if let Ok(style) = ProgressStyle::with_template(template) {
        let rate = |state: &indicatif::ProgressState, w: &mut dyn std::fmt::Write| {
            let per_second = state.per_sec();
            let _ = match per_second {
                x if x >= 1e6 => write!(w, "{:.1} M", x / 1e6),
                x => write!(w, "{:.0} k", x / 1e3),
            };
        };
        bar.set_style(style.with_key("si", rate));
    }
    bar.set_message(what.to_owned());
    bar.enable_steady_tick(Duration::from_millis(200));
    bar
}

/// A bar that counts a few long steps.
pub(super) fn steps(talk: Talk, what: &str) -> ProgressBar {
    let target = match talk.quiet {
        true => ProgressDrawTarget::hidden(),
        false => ProgressDrawTarget::stderr(),
    };
    let bar = ProgressBar::with_draw_target(Some(1), target);
    if let Ok(style) = ProgressStyle::with_template("{msg} {wide_bar} {pos} of {len}  {eta} left") {
        bar.set_style(style);
    }
    bar.set_message(what.to_owned());
    bar
}
