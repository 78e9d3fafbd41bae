//! Arguments of `phicam new`, `phicam completions` and `phicam man`.

use std::path::PathBuf;

use clap::Args as Arguments;
use clap_complete::Shell;

#[derive(Debug, Arguments)]
#[command(
    after_help = "`phicam help scene` explains the keys, `phicam scene check NAME.toml` says what is wrong or suspicious, \
                  `phicam run NAME.toml -o NAME` does the main job."
)]
pub(in crate::cli) struct NewArgs {
    /// Name of the scene; the file is NAME.toml
    pub name: PathBuf,
    /// Start from this built-in scene in place of the commented one
    #[arg(long, value_name = "SCENE")]
    pub from: Option<String>,
    /// Replace the file if it is there
    #[arg(long)]
    pub force: bool,
}

#[derive(Debug, Arguments)]
#[command(
    after_help = "bash: `phicam completions bash > ~/.local/share/bash-completion/completions/phicam`\n\
                  zsh: `phicam completions zsh > DIR/_phicam`, DIR a folder of $fpath\n\
                  fish: `phicam completions fish > ~/.config/fish/completions/phicam.fish`"
)]
pub(in crate::cli) struct CompletionsArgs {
    /// The shell that is to complete commands, options and values
    pub shell: Shell,
}

#[derive(Debug, Arguments)]
pub(in crate::cli) struct ManArgs {
    /// Folder for a page of every command; the main page goes to standard output unless given
    pub dir: Option<PathBuf>,
    /// Replace pages that are there
    #[arg(long, requires = "dir")]
    pub force: bool,
}
