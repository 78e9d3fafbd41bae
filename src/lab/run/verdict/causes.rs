//! What explains a difference of traced and modelled light, in words.

use crate::lab::comparison::score::{Deviation, Score};
use crate::lab::finding::listed;
use crate::num::digits::{figure, significant};
use crate::num::statistics::chi_square_sf;

/// A parameter that leaves more than this part of the excess of χ² over its mean, and more than
/// chance, is no cause of it.
const UNEXPLAINED: f64 = 0.1;
/// Standard errors within which a model's bend does not matter: of a deviation so large a tenth of
/// its size is one.
const STRAIGHT: f64 = 10.0;
/// |z| of a parameter after the picture was fitted beyond which that misses it: 1 % of one
/// parameter chosen among a hundred.
const MISSES: f64 = 3.9;
pub(super) const NO_SINGLE: &str = "no single parameter of the scene explains it";
const MORE_THAN_CHANCE: &str = ", which is more than chance: something else is off too";
/// Causes that are named beside the most likely one.
const NAMED: usize = 3;

impl Score {
    /// The most likely cause of a χ²/dof of so many degrees of freedom, and what explains the
    /// difference as well; whether it does is tested at `level`.
    pub(in crate::lab) fn cause(&self, chi2_per_dof: f64, dof: f64, level: f64) -> String {
        let single = self.single_cause(chi2_per_dof, dof, level);
        let Some(picture) = &self.picture else {
            return single;
        };
        let explains = chi_square_sf(picture.chi2_per_dof * dof, dof) >= level;
        let leaves = format!(
            "all {} reflectances fitted together between 0 and 1 leave χ²/dof {}{}",
            picture.elements,
            significant(picture.chi2_per_dof, 4),
            if explains { "" } else { MORE_THAN_CHANCE }
        );
        let unexplained = picture.chi2_per_dof - 1.0 > UNEXPLAINED * (chi2_per_dof - 1.0);
        if !explains && unexplained {
            return format!("{single}. Another picture does not explain it: {leaves}");
        }
        match (picture.is_missed, picture.misses.abs() > MISSES) {
            (true, false) => {
                let of = if single.starts_with(NO_SINGLE) {
                    ""
                } else {
                    "of single parameters "
                };
                format!(
                    "another picture than the scene's, element by element: {leaves}; {of}{single}"
                )
            }
            (false, true) => {
                format!("{single}. Another picture explains less: {leaves}")
            }
            (false, false) => format!(
                "{single}; not told from another picture than the scene's, element by element: {leaves}"
            ),
            (true, true) => format!(
                "{single}. It and another picture each explain what the other does not: {leaves}"
            ),
        }
    }

    /// The same of single parameters.
    fn single_cause(&self, chi2_per_dof: f64, dof: f64, level: f64) -> String {
        let Some((first, rest)) = self.likely.split_first() else {
            return NO_SINGLE.to_owned();
        };
        let left = first.chi2_per_dof - 1.0;
        let explains = chi_square_sf(first.chi2_per_dof * dof, dof) >= level;
        if !explains && left > UNEXPLAINED * (chi2_per_dof - 1.0) {
            let only = if first.is_followed {
                ""
            } else {
                " as far as the model is straight (one that is not small is not seen so)"
            };
            return format!(
                "{NO_SINGLE}{only}: the best, {}, leaves χ²/dof {}. Several \
                 at once may, or another order, orientation or unit of the photographs (`phicam locate` \
                 tests the order)",
                first.label(),
                significant(first.chi2_per_dof, 4)
            );
        }
        let same: Vec<String> = first
            .same
            .iter()
            .map(|(name, factor)| {
                let percent = 100.0 * (libm::pow(1.0 + 0.01 * first.value, *factor) - 1.0);
                format!("{name} {}", signed(percent, 3, &first.unit))
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
        let more = match (explains, first.is_followed) {
            (true, is_followed) if is_followed || first.z.abs() < STRAIGHT => {
                ", and its ± if nothing else is off"
            }
            (true, _) => "; its value is a first step, as if the model were straight",
            (false, true) => MORE_THAN_CHANCE,
            (false, false) => {
                ", which is more than chance: it is not small against the scene, and its value a first \
                 step, or something else is off too"
            }
        };
        format!(
            "{}{same}{as_good}; χ²/dof {} with it alone fitted{more}",
            first.fitted(),
            significant(first.chi2_per_dof, 4)
        )
    }

    /// Sizes from which deviations are seen 95 times in 100, those of the scene and, of single
    /// spots, the least seen shift and scale.
    pub(in crate::lab) fn detectable(&self) -> String {
        let told = |d: &Deviation| {
            if d.is_within_reach(d.detectable) {
                format!("{} {}\u{a0}{}", d.name, figure(d.detectable, 2), d.unit)
            } else {
                format!("{} never (a scene cannot have so much of it)", d.name)
            }
        };
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
            .filter(|d| wanted.contains(&d.name.as_str()) || d.name.ends_with(".normal"));
        let of_one = ["one spot alone, ", "one photograph alone, scale"];
        let least_seen = of_one.iter().filter_map(|name| {
            let own = self.spots.iter().filter(|d| d.name.starts_with(name));
            own.reduce(|a, b| if b.detectable > a.detectable { b } else { a })
        });
        let all: Vec<String> = of_scene.chain(least_seen).map(told).collect();
        listed(&all)
    }
}

impl Deviation {
    /// Its name, with its spot.
    pub(super) fn label(&self) -> String {
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
mod tests;
