//! Floor 7: the folder of a run: what a render or an import leaves, and what vouches for it.
//!
//! | file | content |
//! | --- | --- |
//! | scene.toml, run.json | the scene, whole; what was rendered and how ([`Record`]) |
//! | files/ | copies of the meshes, pictures and materials that the scene names |
//! | frames/spot-NNNN.exr | one frame a spot |
//! | phi.npy, phi.stderr.npy | Φcam and its standard error, pixels × spots, W |
//! | phi.tails.npy | how far that is to be trusted: [`tails`](crate::transport::tails), pixels × spots |
//! | left_out.npy, import.json, import.png | of imported photographs: what is left out and why, how they were made, where things are in them |
//!
//! [`write_run`] writes a whole run at once, [`read_run`] reads one back; the commands write the
//! same files spot by spot.

mod error;
mod frames;
mod item;
pub mod names;
mod origin;
mod record;
mod whole;

pub use error::FolderError;
pub use frames::{columns, frame, frame_max, refuse_beyond_f32};
pub use item::ItemRecord;
pub use origin::{Origin, Photographs};
pub use record::{Record, Written};
pub use whole::{Run, finish, read_run, write_copies, write_run, write_scene};
