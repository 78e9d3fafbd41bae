//! A verdict in words and tables.

use super::agreement::{Agreement, Entry, EntryBound};
use super::finding::{Cell, Column, Describe, Finding, Place, Table, Tone, listed};
use super::score::{Deviation, Score};
use super::summary::facts;
use crate::num::digits::{figure, significant};

fn percent(x: f64) -> String {
    format!("{}\u{a0}%", figure(100.0 * x, 3))
}

/// A parameter that leaves more than this part of the excess of χ² over its mean is no cause of it.
const UNEXPLAINED: f64 = 0.1;
/// Causes that are named beside the most likely one.
const NAMED: usize = 3;

impl Agreement {
    /// The verdict with its numbers; `DISAGREE` in capitals where a test fails.
    pub fn verdict(&self) -> String {
        let left_out = if self.left_out > 0 {
            let all = self.entries + self.left_out;
            format!(
                "; {} of {all} entries left out, their error not being trusted or as asked",
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
    pub(super) fn facts(&self) -> Vec<(&'static str, String)> {
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
        let test = format!(
            "{} model, {}{occlusion}; significance {}, P(χ²) {}, P(|z|) {}",
            self.kernel,
            self.integration,
            figure(self.significance, 2),
            figure(self.chi2_p, 2),
            figure(self.largest_p, 2)
        );
        let mut told = vec![("difference", difference)];
        if self.fitted > 0 {
            told.push(("fitted first", self.fitted_first()));
        }
        told.push(("test", test));
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
        let both: Vec<String> = scale.into_iter().chain(light).collect();
        both.join("; ")
    }

    /// The most likely cause of a disagreement, and from which size deviations are seen.
    fn limits(&self) -> Vec<(&'static str, String)> {
        let Some(score) = &self.score else {
            return Vec::new();
        };
        let cause = (!self.agrees).then(|| ("most likely", score.cause(self.chi2_per_dof)));
        let detects = format!("95 times in 100 from: {}", score.detectable());
        cause.into_iter().chain([("detects", detects)]).collect()
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
            "|z| up to {limit} is chance for the scene's parameters, {of_spots} for those of single spots, of which the loudest is listed."
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

impl Score {
    /// The most likely cause of a χ²/dof, and what explains the difference as well.
    pub(super) fn cause(&self, chi2_per_dof: f64) -> String {
        let Some((first, rest)) = self.likely.split_first() else {
            return "no single parameter of the scene explains it".to_owned();
        };
        let left = first.chi2_per_dof - 1.0;
        if left > 1.0 && left > UNEXPLAINED * (chi2_per_dof - 1.0) {
            return format!(
                "no single parameter of the scene explains it: the best, {}, leaves χ²/dof {}. Several at \
                 once may, or another order, orientation or unit of the photographs (`phicam locate` \
                 tests the order)",
                first.label(),
                significant(first.chi2_per_dof, 4)
            );
        }
        let same: Vec<String> = first
            .same
            .iter()
            .map(|(name, factor)| {
                format!("{name} {}", signed(first.value * factor, 3, &first.unit))
            })
            .collect();
        let same = if same.is_empty() {
            String::new()
        } else {
            format!(" (or {})", same.join(", "))
        };
        let as_good = if rest.is_empty() {
            String::new()
        } else {
            let named: Vec<String> = rest.iter().take(NAMED).map(Deviation::fitted).collect();
            let more = match rest.len().saturating_sub(NAMED) {
                0 => String::new(),
                n => format!(" and {n} more"),
            };
            format!("; not told from {}{more}", named.join(", "))
        };
        format!(
            "{}{same}{as_good}; χ²/dof {} with it fitted",
            first.fitted(),
            significant(first.chi2_per_dof, 4)
        )
    }

    /// Sizes from which deviations are seen 95 times in 100, those of the scene and the least seen
    /// of single spots.
    pub(super) fn detectable(&self) -> String {
        let told =
            |d: &Deviation| format!("{} {}\u{a0}{}", d.name, figure(d.detectable, 2), d.unit);
        let wanted = [
            "overall scale",
            "hinge angle",
            "S2 along its normal",
            "all spots, x",
            "view, x",
        ];
        let of_scene = self
            .deviations
            .iter()
            .filter(|d| wanted.contains(&d.name.as_str()));
        let least_seen = self
            .spots
            .iter()
            .reduce(|a, b| if b.detectable > a.detectable { b } else { a });
        let all: Vec<String> = of_scene.chain(least_seen).map(told).collect();
        listed(&all)
    }
}

impl Deviation {
    /// Its name, with its spot.
    fn label(&self) -> String {
        match self.spot {
            None => self.name.clone(),
            Some(l) => format!("{} (spot {l})", self.name),
        }
    }

    /// Name, value and error.
    fn fitted(&self) -> String {
        format!(
            "{} {} ± {}\u{a0}{}",
            self.label(),
            signed(self.value, 3, ""),
            figure(self.stderr, 2),
            self.unit
        )
    }
}

/// A number with its sign and unit.
fn signed(x: f64, digits: usize, unit: &str) -> String {
    let sign = if x < 0.0 { "−" } else { "+" };
    let space = if unit.is_empty() { "" } else { "\u{a0}" };
    format!("{sign}{}{space}{unit}", figure(x.abs(), digits))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A parameter that takes the excess of χ² is the cause; one that leaves it is none, however
    /// large its fit is against its error.
    #[test]
    fn what_leaves_the_difference_is_no_cause() {
        let deviation = |chi2_per_dof: f64| Deviation {
            name: "hinge angle".to_owned(),
            unit: "deg".to_owned(),
            value: 6.4,
            stderr: 3e-4,
            bias: 0.0,
            z: 2e4,
            p: 0.0,
            detectable: 1e-3,
            chi2_per_dof,
            same: Vec::new(),
            spot: None,
        };
        let cause = |left: f64, whole: f64| {
            let likely = vec![deviation(left)];
            let score = Score {
                likely,
                ..Score::default()
            };
            score.cause(whole)
        };
        for (left, whole, named) in [(3e5, 4e5, false), (1.05, 40.0, true), (90.0, 1e4, true)] {
            let told = cause(left, whole);
            assert_eq!(!told.starts_with("no single parameter"), named, "{told}");
            assert!(told.contains("hinge angle"), "{told}");
        }
    }
}
