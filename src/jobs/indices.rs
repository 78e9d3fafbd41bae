//! Indices in the array syntax of the schedulers: `1,3-5`.

use std::collections::BTreeSet;
use std::fmt::Write as _;

/// The indices in growing order, neighbours joined to `first-last`; an empty text for no index.
pub fn array_syntax(indices: &BTreeSet<usize>) -> String {
    let mut text = String::new();
    let mut rest = indices.iter().copied().peekable();
    while let Some(first) = rest.next() {
        let mut last = first;
        while let Some(next) = rest.next_if(|&i| i == last + 1) {
            last = next;
        }
        let comma = if text.is_empty() { "" } else { "," };
        let _ = if first == last {
            write!(text, "{comma}{first}")
        } else {
            write!(text, "{comma}{first}-{last}")
        };
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// What a scheduler makes of the text.
    fn read(text: &str) -> Vec<usize> {
        let number = |s: &str| s.parse::<usize>().unwrap();
        let parts = text.split(',').filter(|part| !part.is_empty());
        parts
            .flat_map(|part| match part.split_once('-') {
                None => number(part)..=number(part),
                Some((a, b)) => number(a)..=number(b),
            })
            .collect()
    }

    #[test]
    fn runs_are_joined() {
        let text = |indices: &[usize]| array_syntax(&indices.iter().copied().collect());
        assert_eq!(text(&[]), "");
        assert_eq!(text(&[0]), "0");
        assert_eq!(text(&[1, 3, 4, 5]), "1,3-5");
        assert_eq!(text(&[7, 0, 1, 9, 2]), "0-2,7,9");
    }

    proptest! {
        #[test]
        fn a_scheduler_reads_the_same_indices(indices in prop::collection::btree_set(0_usize..60, 0..40)) {
            let text = array_syntax(&indices);
            prop_assert_eq!(read(&text), indices.iter().copied().collect::<Vec<_>>());
            // As short as can be: one part for each run.
            let runs = indices.iter().filter(|&&i| i == 0 || !indices.contains(&(i - 1))).count();
            prop_assert_eq!(text.split(',').filter(|p| !p.is_empty()).count(), runs);
        }
    }
}
