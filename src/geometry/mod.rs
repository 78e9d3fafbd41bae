//! Floor 1: geometry. Directions, shapes and meshes with their own f64 arithmetic, and the one door
//! to the BVH.
//!
//! Lengths are in the unit of the scene. A [`Shape`] knows everything that is asked of a surface
//! without naming its kind: bounds, intersection, parametrisation, area element. Nothing above this
//! floor may assume rectangles.

mod basis;
mod bvh;
mod corner;
mod disc;
mod flat;
mod instance;
mod mesh;
mod moving;
mod opaque;
mod parallelogram;
mod pieces;
mod plane;
mod ray;
mod shadow;
mod shaft;
mod shape;
mod sphere;
mod tree;

pub use basis::Basis;
pub use bvh::{Bvh, GeometryError, Hit};
pub use corner::{Corner, Polygon, area_and_middle};
pub use disc::Disc;
pub use glam::{DAffine3, DMat3, DQuat, DVec3};
pub use instance::{Instance, Side};
pub(crate) use mesh::is_proper;
pub use mesh::{Facet, Facets, Mesh, MeshError, Patch};
pub use moving::{AT_ONCE, Moving, PlaneRate};
pub use opaque::{Hidden, Opaque};
pub use parallelogram::Parallelogram;
pub use pieces::Pieces;
pub use ray::{Interaction, Intersection, Ray};
pub use shadow::Shadow;
pub use shaft::{Blockers, Region};
pub use shape::{Shape, ShapeId};
pub use sphere::{Facing, Sphere};
