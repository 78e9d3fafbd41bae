//! Does the matrix model hold on a wall that is not Lambertian, and what is lost where the wall's
//! BRDF is not known?
//!
//! A wall of BRDF f enters the model entry by entry: BRDF12 = f(laser → spot → element) multiplies
//! G12 and BRDF23cam = f(element → wall point → camera) multiplies G23. The light is traced once;
//! then each assumption about the wall makes a model of its own, which is tested against that light
//! and used to recover the hidden surface from it. Beside them stands the same bench with a
//! Lambertian wall of equal white-sky albedo, traced and modelled as what it is: how well the
//! method does where no BRDF is in question.
//!
//! Only light that meets three surfaces is traced, as in the model. A hidden surface that is not
//! Lambertian is traced as it is and modelled as [`crate::scene::Surface::lambertian_equivalent`]:
//! what that changes is a part of [`crate::lab::BudgetTasks`].

mod assumption;
mod describe;
mod quality;
mod results;
mod tasks;

pub use results::{Assumption, BrdfPlan, BrdfStudy, Quality, Ratio};
pub use tasks::BrdfTasks;
pub(in crate::lab) use tasks::STUDY;
