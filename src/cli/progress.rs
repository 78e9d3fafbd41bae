//! Progress bars on standard error: two lines, which fit into 40 columns.

use std::fmt::Write;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};

use crate::cli::console::Console;
use crate::cli::interrupt::stop_flag;
use crate::lab::Work;
use crate::matrix::Matrix;
use crate::num::digits::significant;
use crate::store::harmless;
use crate::transport::{Control, Tally};

/// Characters of what is done that are shown.
const WORDS: usize = 20;
/// What is done, the bar, its share and the time that is left.
const TEMPLATE: &str = "{msg} {wide_bar} {percent:>3} % {left}\n{rate}";
/// Time between two drawings.
const TICK: Duration = Duration::from_millis(200);
/// Time between two looks at a standard error at the least; and it takes at most one part in
/// [`SHARE`] of the time.
const LOOK: Duration = Duration::from_millis(200);
const SHARE: u32 = 200;

/// Does `work` by `act` until Ctrl-C, under a bar that counts in the unit of the work.
pub(super) fn run<T>(
    console: Console,
    what: &str,
    work: Work,
    act: impl FnOnce(Control<'_>) -> T,
) -> T {
    let bar = start(console, what, work);
    let done = act(counting(&|n| bar.inc(n)));
    bar.finish_and_clear();
    done
}

/// Does `act`, whose parts nobody counts, beside a clock.
pub(super) fn clocked<T>(console: Console, what: &str, act: impl FnOnce() -> T) -> T {
    let clock = bar_on(console, None);
    if let Ok(style) = ProgressStyle::with_template("{spinner} {msg} {elapsed}") {
        clock.set_style(style);
    }
    clock.set_message(shortened(&harmless(what)));
    clock.enable_steady_tick(TICK);
    let done = act();
    clock.finish_and_clear();
    done
}

/// Ends at Ctrl-C, and reports to `progress`.
fn counting<'a>(progress: &'a (dyn Fn(u64) + Sync)) -> Control<'a> {
    let stop = stop_flag();
    Control { progress, stop }
}

/// A bar for so much work; silent with `--quiet` or where standard error is no terminal.
pub(super) fn start(console: Console, what: &str, work: Work) -> ProgressBar {
    match work {
        Work::Samples(total) => bar(console, what, total, |state, w| {
            let _ = w.write_str(&per_second(state.per_sec()));
        }),
        Work::Methods(count) => bar(console, what, work.units(), move |state, w| {
            let done = state.pos() / Work::EACH_METHOD;
            let _ = write!(w, "{done} of {count} methods");
        }),
        Work::Tasks(total) => bar(console, what, total, |state, w| {
            let _ = write!(w, "{} of {}", state.pos(), state.len().unwrap_or(0));
            let _ = match state.per_sec() {
                x if x >= 1.0 => write!(w, ", {x:.0} per second"),
                x if x > 0.0 => write!(w, ", {} each", duration(1.0 / x)),
                _ => Ok(()),
            };
        }),
    }
}

fn bar(
    console: Console,
    what: &str,
    total: u64,
    rate: impl Fn(&ProgressState, &mut dyn Write) + Clone + Send + Sync + 'static,
) -> ProgressBar {
    let bar = bar_on(console, Some(total));
    if let Some(style) = style(rate) {
        bar.set_style(style);
    }
    bar.set_message(shortened(&harmless(what)));
    bar.enable_steady_tick(TICK);
    bar
}

/// On standard error, of so much work; on nothing with `--quiet`.
fn bar_on(console: Console, total: Option<u64>) -> ProgressBar {
    let target = if console.quiet {
        ProgressDrawTarget::hidden()
    } else {
        ProgressDrawTarget::stderr()
    };
    ProgressBar::with_draw_target(total, target)
}

fn style(
    rate: impl Fn(&ProgressState, &mut dyn Write) + Clone + Send + Sync + 'static,
) -> Option<ProgressStyle> {
    let left = |state: &ProgressState, w: &mut dyn Write| {
        let _ = match state.pos() {
            0 => Ok(()),
            _ => write!(w, "{} left", duration(state.eta().as_secs_f64())),
        };
    };
    let style = ProgressStyle::with_template(TEMPLATE).ok()?;
    Some(style.with_key("left", left).with_key("rate", rate))
}

/// At most [`WORDS`] characters.
fn shortened(text: &str) -> String {
    if text.chars().count() > WORDS {
        return text.chars().take(WORDS - 1).chain(['…']).collect();
    }
    text.to_owned()
}

/// Seconds in the unit that suits them.
fn duration(seconds: f64) -> String {
    match seconds {
        s if s < 99.5 => format!("{s:.0} s"),
        s if s < 99.5 * 60.0 => format!("{:.0} min", s / 60.0),
        s if s < 48.0 * 3600.0 => format!("{:.0} h", s / 3600.0),
        s => format!("{:.0} days", s / 86400.0),
    }
}

/// Samples a second with three digits.
fn per_second(rate: f64) -> String {
    let (value, unit) = match rate {
        x if x >= 999.5e6 => (x / 1e9, "G "),
        x if x >= 999.5e3 => (x / 1e6, "M "),
        x if x >= 999.5 => (x / 1e3, "k "),
        x => (x, ""),
    };
    let value = if unit.is_empty() {
        format!("{value:.0}")
    } else {
        significant(value, 3)
    };
    format!("{value} {unit}samples/s")
}

/// The bar of a render, which shows how precise it is so far as well: ‖σ‖/‖Φ‖ (Frobenius) over the
/// finished columns, and until there is one over the finished blocks. Where nobody sees it, nothing
/// is worked out.
pub(super) struct Tracing {
    bar: ProgressBar,
    /// Bits of what is shown; not a number until it is known.
    shown: Arc<AtomicU64>,
    /// Σσ² and ΣΦ² of the finished columns, W².
    finished: [f64; 2],
    /// When the next look is due.
    next: Instant,
}

impl Tracing {
    /// Nothing yet, of `total` samples.
    pub(super) fn start(console: Console, scene: &str, total: u64) -> Self {
        let shown = Arc::new(AtomicU64::new(f64::NAN.to_bits()));
        let own = Arc::clone(&shown);
        let rate = move |state: &ProgressState, w: &mut dyn Write| {
            let _ = w.write_str(&per_second(state.per_sec()));
            let _ = match f64::from_bits(own.load(Ordering::Relaxed)) {
                error if error.is_finite() => {
                    write!(w, ", standard error {}", share(error))
                }
                _ => Ok(()),
            };
        };
        Self {
            bar: bar(console, &format!("tracing {scene}"), total, rate),
            shown,
            finished: [0.0; 2],
            next: Instant::now(),
        }
    }

    /// Traces by `act` until Ctrl-C: it counts on the bar, and shows now and then what is there.
    pub(super) fn run<T>(
        &mut self,
        act: impl FnOnce(Control<'_>, &mut (dyn FnMut(&Tally) + Send)) -> T,
    ) -> T {
        let bar = self.bar.clone();
        act(counting(&|paths| bar.inc(paths)), &mut |tally| {
            self.look(tally);
        })
    }

    /// Leaves out samples of an earlier process: they say nothing of how fast this one is.
    pub(super) fn skip(&self, samples: u64) {
        self.bar.dec_length(samples);
    }

    /// A remark on a line of its own.
    pub(super) fn say(&self, console: Console, text: impl AsRef<str>) {
        self.bar.suspend(|| console.say(text));
    }

    /// Takes in a column as it is kept: flux by the number of surfaces met, then the standard error
    /// of their sum and its code.
    pub(super) fn finished(&mut self, kept: &Matrix) {
        if self.bar.is_hidden() {
            return;
        }
        let orders = kept.ncols() - 2;
        for row in kept.row_iter() {
            let flux = row.columns(0, orders).sum();
            self.finished[0] += row[orders] * row[orders];
            self.finished[1] += flux * flux;
        }
        let [noise, flux] = self.finished;
        if flux > 0.0 {
            self.show((noise / flux).sqrt());
        }
    }

    /// Looks at the blocks of the columns that are at work, if there are no finished columns and it
    /// is time.
    fn look(&mut self, tally: &Tally) {
        let start = Instant::now();
        if self.bar.is_hidden() || self.finished[1] > 0.0 || start < self.next {
            return;
        }
        if let Some(error) = tally.relative_error() {
            self.show(error);
        }
        let end = Instant::now();
        self.next = end + (SHARE * (end - start)).max(LOOK);
    }

    fn show(&self, error: f64) {
        self.shown.store(error.to_bits(), Ordering::Relaxed);
    }

    /// All is traced, or as much as there will be.
    pub(super) fn end(self) {
        self.bar.finish_and_clear();
    }
}

/// A small share with two digits.
fn share(error: f64) -> String {
    if error < 9.95e-5 {
        format!("{error:.1e}")
    } else {
        format!("{} %", significant(100.0 * error, 2))
    }
}

#[cfg(test)]
mod tests;
