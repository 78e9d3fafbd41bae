//! The dead pixels of a camera.

use std::path::Path;

use super::error::{PhotographError, refused};
use super::read::Reader;
use super::set::{DeadTable, Set};

/// Which pixels of photographs of a size, columns and rows, do not count, as the set says.
pub(super) fn dead_pixels(
    set: &Set,
    [width, height]: [usize; 2],
    folder: &Path,
    reader: &mut Reader<'_>,
) -> Result<Vec<bool>, PhotographError> {
    let mut dead = vec![false; width * height];
    match &set.dead {
        None => {}
        Some(DeadTable::Pixels(pixels)) => {
            for [u, v] in pixels {
                if *u >= width || *v >= height {
                    return Err(refused(
                        format!(
                            "the dead pixel ({u}, {v}) is not in a photograph of {width} × {height}"
                        ),
                        "give column and row from (0, 0), the upper left one",
                    ));
                }
                dead[u + v * width] = true;
            }
        }
        Some(DeadTable::Picture(name)) => {
            let found = reader.photographs(&folder.join(name))?;
            let found = found
                .first()
                .filter(|s| [s.width, s.height] == [width, height]);
            let found = found.ok_or_else(|| {
                refused(
                    format!("{name} is not of {width} × {height} pixels"),
                    "give a picture of dead pixels of the photographs' size",
                )
            })?;
            for (dead, pixel) in dead
                .iter_mut()
                .zip(found.values.chunks(found.channels.len()))
            {
                *dead = pixel.iter().any(|x| *x != 0.0);
            }
        }
    }
    Ok(dead)
}
