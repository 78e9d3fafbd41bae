//! What is said of whether the photographs belong to their spots.

use crate::lab::geometry::located::{Located, Order};
use crate::num::digits::figure;

/// Probability of an order by chance below which the stated one counts as found.
const SIGNIFICANCE: f64 = 1e-3;

impl Order {
    /// Whether random orders explain the photographs too often; none where too few were tried to
    /// tell.
    pub fn is_by_chance(&self) -> Option<bool> {
        if self.as_likely > 0 {
            return Some(self.p > SIGNIFICANCE);
        }
        (self.p <= SIGNIFICANCE).then_some(false)
    }

    /// `is_explained`: whether nothing is left over beside the stated noise.
    fn sentence(&self, is_explained: bool) -> String {
        let Self {
            tried,
            as_likely,
            p,
            misfit,
            least_misfit,
        } = *self;
        let told = match self.is_by_chance() {
            Some(false) if is_explained => "The photographs belong to their spots",
            Some(false) => {
                "As a whole the photographs belong to their spots; whether each single one does is not told"
            }
            Some(true) => {
                "Nothing says that the photographs belong to their spots: the order is wrong, or the \
                 hidden surface is nowhere near, or the noise hides it"
            }
            None => {
                "Too few orders were tried to say whether the photographs belong to their spots"
            }
        };
        format!(
            "{told}. Of {tried} random orders {as_likely} are as likely as the stated one (p = {}); \
             misfit {} as stated, at least {} in the others. Frames up to 8 places too early or too \
             late, all or from one on, two exchanged, or backwards, and photographs mirrored or turned \
             were tried too.",
            figure(p, 2),
            figure(misfit, 3),
            figure(least_misfit, 3)
        )
    }
}

impl Located {
    /// Whether the photographs belong to their spots.
    pub(super) fn ordered(&self) -> String {
        match (&self.mistaken, self.order) {
            (_, None) => "Whether the photographs belong to their spots was not asked.".to_owned(),
            (None, Some(order)) => order.sentence(self.is_explained()),
            (Some(other), Some(order)) if order.is_by_chance() == Some(true) => {
                format!(
                    "{} They fit better if {}.",
                    order.sentence(false),
                    other.what
                )
            }
            (Some(other), Some(_)) => format!(
                "The photographs are NOT IN ORDER: {}. Turned back they are likelier by e^{}, and \
                 their misfit is {}. Import them in the right order.",
                other.what,
                figure(other.log_likelier, 2),
                figure(other.misfit, 3)
            ),
        }
    }
}
