//! Floor 4: photographs of a real camera, as Φcam.
//!
//! A file stores s = R(light) of a pixel. For each spot, repeated photographs are averaged; then
//!
//! > y = (R⁻¹(s) − d)/(F·t·g)
//!
//! with the response R ([`Response`]), the dark frames' mean light d of the same exposure time t,
//! the flat field F, 1 on the axis or on average, and the gain g of the photograph
//! ([`Correction`]). The pixels of the scene's camera gather what falls into their footprints, with
//! the ratio of the two cameras' étendues ([`Footprints`]); where the wall is in the photograph is
//! known from marked points ([`Mapping`]) or a crop.
//!
//! Noise is given, or found from repeats by the photon transfer line ([`noise`]); errors of dark
//! frames and flat field are added to each entry, where those of all spots of a pixel are in truth
//! one. The error of a gain is added as a part of the flux. Where nothing is known of the noise
//! there is no standard error. The error of the mapping is no part of it: n marks that are off by σ
//! along each axis leave the photograph off by 2σ/√n px on average (eight numbers from 2n), at all
//! spots alike.
//!
//! Entries that mean nothing are left out, with codes that add up ([`left_out`]): their flux and
//! standard error are 0.

mod account;
mod columns;
mod correct;
mod dead;
mod error;
mod flicker;
mod footprints;
mod highest;
mod import;
mod kind;
pub mod left_out;
mod lens;
mod list;
mod mapping;
mod misplaced;
pub mod noise;
mod pattern;
mod placing;
mod plane;
mod read;
mod response;
pub mod set;
mod shots;
mod takes;
mod warnings;

pub use account::{ImportAccount, Imported};
pub use correct::{Corrected, Correction, Flat};
pub use error::PhotographError;
pub use footprints::{Evenness, Footprints};
pub use import::{import, scene_of};
pub use lens::Lens;
pub use mapping::{Fitted, Mapping, Mark};
pub use plane::{Averaged, Chosen, Plane, linearised};
pub use read::SourceFile;
pub use response::{Response, ResponseTable};
pub use set::Set;
