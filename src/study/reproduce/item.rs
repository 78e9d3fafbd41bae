//! The items of the published study.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

/// A published table or figure, or a group of figures that show one computation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Item {
    /// K in the flattened cross-section at 7.5 in.
    Table2,
    /// At 1 in.
    Table3,
    /// At 11 in.
    Table4,
    /// Figs 17 and 18: MTF against the distance of the spot lines, without stagger.
    Fig17,
    /// Figs 20 and 21: the same with and without stagger.
    Fig20,
    /// Table 1 and Fig 11: Moore–Penrose against mrdivide.
    Table1,
    /// MTF against the number of spots, 2 × 2 board.
    Fig12,
    /// 4 × 4 board.
    Fig13,
    /// 8 × 8 and 16 × 16 boards.
    Fig14,
    /// Figs 15 and 16: condition number and smallest eigenvalue.
    Fig15,
    /// Figs 22 to 24: noise.
    Fig22,
    /// The same inversions beyond double precision.
    Precision,
    /// The dual image: a traced matrix transposed.
    Dual,
    /// The camera's view moving with the laser spot.
    MovingView,
}

impl Item {
    /// Every item, in the order in which they are computed.
    pub const ALL: [Self; 14] = [
        Self::Table1,
        Self::Table2,
        Self::Table3,
        Self::Table4,
        Self::Fig12,
        Self::Fig13,
        Self::Fig14,
        Self::Fig15,
        Self::Fig17,
        Self::Fig20,
        Self::Fig22,
        Self::Precision,
        Self::Dual,
        Self::MovingView,
    ];

    /// The name by which it is asked for and by which its files are called.
    pub fn name(self) -> &'static str {
        match self {
            Self::Table1 => "table1",
            Self::Table2 => "table2",
            Self::Table3 => "table3",
            Self::Table4 => "table4",
            Self::Fig12 => "fig12",
            Self::Fig13 => "fig13",
            Self::Fig14 => "fig14",
            Self::Fig15 => "fig15",
            Self::Fig17 => "fig17",
            Self::Fig20 => "fig20",
            Self::Fig22 => "fig22",
            Self::Precision => "precision",
            Self::Dual => "dual",
            Self::MovingView => "moving-view",
        }
    }

    /// Published figures that the item shows besides the one that it is named after.
    fn others(self) -> &'static [&'static str] {
        match self {
            Self::Table1 => &["fig11"],
            Self::Fig15 => &["fig16"],
            Self::Fig17 => &["fig18"],
            Self::Fig20 => &["fig21"],
            Self::Fig22 => &["fig23", "fig24"],
            _ => &[],
        }
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
            assert_eq!(item.to_string().parse(), Ok(item));
            assert!(item.others().iter().all(|o| o.parse() == Ok(item)));
        }
        let said = "fig99".parse::<Item>().unwrap_err().to_string();
        assert!(Item::ALL.iter().all(|i| said.contains(i.name())), "{said}");
    }
}
