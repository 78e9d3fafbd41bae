//! The `Range` of a request (RFC 9110, 14.1.2), as far as one range of bytes goes.

/// What of a file is to be sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Part {
    Whole,
    /// Bytes `first` to `last`, both included.
    Bytes {
        first: u64,
        last: u64,
    },
    /// A range of which the file has nothing.
    Unsatisfiable,
}

impl Part {
    /// The part of a file of `length` bytes that `header` asks for. What is malformed, in another
    /// unit or more than one range is ignored, as the standard allows: the whole file is an answer
    /// to every request.
    pub(super) fn of(header: &str, length: u64) -> Self {
        Self::single(header, length).unwrap_or(Self::Whole)
    }

    fn single(header: &str, length: u64) -> Option<Self> {
        let (unit, range) = header.split_once('=')?;
        let (first, last) = range.trim_matches([' ', '\t']).split_once('-')?;
        if !unit.eq_ignore_ascii_case("bytes") {
            return None;
        }
        if first.is_empty() {
            let count = number(last)?.min(length);
            return match (count, length) {
                // Of nothing, the last bytes are all of it.
                (_, 0) if number(last)? > 0 => None,
                (0, _) => Some(Self::Unsatisfiable),
                _ => Some(Self::Bytes {
                    first: length - count,
                    last: length - 1,
                }),
            };
        }
        let first = number(first)?;
        let last = match last {
            "" => u64::MAX,
            last => number(last)?,
        };
        if last < first {
            return None;
        }
        if first >= length {
            return Some(Self::Unsatisfiable);
        }
        let last = last.min(length - 1);
        Some(Self::Bytes { first, last })
    }
}

/// A number of digits alone; what no u64 holds is more than any file has.
fn number(text: &str) -> Option<u64> {
    let digits = !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit());
    digits.then(|| text.parse().unwrap_or(u64::MAX))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_those_of_the_standard() {
        let part = |first, last| Part::Bytes { first, last };
        let huge = "9".repeat(40);
        // The examples of RFC 9110, 14.1.2, for 10000 bytes, and what a client may get wrong.
        for (header, expected) in [
            ("bytes=0-499".to_owned(), part(0, 499)),
            ("bytes=500-999".to_owned(), part(500, 999)),
            ("bytes=-500".to_owned(), part(9500, 9999)),
            ("bytes=9500-".to_owned(), part(9500, 9999)),
            ("bytes=0-0".to_owned(), part(0, 0)),
            ("bytes=-1".to_owned(), part(9999, 9999)),
            ("BYTES= 7-8 ".to_owned(), part(7, 8)),
            ("bytes=0-99999".to_owned(), part(0, 9999)),
            ("bytes=-99999".to_owned(), part(0, 9999)),
            (format!("bytes=3-{huge}"), part(3, 9999)),
            (format!("bytes=-{huge}"), part(0, 9999)),
            (format!("bytes={huge}-"), Part::Unsatisfiable),
            ("bytes=10000-".to_owned(), Part::Unsatisfiable),
            ("bytes=10000-20000".to_owned(), Part::Unsatisfiable),
            ("bytes=-0".to_owned(), Part::Unsatisfiable),
            ("bytes=5-4".to_owned(), Part::Whole),
            (format!("bytes={huge}-4"), Part::Whole),
            ("bytes=0-1,5-6".to_owned(), Part::Whole),
            ("bytes=--1".to_owned(), Part::Whole),
            ("bytes=-".to_owned(), Part::Whole),
            ("bytes=+1-2".to_owned(), Part::Whole),
            ("bytes=1-0x9".to_owned(), Part::Whole),
            ("bytes=1.5-2".to_owned(), Part::Whole),
            ("bytes".to_owned(), Part::Whole),
            ("spots=0-1".to_owned(), Part::Whole),
            (String::new(), Part::Whole),
        ] {
            assert_eq!(Part::of(&header, 10_000), expected, "{header}");
        }
        for (header, expected) in [
            ("bytes=0-", Part::Unsatisfiable),
            ("bytes=-0", Part::Unsatisfiable),
            ("bytes=-5", Part::Whole),
        ] {
            assert_eq!(Part::of(header, 0), expected, "{header} of nothing");
        }
    }
}
