//! Whether photographs belong to the spots that they are said to belong to.

use rayon::prelude::*;
use serde::Serialize;

use super::frames::{Sides, TermsOf};
use super::likelihood::Fit;
use crate::lab::LabError;
use crate::matrix::Matrix;
use crate::num::stream::{Key, Sampling, Stream};
use crate::transport::Control;

/// A permutation test of the spots' order, at the stated place of the hidden surfaces and one
/// length of the prior, so that nothing was chosen by the stated order.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Order {
    /// Random orders tried.
    pub tried: u64,
    /// Those that explain the photographs as well as the stated one, or better.
    pub as_likely: u64,
    /// (1 + as likely)/(1 + tried): at least as improbable as stated if the order were by chance.
    pub p: f64,
    /// Misfit in the stated order.
    pub misfit: f64,
    /// Least misfit of all random ones.
    pub least_misfit: f64,
}

/// The test with `tried` orders of `seed`; none where there is no light.
pub(super) fn order(
    sides: &Sides<'_>,
    terms: TermsOf<'_>,
    root: &Matrix,
    [tried, seed]: [u64; 2],
    control: Control<'_>,
) -> Result<Option<Order>, LabError> {
    let fit = |spots: &[usize]| {
        let lit: Vec<(usize, usize)> = spots.iter().copied().enumerate().collect();
        Fit::new(&sides.lit(&lit, terms), root).map_err(LabError::from)
    };
    let stated: Vec<usize> = (0..sides.len()).collect();
    let Some(own) = fit(&stated)? else {
        return Ok(None);
    };
    let found: Vec<Option<Fit>> = (0..tried)
        .into_par_iter()
        .map(|k| {
            control.check()?;
            let found = fit(&shuffled(&stated, seed, k));
            (control.progress)(1);
            found
        })
        .collect::<Result<_, _>>()?;
    let others = || found.iter().flatten();
    let as_likely = others()
        .filter(|f| f.log_likelihood >= own.log_likelihood)
        .count() as u64;
    Ok(Some(Order {
        tried,
        as_likely,
        p: (1 + as_likely) as f64 / (1 + tried) as f64,
        misfit: own.misfit,
        least_misfit: others().map(|f| f.misfit).fold(f64::INFINITY, f64::min),
    }))
}

/// Order k of `seed`, all being equally likely (Fisher and Yates).
pub(super) fn shuffled(stated: &[usize], seed: u64, k: u64) -> Vec<usize> {
    let key = Key {
        seed,
        spot: Key::ALL_SPOTS,
        pixel: u32::MAX,
        block: k as u32,
    };
    let mut stream = Stream::new(Sampling::Pcg, key);
    let mut order = stated.to_vec();
    for i in (1..order.len()).rev() {
        // Below i + 1 for every uniform number below 1.
        order.swap(i, (stream.uniform() * (i + 1) as f64) as usize);
    }
    order
}
