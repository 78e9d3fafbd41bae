//! The query of a request: `key=value` pairs, values of letters and digits.

use super::answer::Refusal;

/// The pairs of a query, each key once.
#[derive(Debug)]
pub(super) struct Query<'a> {
    pairs: Vec<(&'a str, &'a str)>,
}

impl<'a> Query<'a> {
    /// Takes a query apart that has all of `keys` and no others.
    ///
    /// # Errors
    /// 400, with the keys that are wanted.
    pub(super) fn of(text: Option<&'a str>, keys: &[&str]) -> Result<Self, Refusal> {
        let text = text.unwrap_or_default();
        let pairs: Option<Vec<_>> = match text {
            "" => Some(Vec::new()),
            text => text.split('&').map(|pair| pair.split_once('=')).collect(),
        };
        let right = pairs.filter(|pairs| {
            let once = |key: &&str| pairs.iter().filter(|(k, _)| k == key).count() == 1;
            pairs.len() == keys.len() && keys.iter().all(once)
        });
        right.map(|pairs| Self { pairs }).ok_or_else(|| {
            let wanted: Vec<_> = keys.iter().map(|k| format!("{k}=…")).collect();
            let wanted = match keys {
                [] => "nothing".to_owned(),
                _ => wanted.join("&"),
            };
            Refusal::meaningless(format!("the query has to be {wanted}, each once"))
        })
    }

    /// The value of a key that was asked for.
    pub(super) fn word(&self, key: &str) -> &'a str {
        let pair = self.pairs.iter().find(|(k, _)| *k == key);
        pair.map_or("", |(_, value)| value)
    }

    /// The value of a key that was asked for, as a whole number.
    ///
    /// # Errors
    /// 400 if it is none, or one that this machine does not hold.
    pub(super) fn number(&self, key: &str) -> Result<usize, Refusal> {
        let text = self.word(key);
        let digits = text.bytes().all(|b| b.is_ascii_digit());
        text.parse()
            .ok()
            .filter(|_| digits)
            .ok_or_else(|| Refusal::meaningless(format!("{key} has to be a whole number from 0")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_query_has_its_keys_once_and_no_others() {
        let right = Query::of(Some("b=7&a=traced"), &["a", "b"]).unwrap();
        assert_eq!((right.word("a"), right.number("b").unwrap()), ("traced", 7));
        assert!(Query::of(None, &[]).is_ok());
        assert!(Query::of(Some(""), &[]).is_ok());
        for wrong in [
            None,
            Some(""),
            Some("a=1"),
            Some("a=1&a=2"),
            Some("a=1&b=2&b=3"),
            Some("a=1&b=2&c=3"),
            Some("a=1&b=2&"),
            Some("a&b=2"),
            Some("a=1&%62=2"),
        ] {
            let refused = Query::of(wrong, &["a", "b"]);
            assert!(
                refused.is_err_and(|r| r.status == 400 && r.words.contains("a=…&b=…")),
                "{wrong:?}"
            );
        }
    }

    #[test]
    fn a_number_is_digits_alone() {
        for wrong in [
            "",
            "-1",
            "+1",
            "1.0",
            "1e3",
            "NaN",
            "inf",
            "0x10",
            "%31",
            " 1",
            "18446744073709551616",
        ] {
            let text = format!("n={wrong}");
            let query = Query::of(Some(&text), &["n"]).unwrap();
            assert!(query.number("n").is_err_and(|r| r.status == 400), "{wrong}");
        }
    }
}
