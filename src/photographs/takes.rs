//! Which photograph is of which spot.

use std::path::{Path, PathBuf};

use super::error::{PhotographError, refused};
use super::list::{place, positions};
use super::pattern::expanded;
use super::plane::{Averaged, Plane};
use super::read::Reader;
use super::set::{FrameTable, Set};
use crate::image::Samples;
use crate::num::repetition::first_repeated;

/// A file of photographs of one spot, or of spots in order.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Take {
    pub path: PathBuf,
    /// The spot, where the list says it.
    pub spot: Option<usize>,
    /// Seconds, if known.
    pub exposure: Option<f64>,
    /// The photograph is divided by it.
    pub gain: f64,
    /// Its standard error.
    pub gain_error: f64,
}

/// The files of a set in the order of their spots.
///
/// # Errors
/// [`PhotographError::Refused`] for gains without meaning, for gains and exposures within a spot
/// that differ, and where only some photographs have a spot's number.
pub(super) fn takes(
    set: &Set,
    tables: &[FrameTable],
    folder: &Path,
) -> Result<Vec<Take>, PhotographError> {
    if let Some(files) = &set.frames {
        let paths = expanded(folder, files)?;
        let take = |path| Take {
            path,
            spot: None,
            exposure: set.exposure,
            gain: 1.0,
            gain_error: 0.0,
        };
        return once(paths.into_iter().map(take).collect());
    }
    let places = positions(tables)?;
    let numbered = tables.iter().filter(|t| t.spot.is_some()).count();
    if places.is_none() && numbered != 0 && numbered != tables.len() {
        let without = tables.iter().find(|t| t.spot.is_none());
        let file = without.map_or("", |t| &t.file);
        return Err(refused(
            format!("{file} has no number of its spot, and other photographs have one"),
            "give every photograph the number of its spot, or none (they are then in the spots' order)",
        ));
    }
    let mut takes = Vec::with_capacity(tables.len());
    for (k, table) in tables.iter().enumerate() {
        let spot = match (&places, table.spot) {
            (Some(places), _) => {
                let own = place(table)?;
                places.iter().position(|p| *p == own)
            }
            (None, Some(spot)) => Some(spot),
            (None, None) => Some(k),
        };
        let (gain, gain_error) = (table.gain.unwrap_or(1.0), table.gain_error.unwrap_or(0.0));
        if !(gain > 0.0 && gain.is_finite() && gain_error >= 0.0 && gain_error.is_finite()) {
            return Err(refused(
                format!(
                    "the gain {gain} ± {gain_error} of {} has no meaning",
                    table.file
                ),
                "use a gain above 0 and an error of 0 or more",
            ));
        }
        takes.push(Take {
            path: folder.join(&table.file),
            spot,
            exposure: table.exposure.or(set.exposure),
            gain,
            gain_error,
        });
    }
    takes.sort_by_key(|t| t.spot);
    for pair in takes.windows(2) {
        let same = |f: fn(&Take) -> Option<f64>| f(&pair[0]) == f(&pair[1]);
        let fits = same(|t| t.exposure) && same(|t| Some(t.gain)) && same(|t| Some(t.gain_error));
        if pair[0].spot == pair[1].spot && !fits {
            return Err(refused(
                format!(
                    "{} and {} are of one spot, with different exposure times, gains or errors of the gain",
                    pair[0].path.display(),
                    pair[1].path.display()
                ),
                "give them the same `gain` and `gain_error`, and import each exposure time by itself",
            ));
        }
    }
    once(takes)
}

/// Refuses a file that is named twice: its noise would count as that of two photographs, or two
/// spots would have one.
fn once(takes: Vec<Take>) -> Result<Vec<Take>, PhotographError> {
    match first_repeated(takes.iter().map(|take| &take.path)) {
        None => Ok(takes),
        Some(twice) => Err(refused(
            format!("{} is named twice", twice.display()),
            "name every photograph once",
        )),
    }
}

/// Refuses dark frames of no stated exposure time for photographs of several: dark current grows
/// with it.
///
/// # Errors
/// [`PhotographError::Refused`].
pub(super) fn one_exposure(takes: &[Take]) -> Result<(), PhotographError> {
    let first = takes.first().and_then(|t| t.exposure);
    let Some(other) = takes.iter().find(|t| t.exposure != first) else {
        return Ok(());
    };
    let named = |t: Option<f64>| t.map_or("none known".to_owned(), |t| format!("{t} s"));
    Err(refused(
        format!(
            "the photographs have several exposure times ({}, {}), and nothing says of which the dark frames are",
            named(first),
            named(other.exposure)
        ),
        "give `dark = [{ files, exposure }, ...]`, one for each exposure time",
    ))
}

/// Calls `visit` with the averaged photographs of each spot, in the order of the spots.
///
/// # Errors
/// [`PhotographError`] where a file cannot be read, and where photographs and `spots` do not fit.
pub(super) fn each_spot(
    reader: &mut Reader<'_>,
    (takes, repeats): (&[Take], usize),
    spots: usize,
    plane: &dyn Fn(&str, &Samples) -> Result<Plane, PhotographError>,
    mut visit: impl FnMut(usize, &Take, Averaged) -> Result<(), PhotographError>,
) -> Result<(), PhotographError> {
    let mut sum: Option<(usize, &Take, Averaged)> = None;
    let mut count = 0;
    for take in takes {
        let name = reader.name(&take.path);
        for samples in reader.photographs(&take.path)? {
            let spot = take.spot.unwrap_or(count / repeats);
            count += 1;
            if spot >= spots {
                return Err(too_many(&name, take.spot, spots));
            }
            let next = plane(&name, &samples)?;
            sum = match sum.take() {
                Some((of, first, mut mean)) if of == spot => {
                    mean.add(&name, &next)?;
                    Some((of, first, mean))
                }
                Some((of, first, mean)) => {
                    visit(of, first, mean)?;
                    Some((spot, take, Averaged::of(next)))
                }
                None => Some((spot, take, Averaged::of(next))),
            };
        }
    }
    let is_pattern = takes.iter().any(|t| t.spot.is_none());
    if is_pattern && count != spots * repeats {
        return Err(refused(
            format!("there are {count} photographs for {spots} spots with {repeats} each"),
            "give all of them, set `repeats`, or say in a list which spot each is of ([[frame]])",
        ));
    }
    match sum {
        Some((spot, take, mean)) => visit(spot, take, mean),
        None => Err(refused("there are no photographs", "name one or more")),
    }
}

fn too_many(name: &str, spot: Option<usize>, spots: usize) -> PhotographError {
    let cause = match spot {
        Some(spot) => {
            format!("{name} is of spot {spot}, and the scene has {spots} spots, numbered from 0")
        }
        None => format!("{name} comes after the photographs of all {spots} spots of the scene"),
    };
    refused(
        cause,
        "check the scene's spots, `repeats` and the list; each page of a file is a photograph",
    )
}

#[cfg(test)]
mod tests {
    use super::super::list::parsed;
    use super::*;

    #[test]
    fn photographs_of_a_spot_come_together_and_fit() {
        let tables = parsed("l", "file,spot,exposure,gain\na,2,1,\nb,0,1,\nc,2,1,\n").unwrap();
        let found = takes(&Set::default(), &tables, Path::new("d")).unwrap();
        let spots: Vec<_> = found.iter().map(|t| t.spot.unwrap()).collect();
        assert_eq!(spots, [0, 2, 2]);
        let tables = parsed("l", "file,spot,exposure\na,2,1\nc,2,2\n").unwrap();
        let error = takes(&Set::default(), &tables, Path::new("d")).unwrap_err();
        assert!(error.to_string().contains("different exposure"));
        let tables = parsed("l", "file,gain\na,0\n").unwrap();
        assert!(takes(&Set::default(), &tables, Path::new("d")).is_err());
    }

    #[test]
    fn no_spot_is_guessed_from_a_list_that_lacks_some() {
        let of = |text| takes(&Set::default(), &parsed("l", text).unwrap(), Path::new("d"));
        let error = of("file,spot\na,1\nb,\nc,0\n").unwrap_err().to_string();
        assert!(error.contains("b has no number of its spot"), "{error}");
        // Without any number, the order is that of the spots.
        let spots: Vec<_> = of("file\na\nb\n").unwrap();
        assert_eq!([spots[0].spot, spots[1].spot], [Some(0), Some(1)]);
        let error = of("file,spot,gain,gain_error\na,0,2,0.1\nb,0,2,0.2\n").unwrap_err();
        assert!(error.to_string().contains("errors of the gain"), "{error}");
    }

    #[test]
    fn dark_frames_of_one_time_do_not_serve_several() {
        let of = |text| takes(&Set::default(), &parsed("l", text).unwrap(), Path::new("d"));
        assert!(one_exposure(&of("file,exposure\na,2\nb,2\n").unwrap()).is_ok());
        assert!(one_exposure(&of("file\na\nb\n").unwrap()).is_ok());
        let several = of("file,exposure\na,2\nb,0.5\n").unwrap();
        let error = one_exposure(&several).unwrap_err().to_string();
        assert!(
            error.contains("2 s, 0.5 s") && error.contains("dark = [{"),
            "{error}"
        );
    }
}
