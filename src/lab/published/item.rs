//! The items of the published study.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

/// A published table or figure, or a group of figures that show one computation; in the order in
/// which they are computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Item {
    /// Table 1 and Fig 11: Moore–Penrose against mrdivide.
    Table1,
    /// K in the flattened cross-section at 7.5 in.
    Table2,
    /// At 1 in.
    Table3,
    /// At 11 in.
    Table4,
    /// MTF against the number of spots, 2 × 2 board.
    Fig12,
    /// 4 × 4 board.
    Fig13,
    /// 8 × 8 and 16 × 16 boards.
    Fig14,
    /// Figs 15 and 16: condition number and smallest eigenvalue.
    Fig15,
    /// Figs 17 and 18: MTF against the distance of the spot lines, without stagger.
    Fig17,
    /// Figs 20 and 21: the same with and without stagger.
    Fig20,
    /// Figs 22 to 24: noise.
    Fig22,
    /// The same inversions beyond double precision.
    Precision,
    /// The dual image: a traced matrix transposed.
    Dual,
    /// The camera's view moving with the laser spot.
    MovingView,
}

/// Each item with the name by which it is asked for and by which its files are called, and the
/// published figures that it shows besides.
const NAMES: [(Item, &str, &[&str]); 14] = [
    (Item::Table1, "table1", &["fig11"]),
    (Item::Table2, "table2", &[]),
    (Item::Table3, "table3", &[]),
    (Item::Table4, "table4", &[]),
    (Item::Fig12, "fig12", &[]),
    (Item::Fig13, "fig13", &[]),
    (Item::Fig14, "fig14", &[]),
    (Item::Fig15, "fig15", &["fig16"]),
    (Item::Fig17, "fig17", &["fig18"]),
    (Item::Fig20, "fig20", &["fig21"]),
    (Item::Fig22, "fig22", &["fig23", "fig24"]),
    (Item::Precision, "precision", &[]),
    (Item::Dual, "dual", &[]),
    (Item::MovingView, "moving-view", &[]),
];

impl Item {
    /// Every item, in the order in which they are computed.
    pub const ALL: [Self; 14] = {
        let mut all = [Self::Table1; 14];
        let mut k = 0;
        while k < all.len() {
            all[k] = NAMES[k].0;
            k += 1;
        }
        all
    };

    /// The name by which it is asked for and by which its files are called.
    pub fn name(self) -> &'static str {
        NAMES[self as usize].1
    }

    /// Published figures that the item shows besides the one that it is named after.
    fn others(self) -> &'static [&'static str] {
        NAMES[self as usize].2
    }

    /// All names, with those of the figures that an item shows besides.
    fn list() -> String {
        let name = |i: Self| match i.others() {
            [] => i.name().to_owned(),
            others => format!("{} ({})", i.name(), others.join(", ")),
        };
        Self::ALL.map(name).join(", ")
    }
}

impl fmt::Display for Item {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// A name that no item has.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("there is no published item \"{0}\"; choose from {list}", list = Item::list())]
pub struct UnknownItem(pub String);

impl FromStr for Item {
    type Err = UnknownItem;

    fn from_str(name: &str) -> Result<Self, Self::Err> {
        Self::ALL
            .into_iter()
            .find(|i| i.name() == name || i.others().contains(&name))
            .ok_or_else(|| UnknownItem(name.to_owned()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_further_figures_are_understood_and_strangers_are_told_the_list() {
        for item in Item::ALL {
            assert_eq!(NAMES[item as usize].0, item);
            assert_eq!(item.to_string().parse(), Ok(item));
            assert!(item.others().iter().all(|o| o.parse() == Ok(item)));
        }
        let said = "fig99".parse::<Item>().unwrap_err().to_string();
        assert!(Item::ALL.iter().all(|i| said.contains(i.name())), "{said}");
    }
}
