//! What is to be viewed: values with their size, unit and name.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use super::super::args::ViewArgs;
use super::super::failure::Failure;
use super::super::output::harmless;
use super::super::record::Record;
use super::super::{folder, trust};
use crate::film;
use crate::film::exr::FrameError;
use crate::film::frame::{COUNTS, FLUX};
use crate::image::{self, Channel, Image};
use crate::matrix::npy;

/// Pictures of more bytes than this are not read: 1 GiB.
const LARGEST: u64 = 1 << 30;
/// Luminance of linear R, G, B (ITU-R BT.709).
const LUMINANCE: [f64; 3] = [0.2126, 0.7152, 0.0722];

/// What the values are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Meaning {
    /// They belong between 0 and 1.
    Reflectance,
    /// Anything.
    Any,
}

/// Values by column + row·columns, row 0 at the bottom.
pub(super) struct Source {
    pub title: String,
    pub size: [usize; 2],
    pub values: Vec<f64>,
    pub unit: String,
    pub axes: [String; 2],
    pub meaning: Meaning,
}

impl Source {
    pub(super) fn read(args: &ViewArgs) -> Result<Self, Failure> {
        let path = &args.file;
        if path.extension().is_some_and(|e| e == "npy") {
            if args.channel.is_some() {
                let cause = format!("{} is a matrix: it has no channels", path.display());
                return Err(Failure::new(cause, "leave out --channel"));
            }
            return matrix(path, args.spot);
        }
        if args.spot.is_some() {
            let cause = format!(
                "{} is no matrix: --spot names a column of one",
                path.display()
            );
            return Err(Failure::new(cause, "leave out --spot, or give a file .npy"));
        }
        let channel = args.channel.as_deref();
        match film::exr::read(path) {
            Ok(frame) => self::frame(path, &frame, channel),
            Err(FrameError::Foreign { .. }) => picture(path, channel),
            Err(error) => Err(error.into()),
        }
    }
}

/// Axes of anything that a camera sees.
fn seen() -> [String; 2] {
    ["x", "y"].map(str::to_owned)
}

fn no_channel(path: &Path, asked: &str, there: &[&str]) -> Failure {
    let cause = format!("{} has no channel `{asked}`", path.display());
    Failure::new(cause, format!("use one of {}", there.join(", ")))
}

fn frame(path: &Path, frame: &film::Frame, channel: Option<&str>) -> Result<Source, Failure> {
    let names: Vec<&str> = frame.channels.iter().map(|c| c.name.as_str()).collect();
    let usual = if names.contains(&FLUX) {
        Some(FLUX)
    } else {
        names.first().copied()
    };
    let name = channel.or(usual).unwrap_or(FLUX);
    let values = frame.channel(name);
    let values = values.ok_or_else(|| no_channel(path, name, &names))?;
    let unit = match name {
        _ if name.starts_with(FLUX) => "W",
        _ if name.starts_with(COUNTS) => "counts",
        _ => "",
    };
    let meta = &frame.meta;
    Ok(Source {
        title: harmless(&format!(
            "{}, spot {}: {name}",
            meta.scene_name, meta.spot_index
        )),
        size: [frame.columns, frame.rows],
        values: values.iter().copied().map(f64::from).collect(),
        unit: unit.to_owned(),
        axes: seen(),
        meaning: Meaning::Any,
    })
}

/// A picture of another program; its first row is the top one.
fn picture(path: &Path, channel: Option<&str>) -> Result<Source, Failure> {
    let name = path.display().to_string();
    let unreadable = |e: std::io::Error| {
        let cause = format!("cannot read {name}: {e}");
        Failure::new(cause, "check that the file exists and that you may read it")
    };
    let mut bytes = Vec::new();
    let file = File::open(path).map_err(unreadable)?;
    file.take(LARGEST)
        .read_to_end(&mut bytes)
        .map_err(unreadable)?;
    if !bytes.starts_with(b"v/1\x01") {
        let cause = format!("{name} is neither OpenEXR nor .npy");
        return Err(Failure::new(
            cause,
            "give a frame, an OpenEXR picture or a matrix; other pictures open in any viewer",
        ));
    }
    let image = image::decode(&name, &bytes)?;
    let (chosen, values) = chosen(path, &image, channel)?;
    let [columns, rows] = [image.width, image.height];
    let upright = (0..rows)
        .rev()
        .flat_map(|y| &values[y * columns..(y + 1) * columns]);
    Ok(Source {
        title: format!("{}: {chosen}", file_name(path)),
        size: [columns, rows],
        values: upright.copied().collect(),
        unit: String::new(),
        axes: seen(),
        meaning: Meaning::Any,
    })
}

/// The name and the values, from the top, of the channel that is asked for.
fn chosen(path: &Path, image: &Image, asked: Option<&str>) -> Result<(String, Vec<f64>), Failure> {
    let letter = |c: &Channel| match c {
        Channel::Grey => "Y",
        Channel::Red => "R",
        Channel::Green => "G",
        Channel::Blue => "B",
        Channel::Alpha => "A",
    };
    let mut names: Vec<&str> = image.channels.iter().map(letter).collect();
    let coloured = image.channels.contains(&Channel::Red);
    if coloured {
        names.push("luminance");
    }
    let asked = asked.unwrap_or(if coloured { "luminance" } else { "Y" });
    let values =
        |channel| -> Option<Vec<f64>> { Some(image.channel(channel)?.map(f64::from).collect()) };
    let found = match image.channels.iter().find(|c| letter(c) == asked) {
        Some(channel) => values(*channel),
        None if asked == "luminance" && coloured => {
            let parts = [Channel::Red, Channel::Green, Channel::Blue].map(values);
            let [Some(r), Some(g), Some(b)] = parts else {
                return Err(no_channel(path, asked, &names));
            };
            let [lr, lg, lb] = LUMINANCE;
            let rgb = r.iter().zip(&g).zip(&b);
            Some(rgb.map(|((r, g), b)| lr * r + lg * g + lb * b).collect())
        }
        None => None,
    };
    let values = found.ok_or_else(|| no_channel(path, asked, &names))?;
    Ok((asked.to_owned(), values))
}

fn file_name(path: &Path) -> String {
    path.file_name().map_or_else(
        || path.display().to_string(),
        |n| n.to_string_lossy().into_owned(),
    )
}

/// Columns, rows and spots of the run or scene to which a file belongs: that of its folder, or of the one above.
fn camera(path: &Path) -> Result<Option<([usize; 2], usize)>, Failure> {
    let full = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    for dir in full.ancestors().skip(1).take(2) {
        if let Some(record) = Record::read(dir)? {
            return Ok(Some((record.pixels, record.spots)));
        }
        let scene = dir.join(folder::SCENE);
        if scene.is_file() {
            let scene = trust::load(&scene.to_string_lossy())?;
            let pixels = [scene.camera.columns, scene.camera.rows];
            return Ok(Some((pixels, scene.laser.spots.len())));
        }
    }
    Ok(None)
}

fn matrix(path: &Path, spot: Option<usize>) -> Result<Source, Failure> {
    let matrix = npy::read(path)?;
    let (rows, columns) = matrix.shape();
    let camera = camera(path)?;
    let stacked =
        camera.is_some_and(|(pixels, spots)| (pixels[0] * pixels[1], spots) == (rows, columns));
    let name = file_name(path);
    if let Some(spot) = spot {
        let Some((size, _)) = camera.filter(|([w, h], _)| w * h == rows) else {
            let cause = match camera {
                Some(([w, h], _)) => {
                    format!("{name} has {rows} rows, and the camera of its run {w} × {h} pixels")
                }
                None => {
                    format!("nothing beside {name} says how many columns and rows the camera has")
                }
            };
            let cure = "give the matrix in the folder of its run, with run.json or scene.toml, or leave out --spot";
            return Err(Failure::new(cause, cure));
        };
        if spot >= columns {
            let cause = format!("{name} has no spot {spot}");
            return Err(Failure::new(cause, format!("use 0 to {}", columns - 1)));
        }
        return Ok(Source {
            title: format!("{name}, spot {spot}"),
            size,
            values: matrix.column(spot).iter().copied().collect(),
            unit: unit(&name).to_owned(),
            axes: seen(),
            meaning: Meaning::Any,
        });
    }
    let recovered = path.parent().is_some_and(|p| p.ends_with("recovered")) && !stacked;
    // METHOD.npy and truth.npy; what has another dot is something else about them.
    let reflectance = recovered && name.matches('.').count() == 1;
    let (axes, unit, meaning) = match (stacked, recovered) {
        (true, _) => (["spot", "pixel"], unit(&name), Meaning::Any),
        (_, true) if reflectance => (["iu", "iv"], "reflectance", Meaning::Reflectance),
        (_, true) => (["iu", "iv"], "", Meaning::Any),
        _ => (["column", "row"], "", Meaning::Any),
    };
    let across = (0..rows).flat_map(|i| (0..columns).map(move |j| (i, j)));
    Ok(Source {
        title: name,
        size: [columns, rows],
        values: across.map(|ij| matrix[ij]).collect(),
        unit: unit.to_owned(),
        axes: axes.map(str::to_owned),
        meaning,
    })
}

/// The unit of a matrix pixels × spots, by the names that a run gives.
fn unit(name: &str) -> &'static str {
    if name.starts_with("phi") { "W" } else { "" }
}
