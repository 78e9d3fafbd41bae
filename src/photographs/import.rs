//! All photographs of a set as Φcam.

use std::path::Path;

use serde::Serialize;

use super::correct::{Correction, Flat};
use super::error::{PhotographError, refused};
use super::footprints::{Evenness, Footprints};
use super::left_out::{DEAD, HALO, LeftOut, MISSING, OUTSIDE, SATURATED, in_halo};
use super::mapping::{Fitted, Mapping, Mark};
use super::noise::{CameraNoise, PhotonTransferFit, Repeated, photon_transfer};
use super::pattern::expanded;
use super::plane::{Averaged, Chosen, Plane, linearised};
use super::read::{Reader, SourceFile};
use super::response::{Response, ResponseTable};
use super::set::{ChannelName, DarkTable, DeadTable, Files, FrameTable, Set};
use super::takes::{Take, each_spot, positions, tables, takes};
use crate::image::{Channel, Samples};
use crate::matrix::Matrix;
use crate::scene::{Camera, Scene};

/// What was imported.
#[derive(Clone, Debug)]
pub struct Imported {
    /// Φcam, pixels × spots; W, or counts per second where no factor is known. 0 where an entry is
    /// left out.
    pub phi: Matrix,
    /// Its standard error; none where the noise is not known. 0 where an entry is left out.
    pub stderr: Option<Matrix>,
    /// 0 where an entry counts, else the codes of the reasons.
    pub left_out: Matrix,
    /// The mean of all photographs, row by row from the top, columns and rows.
    pub mean: (Vec<f64>, [usize; 2]),
    /// From the wall to the photograph.
    pub mapping: Mapping,
    /// How it came about.
    pub account: ImportAccount,
}

/// How an import came about.
#[derive(Clone, Debug, Serialize)]
pub struct ImportAccount {
    /// The scene.
    pub scene: String,
    /// Its hash.
    pub scene_hash: String,
    /// All settings.
    pub set: Set,
    /// The channel of photographs in colour.
    pub channel: Option<ChannelName>,
    /// W, counts/s or counts.
    pub unit: &'static str,
    /// Columns and rows of the photographs.
    pub photograph: [usize; 2],
    /// Photographs in all.
    pub photographs: usize,
    /// Gain and read noise, in counts, where they are known.
    pub noise: Option<CameraNoise>,
    /// The line that they were found by.
    pub photon_transfer: Option<PhotonTransferFit>,
    /// Distance of each mark from where the mapping has it, px.
    pub mark_residuals: Vec<f64>,
    /// Their root mean square, px.
    pub mark_rms: Option<f64>,
    /// Error of a mark along each axis that explains them, px.
    pub mark_error: Option<f64>,
    /// The gain of each spot that has one other than 1, with its standard error.
    pub gains: Vec<(usize, f64, f64)>,
    /// Entries that are left out.
    pub left_out: LeftOut,
    /// What a user has to know.
    pub warnings: Vec<String>,
    /// What was read.
    pub files: Vec<SourceFile>,
}

/// Most pixels whose repeats the photon transfer line is fitted to.
const MOST_REPEATED: usize = 1 << 20;
/// Probability of the photon transfer line below which it is said not to fit.
const FITS: f64 = 1e-3;
/// Part of a view's diagonal that a mark may lie off its plane.
const OFF_PLANE: f64 = 0.01;

/// The scene with the spots whose positions the set lists, if it does.
///
/// # Errors
/// [`PhotographError`] for spots that are not on the wall.
pub fn scene_of(set: &Set, scene: Scene, folder: &Path) -> Result<Scene, PhotographError> {
    let mut reader = Reader::new(folder, None, None);
    let tables = tables(set, &mut reader, folder)?;
    Ok(match positions(&tables)? {
        Some(places) => scene.with_listed_spots(&places)?,
        None => scene,
    })
}

/// Φcam of `scene` ([`scene_of`]) from the photographs of `set` in `folder`, of one channel where
/// they are in colour. Files are read once, or twice where the noise is found from repeats; of all
/// photographs one and the average of its spot are held at a time.
///
/// # Errors
/// [`PhotographError`].
pub fn import(
    set: &Set,
    scene: &Scene,
    folder: &Path,
    channel: Option<ChannelName>,
) -> Result<Imported, PhotographError> {
    let mut reader = Reader::new(folder, set.variable.as_deref(), set.axes);
    let listed = tables(set, &mut reader, folder)?;
    let job = Job::new(set, scene, folder, channel, &mut reader, &listed)?;
    job.finish(reader)
}

/// What all passes over the photographs share.
struct Job<'a> {
    set: &'a Set,
    scene: &'a Scene,
    channel: Option<ChannelName>,
    chosen: Chosen,
    response: Option<ResponseTable>,
    takes: Vec<Take>,
    size: [usize; 2],
    darks: Vec<(Option<f64>, Averaged)>,
    flat: Option<(Averaged, Option<Averaged>)>,
    dead: Vec<bool>,
    fitted: Option<Fitted>,
    mapping: Mapping,
    footprints: Footprints,
    warnings: Vec<String>,
}

impl<'a> Job<'a> {
    fn new(
        set: &'a Set,
        scene: &'a Scene,
        folder: &'a Path,
        channel: Option<ChannelName>,
        reader: &mut Reader<'a>,
        listed: &[FrameTable],
    ) -> Result<Self, PhotographError> {
        let takes = takes(set, listed, folder)?;
        let first = takes
            .first()
            .ok_or_else(|| refused("there are no photographs", "name one or more"))?;
        let first = reader.photographs(&first.path)?;
        let first = first
            .first()
            .ok_or_else(|| refused("the first file has no photograph", "name another"))?;
        let size = [first.width, first.height];
        let response = match &set.response {
            None => None,
            Some(name) => Some(response_table(name, &reader.bytes(&folder.join(name))?)?),
        };
        let chosen = match channel {
            None | Some(ChannelName::All) => Chosen::Grey,
            Some(ChannelName::Red) => Chosen::One(Channel::Red),
            Some(ChannelName::Green) => Chosen::One(Channel::Green),
            Some(ChannelName::Blue) => Chosen::One(Channel::Blue),
            Some(ChannelName::Mean) => Chosen::Mean,
        };
        let fitted = fitted(set, &scene.camera)?;
        let mapping = match (&fitted, set.crop) {
            (Some(fitted), _) => fitted.mapping,
            (None, Some(c)) => Mapping::upright([c.x, c.y], [c.width, c.height]),
            (None, None) => Mapping::upright([0.0; 2], size.map(|n| n as f64)),
        };
        let evenness = match (&fitted, set.camera, &set.flat) {
            (None, _, None) => Evenness::Same,
            (Some(_), Some(_), None) => Evenness::ByLens,
            _ => Evenness::Even,
        };
        let footprints = Footprints::new(&scene.camera, &mapping, size, evenness)?;
        let mut job = Self {
            set,
            scene,
            channel,
            chosen,
            response,
            takes,
            size,
            darks: Vec::new(),
            flat: None,
            dead: Vec::new(),
            fitted,
            mapping,
            footprints,
            warnings: Vec::new(),
        };
        job.dead = job.dead_pixels(folder, reader)?;
        let mut average = |files: &Files| job.average(&expanded(folder, files)?, reader);
        let darks = match &set.dark {
            None => Vec::new(),
            Some(DarkTable::Files(files)) => vec![(None, average(files)?)],
            Some(DarkTable::Series(all)) => all
                .iter()
                .map(|s| Ok((Some(s.exposure), average(&s.files)?)))
                .collect::<Result<_, PhotographError>>()?,
        };
        let flat = match &set.flat {
            None => None,
            Some(files) => {
                let dark = set.flat_dark.as_ref().map(&mut average).transpose()?;
                Some((average(files)?, dark))
            }
        };
        (job.darks, job.flat) = (darks, flat);
        job.remark(evenness);
        Ok(job)
    }

    /// One channel of a photograph as light.
    fn plane(&self, name: &str, samples: &Samples) -> Result<Plane, PhotographError> {
        let full_scale = self.set.full_scale.or(samples.full_scale);
        let response = match (&self.response, self.set.gamma) {
            (Some(table), _) => Response::Table(table.clone()),
            (None, None) => Response::Linear,
            (None, Some(gamma)) => {
                let full_scale = full_scale.ok_or_else(|| {
                    refused(
                        format!(
                            "{name} holds floating-point numbers, and nothing says their full scale"
                        ),
                        "give `full_scale` with `gamma`",
                    )
                })?;
                Response::gamma(gamma, full_scale)?
            }
        };
        let saturation = self.set.saturation.or(full_scale).unwrap_or(f64::INFINITY);
        linearised(name, samples, self.chosen, &response, saturation)
    }

    /// The mean of all photographs in `paths`.
    fn average(
        &self,
        paths: &[std::path::PathBuf],
        reader: &mut Reader<'_>,
    ) -> Result<Averaged, PhotographError> {
        let mut mean: Option<Averaged> = None;
        for path in paths {
            let name = reader.name(path);
            for samples in reader.photographs(path)? {
                let plane = self.plane(&name, &samples)?;
                match &mut mean {
                    Some(mean) => mean.add(&name, &plane)?,
                    None => mean = Some(Averaged::of(plane)),
                }
            }
        }
        mean.ok_or_else(|| {
            refused(
                "a list of dark or flat frames is empty",
                "leave it out, or name files",
            )
        })
    }

    fn dead_pixels(
        &self,
        folder: &Path,
        reader: &mut Reader<'_>,
    ) -> Result<Vec<bool>, PhotographError> {
        let [width, height] = self.size;
        let mut dead = vec![false; width * height];
        match &self.set.dead {
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
                let found = found.first().filter(|s| [s.width, s.height] == self.size);
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

    /// The dark frames of an exposure time.
    fn dark(&self, take: &Take) -> Result<Option<&Averaged>, PhotographError> {
        match &self.darks[..] {
            [] => Ok(None),
            [(None, dark)] => Ok(Some(dark)),
            series => {
                let of = |t: &Option<f64>| t.is_some() && *t == take.exposure;
                let found = series
                    .iter()
                    .find(|(time, _)| of(time))
                    .map(|(_, dark)| dark);
                let named = |t: f64| format!("of {t} s");
                let time = take
                    .exposure
                    .map_or("of no known exposure time".to_owned(), named);
                found.map(Some).ok_or_else(|| {
                    refused(
                        format!(
                            "no dark frames go with {}, a photograph {time}",
                            take.path.display()
                        ),
                        "give dark frames of each exposure time",
                    )
                })
            }
        }
    }

    fn repeats(&self) -> usize {
        self.set.repeats.map_or(1, |n| n as usize)
    }

    /// The photon transfer line of all repeated photographs; `None` where none are.
    fn photon_transfer(
        &self,
        reader: &mut Reader<'_>,
    ) -> Result<Option<PhotonTransferFit>, PhotographError> {
        let spots = self.scene.laser.spots.len();
        let pixels = self.size[0] * self.size[1];
        let stride = (spots * pixels).div_ceil(MOST_REPEATED);
        let mut repeated = Vec::new();
        let visit = |spot: usize, take: &Take, mean: Averaged| {
            let dark = self.dark(take)?;
            for k in (0..pixels).skip(spot % stride).step_by(stride) {
                let good = !mean.saturated[k] && !self.dead[k];
                if let (Some(variance), true) = (mean.scatter(k), good) {
                    repeated.push(Repeated {
                        signal: mean.light[k] - dark.map_or(0.0, |d| d.light[k]),
                        variance,
                        rounding: mean.rounding[k],
                        freedom: (mean.frames - 1) as f64,
                    });
                }
            }
            Ok(())
        };
        let plane = |name: &str, samples: &Samples| self.plane(name, samples);
        each_spot(reader, (&self.takes, self.repeats()), spots, &plane, visit)?;
        if repeated.is_empty() {
            return Ok(None);
        }
        photon_transfer(repeated).map(Some)
    }

    /// What the settings leave unsaid.
    fn remark(&mut self, evenness: Evenness) {
        let mut say = |words: &str| self.warnings.push(words.to_owned());
        if self.set.dark.is_none() {
            say(
                "no dark frames: the camera's offset and other light stay in every entry; give `dark`, or recover with --background",
            );
        }
        if self.set.flat.is_some() && self.set.flat_dark.is_none() {
            say(
                "the flat field has no dark frames of its own (`flat_dark`): its offset stays in it",
            );
        }
        if evenness == Evenness::Even && self.set.flat.is_none() {
            say(
                "neither a flat field nor a camera matrix says how the photograph falls off to its corners: it is taken as even",
            );
        }
        if self.fitted.as_ref().is_some_and(|f| f.mark_error.is_none()) {
            say("four marks leave nothing to check the mapping by; give more");
        }
        if self.set.watts.is_none() {
            say(
                "no factor to watts is known (`watts`): fluxes have an arbitrary unit; recover with --free-scale",
            );
        }
    }

    fn finish(mut self, mut reader: Reader<'_>) -> Result<Imported, PhotographError> {
        let given = self.set.camera_noise()?;
        let line = match given {
            Some(_) => None,
            None => self.photon_transfer(&mut reader)?,
        };
        let noise = given.or(line.map(|l| l.noise));
        if line.is_some_and(|l| l.p < FITS) {
            self.warnings.push(format!(
                "the variance of repeated photographs is no line over their light (probability {:.1e}, off by up to {:.0} %): the laser flickers, or the response is not linear; the standard errors are those of the line",
                line.map_or(0.0, |l| l.p),
                100.0 * line.map_or(0.0, |l| l.largest_deviation)
            ));
        }
        if noise.is_none() {
            self.warnings.push("the noise is not known (one photograph a spot, and no `noise`): there is no standard error; recover weighs all entries alike, or with --noise".to_owned());
        }
        let columns = self.columns(noise, &mut reader)?;
        let unit = match (
            self.set.watts,
            self.takes.iter().all(|t| t.exposure.is_some()),
        ) {
            (Some(_), _) => "W",
            (None, true) => "counts/s",
            (None, false) => "counts",
        };
        let exposures = self.takes.iter().filter(|t| t.exposure.is_some()).count();
        if exposures != 0 && exposures != self.takes.len() {
            return Err(refused(
                "some photographs have an exposure time and others not",
                "give every one, or one `exposure` for all",
            ));
        }
        if reader.is_lossy && self.set.gamma.is_none() && self.set.response.is_none() {
            self.warnings.push("JPEG is neither linear nor without loss: give `gamma` or `response`, or photographs that the camera saves as they are".to_owned());
        }
        if columns.zeros > 0 {
            self.warnings.push(format!(
                "{:.2} % of the stored values are 0: what would be below is cut off, so that dark pixels are too bright on average; raise the camera's offset",
                100.0 * columns.zeros as f64 / (columns.photographs * self.size[0] * self.size[1]) as f64
            ));
        }
        let account = ImportAccount {
            scene: self.scene.name.clone(),
            scene_hash: self.scene.hash.clone(),
            set: self.set.clone(),
            channel: self.channel,
            unit,
            photograph: self.size,
            photographs: columns.photographs,
            noise,
            photon_transfer: line,
            mark_residuals: self
                .fitted
                .as_ref()
                .map_or(Vec::new(), |f| f.residuals.clone()),
            mark_rms: self.fitted.as_ref().map(|f| f.rms),
            mark_error: self.fitted.as_ref().and_then(|f| f.mark_error),
            gains: columns.gains,
            left_out: LeftOut::of(&columns.left_out),
            warnings: self.warnings,
            files: reader.sources(),
        };
        Ok(Imported {
            phi: columns.phi,
            stderr: noise.map(|_| columns.stderr),
            left_out: columns.left_out,
            mean: (columns.mean, self.size),
            mapping: self.mapping,
            account,
        })
    }

    /// Φ of every spot.
    fn columns(
        &self,
        noise: Option<CameraNoise>,
        reader: &mut Reader<'_>,
    ) -> Result<Columns, PhotographError> {
        let (pixels, spots) = (self.scene.camera.pixels(), self.scene.laser.spots.len());
        let flat = match &self.flat {
            None => None,
            Some((shot, dark)) => Some(Flat::new(shot, dark.as_ref(), noise)?),
        };
        let mut dead = self.dead.clone();
        if let Some(flat) = &flat {
            dead.iter_mut()
                .zip(&flat.unusable)
                .for_each(|(dead, bad)| *dead |= bad);
        }
        let mut found = Columns {
            phi: Matrix::zeros(pixels, spots),
            stderr: Matrix::zeros(pixels, spots),
            left_out: Matrix::from_element(pixels, spots, f64::from(MISSING)),
            mean: vec![0.0; self.size[0] * self.size[1]],
            gains: Vec::new(),
            photographs: 0,
            zeros: 0,
        };
        let mut seen = 0usize;
        let visit = |spot: usize, take: &Take, mean: Averaged| {
            let name = take.path.to_string_lossy();
            let correction = Correction {
                dark: self.dark(take)?,
                flat: flat.as_ref(),
                noise,
                exposure: take.exposure.unwrap_or(1.0),
            };
            let corrected = correction.apply(&name, &mean)?;
            found.photographs += mean.frames;
            found.zeros += mean.zeros;
            seen += 1;
            for (mean, flux) in found.mean.iter_mut().zip(&corrected.flux) {
                *mean += flux;
            }
            let factor = self.set.watts.unwrap_or(1.0) / take.gain;
            if (take.gain, take.gain_error) != (1.0, 0.0) {
                found.gains.push((spot, take.gain, take.gain_error));
            }
            let relative = take.gain_error / take.gain;
            let flux = self.footprints.gathered(&corrected.flux);
            let variance = corrected
                .variance
                .map(|v| self.footprints.gathered_variance(&v));
            for pixel in 0..pixels {
                let code = self.code(spot, pixel, &mean.saturated, &dead);
                found.left_out[(pixel, spot)] = f64::from(code);
                if code != 0 {
                    continue;
                }
                let value = factor * flux[pixel];
                found.phi[(pixel, spot)] = value;
                if let Some(variance) = &variance {
                    let of_gain = relative * value;
                    let all = factor * factor * variance[pixel] + of_gain * of_gain;
                    found.stderr[(pixel, spot)] = all.sqrt();
                }
            }
            Ok(())
        };
        let plane = |name: &str, samples: &Samples| self.plane(name, samples);
        each_spot(reader, (&self.takes, self.repeats()), spots, &plane, visit)?;
        found.mean.iter_mut().for_each(|x| *x /= seen.max(1) as f64);
        if found.phi.iter().any(|x| !x.is_finite()) {
            return Err(refused(
                "a flux comes out as infinite",
                "check `watts`, `gain` and the exposure times",
            ));
        }
        Ok(found)
    }

    /// Why an entry is left out; 0 if it is not.
    fn code(&self, spot: usize, pixel: usize, saturated: &[bool], dead: &[bool]) -> u8 {
        let mut code = 0;
        if self.footprints.is_outside(pixel) {
            code |= OUTSIDE;
        }
        if self.footprints.touches(pixel, saturated) {
            code |= SATURATED;
        }
        if self.footprints.touches(pixel, dead) {
            code |= DEAD;
        }
        let at = self.scene.laser.spots[spot].target.position;
        if self
            .set
            .halo
            .is_some_and(|radius| in_halo(&self.scene.camera, pixel, at, radius))
        {
            code |= HALO;
        }
        code
    }
}

/// The columns of all spots.
struct Columns {
    phi: Matrix,
    stderr: Matrix,
    left_out: Matrix,
    mean: Vec<f64>,
    gains: Vec<(usize, f64, f64)>,
    photographs: usize,
    zeros: usize,
}

/// The lines `stored,light` of a CSV file; lines that do not begin with a number are passed over.
fn response_table(name: &str, bytes: &[u8]) -> Result<ResponseTable, PhotographError> {
    let text = String::from_utf8_lossy(bytes);
    let mut pairs = Vec::new();
    for (k, line) in text.lines().enumerate() {
        let cells: Vec<Option<f64>> = line.split(',').map(|c| c.trim().parse().ok()).collect();
        match cells[..] {
            [Some(stored), Some(light)] => pairs.push([stored, light]),
            [None, ..] if pairs.is_empty() || line.trim().is_empty() => {}
            _ => {
                return Err(refused(
                    format!("line {} of {name} is not `stored,light`", k + 1),
                    "give two numbers a line",
                ));
            }
        }
    }
    ResponseTable::new(&pairs)
}

/// The mapping of the set's marks, if it has any.
fn fitted(set: &Set, camera: &Camera) -> Result<Option<Fitted>, PhotographError> {
    if set.marks.is_empty() {
        return Ok(None);
    }
    let view = &camera.view;
    let normal = view.normal();
    let diagonal = (view.u() + view.v()).length();
    let mut marks = Vec::with_capacity(set.marks.len());
    for (k, mark) in set.marks.iter().enumerate() {
        let odd = || {
            refused(
                format!("mark {k} at {:?} is no point of the wall", mark.wall),
                "give x and y, or x, y and z, of a point in the plane of the scene's view",
            )
        };
        if !mark.wall.iter().chain(&mark.pixel).all(|x| x.is_finite()) {
            return Err(odd());
        }
        let (x, y) = match mark.wall[..] {
            [x, y] | [x, y, _] => (x, y),
            _ => return Err(odd()),
        };
        // On the view's plane, straight above or below.
        let corner = view.corner();
        let z = corner.z - (normal.x * (x - corner.x) + normal.y * (y - corner.y)) / normal.z;
        if mark
            .wall
            .get(2)
            .is_some_and(|own| (own - z).abs() * normal.z.abs() > OFF_PLANE * diagonal)
        {
            return Err(odd());
        }
        marks.push(Mark {
            pixel: mark.pixel,
            wall: view.coordinates(crate::geometry::DVec3::new(x, y, z)),
        });
    }
    Mapping::from_marks(&marks, set.camera).map(Some)
}
