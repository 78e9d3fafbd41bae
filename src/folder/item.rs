//! ITEM.json: an item of the published study in short, and what vouches for its files.

use std::collections::BTreeMap;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::error::FolderError;
use super::record::{Written, seal};
use crate::lab::published::{Item, ItemSummary};
use crate::store::{self, harmless_json, write_whole};

/// An item as its folder keeps it.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub struct ItemRecord {
    /// The item in short.
    #[serde(flatten)]
    pub summary: ItemSummary,
    /// Its other files as they were written, by name.
    #[serde(default)]
    written: BTreeMap<String, Written>,
    /// SHA-256 of all above as JSON.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    digest: Option<String>,
}

impl ItemRecord {
    /// Most bytes that a file of an item may have: 64 MiB.
    pub const LARGEST: u64 = 64 << 20;

    /// The item that `folder` keeps.
    pub fn read(folder: &Path, item: Item) -> Option<Self> {
        let text = store::read(&folder.join(name(item.name())), Self::LARGEST).ok()?;
        serde_json::from_slice(&text).ok()
    }

    /// Leaves the item in `folder`, whose other files are there: it vouches for them as they are.
    ///
    /// # Errors
    /// [`FolderError`] where a file cannot be read or it cannot be written.
    pub fn write(folder: &Path, summary: ItemSummary) -> Result<(), FolderError> {
        let files = summary.files.iter();
        let written = files.map(|file| Ok((file.clone(), Written::of(&folder.join(file))?)));
        let item = Self {
            written: written.collect::<Result<_, FolderError>>()?,
            summary,
            digest: None,
        };
        let digest = Some(seal(&item)?);
        let json = serde_json::to_string_pretty(&Self {
            digest,
            ..item.clone()
        })?;
        let text = harmless_json(&json) + "\n";
        let path = folder.join(name(&item.summary.item));
        Ok(write_whole(&path, |file| file.write_all(text.as_bytes()))?)
    }

    /// Whether it has changed since it was written.
    pub fn is_damaged(&self) -> bool {
        let bare = Self {
            digest: None,
            ..self.clone()
        };
        self.digest.is_some() && seal(&bare).ok() != self.digest
    }

    /// The item that `folder` keeps if neither it nor any of its files has changed, else the name
    /// of the first that has. None where there is none.
    pub fn whole(folder: &Path, item: Item) -> Option<Result<ItemSummary, String>> {
        let found = Self::read(folder, item)?;
        if found.is_damaged() {
            return Some(Err(name(item.name())));
        }
        let changed = found.changed(folder).map(str::to_owned);
        Some(changed.map_or(Ok(found.summary), Err))
    }

    /// The first of its files in `folder` that is not what was written.
    fn changed(&self, folder: &Path) -> Option<&str> {
        let is_whole = |file: &str| {
            let written = self.written.get(file);
            written.is_some_and(|w| w.is_at(&folder.join(file)).unwrap_or(false))
        };
        let mut files = self.summary.files.iter().map(String::as_str);
        files.find(|file| !is_whole(file))
    }
}

/// The file of the item of that name.
fn name(item: &str) -> String {
    format!("{item}.json")
}
