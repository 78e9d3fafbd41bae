//! Photographs from files of any kind, with what they were read from.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::error::{PhotographError, refused};
use super::set::Axes;
use crate::image::{Channel, Samples, samples};
use crate::matrix::{Array, mat, npy};
use crate::store::{self, hex};

/// Most bytes of a file.
const MOST_BYTES: u64 = 1 << 31;

/// A file as it was read.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize, Serialize)]
pub struct SourceFile {
    /// As the list names it.
    pub name: String,
    /// Its length.
    pub bytes: u64,
    /// Its SHA-256, hex.
    pub sha256: String,
}

/// Reads the files of a set, and remembers what they were.
#[derive(Debug)]
pub(super) struct Reader<'a> {
    folder: &'a Path,
    variable: Option<&'a str>,
    axes: Option<Axes>,
    sources: BTreeMap<PathBuf, SourceFile>,
    /// Whether one was compressed with loss.
    pub is_lossy: bool,
}

impl<'a> Reader<'a> {
    /// Of the files in `folder`.
    pub(super) fn new(folder: &'a Path, variable: Option<&'a str>, axes: Option<Axes>) -> Self {
        Self {
            folder,
            variable,
            axes,
            sources: BTreeMap::new(),
            is_lossy: false,
        }
    }

    /// The name of a file as the set has it.
    pub(super) fn name(&self, path: &Path) -> String {
        let inside = path.strip_prefix(self.folder).unwrap_or(path);
        inside.to_string_lossy().into_owned()
    }

    /// The bytes of a file, which has to be the same at each reading.
    pub(super) fn bytes(&mut self, path: &Path) -> Result<Vec<u8>, PhotographError> {
        let bytes = store::read(path, MOST_BYTES)?;
        let found = SourceFile {
            name: self.name(path),
            bytes: bytes.len() as u64,
            sha256: hex(&Sha256::digest(&bytes)),
        };
        match self.sources.get(path) {
            Some(earlier) if *earlier != found => Err(refused(
                format!("{} was changed while it was read", path.display()),
                "import again once it is whole",
            )),
            _ => {
                self.sources.insert(path.to_owned(), found);
                Ok(bytes)
            }
        }
    }

    /// The photographs in a file, in order.
    pub(super) fn photographs(&mut self, path: &Path) -> Result<Vec<Samples>, PhotographError> {
        let bytes = self.bytes(path)?;
        let name = self.name(path);
        let found = match &bytes[..] {
            [0x93, b'N', b'U', b'M', b'P', b'Y', ..] => {
                of_array(&name, npy::read_array(&name, &bytes)?, self.axes, false)?
            }
            [b'M', b'A', b'T', b'L', b'A', b'B', ..] => of_array(
                &name,
                mat::read(&name, &bytes, self.variable)?,
                self.axes,
                true,
            )?,
            _ => samples(&name, &bytes)?,
        };
        self.is_lossy |= found.iter().any(|s| s.is_lossy);
        Ok(found)
    }

    /// The files that were read, by name.
    pub(super) fn sources(self) -> Vec<SourceFile> {
        self.sources.into_values().collect()
    }
}

/// The photographs in an array of `matlab` or NumPy: (rows, columns); (rows, columns, 3) in colour;
/// (frames, rows, columns) of NumPy and (rows, columns, frames) of MATLAB; (frames, rows, columns, 3).
fn of_array(
    name: &str,
    array: Array,
    axes: Option<Axes>,
    matlab: bool,
) -> Result<Vec<Samples>, PhotographError> {
    let Array {
        shape,
        values,
        full_scale,
    } = array;
    let unclear = || {
        refused(
            format!("{name} has the shape {shape:?}, which does not say what is what"),
            "say `axes`: frames-rows-columns, rows-columns-frames or rows-columns-channels",
        )
    };
    let axes = match (shape.len(), axes) {
        (3, Some(axes)) => axes,
        (3, None) if shape[0] == 3 && shape[2] == 3 => return Err(unclear()),
        (3, None) if shape[2] == 3 => Axes::RowsColumnsChannels,
        (3, None) if matlab => Axes::RowsColumnsFrames,
        _ => Axes::FramesRowsColumns,
    };
    let [frames, rows, columns, channels] = match (&shape[..], axes) {
        ([rows, columns], _) => [1, *rows, *columns, 1],
        ([rows, columns, 3], Axes::RowsColumnsChannels) => [1, *rows, *columns, 3],
        ([frames, rows, columns], Axes::FramesRowsColumns)
        | ([rows, columns, frames], Axes::RowsColumnsFrames) => [*frames, *rows, *columns, 1],
        ([frames, rows, columns, 3], _) => [*frames, *rows, *columns, 3],
        _ => return Err(unclear()),
    };
    let each = rows * columns * channels;
    let frame = |k: usize| Samples {
        width: columns,
        height: rows,
        channels: match channels {
            1 => vec![Channel::Grey],
            _ => vec![Channel::Red, Channel::Green, Channel::Blue],
        },
        values: match axes {
            Axes::RowsColumnsFrames => values.iter().skip(k).step_by(frames).copied().collect(),
            _ => values[k * each..(k + 1) * each].to_vec(),
        },
        full_scale,
        is_lossy: false,
    };
    Ok((0..frames).map(frame).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn array(shape: &[usize]) -> Array {
        let count: usize = shape.iter().product();
        Array {
            shape: shape.to_vec(),
            values: (0..count).map(|k| k as f64).collect(),
            full_scale: None,
        }
    }

    #[test]
    fn the_shape_of_an_array_says_what_its_indices_are() {
        let of = |shape: &[usize], axes, matlab| of_array("a", array(shape), axes, matlab);
        let frames = of(&[2, 4, 5], None, false).unwrap();
        assert_eq!(
            (frames.len(), frames[1].height, frames[1].values[0]),
            (2, 4, 20.0)
        );
        let frames = of(&[4, 5, 2], None, true).unwrap();
        assert_eq!((frames.len(), frames[1].width), (2, 5));
        assert_eq!(frames[1].values[..3], [1.0, 3.0, 5.0]);
        let colour = of(&[4, 5, 3], None, false).unwrap();
        assert_eq!((colour.len(), colour[0].channels.len()), (1, 3));
        let stack = of(&[4, 5, 3], Some(Axes::RowsColumnsFrames), false).unwrap();
        assert_eq!(stack.len(), 3);
        assert_eq!(of(&[2, 4, 5, 3], None, false).unwrap()[1].values[0], 60.0);
        assert!(
            of(&[3, 5, 3], None, false)
                .unwrap_err()
                .to_string()
                .contains("axes")
        );
        assert!(of(&[3], None, false).is_err() && of(&[1, 2, 3, 4, 5], None, false).is_err());
    }
}
