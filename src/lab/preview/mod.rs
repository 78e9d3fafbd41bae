//! A picture of a scene in ordinary light, for people. It is no measurement: its light has nothing
//! to do with the laser, and no other result depends on it.
//!
//! Rays through the pixels find the first surface; points, normals, albedos and BRDFs are those of
//! the scene. The light is an even sky, brighter above than below, one soft lamp over the viewer's
//! left shoulder, and a weak one at the viewer's eye that throws no shadow:
//!
//! > L = ∫ f_r L_sky V cosθ dω + f_r E_key V cosθ_key + f_r E_eye cosθ_eye
//!
//! with V = 0 in shadow; a sample takes one direction of each. A white Lambertian surface in full
//! light has a value of about 1.
//!
//! Backs of surfaces are black to the tracer. Here they are hatched in the colour of their role, so
//! that one sees which way a surface faces. *Outer walls* are seen through from behind: a relay or
//! occluder that is flat and has nothing of the scene behind its plane, or a sphere that reflects
//! inside, throws no shadow, and its back is clear glass wherever something else stands behind it.

mod auto;
mod light;
mod model;
mod overlay;
mod picture;
#[cfg(test)]
mod tests;
mod viewpoint;

pub use auto::{ViewOptions, auto_viewpoint};
pub use light::Colour;
pub use picture::{Preview, PreviewPlan, preview};
pub use viewpoint::{PreviewError, Viewpoint};
