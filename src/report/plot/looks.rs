//! How the curves of a figure look.

use crate::lab::finding::{Curve, Figure, Mark};
use crate::report::look::Look;

/// How the curves of a figure look: those of one name alike in every plot, computed and published
/// ones numbered apart.
pub(super) struct Looks<'a> {
    computed: Vec<&'a Curve>,
    published: Vec<&'a Curve>,
}

impl<'a> Looks<'a> {
    pub(super) fn of(figure: &'a Figure) -> Self {
        let mut looks = Self {
            computed: Vec::new(),
            published: Vec::new(),
        };
        for curve in figure.plots.iter().flat_map(|p| &p.curves) {
            let own = match curve.mark {
                Mark::Published => &mut looks.published,
                _ => &mut looks.computed,
            };
            if own.iter().all(|c| c.name != curve.name) {
                own.push(curve);
            }
        }
        looks
    }

    /// The look of a curve.
    pub(super) fn of_curve(&self, curve: &Curve) -> Look {
        let own = match curve.mark {
            Mark::Published => &self.published,
            _ => &self.computed,
        };
        let place = own.iter().position(|c| c.name == curve.name);
        Look {
            mark: curve.mark,
            number: place.unwrap_or(0),
        }
    }

    /// Samples and texts of the legend.
    pub(super) fn legend(&self) -> Vec<(String, String)> {
        let entry = |c: &&Curve| {
            let name = match c.mark {
                Mark::Published => format!("{} (published)", c.name),
                _ => c.name.clone(),
            };
            (self.of_curve(c).sample(), name)
        };
        let all = self.computed.iter().chain(&self.published);
        all.filter(|c| !c.name.is_empty()).map(entry).collect()
    }
}
