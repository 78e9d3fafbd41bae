//! `phicam stack`: Φcam from the frames alone.

use super::Outcome;
use super::args::StackArgs;
use super::failure::Failure;
use super::folder::{PHI, STDERR};
use super::output::{self, Talk};
use crate::film;
use crate::matrix::npy;
use crate::store::ensure_writable;

pub(super) fn execute(args: &StackArgs, _: Talk) -> Result<Outcome, Failure> {
    let stack = film::stack(&args.dir)?;
    let dir = args.output.as_ref().unwrap_or(&args.dir);
    ensure_writable(dir)?;
    npy::write(&dir.join(STDERR), &stack.stderr)?;
    npy::write(&dir.join(PHI), &stack.phi)?;
    let (pixels, spots) = stack.phi.shape();
    let text = format!(
        "{}: {pixels} pixels × {spots} spots of scene `{}` (f32 precision of the frames)\n",
        dir.join(PHI).display(),
        stack.run.scene_name
    );
    output::print(&text)?;
    Ok(Outcome::Done)
}
