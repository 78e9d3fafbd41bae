//! Albedo from pictures.

use super::file::{Filter, PictureChannel, VariedTable};
use super::{Bilinear, Cells, Files, MOST_CELLS, Texture, Wrap, albedo};
use crate::image::{self, Channel, Encoding, Image, MOST_PIXELS, Transfer};
use crate::num::named::Named;
use crate::scene::error::{Fault, keys};
use crate::scene::room::refuse_larger;
use crate::scene::target::Target;

/// Bytes of a value.
const NUMBER: usize = 8;

/// Luminance of linear red, green and blue: ITU-R BT.709.
const LUMINANCE: [f64; 3] = [0.2126, 0.7152, 0.0722];

/// Dominant wavelengths of the sRGB primaries blue, green and red, m: where the line from D65
/// through the primary meets the spectral locus of CIE 1931.
pub(super) const DOMINANT: [f64; 3] = [464.2e-9, 549.1e-9, 611.4e-9];

const COLOURS: [Channel; 3] = [Channel::Red, Channel::Green, Channel::Blue];

/// The albedo that an image file holds.
pub(super) fn from_image(
    name: &str,
    table: &VariedTable,
    wavelength: f64,
    files: &mut Files,
) -> Result<Texture, Fault> {
    let bytes = files(name).map_err(|reason| {
        let cause = format!("the picture `{name}` cannot be read: {reason}");
        let cure = "put the file into the scene's folder, or below it, and name it from there";
        Fault::new(keys!["image"], cause, cure)
    })?;
    if let Some(size) = image::size(&bytes) {
        refuse_large(&format!("`{name}`"), size, image::PIXEL_BYTES)
            .map_err(|f| f.within(keys!["image"]))?;
    }
    let image = image::decode(name, &bytes).map_err(|error| {
        let text = error.to_string();
        let (cause, cure) = text.rsplit_once("; ").unwrap_or((&text, "save it again"));
        Fault::new(keys!["image"], cause, cure)
    })?;
    let most = MOST_CELLS as usize;
    if image.width > most || image.height > most {
        let cause = format!("`{name}` has {} × {} pixels", image.width, image.height);
        let cure = format!("scale it to {most} a side or less");
        return Err(Fault::new(keys!["image"], cause, cure));
    }
    refuse_transparency(name, &image)?;
    let transfer = transfer(name, table.transfer, image.encoding)?;
    let weights = weights(name, table.channel, &image, wavelength)?;
    let stride = image.channels.len();
    let linear = |pixel: &[f32]| {
        let terms = pixel.iter().zip(&weights).filter(|(_, w)| **w > 0.0);
        terms.map(|(e, w)| w * transfer.decode(f64::from(*e))).sum()
    };
    let values: Vec<f64> = image.values.chunks_exact(stride).map(linear).collect();
    if let Some(at) = values.iter().position(|x| !(0.0..=1.0).contains(x)) {
        let [column, row] = [at % image.width, at / image.width];
        let cause = format!(
            "pixel ({column}, {row}) of `{name}`, counted from 0 at the upper left, is {}: no reflectance",
            values[at]
        );
        let cure =
            "scale the picture's values to 0 … 1; `dark` and `light` say what they stand for";
        return Err(Fault::new(keys!["image"], cause, cure));
    }
    texture([image.width, image.height], &values, table)
}

/// The albedo of a target that is built in.
pub(super) fn from_target(name: &str, table: &VariedTable) -> Result<Texture, Fault> {
    let target = Target::by_name(name).ok_or_else(|| {
        let cure = format!("use one of {}", Target::ALL.map(Target::name).join(", "));
        Fault::new(
            keys!["target"],
            format!("there is no target `{name}`"),
            cure,
        )
    })?;
    let size = table
        .size
        .map_or_else(|| target.usual_size(), |s| s.map(|n| n as usize));
    refuse_large(&format!("target `{name}`"), size, NUMBER)
        .map_err(|f| f.within(keys!["target"]))?;
    let picture = target.picture(size).ok_or_else(|| {
        let [w, h] = size;
        let cure = format!("use 1 to {MOST_CELLS} a side");
        Fault::new(keys!["size"], format!("a target of {w} × {h} pixels"), cure)
    })?;
    texture(size, &picture.values, table)
}

/// Refuses a picture that does not fit into memory, of at most [`MOST_PIXELS`]: as it is made, of
/// `made` bytes a pixel, as values and as albedo.
fn refuse_large(what: &str, [width, height]: [usize; 2], made: usize) -> Result<(), Fault> {
    let pixels = width.saturating_mul(height).min(MOST_PIXELS);
    let need = ((made + 2 * NUMBER) * pixels) as f64;
    let what = format!("{what} of {width} × {height} pixels");
    refuse_larger(&what, need, "scale it down")
}

/// Linear values in \[0, 1\], row by row from the top, as albedo: the lowest row first.
fn texture(count: [usize; 2], values: &[f64], table: &VariedTable) -> Result<Texture, Fault> {
    let level = |key: &'static str, given: Option<f64>, usual: f64| {
        albedo(given.unwrap_or(usual)).map_err(|f| f.within(keys![key]))
    };
    let dark = level("dark", table.dark, 0.0)?;
    let light = level("light", table.light, 1.0)?;
    // Weighted like this both ends are met exactly and nothing lies beyond them.
    let albedo = |x: &f64| ((1.0 - x) * dark + x * light).clamp(dark.min(light), dark.max(light));
    let rows = values.chunks_exact(count[0]).rev();
    let albedo: Vec<f64> = rows.flatten().map(albedo).collect();
    let wrap = table.wrap.unwrap_or_default();
    Ok(match (table.filter.unwrap_or_default(), wrap) {
        (Filter::Nearest, Wrap::Clamp) => Texture::Cells(Cells { count, albedo }),
        (Filter::Nearest, Wrap::Repeat) => Texture::Tiles(Cells { count, albedo }),
        (Filter::Bilinear, _) => Texture::Bilinear(Bilinear {
            count,
            albedo,
            wrap,
        }),
    })
}

fn refuse_transparency(name: &str, image: &Image) -> Result<(), Fault> {
    let clear = image
        .channel(Channel::Alpha)
        .and_then(|mut alpha| alpha.position(|a| a.to_bits() != 1.0_f32.to_bits()));
    match clear {
        None => Ok(()),
        Some(at) => {
            let [column, row] = [at % image.width, at / image.width];
            let cause = format!(
                "`{name}` is not opaque at pixel ({column}, {row}), counted from 0 at the upper left: what lies behind is unknown"
            );
            let cure = "lay it on a background and save it without transparency";
            Err(Fault::new(keys!["image"], cause, cure))
        }
    }
}

fn transfer(name: &str, given: Option<Transfer>, encoding: Encoding) -> Result<Transfer, Fault> {
    match (given, encoding) {
        (Some(Transfer::Srgb), Encoding::Integer) => Ok(Transfer::Srgb),
        (Some(Transfer::Linear), _) | (None, Encoding::Float) => Ok(Transfer::Linear),
        (None, Encoding::Integer) => Err(Fault::new(
            keys!["image"],
            format!("`{name}` does not say what its values mean"),
            "add `transfer = \"srgb\"` (cameras, scanners, drawings for the screen) or `transfer = \"linear\"` (stored in proportion to reflectance)",
        )),
        (Some(Transfer::Srgb), Encoding::Float) => Err(Fault::new(
            keys!["transfer"],
            format!("`{name}` is OpenEXR, which is linear by its definition"),
            "remove `transfer`, or save the picture as PNG",
        )),
    }
}

/// What each value of a pixel counts.
fn weights(
    name: &str,
    given: Option<PictureChannel>,
    image: &Image,
    wavelength: f64,
) -> Result<Vec<f64>, Fault> {
    let of = |w: [f64; 3]| {
        let weight = |c: &Channel| COLOURS.iter().position(|k| k == c).map_or(0.0, |i| w[i]);
        image.channels.iter().map(weight).collect::<Vec<_>>()
    };
    let is_grey = image.channels.contains(&Channel::Grey);
    match (given, is_grey) {
        (None | Some(PictureChannel::Grey), true) => {
            let weight = |c: &Channel| f64::from(u8::from(*c == Channel::Grey));
            Ok(image.channels.iter().map(weight).collect())
        }
        (Some(_), true) => Err(Fault::new(
            keys!["channel"],
            format!("`{name}` is grey: it has no colours to choose from"),
            "remove `channel`",
        )),
        (None, false) => Err(Fault::new(
            keys!["image"],
            format!("`{name}` has colours, and an albedo is one number"),
            "add `channel = \"luminance\"`, \"wavelength\" (the laser's), \"red\", \"green\" or \"blue\"",
        )),
        (Some(PictureChannel::Grey), false) => Err(Fault::new(
            keys!["channel"],
            format!("`{name}` has colours, no grey"),
            "use \"luminance\", \"wavelength\", \"red\", \"green\" or \"blue\"",
        )),
        (Some(PictureChannel::Red), false) => Ok(of([1.0, 0.0, 0.0])),
        (Some(PictureChannel::Green), false) => Ok(of([0.0, 1.0, 0.0])),
        (Some(PictureChannel::Blue), false) => Ok(of([0.0, 0.0, 1.0])),
        (Some(PictureChannel::Luminance), false) => Ok(of(LUMINANCE)),
        (Some(PictureChannel::Wavelength), false) => {
            if !(wavelength.is_finite() && wavelength > 0.0) {
                let cause =
                    format!("the laser's wavelength is {wavelength} m: it weights no colours");
                return Err(Fault::new(
                    keys!["channel"],
                    cause,
                    "give the laser a wavelength, e.g. 632.8e-9",
                ));
            }
            Ok(of(by_wavelength(wavelength)))
        }
    }
}

/// Weights of red, green and blue at a wavelength in m: linear between [`DOMINANT`], level beyond.
pub(super) fn by_wavelength(wavelength: f64) -> [f64; 3] {
    let [blue, green, red] = DOMINANT;
    let part = |from: f64, to: f64| ((wavelength - from) / (to - from)).clamp(0.0, 1.0);
    let [greenish, reddish] = [part(blue, green), part(green, red)];
    [reddish, greenish - reddish, 1.0 - greenish]
}
