//! Every study that can be asked for by name.

use super::registered::Registered;

/// The studies, in the order in which they are listed.
pub static STUDIES: &[&Registered] = &[
    &super::budget::STUDY,
    &super::power::STUDY,
    &super::tolerance::STUDY,
    &super::convergence::STUDY,
    &super::noise::STUDY,
    &super::indicator::STUDY,
    &super::brdf::STUDY,
    &super::coverage::STUDY,
    &super::experiment::STUDY,
    &super::spots::STUDY,
    &super::occluder::STUDY,
    &super::layout::STUDY,
    &super::sweep::STUDY,
];
