//! The tables of photographs, in a set or a CSV file.

use std::path::Path;

use super::error::{PhotographError, refused};
use super::read::Reader;
use super::set::{FrameTable, Set};
use crate::num::repetition::first_repeated;

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

/// The lines of a CSV file as tables. Columns are separated by commas, or, where the line of their
/// names has none, by semicolons or tabs: numbers may then have a decimal comma.
pub(super) fn parsed(name: &str, text: &str) -> Result<Vec<FrameTable>, PhotographError> {
    let mut lines = text
        .lines()
        .enumerate()
        .map(|(k, line)| (k + 1, line.trim()))
        .filter(|(_, line)| !line.is_empty() && !line.starts_with('#'));
    let (_, head) = lines.next().ok_or_else(|| {
        refused(
            format!("{name} is empty"),
            "give a line of column names first",
        )
    })?;
    let head = head.trim_start_matches('\u{feff}');
    let others = [';', '\t'].into_iter().filter(|c| head.contains(*c));
    let mut others = others.filter(|_| !head.contains(','));
    let between = others.next().unwrap_or(',');
    let cells = |line: &str| -> Vec<String> {
        line.split(between)
            .map(|c| c.trim().trim_matches('"').to_owned())
            .collect()
    };
    let head = cells(head);
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
    if let Some(twice) = first_repeated(&head) {
        return Err(refused(
            format!("{name} has two columns `{twice}`"),
            "name every column once, and remove the one that does not count",
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
                "give one value for each column, empty where there is none; numbers have a point, and a comma ends a value",
            ));
        }
        let text = |key: &str| {
            let at = head.iter().position(|h| h == key)?;
            Some(values[at].as_str()).filter(|v| !v.is_empty())
        };
        let number_of = |key: &str| -> Result<Option<f64>, PhotographError> {
            let parse = |v: &str| {
                let point = v.replace(',', ".");
                point
                    .parse::<f64>()
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
        let position = match [number_of("x")?, number_of("y")?, number_of("z")?] {
            [None, None, None] => None,
            [Some(x), Some(y), z] => Some([Some(x), Some(y), z].into_iter().flatten().collect()),
            _ => {
                return Err(refused(
                    format!("line {number} of {name} has a position without its x or its y"),
                    "give both x and y, or neither",
                ));
            }
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
pub(super) fn place(table: &FrameTable) -> Result<[f64; 2], PhotographError> {
    match table.position.as_deref() {
        Some([x, y] | [x, y, _]) if x.is_finite() && y.is_finite() => Ok([*x, *y]),
        _ => Err(refused(
            format!("the position of {} is not x, y or x, y, z", table.file),
            "give two or three numbers",
        )),
    }
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
            ("file,spot,spot\na.png,1,2\n", "two columns `spot`"),
            ("file,gain\na.png,nan\n", "gain `nan`"),
            ("file,x,y\na.png,1,2\nb.png,1,\n", "line 3"),
            ("file,y\na.png,1\n", "without its x"),
            ("file,x,y,z\na.png,,,1\n", "without its x"),
            ("spot\n3\n", "names no file"),
            ("", "empty"),
        ] {
            let error = parsed("l.csv", text).unwrap_err().to_string();
            assert!(error.contains(words), "{error}");
        }
        for text in [
            "file;x;y;exposure\na.png;0,1;-2;0.5\n",
            "\u{feff}file\tx\ty\texposure\r\na.png\t0.1\t-2\t0,5\r\n",
        ] {
            let tables = parsed("l.csv", text).unwrap();
            let [own] = &tables[..] else {
                panic!("{tables:?}")
            };
            assert_eq!(
                (own.position.as_deref(), own.exposure),
                (Some(&[0.1, -2.0][..]), Some(0.5))
            );
        }
        for text in ["file;x;y\na.png;1.000,5;2\n", "file;x,y\na.png;1,2\n"] {
            assert!(parsed("l.csv", text).is_err(), "{text}");
        }
        let mixed = parsed("l.csv", "file,spot,x,y\na,1,,\nb,,1,2\n").unwrap();
        assert!(positions(&mixed).is_err());
    }
}
