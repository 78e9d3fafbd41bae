//! Terms that the commands print, explained in their long help.

use crate::report;

/// Terms that the reports do not explain themselves.
const TERMS: [(&str, &str); 8] = [
    (
        "traced",
        "Φcam as the path tracer finds it, without knowing the matrix model; with random errors, which are stated",
    ),
    (
        "modelled",
        "Φcam as the matrix model computes it: by quadrature, without random errors",
    ),
    (
        "entry",
        "one number of Φcam: one pixel under one laser spot",
    ),
    (
        "z",
        "traced minus modelled flux of an entry in units of its standard error, t, as the standard normal deviate that is as improbable: t follows Student's law of N − 1 degrees of freedom where the error is that of N blocks or replicates",
    ),
    (
        "degrees of freedom",
        "number of independent deviations that χ² sums: the entries that count, less what they share or what was fitted",
    ),
    (
        "by centres",
        "elements, pixels and spots are replaced by their centres, as the published model does; quadrature integrates over their areas",
    ),
    (
        "best scale",
        "the one factor on the modelled Φcam that brings it nearest to the traced one: 1 where both have the same absolute scale",
    ),
    (
        "determined",
        "share of an element's reflectance that the photographs tell at their noise, 0 to 1",
    ),
];

/// The paragraph that explains `words`.
pub(super) fn explained(words: &[&str]) -> String {
    let meaning = |word: &str| {
        let own = TERMS
            .iter()
            .find(|(of, _)| *of == word)
            .map(|(_, meaning)| *meaning);
        own.or_else(|| report::meaning(word)).unwrap_or_default()
    };
    let lines = words
        .iter()
        .map(|word| format!("\n  {word}: {}", meaning(word)));
    format!("Terms:{}", lines.collect::<String>())
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::super::Args;

    /// A term without an explanation would end its line.
    #[test]
    fn every_term_of_the_long_help_is_explained() {
        let mut root = Args::command();
        for name in ["run", "validate", "recover", "model"] {
            let command = root.find_subcommand_mut(name).unwrap();
            let help = command.render_long_help().to_string();
            let (_, terms) = help.split_once("Terms:\n").unwrap();
            assert!(terms.lines().count() > 3, "{name}");
            for line in terms.lines().filter(|line| !line.is_empty()) {
                assert!(!line.trim_end().ends_with(':'), "{name}: {line}");
            }
        }
    }
}
