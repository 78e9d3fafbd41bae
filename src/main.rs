//! The `phicam` command: parse, run, exit code.

use std::process::ExitCode;

fn main() -> ExitCode {
    phicam::cli::main()
}
