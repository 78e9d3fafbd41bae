//! What of the geometry is free.

use crate::lab::error::LabError;
use crate::scene::{Parameter, Scene};

/// The least that a parameter may be known to: its square has to be a number.
const LEAST: f64 = 1e-12;

/// A parameter that is free, and how well it is known beforehand.
#[derive(Clone, Debug, PartialEq)]
pub struct Free {
    /// Name of one or several parameters.
    pub name: String,
    /// Standard deviation of each, in its unit; none where nothing is known.
    pub sigma: Option<f64>,
}

/// The parameters of a scene that are free, and how well each is known.
///
/// # Errors
/// [`LabError`] where none is free, one is not there, or one is known differently well twice.
pub(super) fn parameters(
    scene: &Scene,
    all: &[Free],
) -> Result<(Vec<Parameter>, Vec<Option<f64>>), LabError> {
    let (mut parameters, mut priors): (Vec<Parameter>, Vec<Option<f64>>) = Default::default();
    for free in all {
        if free
            .sigma
            .is_some_and(|s| !(LEAST..=1.0 / LEAST).contains(&s))
        {
            return Err(LabError::Untold(format!(
                "{} is known to {:e}: give a standard deviation from {LEAST:e} to {:e}, or none",
                free.name,
                free.sigma.unwrap_or_default(),
                1.0 / LEAST
            )));
        }
        for own in Parameter::named(scene, &free.name)? {
            match parameters.iter().position(|p| p.name == own.name) {
                None => {
                    parameters.push(own);
                    priors.push(free.sigma);
                }
                Some(k) if priors[k] != free.sigma => {
                    return Err(LabError::Untold(format!(
                        "{} is free twice, known differently well: name it once",
                        own.name
                    )));
                }
                Some(_) => {}
            }
        }
    }
    if parameters.is_empty() {
        return Err(LabError::Unsuited(
            "nothing is free; name parameters with --free, or give the scene a table [uncertainty]",
        ));
    }
    Ok((parameters, priors))
}
