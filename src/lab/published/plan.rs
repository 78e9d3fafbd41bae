//! What is free in the items.

use super::item::Item;

/// What is free in the items.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ReproducePlan {
    /// Items with more elements a side than this leave those curves out.
    pub most_elements: usize,
    /// Draws of the noise in Figs 22 to 24; of the moving view a quarter of them.
    pub seeds: u64,
    /// Seed of the first.
    pub first_seed: u64,
}

impl ReproducePlan {
    /// What results have to share to belong together, in words.
    pub fn settings(&self, item: Item) -> String {
        format!(
            "phicam {} reproduce {item}, up to {} elements a side, {} draws of noise from seed {}",
            env!("CARGO_PKG_VERSION"),
            self.most_elements,
            self.seeds,
            self.first_seed
        )
    }
}
