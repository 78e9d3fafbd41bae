//! One file a subcommand: arguments to checked settings, the work by the floors below, what is
//! written and said. Beside them is what several share.

mod batches;
pub(super) mod beside;
pub(super) mod calibrate;
pub(super) mod completions;
pub(super) mod expose;
pub(super) mod import;
pub(super) mod locate;
pub(super) mod man;
pub(super) mod many;
pub(super) mod mask;
pub(super) mod model;
pub(super) mod new;
pub(super) mod notices;
mod preview;
pub(super) mod recover;
pub(super) mod recover_memory;
pub(super) mod recover_options;
mod recover_own;
pub(super) mod recovered;
pub(super) mod render;
pub(super) mod reproduce;
pub(super) mod run;
pub(super) mod scene;
mod spelled;
pub(super) mod stack;
pub(super) mod study;
pub(super) mod target;
pub(super) mod tasks;
mod unexplained;
pub(super) mod validate;
pub(super) mod view;
