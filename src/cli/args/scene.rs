//! Arguments of `phicam scene`.

use std::path::PathBuf;

use clap::{Args as Arguments, Subcommand};

use super::PreviewArgs;

#[derive(Debug, Arguments)]
pub(in crate::cli) struct SceneArgs {
    #[command(subcommand)]
    pub command: SceneCommand,
}

#[derive(Debug, Subcommand)]
pub(in crate::cli) enum SceneCommand {
    /// List the built-in scenes
    List {
        /// Print their names and summaries as JSON
        #[arg(long)]
        json: bool,
    },
    /// Say what is wrong (exit 2) or suspicious in a scene
    Check {
        /// Built-in scene or path of a scene file
        scene: String,
        /// Print what is in the scene, and what is suspicious or wrong, as JSON
        #[arg(long)]
        json: bool,
    },
    /// Draw the bench from the side and from above, as SVG
    Show {
        /// Built-in scene or path of a scene file
        scene: String,
        /// File to write; standard output unless given
        #[arg(long, short)]
        output: Option<PathBuf>,
        /// Replace the file if it is there
        #[arg(long)]
        force: bool,
    },
    /// Look at a scene from any place, in ordinary light, as PNG
    View(Box<PreviewArgs>),
    /// Write the text of a scene, as a start for one's own
    Export {
        /// Built-in scene or path of a scene file
        scene: String,
        /// A Python program instead, that renders the same Φcam with Mitsuba 3
        #[arg(long)]
        mitsuba: bool,
        /// File to write; standard output unless given
        #[arg(long, short)]
        output: Option<PathBuf>,
        /// Replace the file if it is there
        #[arg(long)]
        force: bool,
    },
}
