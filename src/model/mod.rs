//! Floor 4: the matrix model. G12, G23 and Φcam from the geometry, by formula, without sampling
//! anything.
//!
//! > Φcam\[p,l\] = Φlaser · E_p · (ρ3/π) · (ρ1/π) · Σ_j G23\[p,j\] · (ρ2_j/π) · A_j · G12\[j,l\]
//!
//! with absolute scale: watts, and no free factor. Elements, pixels and spots are taken at their
//! centres ([`MatrixModel`]), or everything is integrated until it no longer changes
//! ([`converged`]). What stands in the way takes its share of each entry, by areas
//! ([`visible`](fn@visible), [`Factors`]), unless it is to be left out ([`Occlusion::Ignored`]).
//! Where a hidden surface shines, Φlaser·(ρ1/π)·G12\[j,l\] is its exitance M, ρ2 its picture x, and
//! G23 has its fall-off with direction as a factor.
//! Three surfaces and a Lambertian object: what light does beyond that is for `transport` to show,
//! which this floor never sees.

mod beam;
mod blocks;
mod cells;
mod converged;
mod cut;
mod differential;
mod divided;
mod effort;
mod error;
mod extent;
mod factors;
mod kernel;
mod matrix_model;
mod obstacles;
mod occlusion;
mod overhang;
mod parts;
mod patch;
mod place;
mod published;
mod series;
mod spot;
mod sweep;
mod swept;
mod tangent;
mod terms;
mod visible;
mod wall_point;

pub use converged::{Converged, Nodes, converged, integrated};
pub use differential::{Differential, Fineness};
pub use effort::Effort;
pub use error::ModelError;
pub use extent::{Extent, Occlusion, Take};
pub use factors::{ElementGrid, Factors};
pub use kernel::Kernel;
pub use matrix_model::{MatrixModel, element_grids, is_obstructed};
pub use published::{PixelGrid, Published, Stagger, flattened_k, table_distances};
pub use swept::Swept;
pub use terms::{Terms, TermsRate};
pub use visible::{Visible, shadows, visible};
