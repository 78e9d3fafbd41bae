//! Rules that choose a regularisation parameter from the data and what is known of their noise.

pub(super) mod discrepancy;
