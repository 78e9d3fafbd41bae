//! The recoveries of one noise.

use super::plan::works_by_directions;
use crate::lab::problem::problem;
use crate::lab::recovered::chosen::{chosen_words, words};
use crate::matrix::Matrix;
use crate::model::MatrixModel;
use crate::recovery::{
    LaserSide, Method, Options, Parameter, Parts, RecoveryError, Uncertainty, recover,
};

/// What is done in one go, and the noise that it is done for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum RecoveryTask {
    /// All methods that work by the directions of the laser side, with all their parameters.
    Directions(usize),
    /// One method that works on all pixels and spots at once.
    Whole(usize, Method),
}

impl RecoveryTask {
    /// Whether it recovers by `method`.
    pub(super) fn of(self, method: Method) -> bool {
        match self {
            Self::Directions(_) => works_by_directions(method),
            Self::Whole(_, own) => own == method,
        }
    }
}

/// A parameter and why it is this one, in words; or why there is none.
pub(super) type Chosen = Result<(Parameter, String), String>;

/// What came of a task.
pub(super) enum Outcome<'s> {
    /// What the directions add, and what each method takes of itself.
    Directions(Parts<'s>, Vec<(Method, Chosen)>),
    /// Reflectance of all elements, and how it came about.
    Whole(Vec<f64>, String),
    /// Why there is nothing.
    Nothing(String),
}

impl<'s> Outcome<'s> {
    /// By the directions of a laser side that is decomposed already.
    pub(super) fn by_directions(
        side: &'s Result<LaserSide, RecoveryError>,
        model: &MatrixModel,
        [phi, stderr]: &[Matrix; 2],
        methods: &[Method],
    ) -> Self {
        let found = |side: &'s LaserSide| {
            let problem = problem(model, phi, Some(stderr))?;
            let choose = |method: &Method| {
                let chosen = side.automatic(*method, &problem).map_err(|e| e.to_string());
                let said = chosen.map(|(parameter, choice)| {
                    (
                        parameter,
                        chosen_words(parameter, side.sigma().len(), choice),
                    )
                });
                (*method, said)
            };
            let own = methods.iter().filter(|m| works_by_directions(**m));
            Ok(Self::Directions(
                side.parts(&problem)?,
                own.map(choose).collect(),
            ))
        };
        let found = side.as_ref().map_err(Clone::clone).and_then(found);
        found.unwrap_or_else(|e: RecoveryError| Self::Nothing(e.to_string()))
    }

    /// By a method that works on everything at once.
    pub(super) fn whole(method: Method, model: &MatrixModel, [phi, stderr]: &[Matrix; 2]) -> Self {
        // The reflectances alone are shown.
        let options = Options {
            uncertainty: Uncertainty::StandardError,
            ..Options::default()
        };
        match problem(model, phi, Some(stderr)).and_then(|p| recover(method, &p, &options)) {
            Ok(found) => Self::Whole(found.reflectance.as_slice().to_vec(), words(&found, true)),
            Err(e) => Self::Nothing(e.to_string()),
        }
    }

    /// What `method` takes of itself.
    pub(super) fn automatic(&self, method: Method) -> Chosen {
        match self {
            Self::Directions(_, chosen) => {
                let own = chosen.iter().find(|(of, _)| *of == method);
                own.map_or_else(|| Err(String::new()), |(_, chosen)| chosen.clone())
            }
            Self::Whole(_, words) => Ok((Parameter::None, words.clone())),
            Self::Nothing(why) => Err(why.clone()),
        }
    }

    /// What is recovered with a parameter.
    pub(super) fn reflectance(&self, parameter: Parameter) -> Option<Vec<f64>> {
        match self {
            Self::Directions(parts, _) => {
                parts.reflectance(parameter).map(|x| x.as_slice().to_vec())
            }
            Self::Whole(found, _) => Some(found.clone()),
            Self::Nothing(_) => None,
        }
    }
}

/// The laser side of photographs, decomposed.
pub(super) fn laser_side(
    model: &MatrixModel,
    phi: &Matrix,
    stderr: &Matrix,
) -> Result<LaserSide, RecoveryError> {
    LaserSide::new(&problem(model, phi, Some(stderr))?)
}
