//! What is computed.

use std::fmt;

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

/// All that the result depends on, as names and values in a fixed order; how the work is divided is
/// no part of it.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Identity(Vec<(String, String)>);

/// SHA-256 of an [`Identity`].
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub struct PlanId([u8; 32]);

impl Identity {
    /// The name of the version of the arithmetic: what differs in it is told apart from every other
    /// difference.
    pub const NUMERICS: &str = "numerics";

    /// Adds a name and its value.
    #[must_use]
    pub fn with(mut self, name: &str, value: impl fmt::Display) -> Self {
        self.0.push((name.to_owned(), value.to_string()));
        self
    }

    /// The value of a name.
    pub fn get(&self, name: &str) -> Option<&str> {
        let found = self.0.iter().find(|(n, _)| n == name);
        found.map(|(_, value)| value.as_str())
    }

    /// The digest of every name and value, each led by its length, so that no two identities share
    /// their bytes.
    pub fn id(&self) -> PlanId {
        let mut digest = Sha256::new();
        for text in self.0.iter().flat_map(|(name, value)| [name, value]) {
            digest.update((text.len() as u64).to_le_bytes());
            digest.update(text.as_bytes());
        }
        PlanId(digest.finalize().into())
    }

    /// The first thing in which the two differ, the numerics before all others: its name, its value
    /// in `self`, its value in `other`.
    pub fn difference(&self, other: &Self) -> Option<(String, String, String)> {
        let nothing = || "nothing".to_owned();
        let value = |of: &Self, name: &str| of.get(name).map_or_else(nothing, str::to_owned);
        let all = self.0.iter().chain(&other.0).map(|(name, _)| name.as_str());
        std::iter::once(Self::NUMERICS)
            .chain(all)
            .map(|name| (name.to_owned(), value(self, name), value(other, name)))
            .find(|(_, own, others)| own != others)
    }
}

impl PlanId {
    /// The first twelve of its 64 hexadecimal digits, enough to tell the plans of a lifetime apart.
    pub fn short(&self) -> String {
        self.to_string()[..12].to_owned()
    }
}

impl fmt::Display for PlanId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|b| write!(f, "{b:02x}"))
    }
}

impl fmt::Debug for PlanId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{self}")
    }
}
