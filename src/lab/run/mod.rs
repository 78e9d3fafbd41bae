//! What is told of one run: its light, its verdict, its answer.

pub(super) mod aim;
pub(super) mod answer;
pub(super) mod exposure;
pub(super) mod pilot;
pub(super) mod results;
pub(super) mod summary;
mod verdict;
