//! The pictures that studies of a bench recover: past an occluder, from another layout of spots.

use std::str::FromStr;

use serde::{Deserialize, Serialize};

use crate::lab::ensemble::Photographs;
use crate::lab::error::LabError;
use crate::lab::problem::problem;
use crate::lab::recovered::fit::Residuals;
use crate::lab::uncertainty::certainty::Certainty;
use crate::metrics::{correlation, mtf_raw};
use crate::model::MatrixModel;
use crate::recovery::{Method, Options, RecoveryError, recover};
use crate::scene::target::Target;
use crate::scene::{Cells, Scene};
use crate::transport::Control;

/// Likeness (MTF of a board, correlation of another picture) at which a picture is resolved.
pub(super) const RESOLVED: f64 = 0.9;

/// A picture on the hidden surfaces.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum Subject {
    /// A checkerboard of so many checks a side, of albedo 0 and 1.
    Board(usize),
    /// A light F of 5 × 5 strokes on a dark ground of 7 × 7.
    Letter,
    /// The playing card.
    Card,
}

/// Pictures besides boards, by their names on the command line.
pub(super) const PICTURES: &[(&str, &str)] = &[
    ("letter", "An F on 14 × 14 elements"),
    ("card", "The playing card on 47 × 31 elements"),
];

/// From the top.
const LETTER: [&str; 7] = [
    ".......", ".#####.", ".#.....", ".####..", ".#.....", ".#.....", ".......",
];

impl FromStr for Subject {
    type Err = &'static str;

    fn from_str(name: &str) -> Result<Self, Self::Err> {
        match name {
            "letter" => Ok(Self::Letter),
            "card" => Ok(Self::Card),
            _ => Err("there is no such picture; use letter or card"),
        }
    }
}

impl Subject {
    /// Its name in tables.
    pub(super) fn name(self) -> String {
        match self {
            Self::Board(n) => format!("{n} × {n}"),
            Self::Letter => "letter".to_owned(),
            Self::Card => "card".to_owned(),
        }
    }

    /// Its name in columns of files.
    pub(super) fn column(self) -> String {
        match self {
            Self::Board(n) => n.to_string(),
            _ => self.name(),
        }
    }

    /// How the likeness is measured.
    pub(super) fn measure(self) -> &'static str {
        match self {
            Self::Board(_) => "MTF",
            _ => "correlation",
        }
    }

    /// The scene with it.
    pub(super) fn in_scene(self, scene: &Scene) -> Scene {
        let (columns, values): (usize, Vec<f64>) = match self {
            Self::Board(n) => return scene.with_checkerboard(n),
            Self::Letter => {
                let cells = LETTER.iter().flat_map(|row| row.bytes());
                let light = |c: u8| f64::from(u8::from(c == b'#'));
                (LETTER.len(), cells.map(light).collect())
            }
            Self::Card => {
                let [nu, nv] = self.elements([0; 2]);
                let drawn = Target::Card.picture([8 * nu, 8 * nv]);
                (8 * nu, drawn.map_or_else(Vec::new, |p| p.values))
            }
        };
        scene.with_cells(&from_the_top(columns, &values))
    }

    /// Elements along u and v for it, at least `own`: of a board the least that its checks divide.
    pub(super) fn elements(self, own: [usize; 2]) -> [usize; 2] {
        match self {
            Self::Board(n) => own.map(|m| m.next_multiple_of(n)),
            Self::Letter => [14; 2],
            Self::Card => [47, 31],
        }
    }

    /// Its albedo on the elements of the model.
    pub(super) fn albedo(self, scene: &Scene, model: &MatrixModel) -> Vec<f64> {
        let scene = self.in_scene(scene);
        let each = scene.hidden().zip(&model.grids);
        each.flat_map(|((_, surface), grid)| surface.divided(grid.count))
            .map(|element| element.albedo)
            .collect()
    }

    /// How like the truth what was recovered is: 1 is the same.
    pub(super) fn likeness(self, recovered: &[f64], truth: &[f64]) -> Option<f64> {
        match self {
            Self::Board(_) => mtf_raw(recovered, truth),
            _ => correlation(recovered, truth),
        }
    }
}

/// What was recovered of a picture.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Recovery {
    /// How like the truth it is.
    pub likeness: Option<f64>,
    /// Probability of as bad a fit by noise alone.
    pub p: Option<f64>,
}

impl Recovery {
    pub(super) fn is_resolved(&self) -> bool {
        self.likeness.is_some_and(|x| x >= RESOLVED)
    }
}

/// What `joint` recovers from photographs: nothing where these, or those of the model, are dark.
pub(super) fn recovered(
    model: &MatrixModel,
    subject: Subject,
    truth: &[f64],
    Photographs { phi, stderr, .. }: &Photographs,
    control: Control<'_>,
) -> Result<Recovery, LabError> {
    let problem = problem(model, phi, Some(stderr))?.under(control);
    let found = match recover(Method::Joint, &problem, &Options::default()) {
        Err(RecoveryError::Dark | RecoveryError::RankZero { .. }) => {
            return Ok(Recovery {
                likeness: None,
                p: None,
            });
        }
        found => found?,
    };
    // A recovery that is stopped ends with the best so far, which is no answer here.
    control.check()?;
    let mut residuals = Residuals::default();
    residuals.add(phi, &found.photographs(&problem), stderr, Certainty::STATED);
    let fit = residuals.fit(found.freedom_used(), Certainty::STATED);
    Ok(Recovery {
        likeness: subject.likeness(found.reflectance.as_slice(), truth),
        p: fit.map(|f| f.p),
    })
}

/// Cells from rows of `columns` values, the first row at the top (v = 1).
fn from_the_top(columns: usize, values: &[f64]) -> Cells {
    let rows = values.chunks(columns);
    Cells {
        count: [columns, rows.len()],
        albedo: rows.rev().flatten().copied().collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A board is on elements that its checks divide, no fewer than there are.
    #[test]
    fn checks_divide_their_elements() {
        let cases = [
            (2, [5, 3], [6, 4]),
            (4, [8, 8], [8, 8]),
            (16, [8, 4], [16, 16]),
        ];
        for (checks, own, want) in cases {
            assert_eq!(Subject::Board(checks).elements(own), want);
        }
    }

    /// The F as it is read: bright upper left, dark lower right, no symmetry; the card has a white
    /// rim's share of its area. Means over elements keep the area's mean.
    #[test]
    fn pictures_stand_upright() {
        let scene = Scene::load("thesis").unwrap();
        let letter = Subject::Letter.in_scene(&scene);
        let albedo = |scene: &Scene, uv| scene.hidden().next().unwrap().1.albedo.albedo(uv);
        assert_eq!(albedo(&letter, [0.5, 0.8]), 1.0);
        assert_eq!(albedo(&letter, [0.8, 0.2]), 0.0);
        assert_eq!(albedo(&letter, [0.2, 0.2]), 1.0);
        let card = Subject::Card.in_scene(&scene);
        let elements = |n: [usize; 2]| {
            let all = card.hidden().next().unwrap().1.divided(n);
            all.iter().map(|e| e.albedo).sum::<f64>() / all.len() as f64
        };
        let whole = elements([1, 1]);
        assert!(
            whole > 0.5 && (elements([47, 31]) - whole).abs() < 1e-9,
            "{whole}"
        );
        assert!("joker".parse::<Subject>().is_err());
    }
}
