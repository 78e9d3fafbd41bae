//! Which boxes does a ray meet? The one door to obvhs.
//!
//! The trees work in f32 on boxes only and decide nothing by themselves: every intersection is
//! computed in f64 on the shape. For that the boxes must hold whatever f32 does to the ray, and
//! obvhs drops boxes that end nearer than 1e-4 along a unit direction. So a tree lives in a space
//! in which the scene measures 1000, and every box is wider than its shape by 4e-3 there: 64 times
//! the f32 spacing at 1000, and forty times obvhs' limit.

mod collapse;
mod compressed;
mod space;
mod wide;

pub(super) use compressed::CompressedTree;
pub(super) use wide::{Query, WideTree};
