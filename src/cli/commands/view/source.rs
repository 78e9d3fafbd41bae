//! What is to be viewed: values with their size, unit and name.

use std::path::Path;

use crate::cli::args::ViewArgs;
use crate::cli::console::Console;
use crate::cli::failure::Failure;
use crate::cli::load_run::refuse_damaged;
use crate::cli::run_folder;
use crate::film;
use crate::film::exr::FrameError;
use crate::film::frame::{COUNTS, FLUX};
use crate::folder::Record;
use crate::image::{self, Channel, Image};
use crate::matrix::npy;
use crate::report::Panel;
use crate::store;
use crate::store::harmless;
use crate::store::memory;

/// Pictures of more bytes than this are not read, nor matrices that would take more: 1 GiB.
const LARGEST: u64 = 1 << 30;
/// Times that a matrix or picture is held at most: as it is read, by rows, its values to be shown,
/// their colours.
const HELD: f64 = 4.0;
/// First bytes of a picture, in which its header ends.
const HEAD: u64 = 1 << 16;
/// Luminance of linear R, G, B (ITU-R BT.709).
const LUMINANCE: [f64; 3] = [0.2126, 0.7152, 0.0722];

/// A matrix or picture to be viewed.
pub(super) struct Source {
    pub panel: Panel,
    /// Of its values; empty for none.
    pub unit: &'static str,
    /// Whether the values are reflectances, between 0 and 1.
    pub reflectance: bool,
}

impl Source {
    pub(super) fn read(args: &ViewArgs, console: Console) -> Result<Self, Failure> {
        let path = &args.file;
        refuse_damaged(path)?;
        if path.extension().is_some_and(|e| e == "npy") {
            if args.channel.is_some() {
                let cause = format!("{} is a matrix: it has no channels", path.display());
                return Err(Failure::new(cause, "leave out --channel"));
            }
            let length = path.metadata().map_or(0, |m| m.len()) as f64;
            let what = format!("{} and its picture", path.display());
            memory::refuse(&what, HELD * length, &[])?;
            return matrix(path, args.spot, console);
        }
        if args.spot.is_some() {
            let path = path.display();
            let cause = format!("{path} is no matrix: --spot names a column of one");
            return Err(Failure::new(cause, "leave out --spot, or give a file .npy"));
        }
        let channel = args.channel.as_deref();
        refuse_unseen(path)?;
        match film::exr::read(path) {
            Ok(frame) => self::frame(path, &frame, channel),
            Err(FrameError::Foreign { .. }) => picture(path, channel),
            Err(error) => Err(error.into()),
        }
    }

    /// What a camera sees, by column + row·columns, row 0 at the bottom.
    fn seen(title: String, size: [usize; 2], values: Vec<f64>, unit: &'static str) -> Self {
        Self::of(title, size, values, unit, ["x", "y"])
    }

    fn of(
        title: String,
        size: [usize; 2],
        values: Vec<f64>,
        unit: &'static str,
        axes: [&str; 2],
    ) -> Self {
        let panel = Panel {
            title: harmless(&title),
            size,
            values,
            axes: axes.map(str::to_owned),
            scale_bar: None,
        };
        Self {
            panel,
            unit,
            reflectance: false,
        }
    }
}

fn no_channel(path: &Path, asked: &str, there: &[&str]) -> Failure {
    let cause = format!("{} has no channel `{asked}`", path.display());
    Failure::new(cause, format!("use one of {}", there.join(", ")))
}

fn frame(path: &Path, frame: &film::Frame, channel: Option<&str>) -> Result<Source, Failure> {
    let names: Vec<&str> = frame.channels.iter().map(|c| c.name.as_str()).collect();
    let usual = names.iter().find(|name| **name == FLUX).or(names.first());
    let name = channel.or(usual.copied()).unwrap_or(FLUX);
    let values = frame.channel(name);
    let values = values.ok_or_else(|| no_channel(path, name, &names))?;
    let unit = match name {
        _ if name.starts_with(FLUX) => "W",
        _ if name.starts_with(COUNTS) => "counts",
        _ => "",
    };
    let (scene, spot) = (&frame.meta.run.scene_name, frame.meta.spot_index);
    let title = format!("{scene}, spot {spot}: {name}");
    let values = values.iter().copied().map(f64::from).collect();
    let size = [frame.columns, frame.rows];
    Ok(Source::seen(title, size, values, unit))
}

/// Refuses by its first bytes what is no OpenEXR, or takes more memory than there is: before it is
/// read.
fn refuse_unseen(path: &Path) -> Result<(), Failure> {
    let name = path.display();
    let start = store::start(path, HEAD)?;
    if !start.is_empty() && !start.starts_with(b"v/1\x01") {
        let cause = format!("{name} is neither OpenEXR nor .npy");
        let cure =
            "give a frame, an OpenEXR picture or a matrix; other pictures open in any viewer";
        return Err(Failure::new(cause, cure));
    }
    let length = store::length(path)?;
    let claimed = image::exr::claimed(&start, length);
    let [pixels, bytes] = claimed.unwrap_or_default();
    let bytes = bytes.min(film::exr::PIXEL_BYTES_MAX as f64);
    let need = length as f64 + HELD * (bytes + 8.0 * pixels.min(bytes));
    let what = format!("{name} and its picture");
    Ok(memory::refuse(&what, need, &[])?)
}

/// A picture of another program; its first row is the top one.
fn picture(path: &Path, channel: Option<&str>) -> Result<Source, Failure> {
    let name = path.display().to_string();
    let bytes = store::read(path, LARGEST)?;
    let image = image::decode(&name, &bytes)?;
    let (chosen, values) = chosen(path, &image, channel)?;
    let rows = values.chunks(image.width).rev();
    let upright = rows.flatten().copied().collect();
    let title = format!("{}: {chosen}", file_name(path));
    let size = [image.width, image.height];
    Ok(Source::seen(title, size, upright, ""))
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
    let luminance = || {
        let [r, g, b] = [Channel::Red, Channel::Green, Channel::Blue].map(values);
        let [lr, lg, lb] = LUMINANCE;
        let (g, b) = (g?, b?);
        let rgb = r?.into_iter().zip(g).zip(b);
        Some(rgb.map(|((r, g), b)| lr * r + lg * g + lb * b).collect())
    };
    let found = match image.channels.iter().find(|c| letter(c) == asked) {
        Some(channel) => values(*channel),
        None if asked == "luminance" && coloured => luminance(),
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

/// Whether a folder has results of `phicam recover`, by its name: `recovered`, or for other Φcam
/// `recovered-NAME-DIGEST`.
fn in_recovered(folder: &Path) -> bool {
    let name = folder.file_name().and_then(|n| n.to_str()).unwrap_or("");
    let rest = name.strip_prefix(run_folder::RECOVERED);
    rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('-'))
}

/// Columns, rows and spots of the run or scene to which a file belongs: that of its folder, or of
/// the one above.
fn camera(path: &Path, console: Console) -> Result<Option<([usize; 2], usize)>, Failure> {
    let full = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    for dir in full.ancestors().skip(1).take(2) {
        if let Some(record) = Record::read(dir)? {
            return Ok(Some((record.pixels, record.spots)));
        }
        let scene = dir.join(run_folder::SCENE);
        if scene.is_file() {
            let scene = console.load_scene(&scene.to_string_lossy())?;
            let pixels = [scene.camera.columns, scene.camera.rows];
            return Ok(Some((pixels, scene.laser.spots.len())));
        }
    }
    Ok(None)
}

fn matrix(path: &Path, spot: Option<usize>, console: Console) -> Result<Source, Failure> {
    let (rows, columns) = npy::shape(path)?;
    if (rows as u64).saturating_mul(columns as u64) > LARGEST / 8 {
        let cause = format!(
            "{} has {rows} × {columns} numbers, too many to view",
            path.display()
        );
        return Err(Failure::new(
            cause,
            "view a frame of its run, or a part of it",
        ));
    }
    let matrix = npy::read(path)?;
    let camera = camera(path, console)?;
    let name = file_name(path);
    // By the names that a run gives.
    let unit = if name.starts_with("phi") { "W" } else { "" };
    if let Some(spot) = spot {
        let size = match camera {
            Some((size, _)) if size[0] * size[1] == rows => size,
            camera => {
                let cause = match camera {
                    Some(([w, h], _)) => format!(
                        "{name} has {rows} rows, and the camera of its run {w} × {h} pixels"
                    ),
                    None => format!(
                        "nothing beside {name} says how many columns and rows the camera has"
                    ),
                };
                let cure = "give the matrix in the folder of its run, with run.json or scene.toml, or leave out --spot";
                return Err(Failure::new(cause, cure));
            }
        };
        if spot >= columns {
            let cause = format!("{name} has no spot {spot}");
            return Err(Failure::new(cause, format!("use 0 to {}", columns - 1)));
        }
        let values = matrix.column(spot).iter().copied().collect();
        let title = format!("{name}, spot {spot}");
        return Ok(Source::seen(title, size, values, unit));
    }
    let stacked = camera.is_some_and(|([w, h], spots)| (w * h, spots) == (rows, columns));
    let recovered = path.parent().is_some_and(in_recovered) && !stacked;
    // METHOD.npy and truth.npy; what has another dot is something else about them.
    let reflectance = recovered && name.matches('.').count() == 1;
    let (axes, unit) = match (stacked, recovered) {
        (true, _) => (["spot", "pixel"], unit),
        (_, true) if reflectance => (["iu", "iv"], "reflectance"),
        (_, true) => (["iu", "iv"], ""),
        _ => (["column", "row"], ""),
    };
    let values = matrix.transpose().iter().copied().collect();
    let source = Source::of(name, [columns, rows], values, unit, axes);
    Ok(Source {
        reflectance,
        ..source
    })
}
