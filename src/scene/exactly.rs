//! Lists of a fixed length in a file: what is longer is refused, as what is shorter is.

use std::fmt;
use std::marker::PhantomData;

use serde::de::{Deserialize, Deserializer, Error, SeqAccess, Visitor};

/// A list of N values and no more: the reader of arrays leaves what follows unread.
struct Exactly<T, const N: usize>([T; N]);

struct Entries<T, const N: usize>(PhantomData<T>);

impl<'de, T: Deserialize<'de>, const N: usize> Visitor<'de> for Entries<T, N> {
    type Value = Exactly<T, N>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "an array of length {N}")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Self::Value, A::Error> {
        let mut entries = Vec::with_capacity(N);
        while let Some(entry) = list.next_element()? {
            entries.push(entry);
        }
        let found = entries.len();
        let all = entries.try_into();
        all.map(Exactly)
            .map_err(|_| A::Error::invalid_length(found, &self))
    }
}

impl<'de, T: Deserialize<'de>, const N: usize> Deserialize<'de> for Exactly<T, N> {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        from.deserialize_seq(Entries(PhantomData))
    }
}

/// One list.
pub(crate) fn one<'de, D: Deserializer<'de>, T: Deserialize<'de>, const N: usize>(
    from: D,
) -> Result<[T; N], D::Error> {
    Ok(Exactly::deserialize(from)?.0)
}

/// One that may be absent, with `default`.
pub(crate) fn maybe<'de, D: Deserializer<'de>, T: Deserialize<'de>, const N: usize>(
    from: D,
) -> Result<Option<[T; N]>, D::Error> {
    one(from).map(Some)
}

/// A list of such lists that may be absent, with `default`.
pub(crate) fn each<'de, D: Deserializer<'de>, T: Deserialize<'de>, const N: usize>(
    from: D,
) -> Result<Option<Vec<[T; N]>>, D::Error> {
    let all: Vec<Exactly<T, N>> = Vec::deserialize(from)?;
    Ok(Some(all.into_iter().map(|own| own.0).collect()))
}

#[cfg(test)]
mod tests {
    use crate::scene::Scene;
    use crate::scene::file::SceneFile;

    /// A number too many is refused with its place, wherever lists have a fixed length.
    #[test]
    fn what_is_too_long_is_refused() {
        let text = SceneFile::builtin("bench").unwrap().toml().unwrap();
        assert!(Scene::from_toml("bench", &text).is_ok());
        let long = |key: &str| {
            let line = text.lines().find(|l| l.starts_with(&format!("{key} = [")));
            let line = line.unwrap_or_else(|| panic!("no {key} in {text}"));
            text.replacen(line, &line.replacen(']', ", 1]", 1), 1)
        };
        for key in ["position", "x", "pixels", "centre"] {
            let refused = Scene::from_toml("bench", &long(key))
                .unwrap_err()
                .to_string();
            assert!(refused.contains("invalid length"), "{key}: {refused}");
            assert!(refused.contains("bench:"), "{key}: {refused}");
        }
        let boards = ["checkerboard = [2, 2, 2]", "ramp = [0.1, 0.5, 0.9]"];
        for board in boards {
            let line = text.lines().find(|l| l.contains("checkerboard")).unwrap();
            let start = line.find("checkerboard").unwrap();
            let end = start + line[start..].find(']').unwrap() + 1;
            let text = text.replacen(&line[start..end], board, 1);
            let refused = Scene::from_toml("bench", &text).unwrap_err().to_string();
            assert!(refused.contains("invalid length 3"), "{refused}");
        }
    }
}
