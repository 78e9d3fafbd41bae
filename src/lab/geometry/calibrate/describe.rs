//! What is said of a calibration.

mod beyond;
mod directions;
mod named;
mod picture;
mod searched;
mod tables;

use super::{Calibrated, Calibration};
use crate::lab::finding::{Column, Describe, Finding, Place, Table, Tone, listed};
use crate::lab::uncertainty::certainty::{
    FOLLOWS_ENTRIES, fits_better, hang_together, neighbours_share, times_too_small,
};
use crate::lab::uncertainty::which_errors::which_errors;
use crate::num::digits::{figure, perhaps};
use crate::recovery::ErrorField;
use crate::scene::Parameter;
pub(super) use directions::untold;
use named::few;

/// Below this probability of so bad a fit the model lacks something.
const SIGNIFICANCE: f64 = super::LEVEL;
/// Errors by other pictures are told from so many times those by the likeliest.
const MORE: f64 = 1.5;
/// What a finer rule moves is told from this part of the error on.
const NOTABLE: f64 = 0.5;
/// Unknowns, or combinations of them, that are listed one by one.
const LISTED: usize = 12;
/// What is left of other light's remainder beyond the stated noise, above which nothing is
/// estimated.
const MUCH: f64 = 0.05;
/// The brightest entries are left over if they lie below the model by so many times what is left of
/// all.
const BRIGHTEST: f64 = 2.0;

fn with_unit(x: f64, digits: usize, unit: &str) -> String {
    format!("{} {unit}", figure(x, digits))
        .trim_end()
        .to_owned()
}

impl Calibration {
    /// Whether the search ended and nowhere else as well, no other size of the surface is much
    /// likelier and elsewhere, the photographs do not refute what it found, and a surface can have
    /// its picture.
    pub fn is_found(&self) -> bool {
        let is_alone = self.is_settled && self.elsewhere.is_empty() && self.moved().is_none();
        is_alone && !self.is_refuted() && self.impossible().is_none()
    }

    /// Whether the photographs do not fit what was found, and it is not for the integration.
    fn is_refuted(&self) -> bool {
        self.p.is_some_and(|p| p < SIGNIFICANCE) && !self.is_coarse()
    }

    /// Whether a misfit may be that of the integration: a finer rule fits, or it moves what was
    /// found by more than noise does and explains half of what is left over.
    fn is_coarse(&self) -> bool {
        let moves = |f: &Calibrated| f.by_rule.is_some_and(|moved| moved > f.by_curvature);
        let fits = self.finer_p.is_some_and(|p| p >= SIGNIFICANCE);
        let explains = |finer: f64| finer - 1.0 < 0.5 * (self.misfit - 1.0);
        let explains = self.p.is_none() || self.finer_misfit.is_some_and(explains);
        let may = fits || explains && self.geometry().any(moves);
        self.is_more_than_noise() && self.is_integrated && may
    }

    /// Whether more than noise may be left.
    fn is_more_than_noise(&self) -> bool {
        self.p.is_none_or(|p| p < SIGNIFICANCE)
    }

    /// Geometric parameters.
    fn geometry(&self) -> impl Iterator<Item = &Calibrated> {
        self.found.iter().filter(|f| !f.unit.is_empty())
    }

    /// Gains of frames.
    fn gains(&self) -> impl Iterator<Item = &Calibrated> {
        self.found.iter().filter(|f| f.unit.is_empty())
    }

    /// What neither model nor stated noise explains, of what other light leaves.
    fn unexplained(&self) -> f64 {
        let by_noise = if self.p.is_some() {
            self.misfit.recip()
        } else {
            0.0
        };
        self.left * (1.0 - by_noise).max(0.0).sqrt()
    }

    fn sentence(&self) -> String {
        let of = |f: &Calibrated| {
            let (value, error) = (figure(f.value, 3), with_unit(f.stderr, 2, &f.unit));
            format!("{} {value} ± {error}", f.name)
        };
        let ended = match self.impossible() {
            _ if !self.is_settled => " The search did not end: do not use it.",
            Some(_) => " No surface can have the picture that goes with it: do not use it.",
            None => "",
        };
        let found = format!(
            "rom what the scene says: {}.{ended}{}{}",
            self.first(of),
            self.or_elsewhere(),
            self.or_as_large()
        );
        match self.p.filter(|_| self.is_refuted()) {
            // Without a stated noise a misfit of the model is not told from it.
            None if self.field.is_some() => format!(
                "If what is left over is noise and errors that neighbouring pixels share, f{found}"
            ),
            None if self.p.is_none() => format!("If what is left over is noise, f{found}"),
            None => format!("F{found}"),
            Some(p) => {
                let much = if self.unexplained() > MUCH {
                    format!(
                        ", {} of what other light leaves is explained by nothing: these are no estimates",
                        figure(self.unexplained(), 2)
                    )
                } else {
                    String::new()
                };
                format!(
                    "The photographs fit NO geometry that is free to be: χ²/dof {} (p = {}){much}. \
                     Closest, f{found}",
                    figure(self.misfit, 3),
                    figure(p, 1)
                )
            }
        }
    }

    /// What is left over, taken for errors that neighbours share.
    fn shared(&self, field: &ErrorField) -> String {
        let which = which_errors(self.log_likelier.unwrap_or(0.0));
        format!(
            "No noise is stated. What is left over, {} of what other light leaves, is taken for \
             errors of {} of each pixel alone and {} that neighbours share over {} pixels (the \
             photographs' unit); {which}. The errors of the geometry allow for that field, and for \
             nothing that the model lacks in another way.",
            figure(self.left, 3),
            figure(field.pixel, 2),
            figure(field.shared, 2),
            figure(field.range, 2)
        )
    }

    /// Whether noise alone explains what is left.
    fn fit(&self) -> String {
        if let Some(field) = &self.field {
            return self.shared(field);
        }
        match self.p {
            Some(p) if p >= SIGNIFICANCE => format!(
                "With it the photographs fit: χ²/dof {} (p = {}).{}",
                figure(self.misfit, 3),
                figure(p, 2),
                if self.dof > 1.0 && fits_better(self.misfit, p) {
                    " That is CLOSER than the standard errors allow: they are too large, or entries \
                     share them, and the errors of the geometry are not those of the noise."
                } else if self.asks_for_elements()
                    || self.shared.is_some()
                    || self.neighbours.is_some()
                    || !self.held.is_empty()
                    || self.is_beyond()
                    || !self.by_pictures().is_empty()
                {
                    ""
                } else {
                    " The errors are those of the noise, if all that is not free is as the scene says."
                }
            ),
            Some(_) if self.is_coarse() => format!(
                "Light is not integrated as finely as these photographs ask for, so that whether they \
                 fit is not told: χ²/dof is {}, and {} by a finer rule. What that moves is counted in \
                 the errors, and so is what single frames and blocks of pixels say.",
                figure(self.misfit, 3),
                perhaps(self.finer_misfit, 3)
            ),
            Some(_) => format!(
                "The model lacks something, or something is wrong that is not free: {}. Errors are the \
                 largest of three: by the noise, by what single frames and by what blocks of pixels \
                 say; none of them sees what is wrong in all alike.",
                self.wrong()
            ),
            None => {
                let much = if self.unexplained() > MUCH {
                    " That is much: the model lacks something."
                } else {
                    ""
                };
                format!(
                    "No noise is stated: whether noise alone is left cannot be told. What is not \
                     explained is {} of what other light leaves.{much} Errors are the largest of \
                     three: by that remainder as if it were noise, by what single frames and by \
                     what blocks of pixels say; none of them sees what is wrong in all alike. \
                     `--error-field` takes it for errors that neighbours share, and says which is \
                     likelier.",
                    figure(self.left, 3)
                )
            }
        }
    }

    /// What may be wrong.
    fn wrong(&self) -> String {
        let rms = self.misfit.sqrt();
        match self.brightest.filter(|left| *left < -BRIGHTEST * rms) {
            Some(left) => format!(
                "values that are clipped or not linear, for the brightest percent of the entries lies \
                 below the model by {} times its noise on average, and all by {} (rms)",
                figure(-left, 2),
                figure(rms, 2)
            ),
            None if self.neighbours.is_none() && self.shared.is_none() => format!(
                "standard errors that are too small (what is left is {} times as large and hangs together no \
                 more than noise does), or the order of the spots, say",
                figure(rms, 2)
            ),
            None => "the order of the spots, say".to_owned(),
        }
    }

    /// That the stated noise is an estimate, where that matters.
    fn few_replicates(&self) -> Option<String> {
        let (few, times) = (self.replicates?, times_too_small(self.too_small?));
        Some(format!(
            "The stated noise is known as from {few} replicates, pooled over pixels and spots as far as \
             they say more, and the errors take it for known: they are {times}. Take more."
        ))
    }

    /// What a change of a weight is, which is not relative to it as other changes of materials are.
    fn weights(&self) -> Option<String> {
        let mut all = self.geometry();
        all.any(|f| f.unit == Parameter::POINTS).then(|| {
            "Weights of mixtures change by percentage points, not by parts of themselves: 2 make 0.32 of a weight \
             of 0.3. The other parts of the mixture make room in proportion, so that their sum stays."
                .to_owned()
        })
    }

    /// That errors which hang together do not average out.
    fn hang_together(&self) -> Option<String> {
        Some(hang_together(self.shared?, "the geometry"))
    }

    /// Parameters whose errors are those of other priors of the picture, by much.
    fn by_pictures(&self) -> Vec<String> {
        let more = |f: &&Calibrated| f.by_pictures > MORE * f.by_curvature;
        let told =
            |f: &Calibrated| format!("{} by {}", f.name, with_unit(f.by_pictures, 2, &f.unit));
        let over = |f: &Calibrated| f.by_pictures / f.by_curvature;
        few(self.geometry().filter(more), over, told)
    }

    fn notes(&self) -> Vec<String> {
        let mut notes = vec![self.fit()];
        notes.extend(self.weights());
        notes.extend(self.hang_together());
        let errors = "errors of the geometry are those by frames and blocks of pixels too, where they are larger";
        let neighbours = self.neighbours.filter(|_| !self.is_refuted());
        notes.extend(neighbours.map(|r| format!("Beware: {}.", neighbours_share(r, errors))));
        notes.extend(self.few_replicates());
        if self.follows_entries {
            notes.push(format!("Beware: {FOLLOWS_ENTRIES}."));
        }
        notes.extend(self.impossible());
        let resized = self.resized.as_ref().filter(|_| self.moved().is_none());
        notes.extend(resized.map(|other| format!("Beware: {}", self.as_large(other))));
        notes.push(self.elements());
        notes.extend([self.searched(), self.picture()]);
        let warnings = self.picture_warnings.iter();
        notes.extend(warnings.map(|warning| format!("Beware, of the picture: {warning}.")));
        notes.extend(self.at_edges());
        notes.extend(self.beyond());
        notes.extend(self.light_beyond());
        notes.extend(self.even_light());
        notes.extend(self.gains_beyond());
        let by_pictures = self.by_pictures();
        if !by_pictures.is_empty() {
            notes.push(format!(
                "What the picture is like these photographs do not tell well enough: by the likeliest \
                 prior of it alone the error would be that by curvature, and others that they do not \
                 exclude move {}. That is counted in the errors. Take more photographs, or fewer \
                 --elements.",
                listed(&by_pictures)
            ));
        }
        let moved = |f: &Calibrated| f.by_rule.unwrap_or(0.0) / f.stderr;
        let by_rule = few(self.geometry().filter(|f| moved(f) > NOTABLE), moved, |f| {
            let moved = f.by_rule.unwrap_or(0.0);
            format!("{} by {}", f.name, with_unit(moved, 2, &f.unit))
        });
        if !by_rule.is_empty() {
            let then = if self.is_integrated {
                "that is counted in its error"
            } else {
                "more elements, or --integration quadrature"
            };
            notes.push(format!(
                "A finer rule of integration would move {}: {then}.",
                listed(&by_rule)
            ));
        }
        notes.extend(self.held_by_what_was_known());
        notes
    }
}

impl Describe for Calibration {
    fn describe(&self) -> Finding {
        let stages = Table {
            caption: "The way through the noises".to_owned(),
            file: Some("stages.csv".to_owned()),
            place: Place::Page,
            ..Table::of(
                &self.stages,
                [
                    (
                        Column::number("noise", "noise", "", 3),
                        |s: &&super::Stage| s.noise.into(),
                    ),
                    (Column::text("steps", "steps"), |s| (s.steps as u64).into()),
                    (Column::number("χ²/dof", "misfit", "", 3), |s| {
                        s.misfit.into()
                    }),
                ],
            )
        };
        Finding {
            title: format!("The geometry, from the photographs: {}", self.scene),
            tone: match self.is_found() {
                true if self.is_coarse()
                    || self.asks_for_elements()
                    || self.shared.is_some()
                    || !self.held.is_empty()
                    || self.resized.is_some()
                    || self.is_beyond() =>
                {
                    Tone::Plain
                }
                true => Tone::Good,
                false => Tone::Bad,
            },
            sentence: self.sentence(),
            notes: self.notes(),
            tables: vec![self.table(), self.told(), stages],
            figures: self.figures(),
            galleries: vec![self.gallery()],
            files: vec![("scene.toml".to_owned(), self.toml.clone())],
            ..Finding::default()
        }
    }
}
