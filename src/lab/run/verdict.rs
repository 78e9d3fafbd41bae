//! A verdict in words and tables.

mod causes;

use super::summary::{facts, percent};
use crate::lab::comparison::agreement::{Agreement, Entry, EntryBound, VAGUE, share};
use crate::lab::comparison::gains::words;
use crate::lab::comparison::grounds::FEWEST;
use crate::lab::comparison::score::{Deviation, SINGLE_ELEMENTS, Score};
use crate::lab::finding::{Cell, Column, Describe, Finding, Place, Table, Tone, listed};
use crate::lab::uncertainty::certainty::fits_better;
use crate::lab::uncertainty::tails::missed;
use crate::lab::uncertainty::with_light::goes_with_light;
use crate::num::digits::{figure, significant};
use causes::NO_SINGLE;

/// Part of the noise up to which bounds of the model change no χ² to speak of.
const SMALL: f64 = 0.1;

impl Agreement {
    /// The verdict with its numbers; `DISAGREE` in capitals where a test fails.
    pub fn verdict(&self) -> String {
        let left_out = if self.left_out > 0 {
            let all = self.entries + self.left_out;
            format!(
                "; {} of {all} entries left out: dark in both, their error not trusted, or as asked",
                self.left_out
            )
        } else {
            String::new()
        };
        if !self.evidence && self.is_scale_free && self.best_scale_stderr > 0.0 {
            return format!(
                "no evidence on the {} model: nothing of its light is seen beside what was fitted, the scale being {} ± {} \
                 (take more or longer photographs, or a polynomial of a lower degree)",
                self.kernel,
                figure(self.best_scale, 3),
                figure(self.best_scale_stderr, 2)
            );
        }
        if !self.evidence && self.relative_discretisation > VAGUE {
            return format!(
                "no evidence on the {} model: of its light {} % may be what its integration leaves out{left_out} \
                 (make pixels, spots or elements smaller, or move what cuts through them)",
                self.kernel,
                figure(100.0 * self.relative_discretisation, 2)
            );
        }
        if !self.evidence {
            return format!(
                "no evidence on the {} model: no entry that counts is lit, traced or modelled{left_out} \
                 (check laser, spots and view with `phicam scene show`, or render with more samples)",
                self.kernel
            );
        }
        format!(
            "traced and {} model {}: χ²/dof {} over {} entries, largest |z| {} of {} allowed{left_out}",
            self.kernel,
            if self.agrees { "agree" } else { "DISAGREE" },
            significant(self.chi2_per_dof, 4),
            self.entries,
            significant(self.largest_z, 2),
            significant(self.z_limit, 2),
        )
    }

    pub(super) fn tone(&self) -> Tone {
        match (self.evidence, self.agrees) {
            (false, _) => Tone::Plain,
            (_, true) => Tone::Good,
            (_, false) => Tone::Bad,
        }
    }

    /// How far off, by what causes, and the test.
    pub(in crate::lab) fn facts(&self) -> Vec<(&'static str, String)> {
        if self.entries == 0 {
            return vec![("test", "none: no entry counts".to_owned())];
        }
        let bound = |b: EntryBound| {
            format!(
                ", {} in pixel {}, spot {}",
                percent(b.relative),
                b.pixel,
                b.spot
            )
        };
        let difference = format!(
            "{} of the model; {} expected from noise, at most {} from its discretisation{}; {} {} ± {}",
            percent(self.relative_difference),
            percent(self.relative_noise),
            percent(self.relative_discretisation),
            self.worst_bound.map_or(String::new(), bound),
            if self.is_scale_free {
                "of a free scale,"
            } else {
                "best scale"
            },
            figure(self.best_scale, 6),
            figure(self.best_scale_stderr, 2),
        );
        let occlusion = self.occlusion.map_or(String::new(), |points| {
            format!(", occlusion by {points} points (what is smaller is not seen)")
        });
        let pooled = self.pooled.map_or(String::new(), |n| {
            format!("; standard errors pooled over pixels and spots, known as from {n} replicates")
        });
        let seldom = match self.seldom {
            0 => String::new(),
            n => format!(
                "; of {n} entries the errors allow for shadows that fewer than 4 paths a block meet"
            ),
        };
        let test = format!(
            "{} model, {}{occlusion}{pooled}{seldom}; significance {}, P(χ²) {}, P(|z|) {}",
            self.kernel,
            self.integration,
            figure(self.significance, 2),
            figure(self.chi2_p, 2),
            figure(self.largest_p, 2)
        );
        let mut told = vec![("difference", difference)];
        if self.fitted > 0 || self.gains.is_some() {
            told.push(("fitted first", self.fitted_first()));
        }
        told.push(("test", test));
        told.extend(self.overstated().map(|words| ("errors", words)));
        // A model that is wrong leaves more where there is more light.
        let passes = self.chi2_p >= share(self.significance, self.score.is_some());
        let is_noise = passes && !fits_better(self.chi2_per_dof, self.chi2_p);
        let with_light = self.with_light.filter(|_| is_noise).map(goes_with_light);
        told.extend(with_light.map(|words| ("errors", words)));
        if !self.agrees && self.evidence {
            told.push(("rejected by", self.rejected_by()));
            if !self.unmodelled.is_empty() {
                told.push(("not in the model", self.unmodelled.join("; ")));
            }
        }
        if !self.agrees {
            let largest = |all: &[Option<f64>]| {
                let known = all.iter().enumerate().filter_map(|(i, x)| Some((i, (*x)?)));
                known.reduce(|a, b| if b.1 > a.1 { b } else { a })
            };
            if let (Some((p, by_pixel)), Some((l, by_spot))) =
                (largest(&self.pixels), largest(&self.spots))
            {
                let [a, b] = [by_pixel, by_spot].map(|x| significant(x, 3));
                told.push((
                    "worst",
                    format!("pixel {p}, χ²/dof {a}; spot {l}, χ²/dof {b}"),
                ));
            }
        }
        told
    }

    /// That the standard errors are larger than what they are those of, where no bound of the model
    /// and no allowance makes χ² small.
    fn overstated(&self) -> Option<String> {
        let noise_alone =
            self.seldom == 0 && self.relative_discretisation < SMALL * self.relative_noise;
        let is_close = noise_alone && fits_better(self.chi2_per_dof, self.chi2_p);
        let then = if self.agrees {
            "A model that is wrong by less than they say is not refused; give errors that are right, and all that is detected is smaller"
        } else {
            "What entries share looks like a deviation of the scene: say which share theirs (`--errors`)"
        };
        is_close.then(|| {
            format!(
                "traced and modelled are CLOSER than the standard errors allow: these are about {} times too large, or entries share them. {then}",
                figure(self.chi2_per_dof.recip().sqrt(), 2)
            )
        })
    }

    /// The tests that the model does not pass.
    fn rejected_by(&self) -> String {
        let share = share(self.significance, self.score.is_some());
        let scored = self.score.as_ref().is_some_and(Score::rejects);
        let tests = [
            ("χ²", self.chi2_p < share),
            ("the largest |z|", self.largest_p < share),
            ("the fit of a single deviation of the scene", scored),
        ];
        let failed = tests.iter().filter(|(_, fails)| *fails);
        let failed: Vec<&str> = failed.map(|(name, _)| *name).collect();
        format!("{} (at {} each)", failed.join(", "), figure(share, 2))
    }

    /// The most likely cause that `score` finds.
    pub(super) fn cause(&self, score: &Score) -> String {
        let level = share(self.significance, true);
        let cause = score.cause(self.chi2_per_dof, self.dof, level);
        let sent_on = self.sent_on.as_ref();
        let sent_on = sent_on.filter(|_| cause.starts_with(NO_SINGLE));
        let beside = sent_on.map_or(String::new(), |names| {
            format!(
                "light that {names} send on, which the model does not have (`phicam recover --occluder-light` estimates \
                 it beside the picture); if it is not that: "
            )
        });
        let cause = beside + &cause;
        if score.untested.iter().all(|name| name != SINGLE_ELEMENTS) {
            return cause;
        }
        format!(
            "{cause}. A picture that is not as the scene says, element by element, looks like such a cause too: \
             `phicam recover` and `phicam calibrate` take it for unknown"
        )
    }

    /// What was fitted before the test, and is not seen by it.
    fn fitted_first(&self) -> String {
        let of_scale = usize::from(self.is_scale_free);
        let other = self.fitted - of_scale;
        let scale = self
            .is_scale_free
            .then(|| "the scale: a factor of all light is not seen".to_owned());
        let light = (other > 0).then(|| {
            format!(
                "other light in {other} directions of {} entries, {} of all light: what has its form is not seen",
                self.entries,
                percent(self.other_light)
            )
        });
        let factors = self.gains.as_ref().map(|gains| {
            let words = words(gains);
            format!(
                "factors of the light, their spread counted as noise: {words}{}",
                gains.larger()
            )
        });
        let all: Vec<String> = scale.into_iter().chain(light).chain(factors).collect();
        all.join("; ")
    }

    /// The most likely cause of a disagreement, and from which size deviations are seen.
    fn limits(&self) -> Vec<(&'static str, String)> {
        let Some(score) = &self.score else {
            let few = format!(
                "no deviation of the scene was fitted: of fewer than {FEWEST} replicates standard errors \
                 are too rough for it"
            );
            let told = [("detects", few)].into_iter().chain(self.untested());
            return told.filter(|_| self.evidence).collect();
        };
        let cause = (!self.agrees).then(|| ("most likely", self.cause(score)));
        let stay = if score.shadows_stay {
            "; both as if shadows stayed where they are, which moves the numbers where they are deep"
        } else {
            ""
        };
        let detects = format!("95 times in 100 from: {}{stay}", score.detectable());
        let detects = [("detects", detects)];
        let told = cause.into_iter().chain(detects);
        told.chain(self.untested()).collect()
    }

    /// What is not tested: of the scene, and of a render of few entries.
    fn untested(&self) -> Option<(&'static str, String)> {
        let of_scene = self.score.iter().flat_map(|score| score.untested.clone());
        let rendered = self.is_rendered.then_some(self.entries + self.left_out);
        let all: Vec<String> = of_scene.chain(rendered.and_then(missed)).collect();
        (!all.is_empty()).then(|| ("not tested", listed(&all)))
    }

    /// The entries with the largest |z|.
    pub fn worst_entries(&self) -> Table {
        let row = |e: &Entry| {
            let numbers = [e.traced, e.modelled, e.z].map(Cell::from);
            [e.pixel, e.spot]
                .map(Cell::from)
                .into_iter()
                .chain(numbers)
                .collect()
        };
        Table {
            caption: "The worst entries".to_owned(),
            columns: vec![
                Column::text("pixel", ""),
                Column::text("spot", ""),
                Column::number("traced", "", "W", 6),
                Column::number("modelled", "", "W", 6),
                Column::number("z", "", "", 4),
            ],
            rows: self.worst.iter().map(row).collect(),
            ..Table::default()
        }
    }

    /// Every parameter of the scene fitted alone, for the page; none where none was.
    pub fn parameters(&self) -> Option<Table> {
        let score = self.score.as_ref()?;
        let loudest = score
            .spots
            .iter()
            .reduce(|a, b| if b.z.abs() > a.z.abs() { b } else { a });
        let fitted = |d: &Deviation| Cell::Estimate {
            value: d.value,
            stderr: Some(d.stderr),
        };
        let row = |d: &Deviation| {
            vec![
                d.label().into(),
                fitted(d),
                d.unit.as_str().into(),
                d.z.into(),
                d.chi2_per_dof.into(),
                d.detectable.into(),
            ]
        };
        let table = Table {
            caption: "Each parameter of the scene fitted alone".to_owned(),
            place: Place::Page,
            columns: vec![
                Column::text("parameter", ""),
                Column::estimate("light less model", "", "", 3),
                Column::text("unit", ""),
                Column::number("z", "", "", 3),
                Column::number("χ²/dof with it fitted", "", "", 4),
                Column::number("rejected 95 times in 100 from", "", "", 2),
            ],
            rows: score.deviations.iter().chain(loudest).map(row).collect(),
            ..Table::default()
        };
        let [limit, of_spots] = score.limits.map(|z| significant(z, 3));
        Some(table.noted(format!(
            "Values are first steps, as if the model were straight. |z| up to {limit} is chance for the scene's parameters, {of_spots} for those of single spots, of which the loudest is listed."
        )))
    }
}

impl Describe for Agreement {
    /// The verdict, what it rests on, and where it fails the worst entries by name.
    fn describe(&self) -> Finding {
        let worst = (self.evidence && !self.agrees).then(|| self.worst_entries());
        Finding {
            title: "Traced against modelled".to_owned(),
            tone: self.tone(),
            sentence: self.verdict(),
            tables: std::iter::once(facts(self.facts().into_iter().chain(self.limits())))
                .chain(worst)
                .chain(self.parameters())
                .collect(),
            ..Finding::default()
        }
    }
}
