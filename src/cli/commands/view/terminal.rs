//! What the terminal can show, by its environment.

use std::env;
use std::io::{IsTerminal, stdout};

use terminal_size::terminal_size_of;

use crate::cli::args::Terminal;

/// Columns of a terminal that does not say how wide it is, and the most that a picture takes.
const COLUMNS: usize = 80;
const MOST: usize = 120;

/// The way that the environment names, or half-blocks.
pub(super) fn chosen() -> Terminal {
    suited(|key| env::var(key).ok()).unwrap_or(Terminal::Blocks)
}

/// The way for standard output; `None` if that is no terminal, or one without colours.
pub(super) fn detected() -> Option<Terminal> {
    stdout()
        .is_terminal()
        .then(|| suited(|key| env::var(key).ok()))?
}

/// The way that suits the environment. Half-blocks within tmux and screen, which pass on no
/// pictures.
fn suited(variable: impl Fn(&str) -> Option<String>) -> Option<Terminal> {
    let is = |key: &str| variable(key).is_some_and(|v| !v.is_empty());
    let term = variable("TERM").unwrap_or_default();
    let program = variable("TERM_PROGRAM").unwrap_or_default();
    if is("NO_COLOR") || term.is_empty() || term == "dumb" {
        return None;
    }
    let inside = is("TMUX") || term.starts_with("screen") || term.starts_with("tmux");
    let kitty = term.contains("kitty") || is("KITTY_WINDOW_ID") || program == "ghostty";
    let iterm = program == "iTerm.app" || program == "WezTerm";
    let colours = term.contains("color") || is("COLORTERM");
    match (inside, kitty, iterm) {
        (false, true, _) => Some(Terminal::Kitty),
        (false, _, true) => Some(Terminal::Iterm),
        _ => (colours || inside || kitty || iterm).then_some(Terminal::Blocks),
    }
}

/// How wide a picture may be, in cells: what COLUMNS says, or the terminal itself.
pub(super) fn columns() -> usize {
    let said = env::var("COLUMNS").ok().and_then(|c| c.parse().ok());
    let measured = || Some(usize::from(terminal_size_of(stdout())?.0.0));
    said.or_else(measured).unwrap_or(COLUMNS).clamp(20, MOST)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_environment_says_what_a_terminal_can() {
        let given = |pairs: &'static [(&str, &str)]| {
            suited(|key| pairs.iter().find(|p| p.0 == key).map(|p| p.1.to_owned()))
        };
        for (pairs, want) in [
            (&[("TERM", "xterm-kitty")][..], Some(Terminal::Kitty)),
            (
                &[("TERM", "xterm-256color"), ("KITTY_WINDOW_ID", "1")],
                Some(Terminal::Kitty),
            ),
            (
                &[("TERM", "xterm-256color"), ("TERM_PROGRAM", "iTerm.app")],
                Some(Terminal::Iterm),
            ),
            (
                &[("TERM", "xterm-256color"), ("TERM_PROGRAM", "WezTerm")],
                Some(Terminal::Iterm),
            ),
            (&[("TERM", "xterm-256color")], Some(Terminal::Blocks)),
            (
                &[("TERM", "alacritty"), ("COLORTERM", "truecolor")],
                Some(Terminal::Blocks),
            ),
            (
                &[("TERM", "screen"), ("KITTY_WINDOW_ID", "1"), ("TMUX", "x")],
                Some(Terminal::Blocks),
            ),
            (&[("TERM", "vt100")], None),
            (&[("TERM", "dumb"), ("COLORTERM", "truecolor")], None),
            (&[("TERM", "xterm-kitty"), ("NO_COLOR", "1")], None),
            (&[], None),
        ] {
            assert_eq!(given(pairs), want, "{pairs:?}");
        }
    }
}
