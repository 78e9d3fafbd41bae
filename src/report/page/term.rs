//! Words of the field, explained where they stand.

use super::super::svg::escape;

/// Words and what they mean. A word that holds another one stands before it.
const TERMS: [(&str, &str); 24] = [
    (
        "χ²/dof",
        "mean of the squared deviations, each in units of its own standard error: 1 on average where the model is right and its errors are known",
    ),
    (
        "|z|",
        "size of a deviation in units of its standard error, as the standard normal deviate that is as improbable by Student's law of N − 1 degrees of freedom (N blocks or replicates give the error)",
    ),
    (
        "Φcam",
        "the matrix of all photographs: the flux into each pixel (row) for each laser spot (column), in W",
    ),
    (
        "Picard",
        "a plot of signal and noise in each singular direction: directions where the signal has \
         fallen below the noise cannot be recovered",
    ),
    (
        "singular values",
        "how strongly each direction of the unknown picture reaches the photographs; small ones \
         are lost in noise",
    ),
    (
        "MTF raw",
        "modified modulation transfer function, (white − black)/(white + black) over the elements that are white and black in truth, of the values as recovered",
    ),
    (
        "MTF normalized",
        "the same after the recovered values are stretched to 0…1, as the published code does",
    ),
    (
        "MTF",
        "modified modulation transfer function: (white − black)/(white + black) over the elements that are white and black in truth; 1 is perfect, 0 shows nothing",
    ),
    (
        "RMSE",
        "root mean square error of the recovered reflectance against the true one",
    ),
    (
        "joint-unbounded",
        "all pixels and spots at once, least squares without bounds",
    ),
    (
        "joint-gp",
        "all pixels and spots at once, the mean of a Gaussian process: neighbours resemble one another, as in photographs",
    ),
    (
        "joint-two-valued",
        "all pixels and spots at once, reflectances of two values in any pattern",
    ),
    (
        "joint-tv",
        "all pixels and spots at once, reflectances between 0 and 1, few edges (total variation)",
    ),
    (
        "joint",
        "all pixels and spots at once, least squares with reflectances between 0 and 1",
    ),
    (
        "pinv",
        "the published method: the pseudoinverse of G12, pixel by pixel, then the mean over the pixels",
    ),
    (
        "tsvd",
        "truncated singular value decomposition: only the strongest directions are inverted",
    ),
    ("tikhonov", "damped inversion: weak directions count less"),
    (
        "G12",
        "geometry between laser spot and hidden element: cosines over squared distance",
    ),
    (
        "G23",
        "geometry between hidden element and the wall point that a pixel sees",
    ),
    (
        "standard error",
        "the standard deviation of a number that is due to chance alone",
    ),
    (
        "Šidák",
        "limit for the largest of many deviations that keeps the chance of a false alarm at the stated significance for all of them together",
    ),
    (
        "replicates",
        "independent repetitions of the computation, whose spread gives the error bars",
    ),
    (
        "estimator",
        "how light paths are shared between pixels and spots",
    ),
    (
        "étendue",
        "area of the aperture times the solid angle of the pixel: what turns radiance into flux",
    ),
];

/// Text as HTML, the first use of each word of the field with its explanation: on hover, on focus,
/// and to screen readers.
pub(in super::super) fn explained(text: &str) -> String {
    let mut out = String::new();
    let mut rest = text;
    let mut told = Vec::new();
    while !rest.is_empty() {
        let found = TERMS
            .iter()
            .filter(|(word, _)| !told.contains(word))
            .filter_map(|(word, meaning)| Some((alone(rest, word)?, *word, *meaning)))
            .min_by_key(|(at, word, _)| (*at, usize::MAX - word.len()));
        let Some((at, word, meaning)) = found else {
            break;
        };
        out += &escape(&rest[..at]);
        out += &term(word, meaning);
        told.push(word);
        rest = &rest[at + word.len()..];
    }
    out + &escape(rest)
}

/// What a word of the field means.
pub fn meaning(word: &str) -> Option<&'static str> {
    let found = TERMS.iter().find(|(of, _)| *of == word);
    found.map(|(_, meaning)| *meaning)
}

/// A word with its explanation.
pub(in super::super) fn term(word: &str, meaning: &str) -> String {
    format!(
        "<abbr tabindex=\"0\" title=\"{}\">{}</abbr>",
        escape(meaning),
        escape(word)
    )
}

/// Where `word` stands on its own, no letter, digit or hyphen beside it.
fn alone(text: &str, word: &str) -> Option<usize> {
    let joins = |c: char| c.is_alphanumeric() || c == '-';
    text.match_indices(word).map(|(at, _)| at).find(|&at| {
        let before = text[..at].chars().next_back().is_some_and(joins);
        let after = text[at + word.len()..].chars().next().is_some_and(joins);
        !before && !after
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_use_of_a_word_is_explained_and_the_longest_word_wins() {
        let html = explained("MTF raw 0.5 & MTF 0.6, joint-tv; MTF raw again, pinvoke");
        assert_eq!(html.matches("<abbr").count(), 3);
        assert!(html.contains(">MTF raw</abbr> 0.5 &amp; <abbr"));
        assert!(html.contains(">joint-tv</abbr>") && html.ends_with("MTF raw again, pinvoke"));
    }

    #[test]
    fn text_stays_text() {
        assert_eq!(explained("<b> & \"x\""), "&lt;b&gt; &amp; &quot;x&quot;");
    }
}
