//! Which photograph is of which spot.

use std::path::{Path, PathBuf};

use super::error::{PhotographError, refused};
use super::pattern::expanded;
use super::plane::{Averaged, Plane};
use super::read::Reader;
use super::set::{FrameTable, Set};
use crate::image::Samples;

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

/// The tables of a set's photographs: those that it has, or those of its CSV file.
///
/// # Errors
/// [`PhotographError`].
pub(super) fn tables(
    set: &Set,
    reader: &mut Reader<'_>,
    folder: &Path,
) -> Result<Vec<FrameTable>, PhotographError> {
    match &set.list {
        None => Ok(set.frame.clone()),
        Some(name) => {
            let bytes = reader.bytes(&folder.join(name))?;
            parsed(name, &String::from_utf8_lossy(&bytes))
        }
    }
}

/// The lines of a CSV file as tables.
fn parsed(name: &str, text: &str) -> Result<Vec<FrameTable>, PhotographError> {
    let mut lines = text
        .lines()
        .enumerate()
        .map(|(k, line)| (k + 1, line.trim()))
        .filter(|(_, line)| !line.is_empty() && !line.starts_with('#'));
    let cells = |line: &str| -> Vec<String> {
        line.split(',')
            .map(|c| c.trim().trim_matches('"').to_owned())
            .collect()
    };
    let (_, head) = lines.next().ok_or_else(|| {
        refused(
            format!("{name} is empty"),
            "give a line of column names first",
        )
    })?;
    let head = cells(head.trim_start_matches('\u{feff}'));
    let known = [
        "file",
        "spot",
        "x",
        "y",
        "z",
        "exposure",
        "gain",
        "gain_error",
    ];
    if let Some(odd) = head.iter().find(|h| !known.contains(&h.as_str())) {
        return Err(refused(
            format!("{name} has a column `{odd}`"),
            format!("name its columns by {}", known.join(", ")),
        ));
    }
    let mut tables = Vec::new();
    for (number, line) in lines {
        let values = cells(line);
        if values.len() != head.len() {
            return Err(refused(
                format!(
                    "line {number} of {name} has {} values for {} columns",
                    values.len(),
                    head.len()
                ),
                "give one value for each column; leave it empty where there is none",
            ));
        }
        let text = |key: &str| {
            let at = head.iter().position(|h| h == key)?;
            Some(values[at].as_str()).filter(|v| !v.is_empty())
        };
        let number_of = |key: &str| -> Result<Option<f64>, PhotographError> {
            let parse = |v: &str| {
                v.parse::<f64>()
                    .ok()
                    .filter(|x| x.is_finite())
                    .ok_or_else(|| {
                        refused(
                            format!("line {number} of {name} has the {key} `{v}`"),
                            "give a number",
                        )
                    })
            };
            text(key).map(parse).transpose()
        };
        let spot = match text("spot") {
            None => None,
            Some(v) => Some(v.parse().map_err(|_| {
                refused(
                    format!("line {number} of {name} has the spot `{v}`"),
                    "give its number, from 0",
                )
            })?),
        };
        let position = match (number_of("x")?, number_of("y")?) {
            (Some(x), Some(y)) => Some(
                [Some(x), Some(y), number_of("z")?]
                    .into_iter()
                    .flatten()
                    .collect(),
            ),
            _ => None,
        };
        tables.push(FrameTable {
            file: text("file")
                .ok_or_else(|| {
                    refused(
                        format!("line {number} of {name} names no file"),
                        "give it in the column `file`",
                    )
                })?
                .to_owned(),
            spot,
            position,
            exposure: number_of("exposure")?,
            gain: number_of("gain")?,
            gain_error: number_of("gain_error")?,
        });
    }
    Ok(tables)
}

/// The positions of spots that the tables name, each once, in order; `None` where they name numbers
/// or nothing.
///
/// # Errors
/// [`PhotographError::Refused`] where only some have one.
pub(super) fn positions(tables: &[FrameTable]) -> Result<Option<Vec<[f64; 2]>>, PhotographError> {
    let with = tables.iter().filter(|t| t.position.is_some()).count();
    if with == 0 {
        return Ok(None);
    }
    if with < tables.len() || tables.iter().any(|t| t.spot.is_some()) {
        return Err(refused(
            "some photographs have a position of their spot and others not, or a number besides",
            "give every photograph a position, or every one a spot's number",
        ));
    }
    let mut places: Vec<[f64; 2]> = Vec::new();
    for table in tables {
        let place = place(table)?;
        if !places.contains(&place) {
            places.push(place);
        }
    }
    Ok(Some(places))
}

/// x and y of a table's position.
fn place(table: &FrameTable) -> Result<[f64; 2], PhotographError> {
    match table.position.as_deref() {
        Some([x, y] | [x, y, _]) if x.is_finite() && y.is_finite() => Ok([*x, *y]),
        _ => Err(refused(
            format!("the position of {} is not x, y or x, y, z", table.file),
            "give two or three numbers",
        )),
    }
}

/// The files of a set in the order of their spots.
///
/// # Errors
/// [`PhotographError::Refused`] for gains without meaning and exposures within a spot that differ.
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
        return Ok(paths.into_iter().map(take).collect());
    }
    let places = positions(tables)?;
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
        if pair[0].spot == pair[1].spot && !(same(|t| t.exposure) && same(|t| Some(t.gain))) {
            return Err(refused(
                format!(
                    "{} and {} are of one spot, with different exposure times or gains",
                    pair[0].path.display(),
                    pair[1].path.display()
                ),
                "import each exposure time by itself",
            ));
        }
    }
    Ok(takes)
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
    refused(cause, "check the scene's spots, `repeats` and the list")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_list_is_read_line_by_line() {
        let text = "file,x,y,exposure,gain,gain_error\n# first\na.png, 0.1, -2,0.5,,\n\"b.png\",3,4,,1.1,0.02\n";
        let tables = parsed("l.csv", text).unwrap();
        assert_eq!(tables[0].position, Some(vec![0.1, -2.0]));
        assert_eq!((tables[0].exposure, tables[0].gain), (Some(0.5), None));
        assert_eq!(
            (tables[1].file.as_str(), tables[1].gain_error),
            ("b.png", Some(0.02))
        );
        assert_eq!(
            positions(&tables).unwrap(),
            Some(vec![[0.1, -2.0], [3.0, 4.0]])
        );
        for (text, words) in [
            ("file,what\n", "column `what`"),
            ("file,x,y\na.png,1\n", "line 2"),
            ("file,spot\na.png,x\n", "spot `x`"),
            ("file,gain\na.png,nan\n", "gain `nan`"),
            ("spot\n3\n", "names no file"),
            ("", "empty"),
        ] {
            let error = parsed("l.csv", text).unwrap_err().to_string();
            assert!(error.contains(words), "{error}");
        }
        let mixed = parsed("l.csv", "file,spot,x,y\na,1,,\nb,,1,2\n").unwrap();
        assert!(positions(&mixed).is_err());
    }

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
}
