//! The reference of the scene file, key by key: the tables of the documentation of
//! [`crate::scene`], which this module reads.

use std::sync::LazyLock;

use super::dimension::Dimension;

/// The reference as Markdown.
pub const TEXT: &str = include_str!("reference.md");

/// A key of the scene file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Key {
    /// Its place: the keys that lead to it, and it, parted by dots. Those of a material stand below
    /// `material`, those of an albedo below `albedo`, for both are the value of several keys.
    pub path: &'static str,
    /// What its value is, and the unit of a bare number after a comma.
    pub value: &'static str,
    /// Its value unless given, or `required`.
    pub default: &'static str,
    /// What it means.
    pub meaning: &'static str,
}

static KEYS: LazyLock<Vec<Key>> = LazyLock::new(|| TEXT.lines().filter_map(row).collect());

/// The key that a row of a table documents; `None` for any other line.
pub fn row(line: &'static str) -> Option<Key> {
    let cells: Vec<&str> = line
        .strip_prefix("| `")?
        .strip_suffix(" |")?
        .split(" | ")
        .collect();
    let [path, value, default, meaning] = cells[..] else {
        return None;
    };
    Some(Key {
        path: path.strip_suffix('`')?,
        value,
        default,
        meaning,
    })
}

/// All keys, in the order of the reference.
pub fn keys() -> &'static [Key] {
    &KEYS
}

impl Key {
    /// What its own keys stand below.
    pub fn inside(&self) -> &'static str {
        match self.value {
            kind @ ("material" | "albedo") => kind,
            _ => self.path,
        }
    }

    /// What a number there measures; `step` is the key as it is written, `beside` says which keys
    /// its table has besides.
    pub(super) fn dimension(&self, step: &str, beside: impl Fn(&str) -> bool) -> Option<Dimension> {
        if self.path == "uncertainty.NAME" {
            return Some(match step.rsplit('.').next() {
                Some("angle" | "pitch" | "yaw" | "roll") => Dimension::Degrees,
                Some("scale" | "spot_diameter" | "roughness" | "ior" | "albedo") => {
                    Dimension::Percent
                }
                // Percentage points, which "5 %" would not say.
                Some("weight") => return None,
                _ => Dimension::Length,
            });
        }
        let (_, unit) = self.value.rsplit_once(", ")?;
        match unit.split_once(" (") {
            Some((unit, of)) => {
                let of = of.trim_end_matches(')');
                beside(of).then(|| Dimension::of_unit(unit)).flatten()
            }
            None => Dimension::of_unit(unit),
        }
    }

    /// The units of which a value with a unit may be, as a list; `None` where it has none.
    pub fn units(&self) -> Option<String> {
        let (_, unit) = self.value.rsplit_once(", ")?;
        let unit = unit.split(" (").next().unwrap_or(unit);
        Dimension::of_unit(unit).map(Dimension::units)
    }
}

/// The key `step` in the table that is the value of `outer`, or of the whole file.
pub(super) fn inside(outer: Option<&Key>, step: &str) -> Option<&'static Key> {
    let prefix = outer.map_or("", Key::inside);
    let is = |key: &Key, last: &str| match key.path.rsplit_once('.') {
        Some((before, own)) => before == prefix && own == last,
        None => prefix.is_empty() && key.path == last,
    };
    let named = keys().iter().find(|key| is(key, step));
    named.or_else(|| keys().iter().find(|key| is(key, "NAME")))
}

/// The key at a path of keys parted by dots, and the path without what names an entry of a list:
/// `surface.wall.material` is `surface.material`.
pub fn find(path: &str) -> Option<(String, &'static Key)> {
    let steps: Vec<&str> = path.split('.').collect();
    let (first, mut rest) = steps.split_first()?;
    let mut key = inside(None, first)?;
    let mut shown = key.path.to_owned();
    while let Some((step, after)) = rest.split_first() {
        let (next, after) = match (inside(Some(key), step), after.split_first()) {
            (Some(next), _) => (next, after),
            (None, Some((step, after))) if key.value == "list of tables" => {
                (inside(Some(key), step)?, after)
            }
            // A list's entry itself.
            (None, None) if key.value == "list of tables" => break,
            _ => return None,
        };
        shown = format!("{shown}.{}", next.path.rsplit('.').next().unwrap_or(step));
        (key, rest) = (next, after);
    }
    Some((shown, key))
}

/// The keys below `prefix`, at any depth; none in the materials and albedos that they have.
pub fn below(prefix: &str) -> impl Iterator<Item = &'static Key> {
    keys().iter().filter(move |key| {
        let rest = key.path.strip_prefix(prefix);
        rest.is_some_and(|rest| rest.starts_with('.'))
    })
}

/// Where a key of materials or albedos stands in a file, as an example; the path of any other.
pub(super) fn example(path: &str) -> String {
    match path.split_once('.') {
        Some(("material", rest)) => format!("surface.material.{rest}"),
        Some(("albedo", rest)) => format!("surface.material.lambertian.{rest}"),
        _ => path.to_owned(),
    }
}

/// Paths of the keys that `path` may be meant to be, at most three: those of that last name, else
/// those whose path or last name is nearest.
pub fn nearest(path: &str) -> Vec<String> {
    let last = |path: &str| path.rsplit('.').next().unwrap_or(path).to_owned();
    let asked = last(path);
    // A word of a megabyte is near to none of them.
    if asked.is_empty() || asked.len() > 100 {
        return Vec::new();
    }
    let apart = |a: &str, b: &str| strsim::damerau_levenshtein(a, b);
    let mut near: Vec<(usize, usize, String)> = keys()
        .iter()
        .map(|key| {
            let whole: String = path.chars().take(100).collect();
            let own = last(key.path);
            (
                apart(&own, &asked),
                apart(&example(key.path), &whole),
                example(key.path),
            )
        })
        .collect();
    near.sort();
    let best = near[0].0;
    let limit = if best == 0 {
        0
    } else {
        (asked.len() / 3).max(1)
    };
    let near = near.into_iter().filter(|(distance, ..)| *distance <= limit);
    near.map(|(.., path)| path).take(3).collect()
}

/// The command that explains the key at `path`, or the nearest one above it that there is.
pub(super) fn command(path: &str) -> Option<String> {
    let mut path = path;
    loop {
        if let Some((shown, _)) = find(path) {
            return Some(format!("`phicam help scene {shown}`"));
        }
        path = path.rsplit_once('.')?.0;
    }
}

#[cfg(test)]
mod tests;
