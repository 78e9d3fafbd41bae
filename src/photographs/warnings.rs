//! What a user of imported photographs has to know.

use std::collections::BTreeMap;

use super::footprints::Evenness;
use super::left_out::LeftOut;
use super::noise::{FITS, PhotonTransferFit};
use super::placing::Placing;
use super::read::SourceFile;
use super::set::Set;
use crate::matrix::{Matrix, TOO_DARK};
use crate::num::digits::{figure, significant};

/// Part of a standard error from which on what all entries share is told.
const ROUNDED: f64 = 0.5;
/// Errors that are larger by more than this are others than stated.
const SHARED: f64 = 1.1;

/// That most entries are left out, or all.
pub(super) fn little_left(found: &LeftOut) -> Option<String> {
    let reasons = found.reasons().into_iter().filter(|(_, count)| *count > 0);
    let reasons: Vec<String> = reasons.map(|(why, n)| format!("{n} {why}")).collect();
    let nothing = if found.left_out == found.entries {
        ", so that nothing can be recovered"
    } else {
        ""
    };
    (2 * found.left_out > found.entries).then(|| {
        format!(
            "{} of {} entries are left out ({}){nothing}: check `saturation`, `full_scale`, `dead`, `flat`, `halo` and `crop`",
            found.left_out,
            found.entries,
            reasons.join(", ")
        )
    })
}

/// That the light adds up to nothing, but for rounding, or to less.
pub(super) fn no_light(phi: &Matrix) -> Option<String> {
    let all: f64 = phi.iter().map(|x| x.abs()).sum();
    (phi.sum() <= 1e-9 * all).then(|| {
        "the light of all photographs adds up to nothing, or less: check the dark frames, and whether the response fits".to_owned()
    })
}

/// That light comes out too dark by so many standard errors.
pub(super) fn by_own_light(errors: f64) -> Option<String> {
    (errors > TOO_DARK).then(|| {
        format!(
            "photographs of fewer than 8 pixels or spots do not tell what light to expect: standard errors are \
             those of the light measured, and where entries are weighted by them the whole is too dark by {} \
             of its standard errors; take more light",
            figure(errors, 2)
        )
    })
}

/// That all pixels of the dark frames are rounded alike, which moves entries by so many of their
/// standard errors.
pub(super) fn rounded(errors: f64) -> Option<String> {
    (errors > ROUNDED).then(|| {
        format!(
            "the dark frames' noise is too small to move their values from one integer to the next, so that all \
             pixels are rounded alike: every entry may be off by {} of its standard errors, all the same way, and \
             more dark frames do not help. Save more bits, raise the camera's gain, or recover with --background",
            figure(errors, 2)
        )
    })
}

/// That footprints share pixels of the photograph, so that the errors of what they show together
/// are larger than stated.
pub(super) fn shared(times: f64) -> Option<String> {
    (times > SHARED).then(|| {
        format!(
            "the photograph has few pixels for each of the scene's, and those beside each other share them: errors \
             of what they show together are {} times as large as stated, and light that varies within a pixel of \
             the photograph is taken as linear there; give the scene fewer `camera.pixels`, or finer photographs",
            significant(times, 3)
        )
    })
}

/// That these shares of the stored values of photographs and of dark frames are 0.
pub(super) fn cut_off(photographs: f64, darks: f64) -> Vec<String> {
    let of = [
        (
            photographs,
            "stored values",
            "dark pixels are too bright on average",
        ),
        (
            darks,
            "dark frames' stored values",
            "the dark frames are too bright on average and every entry too dark, which no standard error holds",
        ),
    ];
    let told = of.into_iter().filter(|(share, ..)| *share > 0.0);
    let words = |(share, which, so): (f64, &str, &str)| {
        format!(
            "{} % of the {which} are 0: what would be below is cut off, so that {so}; raise the camera's offset",
            figure(100.0 * share, 2)
        )
    };
    told.map(words).collect()
}

/// That dark frames or flat fields are grey, of photographs in colour.
pub(super) fn colourless(names: &[String]) -> Option<String> {
    let first = names.first()?;
    let more = match names.len() {
        1 => String::new(),
        n => format!(" and {} others", n - 1),
    };
    Some(format!(
        "dark frames or flat fields are grey and the photographs in colour ({first}{more}): the camera's channels \
         may differ in dark level or falloff, and what these hold is taken for every channel alike, which no \
         standard error holds; give them in colour"
    ))
}

/// That files of different photographs are the same to the byte.
pub(super) fn copied<'a>(takes: impl Iterator<Item = &'a SourceFile>) -> Option<String> {
    let mut first: BTreeMap<&str, &str> = BTreeMap::new();
    let mut same = Vec::new();
    for file in takes {
        match first.get(file.sha256.as_str()) {
            Some(earlier) if *earlier == file.name => {}
            Some(earlier) => same.push(format!("{} as {earlier}", file.name)),
            None => {
                first.insert(&file.sha256, &file.name);
            }
        }
    }
    let example = same.first()?;
    Some(format!(
        "{} photographs are the same files as others ({example}), which noise never makes them: one was copied in \
         place of another, and its spot or its repeats tell nothing",
        same.len()
    ))
}

/// That gains are known roughly, `most` of themselves at the most.
pub(super) fn roughly(most: f64) -> String {
    format!(
        "gains are known to {} %, an error that all pixels of a photograph share: the standard errors leave it \
         out, and recover, validate and calibrate take it as --frame-gain {most}; locate and methods that \
         work pixel by pixel do not",
        figure(100.0 * most, 2)
    )
}

/// What the settings leave unsaid.
pub(super) fn unsaid(set: &Set, placing: &Placing) -> Vec<String> {
    let checked = placing
        .fitted
        .as_ref()
        .is_none_or(|f| f.mark_error.is_some());
    let even = placing.evenness == Evenness::Even && set.flat.is_none();
    let all = [
        (
            set.dark.is_none(),
            "no dark frames: the camera's offset and other light stay in every entry; give `dark`, or recover with --background",
        ),
        (
            set.flat.is_some() && set.flat_dark.is_none(),
            "the flat field has no dark frames of its own (`flat_dark`): its offset stays in it",
        ),
        (
            even,
            "neither a flat field nor a camera matrix says how the photograph falls off to its corners: it is taken as even",
        ),
        (
            !checked,
            "four marks leave nothing to check the mapping by; give more",
        ),
        (
            set.watts.is_some() && placing.fitted.is_some() && set.camera.is_none(),
            "without a camera matrix nothing tells where the axis is, and `watts` is taken to hold on average over the view: right where the axis goes through its middle; give `camera`",
        ),
        (
            set.watts.is_none(),
            "no factor to watts is known (`watts`): fluxes have an arbitrary unit; recover with --free-scale",
        ),
    ];
    let said = all.into_iter().filter(|(holds, _)| *holds);
    said.map(|(_, words)| words.to_owned()).collect()
}

/// That photographs of one spot differ as wholes: one of them by `own`, their means by `of_mean`.
pub(super) fn flickers([own, of_mean]: [f64; 2]) -> String {
    format!(
        "photographs of one spot differ as wholes by {} % more than the noise of their pixels (the laser flickers, or \
         the dark level drifts): their mean has an error of {} % that all its pixels share, and no standard error \
         holds it; give recover, validate and calibrate --frame-gain {}",
        figure(100.0 * own, 2),
        figure(100.0 * of_mean, 2),
        significant(of_mean, 2)
    )
}

/// That repeats tell the variances of the entries to no more than `unknown`, relative, squared.
pub(super) fn extrapolated(unknown: f64) -> String {
    let known = if unknown.is_finite() {
        format!("to {} % of itself only", figure(100.0 * unknown.sqrt(), 2))
    } else {
        "not at all".to_owned()
    };
    format!(
        "so few repeats, or repeats of so little different light, tell the variance of the other entries {known}: there is NO standard error; take two photographs of every spot, or dark frames, or give `noise`"
    )
}

/// That repeats scatter by `ratio` times the variance that is stated.
pub(super) fn misstated(ratio: f64) -> String {
    let (times, which) = if ratio > 1.0 {
        (ratio.sqrt(), "small")
    } else {
        (ratio.sqrt().recip(), "large")
    };
    format!(
        "repeats of one photograph scatter by {} times the variance that `noise` states: the standard errors are {} times too {which}. `gain` is in counts per electron, the variance of the light over the light, and `read_noise` in counts; leave `noise` out to find both from the repeats",
        figure(ratio, 2),
        figure(times, 2)
    )
}

/// That the variance of repeats is no line; `differ` says that not all photographs have the same.
pub(super) fn bent(line: &PhotonTransferFit, differ: Option<&str>) -> Option<String> {
    let why = match differ {
        Some(why) => why,
        None if line.noise.has_offset => "without dark frames it is not told why; give `dark`",
        None => "the laser flickers, or the response is not linear",
    };
    (line.p < FITS).then(|| {
        format!(
            "the variance of repeated photographs is no line over their light (probability {:.1e}, off by up to {:.0} %): {why}; the standard errors are those of the line",
            line.p,
            100.0 * line.largest_deviation
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A file that stands twice under two names is told, and one that is read twice is not.
    #[test]
    fn a_copied_photograph_is_told() {
        let file = |name: &str, sha256: &str| SourceFile {
            name: name.to_owned(),
            bytes: 3,
            sha256: sha256.to_owned(),
        };
        let [a, b, c] = [file("1.png", "x"), file("2.png", "y"), file("3.png", "x")];
        assert_eq!(copied([&a, &b, &a].into_iter()), None);
        let words = copied([&a, &b, &c].into_iter()).unwrap();
        assert!(words.contains("3.png as 1.png"), "{words}");
    }
}
