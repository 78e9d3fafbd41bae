//! All photographs of a set as Φcam.

use std::path::Path;

use super::account::{ImportAccount, Imported};
use super::columns::Columns;
use super::error::{PhotographError, refused};
use super::flicker::Flicker;
use super::left_out::LeftOut;
use super::list::{place, positions, tables};
use super::misplaced::{elsewhere, mirrored, misread, outside, stretched};
use super::noise::{contradicted, photon_transfer};
use super::placing::{OFF_PLANE, Placing};
use super::read::Reader;
use super::set::{ChannelName, FrameTable, Set};
use super::shots::Shots;
use super::takes::Take;
use super::warnings::{
    bent, by_own_light, colourless, copied, cut_off, extrapolated, flickers, little_left,
    misstated, no_light, roughly, rounded, shared, unsaid,
};
use crate::scene::{Scene, SceneError};

/// Variance of the entries' variances over their squares above which no standard error is stated:
/// it would be known to a sixth of itself.
const MOST_UNKNOWN: f64 = 0.1;

/// The scene with the spots whose positions the set lists, if it does.
///
/// # Errors
/// [`PhotographError`] for spots that are not on the wall.
pub fn scene_of(set: &Set, scene: Scene, folder: &Path) -> Result<Scene, PhotographError> {
    let mut reader = Reader::new(folder, None, None);
    let tables = tables(set, &mut reader, folder)?;
    let Some(places) = positions(&tables)? else {
        return Ok(scene);
    };
    let off = |e: SceneError| {
        let cause = format!(
            "the positions of the spots do not fit the scene: {}",
            e.cause
        );
        refused(
            cause,
            "check the columns x and y of the list, or the keys `position`, along the axes of the scene's spots",
        )
    };
    let scene = scene.with_listed_spots(&places).map_err(off)?;
    on_the_wall(&tables, &places, &scene)?;
    Ok(scene)
}

/// Refuses a position whose z is not that of the wall at its x and y.
fn on_the_wall(
    tables: &[FrameTable],
    places: &[[f64; 2]],
    scene: &Scene,
) -> Result<(), PhotographError> {
    let view = &scene.camera.view;
    let diagonal = (view.u() + view.v()).length();
    for table in tables {
        let own = place(table)?;
        let spots = places.iter().zip(&scene.laser.spots);
        let spot = spots.filter(|(place, _)| **place == own).map(|(_, s)| s);
        let z = table.position.as_ref().and_then(|p| p.get(2)).copied();
        for (z, spot) in z.into_iter().zip(spot) {
            let wall = spot.target.position.z;
            let off = (z - wall).abs();
            if off.is_nan() || off > OFF_PLANE * diagonal {
                return Err(refused(
                    format!(
                        "the position {:?} of {} is off the wall, where z is {wall}",
                        table.position.as_deref().unwrap_or_default(),
                        table.file
                    ),
                    "give x and y along the axes of the scene's spots, or these and the wall's z",
                ));
            }
        }
    }
    Ok(())
}

/// Φcam of `scene` ([`scene_of`]) from the photographs of `set` in `folder`, of one channel where
/// they are in colour. Files are read once, or twice where repeats tell the noise; of all
/// photographs those of one file and the average of its spot are held at a time.
///
/// # Errors
/// [`PhotographError`].
pub fn import(
    set: &Set,
    scene: &Scene,
    folder: &Path,
    channel: Option<ChannelName>,
) -> Result<Imported, PhotographError> {
    if set.halo.is_some() && scene.laser.is_shining() {
        return Err(refused(
            "a halo about the laser's spot, and the scene has no laser: its hidden surface shines",
            "remove `halo`",
        ));
    }
    let mut reader = Reader::new(folder, set.variable.as_deref(), set.axes);
    let listed = tables(set, &mut reader, folder)?;
    let spots = scene.laser.spots.len();
    let shots = Shots::new(set, spots, folder, channel, &mut reader, &listed)?;
    let placing = Placing::new(set, &scene.camera, shots.size)?;
    let unit = unit(set.watts, &shots.takes)?;
    let given = set.camera_noise()?;
    let (repeated, flicker) = if given.is_none() || shots.has_repeats(&mut reader)? {
        shots.repeated(&mut reader)?
    } else {
        (Vec::new(), Flicker::default())
    };
    let contradicted = given.and_then(|noise| contradicted(&repeated, noise));
    let line = if given.is_some() || repeated.is_empty() {
        None
    } else {
        let all = [repeated, shots.dark_repeats()].concat();
        Some(photon_transfer(all, shots.has_offset())?)
    };
    let noise = given.or(line.map(|l| l.noise));
    let known = (noise, line.as_ref());
    let columns = Columns::of(set, scene, (&shots, &placing), known, &mut reader)?;
    let is_known = columns.unknown <= MOST_UNKNOWN;
    let left_out = LeftOut::of(&columns.left_out);
    let mut warnings = unsaid(set, &placing);
    warnings.extend(little_left(&left_out));
    warnings.extend(no_light(&columns.phi));
    let view = &scene.camera.view;
    if let Some(fitted) = &placing.fitted {
        warnings.extend(mirrored(&placing.mapping, &scene.camera));
        warnings.extend(outside(&placing.marks, shots.size));
        warnings.extend(misread(fitted, &placing.marks, set.camera));
        let scaled = set.watts.and(elsewhere(&placing.mapping, &scene.camera));
        warnings.extend(scaled);
    } else {
        let extent = set.crop.map(|c| [c.width, c.height]);
        let extent = extent.unwrap_or(shots.size.map(|n| n as f64));
        warnings.extend(stretched(extent, [view.u().length(), view.v().length()]));
    }
    warnings.extend(rounded(columns.rounded));
    warnings.extend(shared(placing.footprints.shared()));
    warnings.extend(line.and_then(|line| bent(&line, shots.differ())));
    warnings.extend(contradicted.map(misstated));
    if noise.is_some() && !is_known {
        warnings.push(extrapolated(columns.unknown));
    }
    warnings.extend(flicker.found().map(flickers));
    if noise.is_some_and(|n| n.has_offset) {
        warnings.push("without dark frames the repeats do not tell the read noise: the photon transfer line is over light with the camera's offset in it, and its value at 0 is σ² − g·offset; give `dark`".to_owned());
    }
    if noise.is_none() {
        warnings.push("the noise is not known (no two photographs of a spot with pixels that count, and no `noise`): there is no standard error; recover weighs all entries alike, or with --noise".to_owned());
    }
    if reader.is_lossy && set.gamma.is_none() && set.response.is_none() {
        warnings.push("JPEG is neither linear nor without loss: give `gamma` or `response`, or photographs that the camera saves as they are".to_owned());
    }
    if let Some((file, gamma)) = &reader.encoded
        && set.gamma.is_none()
        && set.response.is_none()
    {
        warnings.push(format!("{file} says that its values are those of light to the power 1/{gamma:.2} (its sRGB or gAMA chunk), and they are taken for linear: give `gamma` or `response`; `gamma = 1` where they are the camera's own"));
    }
    let all = columns.photographs * shots.size[0] * shots.size[1];
    warnings.extend(cut_off(columns.zeros / all as f64, shots.dark_zeros()));
    warnings.extend(by_own_light(columns.by_own_light));
    warnings.extend(colourless(&shots.grey));
    let table = shots.response.as_ref();
    warnings.extend(table.and_then(|table| table.beyond(columns.highest.value())));
    warnings.extend(
        columns
            .highest
            .clipped()
            .filter(|_| set.saturation.is_none()),
    );
    warnings.extend(copied(
        shots
            .takes
            .iter()
            .filter_map(|take| reader.source(&take.path)),
    ));
    let Placing {
        fitted, mapping, ..
    } = placing;
    let mut account = ImportAccount {
        scene: scene.name.clone(),
        scene_hash: scene.hash.clone(),
        set: set.clone(),
        channel,
        unit,
        photograph: shots.size,
        photographs: columns.photographs,
        noise,
        photon_transfer: line,
        mark_rms: fitted.as_ref().map(|f| f.rms),
        mark_error: fitted.as_ref().and_then(|f| f.mark_error),
        mark_residuals: fitted.map_or(Vec::new(), |f| f.residuals),
        gains: columns.gains,
        unknown: columns.unknown,
        common: columns.common,
        of_flat: columns.of_flat,
        left_out,
        warnings,
        files: reader.sources(),
    };
    account.warnings.extend(account.frame_gain().map(roughly));
    Ok(Imported {
        phi: columns.phi,
        stderr: noise.filter(|_| is_known).map(|_| columns.stderr),
        left_out: columns.left_out,
        mean: (columns.mean, shots.size),
        mapping,
        account,
    })
}

/// The unit of Φ.
fn unit(watts: Option<f64>, takes: &[Take]) -> Result<&'static str, PhotographError> {
    let timed = takes.iter().filter(|t| t.exposure.is_some()).count();
    if timed != 0 && timed != takes.len() {
        return Err(refused(
            "some photographs have an exposure time and others not",
            "give every one, or one `exposure` for all",
        ));
    }
    match (watts, timed) {
        (Some(_), 0) => Err(refused(
            "`watts` is for each count per second, and no exposure time is known",
            "give `exposure`, s",
        )),
        (Some(_), _) => Ok("W"),
        (None, 0) => Ok("counts"),
        (None, _) => Ok("counts/s"),
    }
}

#[cfg(test)]
mod tests {
    use std::slice::from_ref;

    use super::*;

    #[test]
    fn watts_need_seconds() {
        let take = |exposure| Take {
            path: "a".into(),
            spot: None,
            exposure,
            gain: 1.0,
            gain_error: 0.0,
        };
        let (timed, untimed) = (take(Some(0.5)), take(None));
        let error = unit(Some(2.0), from_ref(&untimed)).unwrap_err().to_string();
        assert!(
            error.contains("exposure") && error.contains("watts"),
            "{error}"
        );
        assert_eq!(unit(Some(2.0), from_ref(&timed)).unwrap(), "W");
        assert_eq!(unit(None, from_ref(&timed)).unwrap(), "counts/s");
        assert_eq!(unit(None, from_ref(&untimed)).unwrap(), "counts");
        assert!(unit(None, &[timed, untimed]).is_err());
    }
}
