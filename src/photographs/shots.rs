//! The photographs of a set as light, and what they share: dark frames, flat field, dead pixels.

use std::path::{Path, PathBuf};

use super::dead::dead_pixels;
use super::error::{PhotographError, refused};
use super::flicker::Flicker;
use super::kind::Kind;
use super::noise::Repeated;
use super::pattern::expanded;
use super::plane::{Averaged, Chosen, Plane, linearised, same_full_scale, same_size};
use super::read::Reader;
use super::response::{Response, ResponseTable, response_table};
use super::set::{ChannelName, DarkTable, Files, FrameTable, Set};
use super::takes::{Take, each_spot, one_exposure, takes};
use crate::image::{Channel, Samples};

/// Most pixels whose repeats the photon transfer line is fitted to.
const MOST_REPEATED: usize = 1 << 20;

/// The photographs of a set, of one channel.
pub(super) struct Shots<'a> {
    set: &'a Set,
    spots: usize,
    chosen: Chosen,
    pub response: Option<ResponseTable>,
    pub takes: Vec<Take>,
    /// Columns and rows.
    pub size: [usize; 2],
    /// Largest value that the first photograph's integers can have.
    full_scale: Option<f64>,
    /// Averaged dark frames, with the exposure time of each.
    darks: Vec<(Option<f64>, Averaged)>,
    /// Averaged photographs of even radiance, and their dark frames.
    pub flat: Option<(Averaged, Option<Averaged>)>,
    pub dead: Vec<bool>,
    /// What the photographs are, where a channel of them is chosen.
    kind: Option<Kind>,
    /// Dark frames and flat fields that do not tell the channels of photographs in colour apart.
    pub grey: Vec<String>,
}

impl<'a> Shots<'a> {
    /// Reads what all photographs of the set share, of `spots` spots.
    pub(super) fn new(
        set: &'a Set,
        spots: usize,
        folder: &'a Path,
        channel: Option<ChannelName>,
        reader: &mut Reader<'a>,
        listed: &[FrameTable],
    ) -> Result<Self, PhotographError> {
        let takes = takes(set, listed, folder)?;
        let first = takes.first();
        let first = first.ok_or_else(|| refused("there are no photographs", "name one or more"))?;
        let name = reader.name(&first.path);
        let first = reader.photographs(&first.path)?;
        let first = first.first();
        let first =
            first.ok_or_else(|| refused("the first file has no photograph", "name another"))?;
        let (size, full_scale) = ([first.width, first.height], first.full_scale);
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
        let kind = (chosen != Chosen::Grey).then(|| Kind::of(name, first));
        let mut shots = Self {
            set,
            spots,
            chosen,
            response,
            takes,
            size,
            full_scale,
            darks: Vec::new(),
            flat: None,
            dead: Vec::new(),
            kind,
            grey: Vec::new(),
        };
        shots.dead = dead_pixels(set, shots.size, folder, reader)?;
        let mut grey = Vec::new();
        let mut average =
            |files: &Files| shots.average(&expanded(folder, files)?, reader, &mut grey);
        let darks = match &set.dark {
            None => Vec::new(),
            Some(DarkTable::Files(files)) => {
                one_exposure(&shots.takes)?;
                vec![(None, average(files)?)]
            }
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
        (shots.darks, shots.flat, shots.grey) = (darks, flat, grey);
        Ok(shots)
    }

    /// Share of the stored values of dark frames, those of flat fields too, that are 0; of none 0.
    pub(super) fn dark_zeros(&self) -> f64 {
        let of_flat = self.flat.iter().filter_map(|(_, dark)| dark.as_ref());
        let all = self.darks.iter().map(|(_, dark)| dark).chain(of_flat);
        let (zeros, values) = all.fold((0.0, 0), |(zeros, values), dark| {
            (
                zeros + dark.cut_off(),
                values + dark.frames * dark.light.len(),
            )
        });
        zeros / values.max(1) as f64
    }

    /// One channel of a photograph as light.
    fn plane(
        &self,
        name: &str,
        samples: &Samples,
        chosen: Chosen,
    ) -> Result<Plane, PhotographError> {
        same_size(name, [samples.width, samples.height], self.size)?;
        if self.set.full_scale.is_none() {
            same_full_scale(name, samples.full_scale, self.full_scale)?;
        }
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
        if let (Some(saturation), Some(full)) = (self.set.saturation, full_scale)
            && saturation > full
        {
            return Err(refused(
                format!(
                    "saturation = {saturation} is above the largest value of {name}, {full}, so that no pixel would be \
                     taken for saturated"
                ),
                format!("leave `saturation` out, or give at most {full}"),
            ));
        }
        let saturation = self.set.saturation.or(full_scale).unwrap_or(f64::INFINITY);
        linearised(name, samples, chosen, &response, saturation)
    }

    /// The mean of all photographs in `paths`, dark frames or flat fields; `grey` gets the names of
    /// those that miss the colour of the others.
    fn average(
        &self,
        paths: &[PathBuf],
        reader: &mut Reader<'_>,
        grey: &mut Vec<String>,
    ) -> Result<Averaged, PhotographError> {
        let mut mean: Option<Averaged> = None;
        for path in paths {
            let name = reader.name(path);
            if self.takes.iter().any(|take| take.path == *path) {
                return Err(refused(
                    format!("{name} is named as a photograph, and as a dark frame or flat field"),
                    "name every file once",
                ));
            }
            let found = reader.photographs(path)?;
            let is_missed = |kind: &Kind| found.iter().any(|s| kind.is_missed_by(s));
            if self.kind.as_ref().is_some_and(is_missed) {
                grey.push(name.clone());
            }
            for samples in found {
                // A grey dark frame or flat field is that of every channel.
                let chosen = match samples.channels.len() {
                    1 => Chosen::Grey,
                    _ => self.chosen,
                };
                let plane = self.plane(&name, &samples, chosen)?;
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

    /// The dark frames of the shortest exposure time: what is above them is counted in electrons,
    /// of light and of the dark current.
    pub(super) fn shortest_dark(&self) -> Option<&Averaged> {
        let time = |(time, _): &&(Option<f64>, Averaged)| time.unwrap_or(0.0);
        let shortest = self.darks.iter().min_by(|a, b| time(a).total_cmp(&time(b)));
        shortest.map(|(_, dark)| dark)
    }

    /// The dark frames of an exposure time.
    pub(super) fn dark(&self, take: &Take) -> Result<Option<&Averaged>, PhotographError> {
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

    /// Calls `visit` with the averaged photographs of each spot, in the order of the spots.
    pub(super) fn each_spot(
        &self,
        reader: &mut Reader<'_>,
        visit: impl FnMut(usize, &Take, Averaged) -> Result<(), PhotographError>,
    ) -> Result<(), PhotographError> {
        let plane = |name: &str, samples: &Samples| {
            if let Some(kind) = &self.kind {
                kind.refuse_other(name, samples)?;
            }
            self.plane(name, samples, self.chosen)
        };
        let repeats = self.set.repeats.map_or(1, |n| n as usize);
        each_spot(reader, (&self.takes, repeats), self.spots, &plane, visit)
    }

    /// Whether photographs are repeated: as the set says, in files of one spot, or in the first
    /// file of a list.
    pub(super) fn has_repeats(&self, reader: &mut Reader<'_>) -> Result<bool, PhotographError> {
        let mut pairs = self.takes.windows(2);
        let are_of_one = |pair: &[Take]| pair[0].spot.is_some() && pair[0].spot == pair[1].spot;
        if self.set.repeats.is_some_and(|n| n > 1) || pairs.any(are_of_one) {
            return Ok(true);
        }
        match self.takes.first().filter(|take| take.spot.is_some()) {
            Some(take) => Ok(reader.photographs(&take.path)?.len() > 1),
            None => Ok(false),
        }
    }

    /// The repeats of the pixels of one channel, from all repeated photographs, none where none
    /// are; and by what these differ as wholes.
    pub(super) fn repeated(
        &self,
        reader: &mut Reader<'_>,
    ) -> Result<(Vec<Repeated>, Flicker), PhotographError> {
        let spots = self.spots;
        let pixels = self.size[0] * self.size[1];
        let stride = (spots * pixels).div_ceil(MOST_REPEATED);
        let (mut repeated, mut flicker) = (Vec::new(), Flicker::default());
        let visit = |spot: usize, _: &Take, mean: Averaged| {
            let below = self.shortest_dark();
            flicker.add(&mean, below);
            let light = |k: usize| mean.light[k] - below.map_or(0.0, |d| d.light[k]);
            for k in (0..pixels).skip(spot % stride).step_by(stride) {
                let good = !mean.saturated[k] && !self.dead[k];
                if let (Some(variance), true) = (mean.scatter(k), good) {
                    // Of one channel, where light is the mean of several.
                    repeated.push(Repeated {
                        signal: light(k),
                        beside: 0.5 * (light(k.saturating_sub(1)) + light((k + 1).min(pixels - 1))),
                        variance: variance / mean.share,
                        rounding: mean.rounding[k] / mean.share,
                        freedom: (mean.frames - 1) as f64,
                    });
                }
            }
            Ok(())
        };
        self.each_spot(reader, visit)?;
        Ok((repeated, flicker))
    }

    /// The same of the dark frames of the shortest exposure time: of no light.
    pub(super) fn dark_repeats(&self) -> Vec<Repeated> {
        let Some(dark) = self.shortest_dark() else {
            return Vec::new();
        };
        let stride = dark.light.len().div_ceil(MOST_REPEATED).max(1);
        let pixels = (0..dark.light.len()).step_by(stride);
        let pixels = pixels.filter(|k| !dark.saturated[*k] && !self.dead[*k]);
        let of = |k: usize| {
            Some(Repeated {
                signal: 0.0,
                beside: 0.0,
                variance: dark.scatter(k)? / dark.share,
                rounding: dark.rounding[k] / dark.share,
                freedom: (dark.frames - 1) as f64,
            })
        };
        pixels.filter_map(of).collect()
    }

    /// Why photographs of one set may lie on several photon transfer lines, if they may.
    pub(super) fn differ(&self) -> Option<&'static str> {
        let several = |of: fn(&Take) -> Option<f64>| {
            let first = self.takes.first().map(of);
            self.takes.iter().any(|take| Some(of(take)) != first)
        };
        if several(|take| Some(take.gain)) {
            return Some(
                "the photographs have several `gain`s, and where that is the camera's each has a line of its own; import each by itself, or give `noise`",
            );
        }
        (self.has_offset() && several(|take| take.exposure)).then_some(
            "the photographs have several exposure times, and a dark current differs between them; give `dark` of each",
        )
    }

    /// Whether the camera's offset is in their light.
    pub(super) fn has_offset(&self) -> bool {
        self.darks.is_empty()
    }
}
