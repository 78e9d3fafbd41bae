//! Where the search ended, and where else it might have.

use super::with_unit;
use crate::lab::finding::listed;
use crate::lab::geometry::calibrate::elsewhere::{APART, FARTHEST};
use crate::lab::geometry::calibrate::{Calibrated, Calibration, Elsewhere};
use crate::lab::geometry::resized::Resized;
use crate::num::digits::figure;

impl Calibration {
    /// Places that are not told from this one, by the unknowns that differ.
    pub(super) fn or_elsewhere(&self) -> String {
        let place = |at: &Elsewhere| {
            let each = self.geometry().zip(&at.values);
            let other = each.filter(|(f, x)| (*x - f.value).abs() > APART * f.stderr);
            let named: Vec<String> = other
                .map(|(f, x)| format!("{} {}", f.name, with_unit(*x, 3, &f.unit)))
                .collect();
            format!(
                "{} (by e^{} less likely)",
                listed(&named),
                figure(at.less_likely, 2)
            )
        };
        let each: Vec<String> = self.elsewhere.iter().map(place).collect();
        if each.is_empty() {
            return String::new();
        }
        format!(
            " The photographs do NOT TELL that from {}: give what is known otherwise (--free NAME=SIGMA), or photograph \
             by spots or a view that tell them apart.",
            each.join(" or from ")
        )
    }

    /// Another size of the surface, where with it a parameter is another too.
    pub(super) fn moved(&self) -> Option<&Resized> {
        let own = || self.geometry().map(|f| (f.value, f.stderr));
        let other = self.resized.as_ref();
        other.filter(|other| other.is_elsewhere(own()))
    }

    /// What is said first of another size.
    pub(super) fn or_as_large(&self) -> String {
        let told = |other| format!(" {}", self.as_large(other));
        self.moved().map_or(String::new(), told)
    }

    /// What is said of another size of the surface.
    pub(super) fn as_large(&self, other: &Resized) -> String {
        let each: Vec<_> = self.geometry().zip(&other.values).collect();
        let moved = |(f, x): &(&Calibrated, &f64)| (*x - f.value).abs() / f.stderr;
        let most = each.iter().max_by(|a, b| moved(a).total_cmp(&moved(b)));
        other.told(&most.map_or(String::new(), |(f, x)| {
            format!("{} {}", f.name, with_unit(**x, 3, &f.unit))
        }))
    }

    pub(super) fn searched(&self) -> String {
        let starts = match self.starts.tried {
            1 => "One start was tried: whether others end elsewhere is not known (--starts)."
                .to_owned(),
            n if self.starts.agree == n => format!("All {n} starts end in one place."),
            n => format!(
                "{} of {n} starts end where the likeliest place is; the others ended \
                 elsewhere. If that is few, there may be a likelier place still (--starts).",
                self.starts.agree
            ),
        };
        let looked = if self.is_looked_around {
            format!(
                "Other places were looked for along one parameter at a time, as far as {FARTHEST} times its σ, 1°, 1 % or 1 % \
                 of the distance from the scene, and other sizes of a single surface."
            )
        } else {
            "Of many parameters, and past what stands in the way, no other places or sizes of the surface were looked \
             for but by the starts."
                .to_owned()
        };
        let steps: usize = self.stages.iter().map(|s| s.steps).sum();
        format!(
            "{starts} {looked} The likeliest took {steps} steps at {} noises, from large to the stated one.",
            self.stages.len()
        )
    }
}
