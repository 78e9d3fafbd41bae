//! Photographs from files of any kind, with what they were read from.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::error::{PhotographError, refused};
use super::set::Axes;
use crate::image::{Channel, ImageError, Samples, samples};
use crate::matrix::{Array, mat, npy};
use crate::store::{self, digest_of};

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
    /// The first that says that its values are not linear in the light, and its γ.
    pub encoded: Option<(String, f64)>,
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
            encoded: None,
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
            sha256: digest_of(&bytes),
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
            _ => samples(&name, &bytes).map_err(|e| match e {
                ImageError::Unknown(_) => refused(
                    format!(
                        "{name} is no PNG, JPEG, OpenEXR, TIFF, NPY or MAT file by its first bytes"
                    ),
                    "save it as one of them (NPY: numpy.save; MAT: `save -v7` in MATLAB or Octave)",
                ),
                other => other.into(),
            })?,
        };
        self.is_lossy |= found.iter().any(|s| s.is_lossy);
        let gamma = found.iter().find_map(|s| s.gamma);
        self.encoded = (self.encoded.take()).or_else(|| Some((name, gamma?)));
        Ok(found)
    }

    /// A file that was read.
    pub(super) fn source(&self, path: &Path) -> Option<&SourceFile> {
        self.sources.get(path)
    }

    /// The files that were read, by name.
    pub(super) fn sources(self) -> Vec<SourceFile> {
        self.sources.into_values().collect()
    }
}

/// The photographs in an array of `matlab` or NumPy: (rows, columns); (rows, columns, 3) in colour;
/// (frames, rows, columns) of NumPy and (rows, columns, frames) of MATLAB; in colour (frames, rows,
/// columns, 3), and of MATLAB (rows, columns, 3, frames) too. Where two of these fit, `axes` has to
/// say which.
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
        let cure = match shape.len() {
            3 => {
                "say `axes`: frames-rows-columns, rows-columns-frames or rows-columns-channels (3 channels)"
            }
            4 => {
                "say `axes`: frames-rows-columns-channels or rows-columns-channels-frames (3 channels)"
            }
            _ => "save an array of two, three or four dimensions",
        };
        let known = if axes.is_some() {
            "the given `axes` do not fit"
        } else {
            "which does not say what is what"
        };
        refused(format!("{name} has the shape {shape:?}, {known}"), cure)
    };
    let axes = match (&shape[..], axes) {
        (_, Some(axes)) => axes,
        ([3, _, 3], None) => return Err(unclear()),
        ([_, _, 3], None) => Axes::RowsColumnsChannels,
        ([_, _, _], None) if matlab => Axes::RowsColumnsFrames,
        ([_, _, 3, 3], None) if matlab => return Err(unclear()),
        ([_, _, 3, _], None) if matlab => Axes::RowsColumnsChannelsFrames,
        ([_, _, _, _], None) => Axes::FramesRowsColumnsChannels,
        _ => Axes::FramesRowsColumns,
    };
    let [frames, rows, columns, channels] = match (&shape[..], axes) {
        ([rows, columns], _) => [1, *rows, *columns, 1],
        // One of a stack in colour: MATLAB drops a last dimension of 1.
        (
            [rows, columns, 3],
            Axes::RowsColumnsChannels
            | Axes::RowsColumnsChannelsFrames
            | Axes::FramesRowsColumnsChannels,
        ) => [1, *rows, *columns, 3],
        ([frames, rows, columns], Axes::FramesRowsColumns)
        | ([rows, columns, frames], Axes::RowsColumnsFrames) => [*frames, *rows, *columns, 1],
        ([frames, rows, columns, 3], Axes::FramesRowsColumnsChannels)
        | ([rows, columns, 3, frames], Axes::RowsColumnsChannelsFrames) => {
            [*frames, *rows, *columns, 3]
        }
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
            Axes::RowsColumnsFrames | Axes::RowsColumnsChannelsFrames if shape.len() > 2 => {
                values.iter().skip(k).step_by(frames).copied().collect()
            }
            _ => values[k * each..(k + 1) * each].to_vec(),
        },
        full_scale,
        is_lossy: false,
        gamma: None,
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
        // (rows, columns, 3, frames), as MATLAB stacks colour; row-major, the frame is the last
        // index.
        let stack = of(&[4, 5, 3, 2], None, true).unwrap();
        assert_eq!((stack.len(), stack[1].height, stack[1].width), (2, 4, 5));
        assert_eq!(stack[1].values[..4], [1.0, 3.0, 5.0, 7.0]);
        assert_eq!(of(&[2, 4, 5, 3], None, true).unwrap().len(), 2);
        let error = of(&[4, 5, 3, 3], None, true).unwrap_err().to_string();
        assert!(error.contains("rows-columns-channels-frames"), "{error}");
        // What the cure says is a cure.
        for (axes, size) in [
            (Axes::RowsColumnsChannelsFrames, [5, 4]),
            (Axes::FramesRowsColumnsChannels, [3, 5]),
        ] {
            let stack = of(&[4, 5, 3, 3], Some(axes), true).unwrap();
            assert_eq!([stack[0].width, stack[0].height], size);
        }
        let one = of(&[4, 5, 3], Some(Axes::RowsColumnsChannelsFrames), true).unwrap();
        assert_eq!((one.len(), one[0].values[1]), (1, 1.0));
        let error = of(&[4, 5, 3, 2], Some(Axes::RowsColumnsFrames), true);
        assert!(error.unwrap_err().to_string().contains("do not fit"));
        assert!(of(&[3], None, false).is_err() && of(&[1, 2, 3, 4, 5], None, false).is_err());
    }

    #[test]
    fn an_unknown_file_is_told_all_kinds_that_are_read() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
        let mut reader = Reader::new(folder, None, None);
        let found = reader.photographs(&folder.join("Cargo.toml"));
        let error = found.unwrap_err().to_string();
        for kind in ["PNG", "JPEG", "OpenEXR", "TIFF", "NPY", "MAT"] {
            assert!(error.contains(kind), "{error}");
        }
    }
}
